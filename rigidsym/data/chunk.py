"""Tables of numbers, a chunk of rows at a time."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Literal, Protocol

import numpy as np
from numpy.typing import NDArray

from rigidsym.errors import DataError

Table = NDArray[Any]  # float32 or float64, (rows, columns)
Missing = Literal["error", "nan", "drop"]
ROWS = 65_536  # in memory at once


@dataclass(frozen=True, slots=True, eq=False)
class Chunk:
    """Some rows of a table; missing numbers are NaN."""

    table: Table
    rows: NDArray[np.intp]  # their numbers, counted from 0, (rows,)
    share: float  # of the table that has been read with this chunk
    kept: tuple[NDArray[Any], ...] = ()  # columns passed through as they are, (rows,) each

    def at(self, which: NDArray[Any]) -> Chunk:
        """Some of its rows."""
        kept = tuple(column[which] for column in self.kept)
        return Chunk(self.table[which], self.rows[which], self.share, kept)


def none(columns: Sequence[int]) -> Chunk:
    """No rows."""
    return Chunk(np.empty((0, len(columns))), np.empty(0, np.intp), 1.0)


class TableReader(Protocol):
    """A table whose rows can be read from the beginning, in chunks."""

    source: str  # what messages call the table: the path of its file, or empty for an array
    names: tuple[str, ...] | None  # of the columns, if the file names them
    width: int
    dtype: np.dtype[Any]  # float32 if the file holds nothing finer, else float64
    eps: float  # relative precision of the numbers if it is below double, else 0

    def chunks(
        self, columns: Sequence[int], rows: int = ROWS, kept: Sequence[int] = ()
    ) -> Iterator[Chunk]:
        """All rows, at most `rows` at a time: the numbers of `columns`, and those `kept`.

        Raises DataError, with the line, for a field that is not a number.
        """

    def spread(self, columns: Sequence[int], rows: int) -> Chunk:
        """A few rows from all over the table."""

    def place(self, row: int) -> str:
        """How messages name a row: line 17, row 3."""


def without_missing(
    reader: TableReader, chunks: Iterable[Chunk], names: Sequence[str], missing: Missing
) -> Iterator[Chunk]:
    """Chunks in which missing numbers are an error, stay NaN, or cost the row that lacks them.

    `names` are those of the columns of the chunks, for the message of DataError.
    """
    for chunk in chunks:
        if missing == "nan":
            yield chunk
            continue
        lacking = np.isnan(chunk.table)
        rows = np.asarray(lacking.any(axis=1))
        if not rows.any():
            yield chunk
        elif missing == "drop":
            if not rows.all():
                yield chunk.at(~rows)
        else:
            row = int(rows.argmax())
            name = names[int(lacking[row].argmax())]
            raise DataError(
                f"{reader.source}, {reader.place(int(chunk.rows[row]))}: {name} is missing; "
                "--missing nan writes NaN, --missing drop leaves such rows out"
            )
