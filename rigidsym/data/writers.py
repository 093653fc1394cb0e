"""Files of numbers that are whole or not there: NPY, Parquet, text."""

from __future__ import annotations

import csv
import io
import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.lib import format as npy
from numpy.typing import NDArray

from rigidsym.data.chunk import Table
from rigidsym.errors import DataError, MissingExtra, RequestError
from rigidsym.system.files import whole_file

ENDINGS = (".npy", ".csv", ".txt", ".parquet", ".pq")
Kept = Sequence[NDArray[Any]]  # columns passed through, before those of the table
_EXACT = 1 << 53  # a larger integer may not be a double


def check_ending(path: Path, *others: str) -> None:
    """Raise RequestError for an ending that is neither a writer's nor among the others."""
    if path.suffix.lower() not in (*ENDINGS, *others):
        found = f"the ending {path.suffix}" if path.suffix else "no ending"
        known = ", ".join((*ENDINGS, *others))
        raise RequestError(f"{path} has {found}; expected {known}")


@contextmanager
def table_writer(
    path: Path, names: Sequence[str], dtype: np.dtype[Any], stream: BinaryIO | None = None
) -> Iterator[TableWriter]:
    """The writer of a file, by its ending; the file is in place only if the block succeeds.

    With a stream, such as standard output, text is written there.
    """
    if stream is not None:
        yield TextWriter(stream, names, dtype)
        return
    with whole_file(path) as file:
        writer = _WRITERS[path.suffix.lower()](file, names, dtype)
        try:
            yield writer
        except BaseException:
            with suppress(OSError):  # of a full disk, which was reported when rows were written
                writer.finish()  # pyarrow would do it later, into a closed file
            raise
        writer.finish()
        file.flush()
        os.fsync(file.fileno())


class NpyWriter:
    """An NPY file; its header is written again at the end, when the number of rows is known."""

    def __init__(self, file: BinaryIO, names: Sequence[str], dtype: np.dtype[Any]) -> None:
        self._file, self._width, self._dtype, self._rows = file, len(names), dtype, 0
        self._write_header()

    def _write_header(self) -> None:
        """NumPy leaves room in it for the first axis to grow, so that its length stays."""
        header = {
            "descr": npy.dtype_to_descr(self._dtype),
            "fortran_order": False,
            "shape": (self._rows, self._width),
        }
        npy.write_array_header_1_0(self._file, header)

    def append(self, table: Table, kept: Kept = ()) -> None:
        """Raises DataError for kept columns that are not numbers, or lose digits as such."""
        if kept:
            table = np.column_stack([*map(self._as_number, kept), table])
        self._file.write(np.ascontiguousarray(table, self._dtype).tobytes())
        self._rows += len(table)

    def _as_number(self, column: NDArray[Any]) -> Table:
        try:
            numbers = column.astype(self._dtype)
        except ValueError:
            numbers = None
        if numbers is None or np.abs(numbers).max(initial=0) > _EXACT:
            raise DataError(
                "a column of --keep has texts or integers beyond 2^53, which an NPY file of floats "
                "cannot contain; expected .csv or .parquet"
            )
        return numbers

    def finish(self) -> None:
        """Write the header with the number of rows."""
        self._file.seek(0)
        self._write_header()


class TextWriter:
    """Text with commas and a first line of names; every number reads back as it was."""

    def __init__(self, file: BinaryIO, names: Sequence[str], dtype: np.dtype[Any]) -> None:
        self._file, self._dtype = file, dtype
        self._file.write(_quoted([names]).encode())

    def append(self, table: Table, kept: Kept = ()) -> None:
        """Write rows, kept columns first."""
        # plain floats are faster to write; of a float32 they would hold digits it does not have
        rows = table.tolist() if self._dtype.itemsize == 8 else table
        if kept:
            heads = zip(*kept, strict=True)
            text = _quoted((*head, *map(str, row)) for head, row in zip(heads, rows, strict=True))
        else:
            text = "".join(f"{','.join(map(str, row))}\n" for row in rows)
        self._file.write(text.encode())
        self._file.flush()

    def finish(self) -> None:
        """The end of a text needs nothing."""


def _quoted(rows: Any) -> str:
    """Lines of fields, in quotes if they hold commas."""
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows(rows)
    return text.getvalue()


class ParquetWriter:
    """A Parquet file, a row group for each chunk."""

    def __init__(self, file: BinaryIO, names: Sequence[str], dtype: np.dtype[Any]) -> None:
        try:
            import pyarrow
            from pyarrow import parquet
        except ImportError:
            raise MissingExtra("Parquet", "parquet") from None
        self._arrow, self._parquet = pyarrow, parquet
        self._file, self._names, self._dtype = file, list(names), dtype
        self._writer: Any = None

    def append(self, table: Table, kept: Kept = ()) -> None:
        """Write rows, kept columns first, in their own types."""
        columns = [self._arrow.array(column) for column in kept]
        columns += [np.ascontiguousarray(column, self._dtype) for column in table.T]
        rows = self._arrow.table(dict(zip(self._names, columns, strict=True)))
        if self._writer is None:
            self._writer = self._parquet.ParquetWriter(self._file, rows.schema)
        self._writer.write_table(rows)

    def finish(self) -> None:
        """Write the footer."""
        if self._writer is None:
            self.append(np.empty((0, len(self._names)), self._dtype))
        self._writer.close()


TableWriter = NpyWriter | TextWriter | ParquetWriter  # a file that grows row by row
_WRITERS: dict[str, type[TableWriter]] = {
    ".npy": NpyWriter,
    ".csv": TextWriter,
    ".txt": TextWriter,
    ".parquet": ParquetWriter,
    ".pq": ParquetWriter,
}
