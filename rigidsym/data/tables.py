"""Tables of numbers, read and written in batches: NPY and arrays by NumPy, the rest by polars.

A table is read from its beginning as often as needed, a few ten thousand rows at a time, so that
its length does not matter.
"""

from __future__ import annotations

import csv
import errno
import io
import mmap
import os
import re
from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager, nullcontext
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

Numbers = NDArray[Any]  # float32 or float64, (rows, columns)
Missing = Literal["error", "nan", "drop"]
ROWS = 65_536  # in memory at once
ENDINGS = (".npy", ".csv", ".txt", ".parquet", ".pq")  # that are written
MOST_SHOWN = 10  # faults in one message
_NUMERIC = "fiub"
_FORGET = 32 << 20  # bytes after which pages that were read are given back


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

    def sample(self, columns: Sequence[int], rows: int) -> Batch:
        """A few rows, from all over the table if that is cheap."""
        none = Batch(np.empty((0, len(columns))), np.empty(0, np.intp), 1.0)
        return next(self.batches(columns, rows), none)

    def place(self, row: int) -> str:
        """How messages name a row: row 3, line 17."""
        return f"row {row + 1}"


def open_table(path: Path) -> Table:
    """The table in a file, by its ending: NPY, Parquet, or else text with separators.

    Raises DataError for a file that holds no table of numbers.
    """
    if not path.is_file():
        fault = "not a regular file; `eval` reads a stream from -"
        raise DataError(f"{path}: {fault if path.exists() else 'no such file'}")
    if path.suffix.lower() == ".npy":
        return _npy_table(path)
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

    Nothing is copied but the rows that are asked for; pages of a memory map are given back.
    Raises DataError for other shapes and for types that are not numbers.
    """

    def __init__(self, *arrays: Any) -> None:
        if len(arrays) == 1 and (names := names_of(arrays[0])):
            self.names, arrays = _named(arrays[0], names)
        arrays = tuple(map(np.asanyarray, arrays))
        for array in arrays:
            if array.ndim != 2 or array.dtype.kind not in _NUMERIC:
                raise DataError(
                    f"expected numbers of shape (rows, columns), got {array.dtype} of shape "
                    f"{array.shape}"
                )
        self._maps = {id(m): m for a in arrays if (m := getattr(a, "_mmap", None)) is not None}
        arrays = tuple(map(np.asarray, arrays))  # rows of a memory map are slow to take
        self._columns = [column for array in arrays for column in array.T]
        self._whole = arrays[0] if len(arrays) == 1 else None
        self.width, self._length = len(self._columns), len(arrays[0])
        self._row_bytes = sum(array.shape[1] * array.itemsize for array in arrays)
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
        unread = 0
        for first in range(0, len(self), rows):
            some = np.arange(first, min(first + rows, len(self)))
            part = slice(first, first + rows)
            passed = tuple(self._columns[column][part].copy() for column in kept)
            yield Batch(self._rows(part, columns), some, (some[-1] + 1) / len(self), passed)
            unread += len(some) * self._row_bytes
            if unread > _FORGET or some[-1] + 1 == len(self):
                unread = 0
                for each in self._maps.values() if hasattr(mmap, "MADV_DONTNEED") else ():
                    each.madvise(mmap.MADV_DONTNEED)

    def sample(self, columns: Sequence[int], rows: int) -> Batch:
        """As `Table.sample`: evenly spaced."""
        which = np.unique(np.linspace(0, len(self) - 1, rows).round().astype(np.intp))
        return Batch(self._rows(which, columns), which, 1.0)

    def _rows(self, which: slice | NDArray[np.intp], columns: Sequence[int]) -> Numbers:
        if self._whole is not None:
            return np.asarray(self._whole[which][:, [*columns]], self.dtype)
        return np.stack([self._columns[k][which].astype(self.dtype) for k in columns], axis=1)


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


def _npy_table(path: Path) -> ArrayTable:
    """An NPY file, mapped into memory; the fields of a structured array are its columns."""
    with path.open("rb") as file:
        begins = file.read(6)
    if begins != b"\x93NUMPY":
        kind = "another kind of file" if begins else "an empty file"
        raise DataError(f"{path}: not an NPY file of numbers, but {kind}")
    try:
        table = ArrayTable(np.load(path, mmap_mode="r", allow_pickle=False))
    except DataError as error:
        raise DataError(f"{path}: {error}") from None
    # NumPy parses the header as Python, and maps as many bytes as it states.
    except (ValueError, TypeError, SyntaxError, TokenError, EOFError, OverflowError):
        size = path.stat().st_size
        raise DataError(f"{path}: not an NPY file of numbers, or damaged ({size} bytes)") from None
    table.source = str(path)
    return table


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
                np.stack([_numbers(frame[self._names[k]], self.dtype) for k in columns], axis=1),
                np.arange(start, start + len(frame)),
                (start + len(frame)) / self._length,
                tuple(frame[self._names[k]].to_numpy() for k in kept),
            )
            for first in range(0, len(frame), rows):
                yield whole.at(slice(first, first + rows))

    @contextmanager
    def _reported(self) -> Iterator[None]:
        """Failures of polars, as DataError."""
        try:
            yield
        except (self._polars.exceptions.PolarsError, OSError):
            raise DataError(f"{self.source}: not a Parquet file, or a damaged one") from None


def _numbers(column: Any, dtype: np.dtype[Any]) -> NDArray[Any]:
    return np.asarray(column.to_numpy(), dtype)


# Text

_COMMENTS = ("#", "%")
_MISSING = frozenset({"", "-", "na", "n/a", "nan", "null", "none", "#n/a"})
_CASES = (str.lower, str.upper, str.capitalize)
_BLOCK = 1 << 22  # bytes that are read at once
_LONGEST = 1 << 20  # bytes in a line
_WIDEST = 10_000  # columns
_AFTER_QUOTES = re.compile(r'((?<!")")[ \t]+(?=[,;\t]|$)')  # blanks that no dialect expects
_DECIMAL_COMMA = re.compile(r"[+-]?\d*,\d+(?:[eE][+-]?\d+)?")
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
    the columns, decimal commas are read. polars reads blocks of whole lines; if it refuses one, or
    rows differ in length, the fields of the block are read one by one, so that a fault is named
    with its line. Raises DataError for what is not such a table.
    """

    quotes = True  # whether messages show fields that are not numbers

    def __init__(self, path: Path, stream: BinaryIO | None = None) -> None:
        self._polars = _polars()
        self.path, self.source = path, str(path)
        self._stream = stream and io.BufferedReader(stream)  # type: ignore[type-var]
        self._size = 0 if stream else path.stat().st_size
        self._ahead: list[bytes] = []  # lines that are read to find the header
        with self._opened() as file:
            begin = file.peek(4096)[:4096]
            kind = next((kind for magic, kind in _KINDS.items() if begin.startswith(magic)), None)
            if kind or b"\0" in begin:
                raise DataError(
                    f"{path} holds {kind or 'no text'}; expected text in UTF-8, or an NPY or "
                    "Parquet file"
                )
            lines = iter(lambda: self._line(file), b"")
            comments, first = self._first_row(lines)
            self.separator = _separator(first)
            fields = self._fields(first)
            if fields is None:
                raise DataError(f"{path}, line {len(self._ahead)}: {_QUOTES}")
            if len(fields) > _WIDEST:
                raise DataError(f"{path}: {len(fields)} columns; at most {_WIDEST} are read")
            self.names, self._header = self._read_header(fields, comments, lines)
        self.width = len(fields)
        begin_of_rows = sum(map(len, self._ahead[: self._header]))
        # row, lines and bytes before each block that was read
        self._starts = [(0, self._header, begin_of_rows)]

    def _opened(self) -> AbstractContextManager[Any]:
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
            if text and not text.startswith(_COMMENTS):
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
        if any(is_number(self._with_point(field)) for field in fields):
            named = [self._fields(comment) for comment in reversed(comments)]
            alike = (names for names in named if names and len(names) == len(fields))
            names = next((n for n in alike if not any(map(is_number, n))), None)
            return tuple(names) if names else None, before - 1
        units = self._fields(_decoded(next(lines, b"")).lstrip("#% ")) or []
        units = [unit.strip("[]() ") for unit in units]
        if len(units) != len(fields) or not any(units) or not all(map(is_unit, units)):
            return tuple(fields), before
        if any(map(is_number, units)):  # 1 is a unit, too
            return tuple(fields), before
        pairs = zip(fields, units, strict=True)
        names = [n if u in ("", "-") or unit_in(n) else f"{n} [{u}]" for n, u in pairs]
        return tuple(names), before + 1

    def _fields(self, line: str) -> list[str] | None:
        """The fields of a line; None if quotes end within a field, or in a later line."""
        lines = [_AFTER_QUOTES.sub(r"\1", line if self.separator else line.strip())]
        mark = self.separator or " "
        try:
            rows = list(csv.reader(lines, delimiter=mark, skipinitialspace=True, strict=True))
        except csv.Error:
            return None
        return [field.strip() for row in rows for field in row]

    def _with_point(self, field: str) -> str:
        """A field with a decimal point if it has a decimal comma."""
        has_comma = self.separator != "," and _DECIMAL_COMMA.fullmatch(field)
        return field.replace(",", ".") if has_comma else field

    def place(self, row: int) -> str:
        """How messages name a row: by its line, or else by its number."""
        if self._stream:
            return super().place(row)
        first, before, begin = max(start for start in self._starts if start[0] <= row)
        with self.path.open("rb") as file:
            file.seek(begin)
            rows = (number for number, line in enumerate(file, before + 1) if _is_row(line))
            return f"line {next(islice(rows, row - first, None))}"

    def _blocks(self) -> Iterator[tuple[bytes, int, int]]:
        """Blocks of whole lines, the number of lines before each, and the byte where it begins."""
        with self._opened() as file:
            head = self._ahead if self._stream else [*islice(file, self._header)]
            block, rest = b"", b"".join(head[self._header :])
            before, begin = self._header, sum(map(len, head[: self._header]))
            while new := file.read1(_BLOCK) if self._stream else file.read(_BLOCK):
                if block:
                    yield block, before, begin
                before, begin = before + block.count(b"\n"), begin + len(block)
                whole, end, rest = (rest + new).rpartition(b"\n")
                block = whole + end
                self._check_length(rest, before + block.count(b"\n") + 1)
            if block or rest:  # a last line without its end belongs to the last block
                yield block + rest, before, begin

    def batches(
        self, columns: Sequence[int], rows: int = ROWS, kept: Sequence[int] = ()
    ) -> Iterator[Batch]:
        """As `Table.batches`; columns that are kept are texts."""
        first = 0
        self._starts.clear()
        for block, before, begin in self._blocks():
            self._starts.append((first, before, begin))
            read = self._at_once(block, columns, kept)
            table, passed = read or self._by_field(block, before, columns, kept)
            share = (begin + len(block)) / self._size if self._size else 1.0
            whole = Batch(table, np.arange(first, first := first + len(table)), share, passed)
            for start in range(0, len(table), rows):
                yield whole.at(slice(start, start + rows))

    def _at_once(
        self, block: bytes, columns: Sequence[int], kept: Sequence[int]
    ) -> tuple[Numbers, tuple[NDArray[Any], ...]] | None:
        """The numbers as polars reads them; None if it refuses them or rows differ in length."""
        pl = self._polars
        block = block.removeprefix(b"\xef\xbb\xbf").replace(b"\r\n", b"\n")
        mark = (self.separator or " ").encode()
        if _odd_starts(block) or (not self.separator and (b"  " in block or b" \n" in block)):
            rows = filter(_is_row, block.split(b"\n"))
            # polars takes each blank for a separator
            block = b"\n".join(rows if self.separator else (b" ".join(r.split()) for r in rows))
        has_comma = mark != b"," and b"," in block
        if b'"' in block or b"\r" in block or (has_comma and b"." in block):
            return None
        if not _has_rows_of(block, mark, self.width):
            return None
        schema = {str(k): pl.Float64 if k in columns else pl.String for k in range(self.width)}
        missing = [case(word) for word in _MISSING if word for case in _CASES]
        scan = pl.scan_csv(
            io.BytesIO(block),
            has_header=False,
            separator=mark.decode(),
            quote_char=None,
            schema=schema,
            null_values=missing,
            decimal_comma=has_comma,
        )
        wanted = [str(k) for k in dict.fromkeys([*columns, *kept])]
        try:
            frame = scan.select(wanted).collect()
        except pl.exceptions.PolarsError:
            return None
        table = np.empty((len(frame), len(columns)))
        for place, k in enumerate(columns):
            table[:, place] = frame[str(k)].to_numpy()
        return table, tuple(frame[str(k)].to_numpy() for k in kept)

    def _by_field(
        self, block: bytes, before: int, columns: Sequence[int], kept: Sequence[int] = ()
    ) -> tuple[Numbers, tuple[NDArray[Any], ...]]:
        """The numbers of each line, NaN for those that are missing.

        Raises DataError, with the lines, for fields that are not numbers.
        """
        faults: list[str] = []
        table: list[list[float]] = []
        texts: list[list[str]] = []
        marks: set[str] = set()
        for number, line in enumerate(block.split(b"\n"), before + 1):
            if not _is_row(line):
                continue
            fields = self._fields(_decoded(line))
            if fields is None:
                faults.append(f"line {number}: {_QUOTES}")
                continue
            if len(fields) < self.width or any(fields[self.width :]):
                faults.append(
                    f"line {number}: {counted(len(fields), 'field')}, expected {self.width}"
                )
                continue
            row: list[float] = []
            for k in columns:
                point = self._with_point(fields[k])
                if point.lower() in _MISSING:
                    row.append(np.nan)
                elif is_number(point):
                    row.append(float(point))
                    marks |= {"," if point != fields[k] else "."} if "." in point else set()
                else:
                    shown = f": {fields[k][:40]!r}" if self.quotes else ""
                    hint = "; write decimals with a point" if "," in fields[k] else ""
                    hint = "; write degrees without °" if "°" in fields[k] else hint
                    faults.append(f"line {number}: field {k + 1}{shown} is not a number{hint}")
            if len(marks) > 1:
                faults.append(f"line {number}: decimal commas and decimal points in one file")
                marks.clear()
            table.append(row)
            texts.append([fields[k] for k in kept])
        if faults:
            raise DataError(listed(self.path, faults))
        numbers = np.array(table, float).reshape(-1, len(columns))
        return numbers, tuple(np.array(column, object) for column in zip(*texts, strict=True))

    def sample(self, columns: Sequence[int], rows: int) -> Batch:
        """As `Table.sample`: found by seeking; those that do not read are left out."""
        with self.path.open("rb") as file:
            start = sum(map(len, islice(file, self._header)))
            file.seek(start)
            lines = [file.readline(_LONGEST) for _ in range(rows)]
            for offset in np.linspace(start, self._size, rows, endpoint=False).astype(int):
                file.seek(int(offset))
                file.readline(_LONGEST)  # the rest of a line
                lines.append(file.readline(_LONGEST))
        good: list[Numbers] = []
        for line in filter(_is_row, lines):
            try:
                good.append(self._by_field(line, 0, columns)[0])
            except DataError:
                continue
        if not good:
            return super().sample(columns, rows)
        return Batch(np.concatenate(good), np.zeros(len(good), np.intp), 0.0)


def listed(path: Path | str, faults: Sequence[str], count: int | None = None) -> str:
    """What is wrong with a file: one fault in a line, or the first ten in a list."""
    if len(faults) == 1:
        return f"{path}, {faults[0]}"
    count = count or len(faults)
    more = [f"and {count - MOST_SHOWN} more"] if count > MOST_SHOWN else []
    return "\n  ".join([f"{path}: {count} faults", *faults[:MOST_SHOWN], *more])


def is_number(field: str) -> bool:
    """Whether polars reads it too, which takes neither 1_000 nor digits beyond ASCII."""
    try:
        float(field)
    except ValueError:
        return False
    return field.isascii() and "_" not in field


def _decoded(line: bytes) -> str:
    return line.decode(errors="replace").removeprefix("\ufeff")


def _is_row(line: bytes) -> bool:
    text = line.strip()
    return bool(text) and not text.startswith((b"#", b"%"))


def _line_starts(block: bytes) -> tuple[NDArray[np.uint8], NDArray[np.intp]]:
    letters = np.frombuffer(block.removesuffix(b"\n"), np.uint8)
    return letters, np.concatenate([[0], np.flatnonzero(letters == ord("\n")) + 1])


def _odd_starts(block: bytes) -> bool:
    """Whether a line may be no row: it is empty, or begins with a blank, # or %."""
    letters, starts = _line_starts(block)
    if starts[-1] >= len(letters):
        return True
    return bool(np.isin(letters[starts], np.frombuffer(b"#% \t\n", np.uint8)).any())


def _has_rows_of(block: bytes, mark: bytes, width: int) -> bool:
    """Whether each line has as many fields; polars fills short rows and cuts long ones."""
    letters, starts = _line_starts(block)
    marks = np.flatnonzero(letters == ord(mark))
    if not len(letters) or len(marks) != len(starts) * (width - 1):
        return False
    of_line = marks.reshape(len(starts), width - 1)
    ends = np.append(starts[1:], len(letters))
    return bool((of_line >= starts[:, None]).all() and (of_line < ends[:, None]).all())


def _separator(line: str) -> str | None:
    """What separates the columns; None for blanks."""
    bare = re.sub(r'"[^"]*"', "", line)
    return next((mark for mark in (";", "\t", ",") if mark in bare), None)


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
    """polars takes the frames from here as it writes them."""
    pl = _polars()
    from polars.io.plugins import register_io_source

    frames = _frames(names, dtype, rows)
    first = next(frames)
    source = register_io_source(lambda *_: chain([first], frames), schema=first.schema)
    try:
        source.sink_parquet(file)
    except pl.exceptions.ComputeError as error:  # of a full disk
        raise OSError(errno.EIO, str(error)) from error
