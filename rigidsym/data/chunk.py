"""Some rows of a file, and what gives them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

Table = NDArray[Any]  # float32 or float64, (rows, columns)
ROWS = 65_536  # in memory at once


@dataclass(frozen=True, slots=True)
class Piece:
    """Some rows of a file, and how far they reach."""

    table: Table
    end: int  # where the next piece begins, in the measure of its source
    share: float  # of the file that was read up to there


class Rows(Protocol):
    """Rows of numbers in a file."""

    names: tuple[str, ...] | None  # of the columns, where the file names them
    width: int
    dtype: np.dtype[Any]  # float32 where the file holds nothing finer

    def pieces(self, columns: Sequence[int], start: int = 0, rows: int = ROWS) -> Iterator[Piece]:
        """The rows from `start` on, `columns` of them; raises DataError for what is no number."""
