"""Tables of numbers, read and written in batches: NPY and arrays by NumPy, the rest by polars.

A table is read from its beginning as often as needed, a few ten thousand rows at a time, so that
its length does not matter.
"""

from __future__ import annotations

import csv
import errno
import io
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import chain, islice
from operator import itemgetter
from pathlib import Path
from tokenize import TokenError
from typing import Any, BinaryIO, Literal, TypeAlias

import numpy as np
from numpy.lib import format as npy
from numpy.typing import NDArray

from rigidsym.data.columns import is_unit
from rigidsym.errors import DataError, MissingExtra, RequestError
from rigidsym.system.files import whole_file

Numbers = NDArray[Any]  # (rows, columns)
Missing = Literal["error", "nan", "drop"]
# Columns of numbers, columns that are kept as they are, and the share of the table read so far
Block: TypeAlias = tuple[Sequence[NDArray[Any]], Sequence[NDArray[Any]], float]
ROWS = 65_536  # in memory at once
MOST_SHOWN = 10  # faults in one message
_NUMERIC = "fiub"


@dataclass(frozen=True, slots=True, eq=False)
class Batch:
    """Some rows of a table; missing numbers are NaN."""

    table: Numbers
    rows: NDArray[np.intp]  # their numbers, counted from 0, (rows,)
    share: float  # of the table that has been read with this batch
    kept: tuple[NDArray[Any], ...] = ()  # columns passed through as they are, (rows,) each

    def at(self, which: NDArray[np.bool_]) -> Batch:
        """Some of its rows."""
        kept = tuple(column[which] for column in self.kept)
        return Batch(self.table[which], self.rows[which], self.share, kept)


class Table:
    """Rows that can be read from the beginning, in batches."""

    source = ""  # what messages call the table: the path of its file, or empty for an array
    names: tuple[str, ...] | None = None  # of the columns, if there are any
    width: int
    eps = 0.0  # relative precision of the numbers if it is below double

    def _blocks(self, columns: Sequence[int], kept: Sequence[int], rows: int) -> Iterator[Block]:
        """All rows, at most `rows` at a time."""
        raise NotImplementedError

    def batches(
        self, columns: Sequence[int], rows: int = ROWS, kept: Sequence[int] = ()
    ) -> Iterator[Batch]:
        """All rows, at most `rows` at a time: the numbers of `columns`, and those `kept`.

        Raises DataError, with the line, for a field that is not a number.
        """
        first = 0
        for numbers, others, share in self._blocks(columns, kept, rows):
            table = np.stack([column.astype(float) for column in numbers], axis=1)
            places = np.arange(first, first := first + len(table))
            yield Batch(table, places, share, tuple(others))

    def read(self, columns: Sequence[int]) -> Batch:
        """The whole table."""
        tables, rows = [np.empty((0, len(columns)))], [np.empty(0, np.intp)]
        for batch in self.batches(columns):
            tables.append(batch.table)
            rows.append(batch.rows)
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
    kinds = {".npy": NpyTable, ".parquet": ParquetTable, ".pq": ParquetTable}
    return kinds.get(path.suffix.lower(), TextTable)(path)


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
            columns = {name: np.asanyarray(arrays[0][name]) for name in names}
            numbers = {n: c[:, None] for n, c in columns.items() if c.dtype.kind in _NUMERIC}
            if not numbers:
                raise DataError("no column holds numbers")
            if wide := [name for name in numbers if columns[name].ndim > 1]:
                raise DataError(f"column {wide[0]} has several numbers in a row; expected one")
            self.names, arrays = tuple(numbers), tuple(numbers.values())
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
        self.eps = max((float(np.finfo(k).eps) for k in floats if k.itemsize < 8), default=0.0)

    def _blocks(self, columns: Sequence[int], kept: Sequence[int], rows: int) -> Iterator[Block]:
        for first in range(0, self._length, rows):
            end = min(first + rows, self._length)
            numbers, others = (
                [self._columns[k][first:end].copy() for k in which] for which in (columns, kept)
            )
            yield numbers, others, end / self._length


class NpyTable(ArrayTable):
    """An NPY file; the fields of a structured array are its columns."""

    def __init__(self, path: Path) -> None:
        self.source, self._path = str(path), path
        try:
            data = np.load(path, mmap_mode="r", allow_pickle=False)
            if not isinstance(data, np.ndarray):
                raise DataError("an NPZ archive of arrays; expected one array, an NPY file")
            super().__init__(data)
        except DataError as error:
            raise DataError(f"{path}: {error}") from None
        # NumPy parses the header as Python, and maps as many bytes as it states.
        except (ValueError, TypeError, SyntaxError, TokenError, EOFError, OverflowError):
            raise DataError(
                f"{path}: not an NPY file of numbers, or damaged ({path.stat().st_size} bytes)"
            ) from None

    def _blocks(self, columns: Sequence[int], kept: Sequence[int], rows: int) -> Iterator[Block]:
        for block in super()._blocks(columns, kept, rows):
            yield block
            # mapped anew, which frees what was read
            ArrayTable.__init__(self, np.load(self._path, mmap_mode="r", allow_pickle=False))


def names_of(data: Any) -> list[str]:
    """The names of the columns of a data frame, structured array or mapping; none without them."""
    names = getattr(data, "column_names", None)
    names = names or (data.keys() if hasattr(data, "keys") else getattr(data, "columns", None))
    names = getattr(getattr(data, "dtype", None), "names", None) if names is None else names
    names = [] if names is None else list(names)
    return names if any(isinstance(name, str) for name in names) else []


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
            self._schema = self._scan.collect_schema()
            self._length = self._scan.select(self._polars.len()).collect().item()
        self.names, self.width = tuple(self._schema), len(self._schema)

    def _blocks(self, columns: Sequence[int], kept: Sequence[int], rows: int) -> Iterator[Block]:
        used, others = ([[*self._schema][k] for k in which] for which in (columns, kept))
        if wrong := [name for name in used if not self._schema[name].is_numeric()]:
            raise DataError(f"{self.source}: no numbers in the columns {', '.join(wrong)}")
        chosen, done = self._scan.select([*dict.fromkeys([*used, *others])]), 0
        with self._reported():
            for frame in chosen.collect_batches(chunk_size=rows, maintain_order=True):
                for part in frame.iter_slices(rows):
                    done += len(part)
                    numbers, more = ([part[n].to_numpy() for n in each] for each in (used, others))
                    yield numbers, more, done / self._length

    @contextmanager
    def _reported(self) -> Iterator[None]:
        """Failures of polars, as DataError; of a damaged file its Rust code may panic."""
        errors = self._polars.exceptions
        try:
            yield
        except (errors.PolarsError, errors.PanicException, OSError):
            raise DataError(f"{self.source}: not a Parquet file, or a damaged one") from None


# Text

_MISSING = ["", "-", "na", "n/a", "nan", "null", "none", "#n/a"]
_QUOTES = "quotes that do not end where the field does; expected one row per line"
_OTHER_KINDS = {  # by which files that are no plain text begin
    b"\xff\xfe": "text in UTF-16",
    b"\xfe\xff": "text in UTF-16",
    b"\x1f\x8b": "compressed by gzip",
    b"PK\x03\x04": "an archive or a spreadsheet",
    b"PK\x05\x06": "an archive or a spreadsheet",  # an empty one
}


class TextTable(Table):
    """A text file; the first line that is no comment may name the columns.

    Comments begin with # or %; the last one before the numbers names them if no other line does.
    Quoted fields, a byte-order mark and, unless commas separate the columns, decimal commas are
    read. `content` is what to read instead of the file. Raises DataError, with the lines, for what
    is not such a table.
    """

    def __init__(self, path: Path, content: bytes | None = None) -> None:
        self._polars, self.source = _polars(), str(path)
        self._path, self._content = path, content
        comments: list[str] = []
        with self._open() as file:
            start = file.read(4096)
            kinds = (kind for begin, kind in _OTHER_KINDS.items() if start.startswith(begin))
            kind = next(kinds, "not a text file" if b"\0" in start else None)
            if kind is not None:
                raise DataError(f"{path} is {kind}; expected text in UTF-8, NPY or Parquet")
            file.seek(0)
            line, first = next(_rows(file, comments), (0, ""))
            self._size = file.seek(0, io.SEEK_END)
        if not first and not comments:
            raise DataError(f"{path}: no rows")
        first = first or comments.pop()  # the header of no rows
        bare = re.sub(r'"[^"]*"', "", first)
        self.separator = next((mark for mark in (";", "\t", ",") if mark in bare), None)
        fields = self._fields(first)
        if fields is None:
            raise DataError(f"{path}, line {line}: {_QUOTES}")
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
            return next(csv.reader([line], delimiter=mark, skipinitialspace=True, strict=True))
        except csv.Error:
            return None

    def _numbers(self, texts: Any, *, has_commas: bool) -> Any:
        """Texts as numbers, null if they are none."""
        if has_commas:
            texts = texts.str.replace(",", ".", literal=True)
        return texts.cast(self._polars.Float64, strict=False)

    def place(self, row: int) -> str:
        """How messages name a row: by its line."""
        with self._open() as file:
            return f"line {next(islice(_rows(file), self._header + row, None))[0]}"

    def _blocks(self, columns: Sequence[int], kept: Sequence[int], rows: int) -> Iterator[Block]:
        with self._open() as file:
            lines = islice(_rows(file), self._header, None)
            while block := dict(islice(lines, rows)):
                numbers, others = self._read(block, columns, kept)
                yield numbers, others, file.tell() / self._size

    def _read(
        self, lines: Mapping[int, str], columns: Sequence[int], kept: Sequence[int]
    ) -> tuple[list[Numbers], list[NDArray[Any]]]:
        """The numbers of rows, NaN where one is missing, and the columns to keep as text.

        Raises DataError, with the lines, for rows of another length and fields without a number.
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
        texts, others = (
            [fields.list.get(k, null_on_oob=True).str.strip_chars() for k in which]
            for which in (columns, kept)
        )
        # 1,234 beside 0.5 may be a thousand: then it is no number
        has_points = any(column.str.contains(".", literal=True).any() for column in texts)
        has_commas = self.separator != "," and not has_points
        numbers = [self._numbers(column, has_commas=has_commas) for column in texts]
        if has_commas:  # kept numbers have points too, since commas separate the columns written
            others = [c.str.replace(r"^([+-]?\d*),(\d+(e[+-]?\d+)?)$", "$1.$2") for c in others]
        for k, column, values in zip(columns, texts, numbers, strict=True):
            if not values.has_nulls():
                continue
            is_gap = column.str.to_lowercase().is_in(_MISSING)
            for row in (values.is_null() & ~is_gap & ~is_wrong).arg_true():
                text = column[row][:40]
                fault = f"field {k + 1}: {text!r} is not a number"
                unit = text[1:-1] if text.startswith(("[", "(")) else text
                if is_unit(unit):
                    name = self.names[k] if self.names else "angle"
                    fault += f"; a unit belongs to the name of its column, as in {name} [{unit}]"
                faults.append((places[row], fault))
        if faults:
            faults.sort(key=itemgetter(0))
            messages = [f"line {line}: {fault}" for line, fault in faults]
            raise DataError(listed(self.source, messages))
        return [values.to_numpy() for values in numbers], [text.to_numpy() for text in others]


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


def check_ending(path: Path) -> None:
    """Raise RequestError for an ending that is not written."""
    if path.suffix.lower() not in _WRITERS:
        ending = f"the ending {path.suffix}" if path.suffix else "no ending"
        raise RequestError(f"{path} has {ending}; expected {', '.join(_WRITERS)}")


def write_table(
    path: Path, names: Sequence[str], rows: Iterable[Rows], stream: BinaryIO | None = None
) -> None:
    """Write batches of rows by the ending of a file, which is in place when it is complete.

    With a stream, such as standard output, text is written there.
    """
    if stream is not None:
        _write_text(stream, names, rows)
        return
    with whole_file(path) as file:
        _WRITERS[path.suffix.lower()](file, names, rows)


def _write_npy(file: BinaryIO, names: Sequence[str], rows: Iterable[Rows]) -> None:
    """The header is written again at the end; NumPy leaves room in it for the number of rows."""
    header = {"descr": "<f8", "fortran_order": False, "shape": (0, len(names))}
    npy.write_array_header_1_0(file, header)
    count = 0
    for table, kept in rows:
        if kept:
            raise DataError("an NPY file has no names of columns, so --keep needs .csv or .parquet")
        file.write(np.ascontiguousarray(table, float).tobytes())
        count += len(table)
    file.seek(0)
    npy.write_array_header_1_0(file, header | {"shape": (count, len(names))})


def _frames(names: Sequence[str], rows: Iterable[Rows]) -> Iterator[Any]:
    """Data frames; at least one, so that an empty table has its columns."""
    pl = _polars()
    empty: Rows = (np.empty((0, len(names))), ())
    rows = iter(rows)
    for table, kept in chain([next(rows, empty)], rows):
        yield pl.DataFrame([pl.Series(n, c) for n, c in zip(names, [*kept, *table.T], strict=True)])


def _write_text(file: BinaryIO, names: Sequence[str], rows: Iterable[Rows]) -> None:
    """Text with commas and a first line of names; every number reads back as it was."""
    for number, frame in enumerate(_frames(names, rows)):
        file.write(frame.write_csv(include_header=number == 0).encode())
        file.flush()


def _write_parquet(file: BinaryIO, names: Sequence[str], rows: Iterable[Rows]) -> None:
    """polars asks for the next frame when it has written one."""
    pl = _polars()
    from polars.io.plugins import register_io_source

    frames = _frames(names, rows)
    first = next(frames)
    source = register_io_source(lambda *_: chain([first], frames), schema=first.schema)
    try:
        source.sink_parquet(file)
    except pl.exceptions.ComputeError as error:  # of a full disk
        raise OSError(errno.EIO, str(error)) from error


_WRITERS = {".npy": _write_npy, ".csv": _write_text, ".txt": _write_text}
_WRITERS |= {".parquet": _write_parquet, ".pq": _write_parquet}
