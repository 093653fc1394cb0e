"""Text with one row a line, between commas, semicolons, tabs or blanks."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import islice
from pathlib import Path

import numpy as np

from rigidsym.data.chunk import ROWS, Piece, Table
from rigidsym.data.column_names import counted
from rigidsym.errors import DataError

_PROBED = 4096  # bytes at the beginning that tell text from other files
_KINDS = {
    b"\x1f\x8b": "data compressed by gzip (gunzip unpacks them)",
    b"PK": "a ZIP archive or a spreadsheet",
    b"\xff\xfe": "text in UTF-16",
    b"\xfe\xff": "text in UTF-16",
    b"\x93NUMPY": "NPY, but its name does not end in .npy",
    b"PAR1": "Parquet, but its name does not end in .parquet",
    b"\x89HDF": "HDF5",
}
_SEPARATORS = (",", ";", "\t", None)  # None: blanks


@dataclass(frozen=True, slots=True)
class Lines:
    """Some lines that hold rows, and how far they reach."""

    numbers: tuple[int, ...]  # of the lines, the first that was read being 1
    texts: tuple[str, ...]
    end: int  # byte at which the next ones begin


class TextRows:
    """A text file; its first line names the columns, unless it holds numbers.

    Empty lines, and those that begin with #, are left out.
    """

    dtype = np.dtype(np.float64)

    def __init__(self, path: Path) -> None:
        self.path = path
        self.size = path.stat().st_size
        with path.open("rb") as file:
            check_text(path, file.read(_PROBED))
            file.seek(0)
            first = next((line for line in map(text_of, file) if line), "")
        if not first:
            raise DataError(f"{path}: no rows")
        self.separator = next(s for s in _SEPARATORS if s is None or s in first)
        fields = first.lstrip("#").split(self.separator)
        self.width = len(fields)
        has_header = not all(map(is_number, fields))
        self.names = tuple(field.strip().strip('"') for field in fields) if has_header else None

    def lines(self, start: int = 0, rows: int = ROWS) -> Iterator[Lines]:
        """The lines from a byte on at which one begins, at most `rows` at a time."""
        end, count = start, 0
        is_header = start == 0 and self.names is not None
        with self.path.open("rb") as file:
            file.seek(start)
            while lines := list(islice(file, rows)):
                end += sum(map(len, lines))
                numbered = [(count + k, text) for k, text in enumerate(map(text_of, lines), 1)]
                count += len(lines)
                kept = [(number, text) for number, text in numbered if text]
                if is_header and kept:
                    kept, is_header = kept[1:], False
                kept = [(number, text) for number, text in kept if not text.startswith("#")]
                if kept:
                    numbers, texts = zip(*kept, strict=True)
                    yield Lines(numbers, texts, end)

    def pieces(self, columns: Sequence[int], start: int = 0, rows: int = ROWS) -> Iterator[Piece]:
        """As `Rows.pieces`; `start` counts bytes."""
        for lines in self.lines(start, rows):
            try:
                table = self.table(lines.texts, columns)
            except ValueError as error:
                raise DataError(self._fault(columns) or f"{self.path}: {error}") from None
            yield Piece(table, lines.end, lines.end / self.size)

    def table(self, texts: Sequence[str], columns: Sequence[int]) -> Table:
        """The numbers of some columns; raises ValueError where one does not read."""
        return np.loadtxt(
            texts, delimiter=self.separator, comments=None, ndmin=2, usecols=list(columns)
        )

    def wrong_with(self, line: str, columns: Sequence[int]) -> list[str]:
        """Which fields of a line are missing or no numbers."""
        fields = line.split(self.separator)
        if len(fields) <= max(columns):
            return [f"{counted(len(fields), 'field')}, expected {self.width}"]
        return [
            f"field {place + 1}: {fields[place].strip()!r} is not a number{_hint(fields[place])}"
            for place in columns
            if not is_number(fields[place])
        ]

    def line_of(self, row: int) -> int:
        """The number of the line in which a row stands, rows counted from 0."""
        for lines in self.lines():
            if row < len(lines.numbers):
                return lines.numbers[row]
            row -= len(lines.numbers)
        raise IndexError(f"{self.path} has fewer rows")

    def _fault(self, columns: Sequence[int]) -> str:
        """The first line of the file that does not read, and why."""
        for lines in self.lines():
            for number, line in zip(lines.numbers, lines.texts, strict=True):
                for why in self.wrong_with(line, columns):
                    return f"{self.path}, line {number}: {why}"
        return ""


def check_text(path: Path, begin: bytes) -> None:
    """Raise DataError where a file begins as no text in UTF-8 does."""
    kind = next((kind for magic, kind in _KINDS.items() if begin.startswith(magic)), None)
    if kind is None and b"\0" in begin:
        kind = "no text"
    if kind is not None:
        raise DataError(f"{path} holds {kind}; expected text in UTF-8, or an NPY or Parquet file")


def text_of(line: bytes) -> str:
    return line.decode(errors="replace").removeprefix("\ufeff").strip()


def is_number(field: str) -> bool:
    """Whether NumPy reads it too, which takes neither 1_000 nor digits beyond ASCII."""
    try:
        float(field)
    except ValueError:
        return False
    return field.isascii() and "_" not in field


def _hint(field: str) -> str:
    if "," in field:
        return "; a decimal takes a point"
    return "; degrees are written without a sign" if "°" in field else ""
