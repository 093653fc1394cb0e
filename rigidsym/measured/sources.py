"""Files of particles, read piece by piece: NPY (memory-mapped), CSV, Parquet."""

from __future__ import annotations

import mmap
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rigidsym.errors import BodyError, MissingExtra
from rigidsym.measured.blocks import BLOCK, Array
from rigidsym.names import offer

DEFAULT = ("m", "x", "y", "z")
_AXES = ("x", "y", "z")
_SPELLINGS = {"mass": "m", "masses": "m"}
_FORGET = 32 << 20  # bytes after which pages that were read are given back
_SEPARATORS = (",", ";", "\t", None)  # None: blanks
Piece = tuple[Array | None, Array]  # masses (n,) or None, and places (3, n)


@dataclass(frozen=True, kw_only=True, slots=True)
class Columns:
    """Where mass and place stand in a row; without a mass each particle has 1 kg."""

    mass: int | None
    place: tuple[int, int, int]

    @classmethod
    def named(cls, names: Sequence[str]) -> Columns:
        """By the names of the columns; raises BodyError where x, y or z is missing."""
        plain = [_SPELLINGS.get(name.strip().lower(), name.strip().lower()) for name in names]
        for name in ("m", *_AXES):
            if plain.count(name) > 1:
                raise BodyError(f"two columns are named {name}")
        for name in _AXES:
            if name not in plain:
                raise BodyError(f"no column {name} among {', '.join(names)}; {offer(name, plain)}")
        x, y, z = map(plain.index, _AXES)
        return cls(mass=plain.index("m") if "m" in plain else None, place=(x, y, z))

    @classmethod
    def of_width(cls, width: int, names: Sequence[str] | None) -> Columns:
        """By the names given, or of 3 (x, y, z) or 4 (m, x, y, z) columns without any."""
        if names is None:
            if width not in (3, 4):
                raise BodyError(
                    f"expected 3 columns (x, y, z) or 4 (m, x, y, z), got {width}; name them"
                )
            names = DEFAULT[4 - width :]
        if len(names) != width:
            raise BodyError(f"{len(names)} names for {width} columns")
        return cls.named(names)

    def piece(self, columns: NDArray[Any]) -> Piece:
        """Of an array (columns, n)."""
        first = self.place[0]
        if self.place == (first, first + 1, first + 2):
            places = columns[first : first + 3]
        else:
            places = columns[list(self.place)]
        return (None if self.mass is None else columns[self.mass]), places


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

    def pieces(self, start: int = 0, stop: int | None = None) -> Iterator[Piece]:
        """Blocks of particles from a row on; the data are copied block by block."""
        end = len(self) if stop is None else min(stop, len(self))
        for row in range(start, end, BLOCK):
            rows = self._array[row : min(row + BLOCK, end)]
            if self._fields is not None:
                table = np.array([rows[name] for name in self._fields], dtype=np.float64)
            else:
                table = np.ascontiguousarray(rows.T, dtype=np.float64)
            yield self.columns.piece(table)


class NpySource:
    """Rows of an NPY file, mapped into memory; what was read is given back as it goes."""

    def __init__(self, path: Path, names: Sequence[str] | None = None) -> None:
        try:
            mapped = np.load(path, mmap_mode="r", allow_pickle=False)
        except ValueError as error:
            raise BodyError(f"{path}: not an NPY file of numbers: {error}") from None
        if not isinstance(mapped, np.memmap):
            raise BodyError(f"{path}: expected one array, in the format NPY")
        self._map: mmap.mmap | None = getattr(mapped, "_mmap", None)
        self._source = ArraySource(mapped, names)
        self._row_bytes = mapped.itemsize * (mapped.shape[1] if mapped.ndim == 2 else 1)

    def __len__(self) -> int:
        return len(self._source)

    def pieces(self, start: int = 0, stop: int | None = None) -> Iterator[Piece]:
        """As those of an array, with the pages forgotten after every few megabytes."""
        unread = 0
        for piece in self._source.pieces(start, stop):
            yield piece
            unread += piece[1].shape[1] * self._row_bytes
            if unread > _FORGET:
                self._forget()
                unread = 0
        self._forget()

    def _forget(self) -> None:
        if self._map is not None and hasattr(mmap, "MADV_DONTNEED"):
            self._map.madvise(mmap.MADV_DONTNEED)


class TextSource:
    """Rows of a text file whose first line names its columns."""

    def __init__(self, path: Path, names: Sequence[str] | None = None) -> None:
        self._path = path
        with path.open(encoding="utf-8-sig") as stream:
            head = stream.readline().strip().lstrip("#").strip()
        self._separator = next(s for s in _SEPARATORS if s is None or s in head)
        found = [name.strip().strip('"') for name in head.split(self._separator)]
        self._has_head = not all(map(_is_number, found))
        if not self._has_head and names is None:
            names = None if len(found) in (3, 4) else found
            self.columns = Columns.of_width(len(found), names)
        else:
            self.columns = Columns.named(names if names is not None else found)

    def __len__(self) -> int:
        """How many there are is not known before the file is read."""
        return 0

    def pieces(self, start: int = 0, stop: int | None = None) -> Iterator[Piece]:
        """Blocks of all rows; a part of a text file cannot be asked for."""
        assert start == 0
        assert stop is None
        with self._path.open(encoding="utf-8-sig") as stream:
            line = 1
            if self._has_head:
                stream.readline()
                line += 1
            while lines := list(islice(stream, BLOCK)):
                yield self.columns.piece(self._table(lines, line))
                line += len(lines)

    def _table(self, lines: list[str], first: int) -> Array:
        try:
            table = np.loadtxt(lines, delimiter=self._separator, ndmin=2, dtype=np.float64)
        except ValueError as error:
            raise BodyError(f"{self._path}, line {self._wrong(lines, first)}: {error}") from None
        return np.ascontiguousarray(table.T)

    def _wrong(self, lines: list[str], first: int) -> int:
        width = None
        for place, line in enumerate(lines):
            fields = line.split("#")[0].split(self._separator)
            if width is not None and len(fields) != width:
                return first + place
            width = len(fields)
            if not all(_is_number(field) for field in fields):
                return first + place
        return first


class ParquetSource:
    """Rows of a Parquet file, by the names of its columns."""

    def __init__(self, path: Path, names: Sequence[str] | None = None) -> None:
        try:
            from pyarrow.parquet import ParquetFile
        except ImportError:
            raise MissingExtra("reading Parquet", "parquet") from None
        self._file = ParquetFile(path, memory_map=True)
        own = self._file.schema_arrow.names
        self.columns = Columns.named(own if names is None else names)

    def __len__(self) -> int:
        return int(self._file.metadata.num_rows)

    def pieces(self, start: int = 0, stop: int | None = None) -> Iterator[Piece]:
        """Blocks of all rows."""
        assert start == 0
        assert stop is None
        for batch in self._file.iter_batches(batch_size=BLOCK):
            columns = [column.to_numpy(zero_copy_only=False) for column in batch.columns]
            yield self.columns.piece(np.array(columns, dtype=np.float64))


Source = ArraySource | NpySource | TextSource | ParquetSource
_BY_ENDING: dict[str, type[NpySource] | type[ParquetSource]] = {
    ".npy": NpySource,
    ".parquet": ParquetSource,
    ".pq": ParquetSource,
}


def source_of(path: Path, names: Sequence[str] | None = None) -> Source:
    """The particles of a file, by its ending; anything but NPY and Parquet is text."""
    if not path.is_file():
        raise BodyError(f"{path}: no such file of particles")
    return _BY_ENDING.get(path.suffix.lower(), TextSource)(path, names)


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True
