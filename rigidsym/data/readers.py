"""Files of numbers, a row at a time on paper and many at a time here: NPY, Parquet, text.

Every source can begin again at a place where a piece ended, so that long work can be resumed.
"""

from __future__ import annotations

import mmap
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from rigidsym.data.chunk import ROWS, Piece, Rows
from rigidsym.data.npy import mapped
from rigidsym.data.text import TextRows
from rigidsym.errors import DataError, MissingExtra


def rows_of(path: Path) -> Rows:
    """The rows of a file, by its ending: NPY, Parquet, or else text with separators.

    Raises DataError for a file that holds no table of numbers.
    """
    if not path.is_file():
        raise DataError(f"{path}: no such file")
    ending = path.suffix.lower()
    if ending == ".npy":
        return NpyRows(path)
    if ending in (".parquet", ".pq"):
        return ParquetRows(path)
    return TextRows(path)


class NpyRows:
    """An NPY file, mapped into memory; pages that were read are given back."""

    names: tuple[str, ...] | None = None

    def __init__(self, path: Path) -> None:
        array = mapped(path)
        if array.ndim != 2 or array.dtype.kind not in "fiu":
            found = f"{array.dtype} {array.shape}"
            raise DataError(f"{path}: expected numbers of shape (rows, columns), got {found}")
        self._array = array
        self._map: mmap.mmap | None = getattr(array, "_mmap", None)
        self.width = array.shape[1]
        is_single = array.dtype.kind == "f" and array.dtype.itemsize == 4
        self.dtype = np.dtype(np.float32 if is_single else np.float64)

    def pieces(self, columns: Sequence[int], start: int = 0, rows: int = ROWS) -> Iterator[Piece]:
        """As `Rows.pieces`; `start` counts rows."""
        count = len(self._array)
        for first in range(start, count, rows):
            end = min(first + rows, count)
            table = np.asarray(self._array[first:end][:, list(columns)], self.dtype)
            self._forget()
            yield Piece(table, end, end / count)

    def _forget(self) -> None:
        if self._map is not None and hasattr(mmap, "MADV_DONTNEED"):
            self._map.madvise(mmap.MADV_DONTNEED)


class ParquetRows:
    """A Parquet file; numbers that are missing are NaN."""

    def __init__(self, path: Path) -> None:
        try:
            import pyarrow as arrow
            from pyarrow.parquet import ParquetFile
        except ImportError:
            raise MissingExtra("Parquet", "parquet") from None
        try:
            self._file = ParquetFile(path, memory_map=True)
        except arrow.ArrowInvalid as error:
            raise DataError(f"{path}: not a Parquet file ({error})") from None
        schema = self._file.schema_arrow
        own = tuple(schema.names)
        self.names: tuple[str, ...] | None = own
        self.width = len(own)
        self._names = own
        self._is_number = [
            arrow.types.is_floating(kind) or arrow.types.is_integer(kind) for kind in schema.types
        ]
        single = all(kind == arrow.float32() for kind in schema.types)
        self.dtype = np.dtype(np.float32 if single else np.float64)
        self._path = path

    def pieces(self, columns: Sequence[int], start: int = 0, rows: int = ROWS) -> Iterator[Piece]:
        """As `Rows.pieces`; `start` counts rows."""
        wrong = [self._names[place] for place in columns if not self._is_number[place]]
        if wrong:
            raise DataError(f"{self._path}: no numbers in the columns {', '.join(wrong)}")
        count = self._file.metadata.num_rows
        groups, end = self._groups_from(start)
        chosen = [self._names[place] for place in dict.fromkeys(columns)]
        for batch in self._file.iter_batches(batch_size=rows, row_groups=groups, columns=chosen):
            first, end = end, end + batch.num_rows
            if end <= start:
                continue
            fresh = batch.slice(max(0, start - first))
            read = {name: fresh.column(name).to_numpy(zero_copy_only=False) for name in chosen}
            table = np.stack([read[self._names[place]] for place in columns], axis=1)
            yield Piece(np.asarray(table, self.dtype), end, end / count)

    def _groups_from(self, start: int) -> tuple[list[int], int]:
        """The row groups that reach beyond a row, and the row at which they begin."""
        metadata = self._file.metadata
        first = 0
        for group in range(metadata.num_row_groups):
            length = metadata.row_group(group).num_rows
            if first + length > start:
                return list(range(group, metadata.num_row_groups)), first
            first += length
        return [], first
