"""Text with one row a line, between commas, semicolons, tabs or blanks.

pyarrow reads the numbers of a long chunk if it is installed, else NumPy. A chunk that they refuse
is read again by the csv module, field by field, so that a fault is named with its line and field.
"""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Iterable, Iterator, Sequence
from contextlib import AbstractContextManager, nullcontext, suppress
from functools import partial
from itertools import chain, islice
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from rigidsym.data.chunk import ROWS, Chunk, Table, none
from rigidsym.data.columns import counted, is_unit, unit_in
from rigidsym.errors import DataError

MOST_SHOWN = 10
_PROBED = 4096  # bytes at the beginning that tell text from other files
_LONGEST = 1 << 20  # bytes in a line
_WIDEST = 10_000  # columns
_COMMENTS = ("#", "%")
_MISSING = frozenset({"", "-", "na", "n/a", "nan", "null", "none", "#n/a"})
_AFTER_QUOTES = re.compile(r'((?<!")")[ \t]+(?=[,;\t]|$)')  # blanks that no dialect expects
_CASES = (str.lower, str.upper, str.capitalize)
_LONG = 1 << 22  # characters in a chunk for which pyarrow is worth the time it takes to import
_DECIMAL_COMMA = re.compile(r"[+-]?\d*,\d+(?:[eE][+-]?\d+)?")
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


class TextReader:
    """A text file, or standard input; the first line that is no comment may name the columns.

    Comments begin with # or %; the last one before the numbers names them if no other line does. A
    second line may hold the units. Quoted fields, a byte-order mark and, unless commas separate
    the columns, decimal commas are read. Raises DataError for what is not such a table.
    """

    dtype = np.dtype(np.float64)
    eps = 0.0

    def __init__(self, path: Path, stream: BinaryIO | None = None) -> None:
        self.path, self.source = path, str(path)
        self.quotes = True  # whether messages show fields that are not numbers
        self._stream = stream and io.BufferedReader(stream)  # type: ignore[type-var]
        self._size = 0 if stream else path.stat().st_size
        self._ahead: list[bytes] = []  # lines that were read to find the header
        with self._opened() as file:
            check_text(path, file.peek(_PROBED)[:_PROBED])
            lines = self._bounded(file)
            comments, first = self._first_line(lines)
            self.separator = _separator(first)
            fields = self._fields(first)
            if fields is None:
                raise DataError(f"{path}, line {self._skipped + 1}: {_QUOTES}")
            if len(fields) > _WIDEST:
                raise DataError(f"{path}: {len(fields)} columns; at most {_WIDEST} are read")
            self.names = self._header(fields, comments, lines)
        self.width = len(fields)
        begin = sum(map(len, self._ahead[: self._skipped]))
        self._starts = [(0, self._skipped, begin)]  # row, line and byte where each chunk begins

    def _opened(self) -> AbstractContextManager[Any]:
        return nullcontext(self._stream) if self._stream else self.path.open("rb")

    def _bounded(self, file: io.BufferedReader, before: int = 0) -> Iterator[bytes]:
        """The lines of a file; raises DataError for one that is too long."""
        for number, line in enumerate(iter(partial(file.readline, _LONGEST), b""), before + 1):
            if len(line) == _LONGEST:
                raise DataError(
                    f"{self.path}, line {number}: longer than {_LONGEST >> 20} MB; "
                    "expected one row per line"
                )
            yield line

    def _first_line(self, lines: Iterable[bytes]) -> tuple[list[str], str]:
        """The comments before the first line that is none, and that line."""
        comments: list[str] = []
        for line in lines:
            self._ahead.append(line)
            text = _decoded(line).strip()
            if text.startswith(_COMMENTS):
                comments.append(text.lstrip("#% "))
            elif text:
                self._skipped = len(self._ahead) - 1  # lines before the rows
                return comments, text
        if not comments:
            raise DataError(f"{self.path}: no rows")
        self._skipped = len(self._ahead)
        return comments[:-1], comments[-1]  # a header, and no rows

    def _header(
        self, fields: Sequence[str], comments: Sequence[str], lines: Iterable[bytes]
    ) -> tuple[str, ...] | None:
        """The names of the columns, with the units of a second line in brackets."""
        if any(map(self._is_number, fields)):
            named = [self._fields(comment) for comment in reversed(comments)]
            alike = (names for names in named if names and len(names) == len(fields))
            return next((tuple(n) for n in alike if not any(map(is_number, n))), None)
        self._skipped = len(self._ahead)
        second = next(lines, b"")  # type: ignore[call-overload]
        self._ahead.append(second)
        second_fields = self._fields(_decoded(second).lstrip("#% ")) or ()
        units = [field.strip("[]() ") for field in second_fields]
        if len(units) != len(fields) or not any(units) or any(map(is_number, units)):
            return tuple(fields)
        if not all(map(is_unit, units)):
            return tuple(fields)
        self._skipped += 1
        return tuple(
            name if unit in ("", "-") or unit_in(name) else f"{name} [{unit}]"
            for name, unit in zip(fields, units, strict=True)
        )

    def _fields(self, line: str) -> list[str] | None:
        """The fields of a line; None if quotes end within a field, or in a later line."""
        separator = self.separator or " "
        lines = [_AFTER_QUOTES.sub(r"\1", line if self.separator else line.strip())]
        try:
            rows = list(csv.reader(lines, delimiter=separator, skipinitialspace=True, strict=True))
        except csv.Error:
            return None
        return [field.strip() for fields in rows for field in fields]

    def _is_number(self, field: str) -> bool:
        return is_number(self._with_point(field))

    def _with_point(self, field: str) -> str:
        """A field with a decimal point if it has a decimal comma."""
        has_comma = self.separator != "," and _DECIMAL_COMMA.fullmatch(field)
        return field.replace(",", ".") if has_comma else field

    def place(self, row: int) -> str:
        """How messages name a row: by its line, or else by its number."""
        if self._stream:
            return f"row {row + 1}"
        first, number, begin = max(start for start in self._starts if start[0] <= row)
        with self.path.open("rb") as file:
            file.seek(begin)
            rows = (number for number, line in enumerate(file, number + 1) if _is_row(line))
            return f"line {next(islice(rows, row - first, None))}"

    def chunks(
        self, columns: Sequence[int], rows: int = ROWS, kept: Sequence[int] = ()
    ) -> Iterator[Chunk]:
        """As `TableReader.chunks`; columns that are kept are texts."""
        row, number, byte = self._starts[0]
        del self._starts[1:]
        with self._opened() as file:
            lines: Iterator[bytes] = islice(self._bounded(file), number, None)
            if self._stream:
                lines = chain(self._ahead[number:], self._bounded(file, len(self._ahead)))
            while some := list(islice(lines, rows)):
                table, passed = self._table(some, number, columns, kept)
                self._starts.append((row, number, byte))
                number, byte = number + len(some), byte + sum(map(len, some))
                if len(table):
                    found = np.arange(row, row + len(table))
                    row += len(table)
                    yield Chunk(table, found, byte / self._size if self._size else 1.0, passed)

    def spread(self, columns: Sequence[int], rows: int) -> Chunk:
        """As `TableReader.spread`: found by seeking; those that do not read are left out."""
        begin = self._starts[0][2]
        with self.path.open("rb") as file:
            file.seek(begin)
            lines = [line for line in islice(self._bounded(file), rows) if _is_row(line)]
            for offset in np.linspace(file.tell(), self._size, rows, endpoint=False).astype(int):
                file.seek(int(offset))
                next(self._bounded(file), b"")  # the rest of a line
                lines.append(next(self._bounded(file), b""))
        good: list[Table] = []
        for line in filter(_is_row, lines):
            try:
                good.append(self._by_field([_decoded(line)], 0, columns))
            except DataError:
                continue
        if not good:
            return next(self.chunks(columns, rows), none(columns))
        return Chunk(np.concatenate(good), np.zeros(len(good), np.intp), 0.0)

    def _table(
        self, lines: Sequence[bytes], before: int, columns: Sequence[int], kept: Sequence[int]
    ) -> tuple[Table, tuple[NDArray[Any], ...]]:
        """The numbers of some lines, and the texts of the columns that are kept."""
        text = _decoded(b"".join(lines))
        rows = text.split("\n")
        if any(mark in text for mark in _COMMENTS):
            rows = ["" if row.lstrip().startswith(_COMMENTS) else row for row in rows]
            text = "\n".join(rows)
        table = self._at_once(text, rows, columns)
        if table is None:
            table = self._by_field(rows, before, columns)
        if not kept:
            return table, ()
        fields = [self._fields(row) or () for row in rows if row.strip()]
        return table, tuple(np.array([row[k] for row in fields], object) for k in kept)

    def _at_once(self, text: str, rows: Sequence[str], columns: Sequence[int]) -> Table | None:
        """The numbers as pyarrow or NumPy reads them; None for text with quotes or faults."""
        if '"' in text or "\r" in text or not text.strip():
            return None
        if self.separator and len(text) > _LONG and "(" not in text:  # pyarrow knows nan(1)
            table = self._by_arrow(text, columns)
            if table is not None:
                return table
        if self.separator != "," and "," in text:
            if "." in text:
                return None
            rows = text.replace(",", ".").split("\n")
        try:
            table = np.loadtxt(
                rows, delimiter=self.separator, comments=None, ndmin=2, usecols=list(columns)
            )
        except ValueError:
            return None
        if self.separator is None:
            widths = {len(row.split()) for row in rows} - {0}
        else:
            widths = {row.count(self.separator) + 1 for row in rows if row.strip()}
        return table if widths == {self.width} else None

    def _by_arrow(self, text: str, columns: Sequence[int]) -> Table | None:
        """The numbers as pyarrow reads them; None without it, or for text that it refuses."""
        try:
            import pyarrow as arrow
            from pyarrow import csv as arrow_csv
        except ImportError:
            return None
        names = [str(column) for column in range(self.width)]
        used = [names[column] for column in columns]
        for point in ".," if self.separator != "," else ".":
            with suppress(arrow.ArrowInvalid):
                table = arrow_csv.read_csv(
                    io.BytesIO(text.encode()),
                    arrow_csv.ReadOptions(use_threads=False, column_names=names),
                    arrow_csv.ParseOptions(delimiter=self.separator, quote_char=False),
                    arrow_csv.ConvertOptions(
                        column_types=dict.fromkeys(used, arrow.float64()),
                        include_columns=used,
                        null_values=[case(word) for word in _MISSING for case in _CASES],
                        decimal_point=point,
                    ),
                )
                return np.column_stack([table[name].to_numpy() for name in used])
        return None

    def _quoted(self, field: str) -> str:
        return f": {field[:40]!r}" if self.quotes else ""

    def _by_field(self, rows: Sequence[str], before: int, columns: Sequence[int]) -> Table:
        """The numbers of each line, NaN for those that are missing.

        Raises DataError, with the lines, for fields that are not numbers.
        """
        faults: list[str] = []
        table: list[list[float]] = []
        numbered = [(number, row) for number, row in enumerate(rows, before + 1) if row.strip()]
        marks: set[str] = set()
        for number, row in numbered:
            fields = self._fields(row)
            if fields is None:
                faults.append(f"line {number}: {_QUOTES}")
                continue
            extra = fields[self.width :]
            if len(fields) < self.width or any(extra):
                faults.append(
                    f"line {number}: {counted(len(fields), 'field')}, expected {self.width}"
                )
                continue
            found = [fields[column] for column in columns]
            points = [self._with_point(field) for field in found]
            marks |= {
                "," if a != b else "." for a, b in zip(found, points, strict=True) if "." in b
            }
            if len(marks) > 1:
                faults.append(f"line {number}: decimal commas and decimal points in one file")
                marks.clear()
            values = [_number(point) for point in points]
            faults += [
                f"line {number}: field {column + 1}{self._quoted(field)} is not a number"
                + _hint(field)
                for column, field, value in zip(columns, found, values, strict=True)
                if value is None
            ]
            table.append([value for value in values if value is not None])
        if faults:
            raise DataError(listed(self.path, faults))
        return np.array(table, float).reshape(-1, len(columns))


_QUOTES = "quotes that do not end where the field does; expected one row per line"


def listed(path: Path | str, faults: Sequence[str], count: int | None = None) -> str:
    """What is wrong with a file: one fault in a line, or the first ten in a list."""
    if len(faults) == 1:
        return f"{path}, {faults[0]}"
    count = count or len(faults)
    more = [f"and {count - MOST_SHOWN} more"] if count > MOST_SHOWN else []
    return "\n  ".join([f"{path}: {count} faults", *faults[:MOST_SHOWN], *more])


def check_text(path: Path, begin: bytes) -> None:
    """Raise DataError for a file whose first bytes are not text in UTF-8, naming its kind."""
    kind = next((kind for magic, kind in _KINDS.items() if begin.startswith(magic)), None)
    if kind is None and b"\0" in begin:
        kind = "no text"
    if kind is not None:
        raise DataError(f"{path} holds {kind}; expected text in UTF-8, or an NPY or Parquet file")


def is_number(field: str) -> bool:
    """Whether NumPy reads it too, which takes neither 1_000 nor digits beyond ASCII."""
    try:
        float(field)
    except ValueError:
        return False
    return field.isascii() and "_" not in field


def _number(field: str) -> float | None:
    """NaN for a number that is missing; None for what is not a number."""
    if field.lower() in _MISSING:
        return float("nan")
    return float(field) if is_number(field) else None


def _decoded(line: bytes) -> str:
    text = line.decode(errors="replace").removeprefix("\ufeff")
    return text.replace("\r\n", "\n") if "\r" in text else text


def _is_row(line: bytes) -> bool:
    text = line.strip()
    return bool(text) and not text.startswith((b"#", b"%"))


def _separator(line: str) -> str | None:
    """What separates the columns; None for blanks."""
    bare = re.sub(r'"[^"]*"', "", line)
    return next((mark for mark in (";", "\t", ",") if mark in bare), None)


def _hint(field: str) -> str:
    if "," in field:
        return "; write decimals with a point"
    return "; write degrees without °" if "°" in field else ""
