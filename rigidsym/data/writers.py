"""Files that grow row by row: a draft beside their place, moved into it when it is whole.

A draft can be taken up again at a place where a piece ended.
"""

from __future__ import annotations

import os
import shutil
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from numpy.lib import format as npy

from rigidsym.data.chunk import Table
from rigidsym.errors import MissingExtra, RequestError
from rigidsym.system.files import to_disk


class Sink(Protocol):
    """Where rows go."""

    def append(self, table: Table) -> int:
        """Write rows; the place at which they end, in the sink's own measure."""

    def settle(self) -> None:
        """Wait until all rows so far are on the disk."""

    def finish(self, rows: int) -> None:
        """Close the draft, which holds this many rows, and move it into its place."""

    def close(self) -> None:
        """Leave the draft as it is."""


def draft_of(path: Path) -> Path:
    """Where the rows stand until all are there."""
    return path.with_name(f"{path.name}.part")


def check_ending(path: Path) -> None:
    """Raise RequestError for a file that no sink writes, naming the endings that are known."""
    if path.suffix.lower() not in ENDINGS:
        found = f"the ending {path.suffix}" if path.suffix else "no ending"
        raise RequestError(f"{path} has {found}; a result ends in {', '.join(ENDINGS)}")


def sink_for(path: Path, names: Sequence[str], dtype: np.dtype[Any], start: int = 0) -> Sink:
    """The sink for a file, by its ending: NPY, Parquet, or text with commas.

    `start` is the place at which a draft goes on; 0 begins a new one.
    """
    return _KINDS[path.suffix.lower()](path, names, dtype, start)


def reaches(path: Path, place: int) -> bool:
    """Whether the draft of a file has all that was written up to a place."""
    return _KINDS[path.suffix.lower()].reaches(draft_of(path), place)


class _FileSink:
    """A draft that is one file, written from its start or from where it ended."""

    def __init__(self, path: Path, start: int) -> None:
        self._path = path
        self._file = draft_of(path).open("r+b" if start else "w+b")
        self._file.truncate(start)
        self._file.seek(start)

    @staticmethod
    def reaches(draft: Path, place: int) -> bool:
        return draft.is_file() and draft.stat().st_size >= place

    def _write(self, content: bytes) -> int:
        self._file.write(content)
        self._file.flush()
        return self._file.tell()

    def settle(self) -> None:
        self._file.flush()
        os.fsync(self._file.fileno())

    def finish(self, rows: int) -> None:  # noqa: ARG002 - a text does not say how many it has
        self.settle()
        self._file.close()
        os.replace(draft_of(self._path), self._path)

    def close(self) -> None:
        with suppress(OSError):  # of a full disk, which was said when the rows were written
            self._file.close()


class NpySink(_FileSink):
    """An NPY file; its header is written again at the end, when the number of rows is known."""

    def __init__(
        self, path: Path, names: Sequence[str], dtype: np.dtype[Any], start: int = 0
    ) -> None:
        super().__init__(path, start)
        self._dtype, self._width = dtype, len(names)
        if not start:
            self._write_header(0)

    def _write_header(self, rows: int) -> None:
        """NumPy leaves room in it for the first axis to grow, so that its length stays."""
        header = {
            "descr": npy.dtype_to_descr(self._dtype),
            "fortran_order": False,
            "shape": (rows, self._width),
        }
        npy.write_array_header_1_0(self._file, header)

    def append(self, table: Table) -> int:
        return self._write(np.ascontiguousarray(table, self._dtype).tobytes())

    def finish(self, rows: int) -> None:
        self._file.seek(0)
        self._write_header(rows)
        super().finish(rows)


class TextSink(_FileSink):
    """Text with commas and a first line of names; every number reads back as it was."""

    def __init__(
        self, path: Path, names: Sequence[str], dtype: np.dtype[Any], start: int = 0
    ) -> None:
        super().__init__(path, start)
        self._dtype = dtype
        if not start:
            self._write((",".join(names) + "\n").encode())

    def append(self, table: Table) -> int:
        # plain floats are faster to write; of a float32 they would hold digits it does not have
        rows = table.tolist() if self._dtype.itemsize == 8 else table
        return self._write("".join(f"{','.join(map(str, row))}\n" for row in rows).encode())


class ParquetSink:
    """A Parquet file; its draft is a folder with a file for each piece."""

    def __init__(
        self, path: Path, names: Sequence[str], dtype: np.dtype[Any], start: int = 0
    ) -> None:
        try:
            import pyarrow
            from pyarrow import parquet
        except ImportError:
            raise MissingExtra("Parquet", "parquet") from None
        self._arrow, self._parquet = pyarrow, parquet
        self._path, self._folder = path, draft_of(path)
        self._names, self._dtype, self._count = list(names), dtype, start
        self._settled = start
        if not start and self._folder.exists():
            shutil.rmtree(self._folder)
        self._folder.mkdir(exist_ok=True)

    @staticmethod
    def reaches(draft: Path, place: int) -> bool:
        return all((draft / _part(count)).is_file() for count in range(place))

    def append(self, table: Table) -> int:
        self._parquet.write_table(self._as_arrow(table), self._folder / _part(self._count))
        self._count += 1
        return self._count

    def settle(self) -> None:
        for count in range(self._settled, self._count):
            to_disk(self._folder / _part(count))
        to_disk(self._folder)
        self._settled = self._count

    def _as_arrow(self, table: Table) -> Any:
        columns = [np.ascontiguousarray(column, self._dtype) for column in table.T]
        return self._arrow.table(dict(zip(self._names, columns, strict=True)))

    def finish(self, rows: int) -> None:  # noqa: ARG002 - the pieces know how many they are
        whole = self._folder / "whole.parquet"
        schema = self._as_arrow(np.empty((0, len(self._names)))).schema
        with self._parquet.ParquetWriter(whole, schema) as writer:
            for place in range(self._count):
                writer.write_table(self._parquet.read_table(self._folder / _part(place)))
        to_disk(whole)
        os.replace(whole, self._path)
        shutil.rmtree(self._folder)

    def close(self) -> None:
        """Every piece is a file of its own: there is nothing to close."""


def _part(count: int) -> str:
    return f"{count:08d}.parquet"


_KINDS: dict[str, type[NpySink] | type[TextSink] | type[ParquetSink]] = {
    ".npy": NpySink,
    ".csv": TextSink,
    ".txt": TextSink,
    ".parquet": ParquetSink,
    ".pq": ParquetSink,
}
ENDINGS = tuple(_KINDS)
