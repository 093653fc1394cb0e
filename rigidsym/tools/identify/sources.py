"""Samples from arrays in memory or on disk and from files, read in blocks."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence, Set
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rigidsym.data.chunk import Chunk, TableReader
from rigidsym.data.columns import names_for
from rigidsym.data.readers import ArrayReader, reader_of
from rigidsym.errors import DataError
from rigidsym.tools.identify.readings import ANGLE_NAMES
from rigidsym.tools.identify.sample_columns import Columns, by_name, by_width
from rigidsym.tools.identify.samples import SampleBlock, SampleError

BLOCK = 16384  # rows that are in memory at once
SPREAD = 64  # rows that are looked at first
_THREE = ((3,),)
_SHAPES: dict[str, tuple[tuple[int, ...], ...]] = {"angles": _THREE, "matrix": ((3, 3), (9,))}
_SHAPES |= {"quaternion": ((4,),), "rates": _THREE, "omega": _THREE}


@dataclass(frozen=True, kw_only=True, slots=True)
class SampleSource:
    """The samples of a table, which can be read from the beginning more than once."""

    reader: TableReader
    columns: Columns
    drops_missing: bool = False  # samples with numbers that are missing, else an error

    @property
    def coarseness(self) -> float:
        """What computing in a precision below double leaves uncertain."""
        return 64 * self.reader.eps

    def place(self, row: int) -> str:
        """How messages name a row."""
        return self.reader.place(row) if self.reader.source else f"sample {row + 1}"

    def blocks(self) -> Iterator[SampleBlock]:
        """All rows."""
        for chunk in self.reader.chunks(self.columns.used, BLOCK):
            yield self._block(chunk)

    def spread(self) -> SampleBlock:
        """A few rows from all over the data."""
        return self._block(self.reader.spread(self.columns.used, SPREAD))

    def _block(self, chunk: Chunk) -> SampleBlock:
        if self.drops_missing:
            chunk = chunk.at(np.asarray(~np.isnan(chunk.table).any(axis=1)))
        columns = self.columns
        table = np.asarray(chunk.table, float)
        if columns.factors:
            table = table * np.array(columns.factors)
        at = np.cumsum([3, len(columns.attitude), len(columns.rates)])
        angles, attitude, *velocity = np.split(table, at, axis=1)
        rates, omega = velocity if columns.rates else (None, None)
        return SampleBlock(
            rows=chunk.rows,
            angles=angles,
            attitude=attitude,
            rates=rates,
            omega=omega,
            done=chunk.share,
        )


def from_file(
    path: Path, names: Sequence[str] | None = None, *, drops_missing: bool = False
) -> SampleSource:
    """Samples from an NPY, Parquet or text file.

    `names` are those of the columns, with `-` for one to leave out. Raises SampleError for a file
    without samples, and for columns that are missing.
    """
    try:
        reader = reader_of(path)
        named = names_for(names, reader.width, reader.names)
        columns = by_width(reader.width) if named is None else by_name(named)
    except SampleError:
        raise
    except DataError as error:
        raise SampleError([str(error)]) from None
    return SampleSource(reader=reader, columns=columns, drops_missing=drops_missing)


def from_arrays(
    given: Mapping[str, ArrayLike | None], names: Sequence[str] = ANGLE_NAMES
) -> SampleSource:
    """Samples from Python; raises SampleError for shapes that do not belong together."""
    arrays: dict[str, NDArray[Any]] = {}
    faults: list[str] = []
    for name, value in given.items():
        if value is not None:
            array, fault = _shaped(name, value)
            arrays[name] = array
            faults += fault
    faults += parts_missing(set(arrays))
    counts = {name: len(array) for name, array in arrays.items() if array.ndim}
    if not faults and len(set(counts.values())) > 1:
        said = ", ".join(f"{count} of {name}" for name, count in counts.items())
        faults.append(f"expected one row per sample in every array, got {said}")
    if len(names) != 3 or len(set(names)) != 3:
        faults.append(f"expected three different names of angles, got {', '.join(names)}")
    if faults or not min(counts.values()):
        raise SampleError(faults or ["no samples"])
    width = 13 if "quaternion" in arrays else 18
    columns = replace(by_width(width - 6 * ("omega" not in arrays)), names=tuple(names))
    order = [arrays[name] for name in _SHAPES if name in arrays]
    return SampleSource(reader=ArrayReader(*order), columns=columns)


def _shaped(name: str, value: ArrayLike) -> tuple[NDArray[Any], list[str]]:
    """The array with samples on the first axis and numbers on the second."""
    if hasattr(value, "as_matrix") and hasattr(value, "as_quat"):  # a Rotation of SciPy
        value = value.as_quat() if name == "quaternion" else value.as_matrix()
    try:
        array = np.asanyarray(value)
    except ValueError as error:  # rows of different lengths
        return np.empty(0), [f"{name}: not an array of numbers ({error})"]
    if array.dtype.kind not in "fiub":
        return array, [f"{name}: expected real numbers, got {array.dtype}"]
    if np.ma.is_masked(array):
        return array, [f"{name}: masked entries; leave their samples out"]
    shapes = _SHAPES[name]
    if array.shape in shapes:
        return array.reshape(1, -1), []
    if array.shape[1:] in shapes:
        return array.reshape(len(array), int(np.prod(array.shape[1:]))), []
    expected = " or ".join(str(("n", *shape)).replace("'", "") for shape in shapes)
    return array, [f"{name}: expected the shape {expected}, got {array.shape}"]


def parts_missing(parts: Set[str]) -> list[str]:
    """Messages on a choice of parts that is not enough, or too much."""
    faults = [] if "angles" in parts else ["angles are missing"]
    if not parts & {"matrix", "quaternion"}:
        faults.append("a matrix or a quaternion is missing")
    if {"matrix", "quaternion"} <= parts:
        faults.append("give a matrix or a quaternion, not both")
    if len(parts & {"rates", "omega"}) == 1:
        faults.append("expected both rates and omega, or neither")
    return faults
