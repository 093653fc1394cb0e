"""Tables of numbers, read and written in batches: NPY and arrays by NumPy, the rest by polars.

A table is read from its beginning as often as needed, a few ten thousand rows at a time, so that
its length does not matter.
"""

from __future__ import annotations

import csv
import errno
import io
import re
from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import chain, islice
from pathlib import Path
from tokenize import TokenError
from typing import Any, BinaryIO, Literal

import numpy as np
from numpy.lib import format as npy
from numpy.typing import NDArray

from rigidsym.errors import DataError, MissingExtra, RequestError
from rigidsym.system.files import whole_file
from rigidsym.system.processes import Progress

Numbers = NDArray[Any]  # float32 or float64, (rows, columns)
Missing = Literal["error", "nan", "drop"]
ROWS = 65_536  # in memory at once
ENDINGS = (".npy", ".csv", ".txt", ".parquet", ".pq")  # that are written
MOST_SHOWN = 10  # faults in one message
_NUMERIC = "fiub"


@dataclass(frozen=True, slots=True, eq=False)
class Batch:
    """Some rows of a table; missing numbers are NaN."""

    table: Numbers
    rows: NDArray[np.intp]  # their numbers, counted from 0, (rows,)
    share: float  # of the table that has been read with this batch
    kept: tuple[NDArray[Any], ...] = ()  # columns passed through as they are, (rows,) each

    def at(self, which: slice | NDArray[Any]) -> Batch:
        """Some of its rows."""
        kept = tuple(column[which] for column in self.kept)
        return Batch(self.table[which], self.rows[which], self.share, kept)


class Table(ABC):
    """Rows that can be read from the beginning, in batches."""

    source = ""  # what messages call the table: the path of its file, or empty for an array
    names: tuple[str, ...] | None = None  # of the columns, if there are any
    width: int
    dtype: np.dtype[Any] = np.dtype(np.float64)  # float32 if the table holds nothing finer
    eps = 0.0  # relative precision of the numbers if it is below double

    @abstractmethod
    def batches(
        self, columns: Sequence[int], rows: int = ROWS, kept: Sequence[int] = ()
    ) -> Iterator[Batch]:
        """All rows, at most `rows` at a time: the numbers of `columns`, and those `kept`.

        Raises DataError, with the line, for a field that is not a number.
        """

    def read(self, columns: Sequence[int], progress: Progress | None = None) -> Batch:
        """The whole table."""
        tables, rows = [np.empty((0, len(columns)))], [np.empty(0, np.intp)]
        for batch in self.batches(columns):
            tables.append(batch.table)
            rows.append(batch.rows)
            if progress is not None:
                progress(batch.share)
        return Batch(np.concatenate(tables), np.concatenate(rows), 1.0)

    def place(self, row: int) -> str:
        """How messages name a row: row 3, line 17."""
        return f"row {row + 1}"


def open_table(path: Path) -> Table:
    """The table in a file, by its ending: NPY, Parquet, or else text with separators.

    Raises DataError for a file that holds no table of numbers.
    """
    if not path.is_file():
        fault = "not a regular file"
        raise DataError(f"{path}: {fault if path.exists() else 'no such file'}")
    if path.suffix.lower() == ".npy":
        return NpyTable(path)
    return (ParquetTable if path.suffix.lower() in (".parquet", ".pq") else TextTable)(path)


def without_missing(
    table: Table, batches: Iterable[Batch], names: Sequence[str], missing: Missing
) -> Iterator[Batch]:
    """Batches in which missing numbers are an error, stay NaN, or cost the row that lacks them.

    `names` are those of the columns of the batches, for the message of DataError.
    """
    for batch in batches:
        lacking = np.isnan(batch.table)
        rows = np.asarray(lacking.any(axis=1))
        if missing == "nan" or not rows.any():
            yield batch
        elif missing == "drop":
            if not rows.all():
                yield batch.at(~rows)
        else:
            row = int(rows.argmax())
            raise DataError(
                f"{table.source}, {table.place(int(batch.rows[row]))}: "
                f"{names[int(lacking[row].argmax())]} is missing; "
                "--missing nan writes NaN, --missing drop leaves such rows out"
            )


# Arrays


class ArrayTable(Table):
    """Arrays (rows, columns) side by side; data with named columns have these names.

    Raises DataError for other shapes and for types that are not numbers.
    """

    def __init__(self, *arrays: Any) -> None:
        if len(arrays) == 1 and (names := names_of(arrays[0])):
            self.names, arrays = _named(arrays[0], names)
        arrays = tuple(map(np.asarray, arrays))
        for array in arrays:
            if array.ndim != 2 or array.dtype.kind not in _NUMERIC:
                raise DataError(
                    f"expected numbers of shape (rows, columns), got {array.dtype} of shape "
                    f"{array.shape}"
                )
        self._columns = [column for array in arrays for column in array.T]
        self.width, self._length = len(self._columns), len(arrays[0])
        floats = [a.dtype for a in arrays if a.dtype.kind == "f"]
        is_single = len(floats) == len(arrays) and all(kind.itemsize == 4 for kind in floats)
        self.dtype = np.dtype(np.float32 if is_single else np.float64)
        self.eps = max((float(np.finfo(k).eps) for k in floats if k.itemsize < 8), default=0.0)

    def __len__(self) -> int:
        return self._length

    def batches(
        self, columns: Sequence[int], rows: int = ROWS, kept: Sequence[int] = ()
    ) -> Iterator[Batch]:
        """As `Table.batches`."""
        for first in range(0, len(self), rows):
            some = slice(first, min(first + rows, len(self)))
            yield Batch(
                np.stack([self._columns[k][some].astype(self.dtype) for k in columns], axis=1),
                np.arange(some.start, some.stop),
                some.stop / len(self),
                tuple(self._columns[k][some].copy() for k in kept),
            )


class NpyTable(ArrayTable):
    """An NPY file; the fields of a structured array are its columns."""

    def __init__(self, path: Path) -> None:
        self.source, self._path = str(path), path
        with path.open("rb") as file:
            begins = file.read(6)
        if begins != b"\x93NUMPY":
            kind = "another kind of file" if begins else "an empty file"
            raise DataError(f"{path}: not an NPY file of numbers, but {kind}")
        try:
            super().__init__(np.load(path, mmap_mode="r", allow_pickle=False))
        except DataError as error:
            raise DataError(f"{path}: {error}") from None
        # NumPy parses the header as Python, and maps as many bytes as it states.
        except (ValueError, TypeError, SyntaxError, TokenError, EOFError, OverflowError):
            size = path.stat().st_size
            message = f"{path}: not an NPY file of numbers, or damaged ({size} bytes)"
            raise DataError(message) from None

    def batches(
        self, columns: Sequence[int], rows: int = ROWS, kept: Sequence[int] = ()
    ) -> Iterator[Batch]:
        """As `Table.batches`; the file is mapped anew for each, which frees what was read."""
        for batch in super().batches(columns, rows, kept):
            yield batch
            ArrayTable.__init__(self, np.load(self._path, mmap_mode="r", allow_pickle=False))


def names_of(data: Any) -> list[str]:
    """The names of the columns of a data frame, structured array or mapping; none without them."""
    names = getattr(data, "column_names", None)
    names = names or (data.keys() if hasattr(data, "keys") else getattr(data, "columns", None))
    names = getattr(getattr(data, "dtype", None), "names", None) if names is None else names
    names = [] if names is None else list(names)
    return names if any(isinstance(name, str) for name in names) else []


def _named(data: Any, names: Sequence[str]) -> tuple[tuple[str, ...], tuple[NDArray[Any], ...]]:
    """The columns of numbers and their names; a field of several numbers is q[0], q[1], ..."""
    arrays: dict[str, NDArray[Any]] = {}
    for name in names:
        column = np.asanyarray(data[name])
        if column.dtype.kind in _NUMERIC:
            parts = column.reshape(len(column), -1).T
            keys = [name] if len(parts) == 1 else [f"{name}[{k}]" for k in range(len(parts))]
            arrays |= dict(zip(keys, parts, strict=True))
    if not arrays:
        raise DataError("no field of the structured array holds numbers")
    return tuple(arrays), tuple(column[:, None] for column in arrays.values())


# Parquet


def _polars() -> Any:
    try:
        import polars
    except ImportError:
        raise MissingExtra("reading and writing text and Parquet", "data") from None
    return polars


class ParquetTable(Table):
    """A Parquet file; numbers that are missing are NaN."""

    def __init__(self, path: Path) -> None:
        self._polars, self.source = _polars(), str(path)
        with self._reported():
            self._scan = self._polars.scan_parquet(path)
            schema = self._scan.collect_schema()
            self._length = self._scan.select(self._polars.len()).collect().item()
        self._names = self.names = tuple(schema.names())
        self.width = len(self._names)
        self._is_number = [kind.is_numeric() for kind in schema.dtypes()]
        if all(kind == self._polars.Float32 for kind in schema.dtypes()):
            self.dtype = np.dtype(np.float32)

    def batches(
        self, columns: Sequence[int], rows: int = ROWS, kept: Sequence[int] = ()
    ) -> Iterator[Batch]:
        """As `Table.batches`."""
        if wrong := [self._names[k] for k in columns if not self._is_number[k]]:
            raise DataError(f"{self.source}: no numbers in the columns {', '.join(wrong)}")
        chosen = [self._names[k] for k in dict.fromkeys([*columns, *kept])]
        for start in range(0, self._length, rows):
            with self._reported():
                frame = self._scan.select(chosen).slice(start, rows).collect()
            yield Batch(
                frame.select(self._names[k] for k in columns).to_numpy().astype(self.dtype),
                np.arange(start, start + len(frame)),
                (start + len(frame)) / self._length,
                tuple(frame[self._names[k]].to_numpy() for k in kept),
            )

    @contextmanager
    def _reported(self) -> Iterator[None]:
        """Failures of polars, as DataError."""
        try:
            yield
        except (self._polars.exceptions.PolarsError, OSError):
            raise DataError(f"{self.source}: not a Parquet file, or a damaged one") from None


# Text

_MISSING = ["", "-", "na", "n/a", "nan", "null", "none", "#n/a"]
_WIDEST = 10_000  # columns
_TOO_WIDE = f"more than {_WIDEST} columns"
_QUOTES = "quotes that do not end where the field does; expected one row per line"


class TextTable(Table):
    """A text file; the first line that is no comment may name the columns.

    Comments begin with # or %; the last one before the numbers names them if no other line does.
    Quoted fields, a byte-order mark and, unless commas separate the columns, decimal commas are
    read. `content` is what to read instead of the file. Raises DataError, with the lines, for what
    is not such a table.
    """

    quotes = True  # whether messages show fields that are not numbers

    def __init__(self, path: Path, content: bytes | None = None) -> None:
        self._polars, self.source = _polars(), str(path)
        self._path, self._content = path, content
        comments: list[str] = []
        with self._open() as file:
            if b"\0" in file.read(4096):
                raise DataError(f"{path} holds no text; expected text in UTF-8, NPY or Parquet")
            file.seek(0)
            line, first = next(_rows(file, comments), (0, ""))
            self._size = file.seek(0, io.SEEK_END)
        if not first and not comments:
            raise DataError(f"{path}: no rows")
        first = first or comments.pop()  # the header of no rows
        bare = re.sub(r'"[^"]*"', "", first)
        self.separator = next((mark for mark in (";", "\t", ",") if mark in bare), None)
        fields = self._fields(first)
        if fields is None or len(fields) > _WIDEST:
            raise DataError(f"{path}, line {line}: {_QUOTES if fields is None else _TOO_WIDE}")
        self.width, self._header = len(fields), int(line > 0)
        self.names = tuple(fields)
        if self._has_number(fields):
            self._header = 0
            named = (self._fields(comment) or [] for comment in reversed(comments))
            alike = (n for n in named if len(n) == self.width and not self._has_number(n))
            self.names = next(map(tuple, alike), None)

    def _open(self) -> BinaryIO:
        return self._path.open("rb") if self._content is None else io.BytesIO(self._content)

    def _has_number(self, fields: Sequence[str]) -> bool:
        texts = self._polars.Series(fields).str.strip_chars()
        return bool(self._numbers(texts, has_commas=self.separator != ",").is_not_null().any())

    def _fields(self, line: str) -> list[str] | None:
        """The fields of a line; None if quotes end within a field, or in a later line."""
        mark = self.separator or " "
        try:
            (row,) = csv.reader([line], delimiter=mark, skipinitialspace=True, strict=True)
        except csv.Error:
            return None
        return row

    def _numbers(self, texts: Any, *, has_commas: bool) -> Any:
        """Texts as numbers, null if they are none."""
        if has_commas:
            texts = texts.str.replace(",", ".", literal=True)
        return texts.cast(self._polars.Float64, strict=False)

    def place(self, row: int) -> str:
        """How messages name a row: by its line."""
        with self._open() as file:
            return f"line {next(islice(_rows(file), self._header + row, None))[0]}"

    def batches(
        self, columns: Sequence[int], rows: int = ROWS, kept: Sequence[int] = ()
    ) -> Iterator[Batch]:
        """As `Table.batches`; columns that are kept are texts."""
        first = 0
        with self._open() as file:
            lines = islice(_rows(file), self._header, None)
            while block := dict(islice(lines, rows)):
                table, texts = self._read(block, columns, kept)
                numbers = np.arange(first, first := first + len(table))
                yield Batch(table, numbers, file.tell() / self._size, texts)

    def _read(
        self, lines: Mapping[int, str], columns: Sequence[int], kept: Sequence[int]
    ) -> tuple[Numbers, tuple[NDArray[Any], ...]]:
        """The numbers in the rows by their lines, NaN for those that are missing, and kept texts.

        Raises DataError, with the lines, for rows of another length and fields that are no numbers.
        """
        pl, places = self._polars, [*lines]
        if self.separator and not any('"' in row for row in lines.values()):
            fields = pl.Series(lines.values(), dtype=pl.String).str.split(self.separator)
        else:
            fields = pl.Series(map(self._fields, lines.values()), dtype=pl.List(pl.String))
        counts = fields.list.len()
        # separators at the end of a row make empty fields
        surplus = fields.list.slice(self.width).list.join("").str.strip_chars() != ""
        is_wrong = ((counts < self.width) | surplus).fill_null(True)
        faults = []
        for row in is_wrong.arg_true():
            count = counts[row]
            fault = _QUOTES if count is None else f"{count} fields, expected {self.width}"
            faults.append((places[row], fault))
        texts = [fields.list.get(k, null_on_oob=True).str.strip_chars() for k in columns]
        # 1,234 beside 0.5 may be a thousand: then it is no number
        has_points = any(column.str.contains(".", literal=True).any() for column in texts)
        has_commas = self.separator != "," and not has_points
        table = np.empty((len(lines), len(columns)))
        for k, column in enumerate(texts):
            numbers = self._numbers(column, has_commas=has_commas)
            if numbers.has_nulls():
                is_gap = column.str.to_lowercase().is_in(_MISSING)
                for row in (numbers.is_null() & ~is_gap & ~is_wrong).arg_true():
                    text = f": {column[row][:40]!r}" if self.quotes else ""
                    fault = f"field {columns[k] + 1}{text} is not a number"
                    faults.append((places[row], fault))
            table[:, k] = numbers.to_numpy()
        if faults:
            messages = [f"line {line}: {fault}" for line, fault in sorted(faults)]
            raise DataError(listed(self.source, messages))
        return table, tuple(fields.list.get(k).str.strip_chars().to_numpy() for k in kept)


def _rows(file: BinaryIO, comments: list[str] | None = None) -> Iterator[tuple[int, str]]:
    """The lines that are neither blank nor comments, with their numbers from 1."""
    for number, line in enumerate(file, start=1):
        text = line.decode(errors="replace").removeprefix("\ufeff").strip(" \r\n")
        if text.strip() and text[0] not in "#%":
            yield number, text
        elif text.strip() and comments is not None:
            comments.append(text.lstrip("#% "))


def listed(source: Path | str, faults: Sequence[str], count: int = 0) -> str:
    """What is wrong with a source: one fault in a line, or the first ten in a list."""
    count = count or len(faults)
    if count == 1:
        return f"{source}, {faults[0]}" if source else faults[0]
    more = [f"and {count - MOST_SHOWN} more"] if count > MOST_SHOWN else []
    return "\n  ".join([f"{source or 'the data'}: {count} faults", *faults[:MOST_SHOWN], *more])


# Writing

Rows = tuple[Numbers, Sequence[NDArray[Any]]]  # numbers, and kept columns that go before them
_EXACT = 1 << 53  # a larger integer may not be a double


def check_ending(path: Path) -> None:
    """Raise RequestError for an ending that is not written."""
    if path.suffix.lower() not in ENDINGS:
        ending = f"the ending {path.suffix}" if path.suffix else "no ending"
        raise RequestError(f"{path} has {ending}; expected {', '.join(ENDINGS)}")


def write_table(
    path: Path,
    names: Sequence[str],
    dtype: np.dtype[Any],
    rows: Iterable[Rows],
    stream: BinaryIO | None = None,
) -> int:
    """Write batches of rows by the ending of a file, which is in place when it is complete.

    With a stream, such as standard output, text is written there. Returns the number of rows.
    """
    count = 0

    def tallied() -> Iterator[Rows]:
        nonlocal count
        for table, kept in rows:
            count += len(table)
            yield table, kept

    if stream is not None:
        _write_text(stream, names, dtype, tallied())
        return count
    write = {".npy": _write_npy, ".parquet": _write_parquet, ".pq": _write_parquet}
    with whole_file(path) as file:
        write.get(path.suffix.lower(), _write_text)(file, names, dtype, tallied())
    return count


def _write_npy(
    file: BinaryIO, names: Sequence[str], dtype: np.dtype[Any], rows: Iterable[Rows]
) -> None:
    """The header is written again at the end; NumPy leaves room in it for the number of rows."""
    header = {"descr": npy.dtype_to_descr(dtype), "fortran_order": False, "shape": (0, len(names))}
    npy.write_array_header_1_0(file, header)
    count = 0
    for table, kept in rows:
        columns = [_as_number(column, dtype) for column in kept]
        whole = np.column_stack([*columns, table]) if columns else table
        file.write(np.ascontiguousarray(whole, dtype).tobytes())
        count += len(table)
    file.seek(0)
    npy.write_array_header_1_0(file, header | {"shape": (count, len(names))})


def _as_number(column: NDArray[Any], dtype: np.dtype[Any]) -> Numbers:
    is_number = column.dtype.kind in _NUMERIC
    numbers = column.astype(dtype) if is_number else np.empty(0)
    if not is_number or np.abs(numbers).max(initial=0) > _EXACT:
        raise DataError(
            "a column of --keep has texts or integers beyond 2^53, which an NPY file of floats "
            "cannot contain; expected .csv or .parquet"
        )
    return numbers


def _frames(names: Sequence[str], dtype: np.dtype[Any], rows: Iterable[Rows]) -> Iterator[Any]:
    """Data frames; at least one, so that an empty table has its columns."""
    pl = _polars()
    empty: Rows = (np.empty((0, len(names)), dtype), ())
    rows = iter(rows)
    for table, kept in chain([next(rows, empty)], rows):
        columns = [*kept, *np.asarray(table, dtype).T]
        yield pl.DataFrame([pl.Series(n, c) for n, c in zip(names, columns, strict=True)])


def _write_text(
    file: BinaryIO, names: Sequence[str], dtype: np.dtype[Any], rows: Iterable[Rows]
) -> None:
    """Text with commas and a first line of names; every number reads back as it was."""
    for number, frame in enumerate(_frames(names, dtype, rows)):
        file.write(frame.write_csv(include_header=number == 0).encode())
        file.flush()


def _write_parquet(
    file: BinaryIO, names: Sequence[str], dtype: np.dtype[Any], rows: Iterable[Rows]
) -> None:
    """polars asks for the next frame when it has written one."""
    pl = _polars()
    from polars.io.plugins import register_io_source

    frames = _frames(names, dtype, rows)
    first = next(frames)
    source = register_io_source(lambda *_: chain([first], frames), schema=first.schema)
    try:
        source.sink_parquet(file)
    except pl.exceptions.ComputeError as error:  # of a full disk
        raise OSError(errno.EIO, str(error)) from error
