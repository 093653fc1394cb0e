"""Particles, piece by piece: arrays, NPY (memory-mapped), text, Parquet."""

from __future__ import annotations

import mmap
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from rigidsym.data.column_names import counted, plain, unit_in
from rigidsym.data.mass.blocks import BLOCK, Array, named
from rigidsym.data.npy import mapped
from rigidsym.data.readers import rows_of
from rigidsym.data.text import TextRows
from rigidsym.errors import BodyError, DataError

DEFAULT = ("m", "x", "y", "z")
_AXES = ("x", "y", "z")
_SPELLINGS = {"mass": "m", "masses": "m"}
_FORGET = 32 << 20  # bytes after which pages that were read are given back


class Piece(NamedTuple):
    """Some particles."""

    masses: Array | None  # (n,); None: 1 kg each
    places: Array  # (3, n)
    share: float  # of all particles that have been read with these


@dataclass(frozen=True, kw_only=True, slots=True)
class Columns:
    """Where mass and place stand in a row; without a mass each particle has 1 kg."""

    mass: int | None
    place: tuple[int, int, int]

    @classmethod
    def named(cls, names: Sequence[str]) -> Columns:
        """By the names of the columns; others are left out.

        Raises BodyError where x, y or z is missing, where no column is the mass but one looks like
        it, and for units that are not m and kg.
        """
        bare = [_SPELLINGS.get(name, name) for name in map(plain, names)]
        for name in DEFAULT:
            if bare.count(name) > 1:
                raise BodyError(f"two columns are named {name}")
        for name in _AXES:
            if name not in bare:
                near = get_close_matches(name, [n for n in bare if n not in DEFAULT], n=1)
                raise BodyError(
                    f"no column {name} among {', '.join(names)}; "
                    + (f"did you mean {near[0]}?" if near else "--columns says which is which")
                )
        if "m" not in bare and (near := get_close_matches("mass", bare, n=1)):
            raise BodyError(f"no column m or mass among {', '.join(names)}; is {near[0]} the mass?")
        for name, short in zip(names, bare, strict=True):
            unit, expected = unit_in(name), "kg" if short == "m" else "m"
            if short in DEFAULT and unit not in ("", expected):
                raise BodyError(f"column {name}: expected {expected}, got {unit}")
        x, y, z = map(bare.index, _AXES)
        return cls(mass=bare.index("m") if "m" in bare else None, place=(x, y, z))

    @classmethod
    def of_width(cls, width: int, names: Sequence[str] | None) -> Columns:
        """By the names given, or of 3 (x, y, z) or 4 (m, x, y, z) columns without any."""
        if names is None:
            if width not in (3, 4):
                raise BodyError(
                    f"expected 3 columns (x, y, z) or 4 (m, x, y, z), got {width}; "
                    "--columns names them"
                )
            names = DEFAULT[4 - width :]
        if len(names) != width:
            raise BodyError(f"{counted(len(names), 'name')} for {counted(width, 'column')}")
        return cls.named(names)

    def piece(self, columns: NDArray[Any], share: float) -> Piece:
        """Of an array (columns, n)."""
        first = self.place[0]
        if self.place == (first, first + 1, first + 2):
            places = columns[first : first + 3]
        else:
            places = columns[list(self.place)]
        return Piece(None if self.mass is None else columns[self.mass], places, share)


class ArraySource:
    """Rows of an array in memory or mapped into it, (n, 3) or (n, 4)."""

    def __init__(self, array: NDArray[Any], names: Sequence[str] | None = None) -> None:
        if array.dtype.names is not None:
            names = array.dtype.names
            self._fields: Sequence[str] | None = names
            self.columns = Columns.named(names)
        else:
            self._fields = None
            if array.ndim != 2 or array.dtype.kind not in "fiu":
                raise BodyError(
                    f"expected real numbers of shape (n, 3) or (n, 4), got {array.dtype} of shape "
                    f"{array.shape}"
                )
            self.columns = Columns.of_width(array.shape[1], names)
        self._array = array

    def __len__(self) -> int:
        return len(self._array)

    place = staticmethod(named)

    def pieces(self, start: int = 0, stop: int | None = None) -> Iterator[Piece]:
        """Blocks of particles from a row on; the data are copied block by block."""
        end = len(self) if stop is None else min(stop, len(self))
        for row in range(start, end, BLOCK):
            last = min(row + BLOCK, end)
            rows = self._array[row:last]
            if self._fields is not None:
                table = np.array([rows[name] for name in self._fields], dtype=np.float64)
            else:
                table = np.ascontiguousarray(rows.T, dtype=np.float64)
            yield self.columns.piece(table, last / len(self))


class NpySource:
    """Rows of an NPY file, mapped into memory; what was read is given back as it goes."""

    def __init__(self, path: Path, names: Sequence[str] | None = None) -> None:
        try:
            array = mapped(path)
        except DataError as error:
            raise BodyError(str(error)) from None
        self._map: mmap.mmap | None = getattr(array, "_mmap", None)
        self._source = ArraySource(array, names)
        self._row_bytes = array.itemsize * (array.shape[1] if array.ndim == 2 else 1)

    def __len__(self) -> int:
        return len(self._source)

    place = staticmethod(named)

    def pieces(self, start: int = 0, stop: int | None = None) -> Iterator[Piece]:
        """As those of an array, with the pages forgotten after every few megabytes."""
        unread = 0
        for piece in self._source.pieces(start, stop):
            yield piece
            unread += piece.places.shape[1] * self._row_bytes
            if unread > _FORGET:
                self._forget()
                unread = 0
        self._forget()

    def _forget(self) -> None:
        if self._map is not None and hasattr(mmap, "MADV_DONTNEED"):
            self._map.madvise(mmap.MADV_DONTNEED)


class RowsSource:
    """Rows of a text or of a Parquet file, by the names of its columns."""

    def __init__(self, path: Path, names: Sequence[str] | None = None) -> None:
        try:
            self._rows = rows_of(path)
        except DataError as error:
            raise BodyError(str(error)) from None
        self.columns = Columns.of_width(
            self._rows.width, self._rows.names if names is None else names
        )

    def place(self, row: int) -> str:
        """What a particle is called in messages."""
        if isinstance(self._rows, TextRows):
            return f"{self._rows.path}, line {self._rows.line_of(row)}"
        return named(row)

    def pieces(self) -> Iterator[Piece]:
        """Blocks of all rows."""
        place, mass = self.columns.place, self.columns.mass
        used = place if mass is None else (*place, mass)
        try:
            for piece in self._rows.pieces(used, rows=BLOCK):
                table = np.ascontiguousarray(piece.table.T, dtype=np.float64)
                yield Piece(table[3] if mass is not None else None, table[:3], piece.share)
        except DataError as error:
            raise BodyError(str(error)) from None


Source = ArraySource | NpySource | RowsSource


def source_of(path: Path, names: Sequence[str] | None = None) -> Source:
    """The particles of a file, by its ending; anything but NPY and Parquet is text."""
    if not path.is_file():
        raise BodyError(f"{path}: no such file of particles")
    try:
        return (NpySource if path.suffix.lower() == ".npy" else RowsSource)(path, names)
    except BodyError as error:
        if str(path) in str(error):
            raise
        raise BodyError(f"{path}: {error}") from None
