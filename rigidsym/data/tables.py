"""Tables of numbers, read and written in batches: NPY and arrays by NumPy, the rest by polars.

A table is read from its beginning as often as needed, a few ten thousand rows at a time, so that
its length does not matter.
"""

from __future__ import annotations

import csv
import errno
import io
import os
import re
from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass
from itertools import chain, islice
from pathlib import Path
from tokenize import TokenError
from typing import Any, BinaryIO, Literal

import numpy as np
from numpy.lib import format as npy
from numpy.typing import NDArray

from rigidsym.data.columns import counted, is_unit, unit_in
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

    def split(self, rows: int) -> Iterator[Batch]:
        """The batch in pieces of at most so many rows."""
        for start in range(0, len(self.rows), rows):
            yield self.at(slice(start, start + rows))


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
        at_once = max(1, 4 * ROWS // rows) * rows  # polars seeks the rows of a slice
        for start in range(0, self._length, at_once):
            with self._reported():
                frame = self._scan.select(chosen).slice(start, at_once).collect()
            whole = Batch(
                frame.select(self._names[k] for k in columns).to_numpy().astype(self.dtype),
                np.arange(start, start + len(frame)),
                (start + len(frame)) / self._length,
                tuple(frame[self._names[k]].to_numpy() for k in kept),
            )
            yield from whole.split(rows)

    @contextmanager
    def _reported(self) -> Iterator[None]:
        """Failures of polars, as DataError."""
        try:
            yield
        except (self._polars.exceptions.PolarsError, OSError):
            raise DataError(f"{self.source}: not a Parquet file, or a damaged one") from None


# Text

_MISSING = ["", "-", "na", "n/a", "nan", "null", "none", "#n/a"]
_LINES = 50_000  # that are read at once
_LONGEST = 1 << 20  # bytes in a line
_WIDEST = 10_000  # columns
_AFTER_QUOTES = re.compile(r'((?<!")")[ \t]+(?=[,;\t]|$)')  # blanks that no dialect expects
_QUOTES = "quotes that do not end where the field does; expected one row per line"
_KINDS = {
    b"\x1f\x8b": "data compressed by gzip (gunzip unpacks them)",
    b"PK": "a ZIP archive or a spreadsheet",
    b"\xff\xfe": "text in UTF-16",
    b"\xfe\xff": "text in UTF-16",
    b"\x93NUMPY": "NPY, but its name does not end in .npy",
    b"PAR1": "Parquet, but its name does not end in .parquet",
    b"\x89HDF": "HDF5",
    b"ULog": "a log of PX4 (ulog2csv converts it)",
    b"\xa3\x95": "a log of ArduPilot (mavlogdump.py --format csv converts it)",
    b"#ROSBAG": "a ROS bag (rostopic echo -p converts it)",
}


class TextTable(Table):
    """A text file, or standard input; the first line that is no comment may name the columns.

    Comments begin with # or %; the last one before the numbers names them if no other line does. A
    second line may hold the units. Quoted fields, a byte-order mark and, unless commas separate
    the columns, decimal commas are read. Raises DataError, with the lines, for what is not such a
    table.
    """

    quotes = True  # whether messages show fields that are not numbers

    def __init__(self, path: Path, stream: BinaryIO | None = None) -> None:
        self._polars = _polars()
        self.path, self.source = path, str(path)
        self._stream = stream and io.BufferedReader(stream)  # type: ignore[type-var]
        self._size = 0 if stream else path.stat().st_size
        self._ahead: list[bytes] = []  # lines that were read to find the header
        with self._opened() as file:
            begin = file.peek(4096)[:4096]
            kind = next((kind for magic, kind in _KINDS.items() if begin.startswith(magic)), None)
            if kind or b"\0" in begin:
                what = kind or "no text"
                raise DataError(f"{path} holds {what}; expected text in UTF-8, NPY or Parquet")
            lines = iter(lambda: self._line(file), b"")
            comments, first = self._first_row(lines)
            bare = re.sub(r'"[^"]*"', "", first)
            self.separator = next((mark for mark in (";", "\t", ",") if mark in bare), None)
            fields = self._fields(first)
            if fields is None:
                raise DataError(f"{path}, line {len(self._ahead)}: {_QUOTES}")
            if len(fields) > _WIDEST:
                raise DataError(f"{path}: {len(fields)} columns; at most {_WIDEST} are read")
            self.names, self._header = self._read_header(fields, comments, lines)
        self.width = len(fields)

    def _opened(self) -> Any:
        return nullcontext(self._stream) if self._stream else self.path.open("rb")

    def _line(self, file: io.BufferedReader) -> bytes:
        """The next line of the beginning."""
        self._ahead.append(file.readline(_LONGEST))
        self._check_length(self._ahead[-1], len(self._ahead))
        return self._ahead[-1]

    def _check_length(self, line: bytes, number: int) -> None:
        if len(line) >= _LONGEST:
            raise DataError(
                f"{self.path}, line {number}: longer than {_LONGEST >> 20} MB; "
                "expected one row per line"
            )

    def _first_row(self, lines: Iterator[bytes]) -> tuple[list[str], str]:
        """The comments before the first line that is none, and that line."""
        comments: list[str] = []
        for text in (_decoded(line).strip() for line in lines):
            if _is_row(text):
                return comments, text
            comments += [text.lstrip("#% ")] if text else []
        if not comments:
            raise DataError(f"{self.path}: no rows")
        self._ahead.pop()  # the end of the file, after a header and no rows
        return comments[:-1], comments[-1]

    def _read_header(
        self, fields: Sequence[str], comments: Sequence[str], lines: Iterator[bytes]
    ) -> tuple[tuple[str, ...] | None, int]:
        """The names of the columns, with the units of a second line; the lines before the rows."""
        before = len(self._ahead)
        if self._has_number(fields):
            named = [self._fields(comment) for comment in reversed(comments)]
            alike = (names for names in named if names and len(names) == len(fields))
            names = next((n for n in alike if not self._has_number(n)), None)
            return tuple(names) if names else None, before - 1
        units = self._fields(_decoded(next(lines, b"")).lstrip("#% ")) or []
        units = [unit.strip("[]() ") for unit in units]
        is_second = len(units) == len(fields) and any(units) and all(map(is_unit, units))
        if not is_second or self._has_number(units):  # 1 is a unit, too
            return tuple(fields), before
        pairs = zip(fields, units, strict=True)
        return tuple(
            n if u in ("", "-") or unit_in(n) else f"{n} [{u}]" for n, u in pairs
        ), before + 1

    def _has_number(self, fields: Sequence[str]) -> bool:
        return any(self._numbers(self._polars.Series(fields).str.strip_chars()).is_not_null())

    def _fields(self, line: str) -> list[str] | None:
        """The fields of a line; None if quotes end within a field, or in a later line."""
        lines = [_AFTER_QUOTES.sub(r"\1", line if self.separator else line.strip())]
        mark = self.separator or " "
        try:
            rows = list(csv.reader(lines, delimiter=mark, skipinitialspace=True, strict=True))
        except csv.Error:
            return None
        return [field for row in rows for field in row]

    def _numbers(self, texts: Any) -> Any:
        """Texts as numbers, null if they are none; commas are decimal unless they separate."""
        points = texts if self.separator == "," else texts.str.replace(",", ".", literal=True)
        return points.cast(self._polars.Float64, strict=False)

    def place(self, row: int) -> str:
        """How messages name a row: by its line, or else by its number."""
        if self._stream:
            return super().place(row)
        with self.path.open("rb") as file:
            lines = enumerate(map(_decoded, file), start=1)
            numbers = (n for n, line in lines if n > self._header and _is_row(line))
            return f"line {next(islice(numbers, row, None))}"

    def batches(
        self, columns: Sequence[int], rows: int = ROWS, kept: Sequence[int] = ()
    ) -> Iterator[Batch]:
        """As `Table.batches`; columns that are kept are texts."""
        first, before, done = 0, self._header, sum(map(len, self._ahead[: self._header]))
        with self._opened() as file:
            if self._stream:
                file = chain(self._ahead[self._header :], iter(file.readline, b""))
            else:
                file.seek(done)
            while block := [*islice(file, _LINES)]:
                if max(map(len, block)) >= _LONGEST:
                    for number, line in enumerate(block, before + 1):
                        self._check_length(line, number)
                lines = enumerate(_decoded(b"".join(block)).split("\n"), before + 1)
                numbered = {number: line for number, line in lines if _is_row(line)}
                table, texts = self._read(numbered, columns, kept)
                before, done = before + len(block), done + sum(map(len, block))
                numbers = np.arange(first, first := first + len(table))
                share = done / self._size if self._size else 1.0
                yield from Batch(table, numbers, share, texts).split(rows)

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
            split = [self._fields(row.removesuffix("\r")) for row in lines.values()]
            fields = pl.Series(split, dtype=pl.List(pl.String))
        counts = fields.list.len()
        # separators at the end of a row make empty fields
        surplus = fields.list.slice(self.width).list.join("").str.strip_chars() != ""
        is_wrong = fields.is_null() | (counts < self.width) | surplus
        faults = [
            (places[row], f"{counted(counts[row], 'field')}, expected {self.width}")
            if fields[row] is not None
            else (places[row], _QUOTES)
            for row in is_wrong.arg_true()
        ]
        table = np.empty((len(lines), len(columns)))
        marks: dict[str, int] = {}  # of decimals, and the first row that has them
        for column, k in enumerate(columns):
            texts = fields.list.get(k, null_on_oob=True).str.strip_chars()
            numbers = self._numbers(texts)
            if numbers.has_nulls():
                is_gap = texts.str.to_lowercase().is_in(_MISSING)
                is_text = numbers.is_null() & ~is_gap & ~is_wrong
                faults += [(places[row], self._fault(k, texts[row])) for row in is_text.arg_true()]
            for mark in "" if self.separator == "," else ",.":
                for row in texts.str.contains(mark, literal=True).arg_true()[:1]:
                    marks[mark] = min(row, marks.get(mark, row))
            table[:, column] = numbers.to_numpy()
        if len(marks) > 1 and not faults:
            row = max(marks.values())
            faults = [(places[row], "decimal commas and decimal points in one file")]
        if faults:
            raise DataError(
                listed(self.path, [f"line {n}: {fault}" for n, fault in sorted(faults)])
            )
        return table, tuple(fields.list.get(k).str.strip_chars().to_numpy() for k in kept)

    def _fault(self, column: int, text: str) -> str:
        shown = f": {text[:40]!r}" if self.quotes else ""
        hint = "; write decimals with a point" if "," in text else ""
        hint = "; write degrees without °" if "°" in text else hint
        return f"field {column + 1}{shown} is not a number{hint}"


def listed(source: Path | str, faults: Sequence[str], count: int = 0) -> str:
    """What is wrong with a source: one fault in a line, or the first ten in a list."""
    count = count or len(faults)
    if count == 1:
        return f"{source}, {faults[0]}" if source else faults[0]
    more = [f"and {count - MOST_SHOWN} more"] if count > MOST_SHOWN else []
    return "\n  ".join([f"{source or 'the data'}: {count} faults", *faults[:MOST_SHOWN], *more])


def _decoded(line: bytes) -> str:
    return line.decode(errors="replace").removeprefix("\ufeff")


def _is_row(line: str) -> bool:
    bare = line.lstrip()
    return bare != "" and bare[0] not in "#%"


# Writing

Rows = tuple[Numbers, Sequence[NDArray[Any]]]  # numbers, and kept columns that go before them
_EXACT = 1 << 53  # a larger integer may not be a double


def check_ending(path: Path, *others: str) -> None:
    """Raise RequestError for an ending that is neither written here nor among the others."""
    if path.suffix.lower() not in (*ENDINGS, *others):
        ending = f"the ending {path.suffix}" if path.suffix else "no ending"
        raise RequestError(f"{path} has {ending}; expected {', '.join((*ENDINGS, *others))}")


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
        file.flush()
        os.fsync(file.fileno())
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
    try:
        numbers = column.astype(dtype)
    except ValueError:
        numbers = None
    if numbers is None or np.abs(numbers).max(initial=0) > _EXACT:
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
