"""Files of numbers: NPY, Parquet, text."""

from __future__ import annotations

import mmap
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from tokenize import TokenError
from typing import Any
from warnings import catch_warnings

import numpy as np
from numpy.typing import NDArray

from rigidsym.data.chunk import ROWS, Chunk, Table, TableReader, none
from rigidsym.data.text import TextReader
from rigidsym.errors import DataError, MissingExtra

_MAGIC = b"\x93NUMPY"
_DAMAGED = (  # what NumPy raises for the header of a damaged file
    ArithmeticError,
    EOFError,
    LookupError,
    MemoryError,
    OSError,
    RecursionError,
    SyntaxError,
    TokenError,
    TypeError,
    ValueError,
)
_FORGET = 32 << 20  # bytes after which pages that were read are given back


def reader_of(path: Path) -> TableReader:
    """The reader of a file, by its ending: NPY, Parquet, or else text with separators.

    Raises DataError for a file that holds no table of numbers.
    """
    if not path.is_file():
        found = (
            "not a regular file; `eval` reads a stream from -" if path.exists() else "no such file"
        )
        raise DataError(f"{path}: {found}")
    ending = path.suffix.lower()
    if ending == ".npy":
        return npy_reader(path)
    if ending in (".parquet", ".pq"):
        return ParquetReader(path)
    return TextReader(path)


def npy_reader(path: Path) -> ArrayReader:
    """An NPY file, mapped into memory; the fields of a structured array are its columns.

    Raises DataError for another file, for one that is cut short, and for other shapes and types.
    """
    with path.open("rb") as file:
        begins = file.read(len(_MAGIC))
    if begins != _MAGIC:
        found = "another kind of file" if begins else "an empty file"
        raise DataError(f"{path}: not an NPY file of numbers, but {found}")
    try:
        with catch_warnings(action="ignore"):
            array: NDArray[Any] = np.load(path, mmap_mode="r", allow_pickle=False)
    except _DAMAGED:
        size = path.stat().st_size
        raise DataError(f"{path}: not an NPY file of numbers, or damaged ({size} bytes)") from None
    try:
        reader = ArrayReader(array)
    except DataError as error:
        raise DataError(f"{path}: {error}") from None
    reader.source = str(path)
    return reader


class ArrayReader:
    """An array (rows, columns), a structured array (rows,), or several arrays side by side.

    Nothing is copied but the rows that are asked for; pages of a memory map are given back.
    Raises DataError for other shapes and for types that are not numbers.
    """

    names: tuple[str, ...] | None = None
    source = ""

    def __init__(self, *arrays: NDArray[Any]) -> None:
        self._maps = [found for a in arrays if (found := getattr(a, "_mmap", None)) is not None]
        if len(arrays) == 1 and arrays[0].dtype.names is not None:
            self.names, arrays = _fields(arrays[0])
        for array in arrays:
            if array.ndim != 2 or array.dtype.kind not in "fiub":
                found = f"{array.dtype} of shape {array.shape}"
                raise DataError(f"expected numbers of shape (rows, columns), got {found}")
        self._arrays = arrays
        self._columns = [column for array in arrays for column in array.T]
        self.width = len(self._columns)
        floats = [a.dtype for a in arrays if a.dtype.kind == "f"]
        is_single = len(floats) == len(arrays) and all(kind.itemsize == 4 for kind in floats)
        self.dtype = np.dtype(np.float32 if is_single else np.float64)
        self.eps = max((float(np.finfo(k).eps) for k in floats if k.itemsize < 8), default=0.0)
        self._row_bytes = sum(array.shape[1] * array.itemsize for array in arrays)

    def __len__(self) -> int:
        return len(self._arrays[0])

    def place(self, row: int) -> str:
        """How messages name a row."""
        return f"row {row + 1}"

    def chunks(
        self,
        columns: Sequence[int],
        rows: int = ROWS,
        kept: Sequence[int] = (),
        start: int = 0,
        stop: int | None = None,
    ) -> Iterator[Chunk]:
        """As `TableReader.chunks`, from a row on and to another."""
        last = len(self) if stop is None else min(stop, len(self))
        unread = 0
        for first in range(start, last, rows):
            end = min(first + rows, last)
            passed = tuple(self._columns[column][first:end].copy() for column in kept)
            yield Chunk(
                self._rows(slice(first, end), columns), np.arange(first, end), end / last, passed
            )
            unread += (end - first) * self._row_bytes
            if unread > _FORGET or end == last:
                self._forget()
                unread = 0

    def spread(self, columns: Sequence[int], rows: int) -> Chunk:
        """As `TableReader.spread`: evenly spaced."""
        which = np.unique(np.linspace(0, len(self) - 1, rows).round().astype(np.intp))
        return Chunk(self._rows(which, columns), which, 1.0)

    def _rows(self, which: slice | NDArray[np.intp], columns: Sequence[int]) -> Table:
        if len(self._arrays) == 1:
            rows = self._arrays[0][which]
            first = columns[0] if columns else 0
            if list(columns) == list(range(first, first + len(columns))):
                return np.asarray(rows[:, first : first + len(columns)], self.dtype)
            return np.asarray(rows[:, list(columns)], self.dtype)
        table = np.empty((len(self._columns[0][which]), len(columns)), self.dtype)
        for place, column in enumerate(columns):
            table[:, place] = self._columns[column][which]
        return table

    def _forget(self) -> None:
        if hasattr(mmap, "MADV_DONTNEED"):
            for each in self._maps:
                each.madvise(mmap.MADV_DONTNEED)


def _fields(array: NDArray[Any]) -> tuple[tuple[str, ...], tuple[NDArray[Any], ...]]:
    """The names and columns of a structured array; a field of several numbers is q[0], q[1], ..."""
    names: list[str] = []
    arrays: list[NDArray[Any]] = []
    for name in array.dtype.names or ():
        field = array[name].reshape(len(array), -1) if array.ndim == 1 else array[name]
        if field.dtype.kind not in "fiub":
            continue
        count = field.shape[-1]
        names += [name] if count == 1 else [f"{name}[{k}]" for k in range(count)]
        arrays.append(field)
    if not arrays:
        raise DataError("no field of the structured array holds numbers")
    return tuple(names), tuple(arrays)


class ParquetReader:
    """A Parquet file; numbers that are missing are NaN."""

    eps = 0.0

    def __init__(self, path: Path) -> None:
        try:
            import pyarrow as arrow
            from pyarrow.parquet import ParquetFile
        except ImportError:
            raise MissingExtra("Parquet", "parquet") from None
        self.source = str(path)
        self._failures = (arrow.ArrowException, OSError)
        with self._reported():
            self._file = ParquetFile(path, memory_map=True)
            schema = self._file.schema_arrow
        self._names: tuple[str, ...] = tuple(schema.names)
        self.names: tuple[str, ...] | None = self._names
        self.width = len(self._names)
        is_number = arrow.types.is_floating, arrow.types.is_integer
        self._is_number = [any(test(kind) for test in is_number) for kind in schema.types]
        is_single = all(kind == arrow.float32() for kind in schema.types)
        self.dtype = np.dtype(np.float32 if is_single else np.float64)

    def place(self, row: int) -> str:
        """How messages name a row."""
        return f"row {row + 1}"

    def chunks(
        self, columns: Sequence[int], rows: int = ROWS, kept: Sequence[int] = ()
    ) -> Iterator[Chunk]:
        """As `TableReader.chunks`."""
        wrong = [self._names[place] for place in columns if not self._is_number[place]]
        if wrong:
            raise DataError(f"{self.source}: no numbers in the columns {', '.join(wrong)}")
        count, start = self._file.metadata.num_rows, 0
        chosen = [self._names[place] for place in dict.fromkeys([*columns, *kept])]
        batches = self._file.iter_batches(batch_size=rows, columns=chosen)
        while True:
            with self._reported():
                batch = next(batches, None)
            if batch is None:
                return
            end = start + batch.num_rows
            read = {name: batch.column(name).to_numpy(zero_copy_only=False) for name in chosen}
            table = np.empty((batch.num_rows, len(columns)), self.dtype)
            for place, column in enumerate(columns):
                table[:, place] = read[self._names[column]]
            passed = tuple(read[self._names[column]] for column in kept)
            yield Chunk(table, np.arange(start, end), end / count, passed)
            start = end

    @contextmanager
    def _reported(self) -> Iterator[None]:
        """Failures of pyarrow, as DataError."""
        try:
            yield
        except self._failures:
            raise DataError(f"{self.source}: not a Parquet file, or a damaged one") from None

    def spread(self, columns: Sequence[int], rows: int) -> Chunk:
        """As `TableReader.spread`: its first rows."""
        return next(self.chunks(columns, rows), none(columns))
