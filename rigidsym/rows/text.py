"""Text with one row a line, between commas, semicolons, tabs or blanks."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import islice
from pathlib import Path

import numpy as np

from rigidsym.errors import DataError
from rigidsym.rows.piece import ROWS, Piece, Table

_SEPARATORS = (",", ";", "\t", None)  # None: blanks


class TextRows:
    """A text file; its first line names the columns, unless it holds numbers.

    Empty lines are left out.
    """

    dtype = np.dtype(np.float64)

    def __init__(self, path: Path) -> None:
        self.path = path
        self.size = path.stat().st_size
        with path.open("rb") as file:
            first = next((line for line in map(text_of, file) if line), "")
        if not first:
            raise DataError(f"{path}: no rows")
        self.separator = next(s for s in _SEPARATORS if s is None or s in first)
        fields = first.removeprefix("#").split(self.separator)
        self.width = len(fields)
        has_header = not all(map(is_number, fields))
        self.names = tuple(field.strip().strip('"') for field in fields) if has_header else None

    def pieces(self, columns: Sequence[int], start: int = 0, rows: int = ROWS) -> Iterator[Piece]:
        """As `Rows.pieces`; `start` counts bytes."""
        end = start
        with self.path.open("rb") as file:
            file.seek(start)
            while lines := list(islice(file, rows)):
                first, end = end, end + sum(map(len, lines))
                texts = [text for text in map(text_of, lines) if text]
                if first == 0 and self.names is not None:
                    texts = texts[1:]
                if texts:
                    yield Piece(self._table(texts, columns), end, end / self.size)

    def _table(self, texts: Sequence[str], columns: Sequence[int]) -> Table:
        try:
            return np.loadtxt(
                texts, delimiter=self.separator, comments=None, ndmin=2, usecols=list(columns)
            )
        except ValueError as error:
            raise DataError(self._fault(columns) or f"{self.path}: {error}") from None

    def _fault(self, columns: Sequence[int]) -> str:
        """The first line of the file that does not read, and why."""
        with self.path.open("rb") as file:
            is_header = self.names is not None
            for number, line in enumerate(map(text_of, file), 1):
                if line and not is_header and (why := self._wrong_with(line, columns)):
                    return f"{self.path}, line {number}: {why}"
                is_header = is_header and not line
        return ""

    def _wrong_with(self, line: str, columns: Sequence[int]) -> str:
        fields = line.split(self.separator)
        if len(fields) <= max(columns):
            return f"{len(fields)} fields, expected {self.width}"
        wrong = [place for place in columns if not is_number(fields[place])]
        return (
            f"field {wrong[0] + 1}: {fields[wrong[0]].strip()!r} is not a number" if wrong else ""
        )


def text_of(line: bytes) -> str:
    return line.decode(errors="replace").removeprefix("\ufeff").strip()


def is_number(field: str) -> bool:
    """Whether NumPy reads it too, which takes neither 1_000 nor digits beyond ASCII."""
    try:
        float(field)
    except ValueError:
        return False
    return field.isascii() and "_" not in field
