"""Where samples come from: arrays in memory or on disk, and text files read piece by piece."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence, Set
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rigidsym.data.column_names import misnumbered
from rigidsym.data.npy import mapped
from rigidsym.data.text import TextRows, text_of
from rigidsym.errors import DataError
from rigidsym.tools.identify.columns import by_name, by_width
from rigidsym.tools.identify.readings import ANGLE_NAMES
from rigidsym.tools.identify.samples import Block, SampleError
from rigidsym.tools.identify.turns import Array

BLOCK = 16384  # rows that are in memory at once
SPREAD = 64  # rows that are looked at first
_SHAPES = {
    "angles": ((3,),),
    "matrix": ((3, 3), (9,)),
    "quaternion": ((4,),),
    "rates": ((3,),),
    "omega": ((3,),),
}


class Source(Protocol):
    """Rows that can be read from the beginning more than once."""

    names: tuple[str, ...]  # of the angles
    layouts: tuple[bool | None, ...]  # whether the scalar stands last; None: a matrix
    coarseness: float  # of the numbers, beyond what their digits say: single precision

    def blocks(self) -> Iterator[Block]:
        """All rows."""

    def spread(self) -> Block:
        """A few rows from all over the data."""

    def place(self, row: int) -> str:
        """What a row is called in messages."""


def layouts_of(*, is_matrix: bool, scalar_last: bool | None = None) -> tuple[bool | None, ...]:
    if is_matrix:
        return (None,)
    return (False, True) if scalar_last is None else (scalar_last,)


@dataclass(frozen=True, slots=True)
class _Part:
    """Some columns of an array whose rows are samples; nothing is copied but the rows asked for."""

    array: NDArray[Any]
    columns: tuple[int, ...] | None = None  # None: all

    def rows(self, which: slice | NDArray[np.intp]) -> Array:
        rows = self.array[which]
        rows = rows.reshape(len(rows), -1)
        return np.asarray(rows if self.columns is None else rows[:, list(self.columns)], float)


class ArraySource:
    """Arrays with one sample a row, such as a memory map."""

    def __init__(
        self,
        parts: dict[str, _Part],
        *,
        names: tuple[str, ...] = ANGLE_NAMES,
        scalar_last: bool | None = None,
    ) -> None:
        self.names = names
        self.layouts = layouts_of(is_matrix="matrix" in parts, scalar_last=scalar_last)
        self.coarseness = max(_coarseness(part.array.dtype) for part in parts.values())
        self._attitude = parts["matrix"] if "matrix" in parts else parts["quaternion"]
        self._parts = parts
        self._count = len(self._attitude.array)

    def place(self, row: int) -> str:
        return f"sample {row + 1}"

    def blocks(self) -> Iterator[Block]:
        for start in range(0, self._count, BLOCK):
            end = min(start + BLOCK, self._count)
            yield self._block(slice(start, end), np.arange(start, end))

    def spread(self) -> Block:
        rows = np.unique(np.linspace(0, self._count - 1, SPREAD).round().astype(np.intp))
        return self._block(rows, rows)

    def _block(self, which: slice | NDArray[np.intp], rows: NDArray[np.intp]) -> Block:
        has_velocity = "omega" in self._parts
        return Block(
            rows=rows,
            angles=self._parts["angles"].rows(which),
            attitude=self._attitude.rows(which),
            rates=self._parts["rates"].rows(which) if has_velocity else None,
            omega=self._parts["omega"].rows(which) if has_velocity else None,
            done=(int(rows[-1]) + 1) / self._count,
        )


def _coarseness(dtype: np.dtype[Any]) -> float:
    """What computing in a precision below double leaves uncertain."""
    if dtype.kind == "f" and dtype.itemsize < 8:
        return 64 * float(np.finfo(dtype).eps)
    return 0.0


def from_arrays(
    given: Mapping[str, ArrayLike | None], names: Sequence[str] = ANGLE_NAMES
) -> Source:
    """Samples from Python; raises SampleError for shapes that do not belong together."""
    arrays: dict[str, NDArray[Any]] = {}
    faults: list[str] = []
    for name, value in given.items():
        if value is not None:
            array, fault = _shaped(name, value)
            arrays[name] = array
            faults += fault
    faults += parts_missing(set(arrays))
    counts = {name: len(array) for name, array in arrays.items()}
    if not faults and len(set(counts.values())) > 1:
        said = ", ".join(f"{count} of {name}" for name, count in counts.items())
        faults.append(f"every part needs one row a sample, got {said}")
    if len(names) != 3 or len(set(names)) != 3:
        faults.append(f"expected three different names of angles, got {', '.join(names)}")
    if not faults and not min(counts.values()):
        faults.append("no samples")
    if faults:
        raise SampleError(faults)
    return ArraySource({name: _Part(a) for name, a in arrays.items()}, names=tuple(names))


def _shaped(name: str, value: ArrayLike) -> tuple[NDArray[Any], list[str]]:
    """The array with samples on the first axis."""
    try:
        array = np.asanyarray(value)
    except ValueError as error:  # rows of different lengths
        return np.empty(0), [f"{name}: not an array of numbers ({error})"]
    if array.dtype.kind not in "fiub":
        return array, [f"{name}: expected real numbers, got {array.dtype}"]
    shapes = _SHAPES[name]
    if array.shape in shapes:
        return array[None], []
    if array.shape[1:] in shapes:
        return array, []
    expected = " or ".join(str(("n", *shape)).replace("'", "") for shape in shapes)
    return array, [f"{name}: expected the shape {expected}, got {array.shape}"]


def parts_missing(parts: Set[str]) -> list[str]:
    """What is wrong with this choice of parts."""
    faults = [] if "angles" in parts else ["angles are missing"]
    if not parts & {"matrix", "quaternion"}:
        faults.append("a matrix or a quaternion is missing")
    if {"matrix", "quaternion"} <= parts:
        faults.append("give a matrix or a quaternion, not both")
    if len(parts & {"rates", "omega"}) == 1:
        faults.append("rates and omega belong together; one of them is missing")
    return faults


def from_file(path: Path, columns: Sequence[str] | None = None) -> Source:
    """Samples from an NPY file (memory-mapped) or a text file.

    `columns` names the columns, with `-` for one to leave out. Raises SampleError for what is
    not one of these, and for columns that are missing.
    """
    if path.suffix.lower() != ".npy":
        return TextSource(path, columns)
    try:
        array = mapped(path)
    except DataError as error:
        raise SampleError([str(error)]) from None
    return _from_npy(path, array, columns)


def _from_npy(path: Path, array: NDArray[Any], names: Sequence[str] | None) -> Source:
    if array.ndim != 2 or array.dtype.kind not in "fiub" or not len(array):
        raise SampleError(
            [f"{path}: expected numbers, one sample a row, got {array.dtype} {array.shape}"]
        )
    if names and len(names) != array.shape[1]:
        raise SampleError([misnumbered(path, array.shape[1], len(names))])
    found = by_name(names) if names else by_width(array.shape[1])
    attitude = "matrix" if len(found.attitude) == 9 else "quaternion"
    parts = {"angles": _Part(array, found.angles), attitude: _Part(array, found.attitude)}
    if found.rates:
        parts |= {"rates": _Part(array, found.rates), "omega": _Part(array, found.omega)}
    return ArraySource(parts, names=found.names, scalar_last=found.scalar_last)


class TextSource:
    """A text file with one sample a line; the user may name its columns where it does not."""

    def __init__(self, path: Path, names: Sequence[str] | None = None) -> None:
        try:
            self._text = TextRows(path)
        except DataError as error:
            raise SampleError([str(error)]) from None
        self.coarseness = 0.0
        width, header = self._text.width, self._text.names
        if names and len(names) != width:
            raise SampleError([misnumbered(path, width, len(names))])
        named = names or header
        self._columns = by_name(named) if named else by_width(width)
        self.names = self._columns.names
        is_matrix = len(self._columns.attitude) == 9
        self.layouts = layouts_of(is_matrix=is_matrix, scalar_last=self._columns.scalar_last)

    def place(self, row: int) -> str:
        return f"line {row}"

    def blocks(self) -> Iterator[Block]:
        found = False
        for lines in self._text.lines(rows=BLOCK):
            found = True
            yield self._block(lines.numbers, lines.texts, lines.end / self._text.size)
        if not found:
            raise SampleError([f"{self._text.path}: no samples"])

    def _block(self, rows: Sequence[int], lines: Sequence[str], done: float) -> Block:
        try:
            table = self._text.table(lines, self._columns.used)
        except ValueError:
            raise SampleError(self._faults(rows, lines)) from None
        return self._as_block(np.array(rows), table, done)

    def _as_block(self, rows: NDArray[np.intp], table: Array, done: float) -> Block:
        at = np.cumsum([3, len(self._columns.attitude), len(self._columns.rates)])
        angles, attitude, rates, omega = np.split(table, at, axis=1)
        has_velocity = bool(self._columns.rates)
        return Block(
            rows=rows,
            angles=angles,
            attitude=attitude,
            rates=rates if has_velocity else None,
            omega=omega if has_velocity else None,
            done=done,
        )

    def _faults(self, rows: Sequence[int], lines: Sequence[str]) -> list[str]:
        return [
            f"{self.place(row)}: {fault}"
            for row, line in zip(rows, lines, strict=True)
            for fault in self._text.wrong_with(line, self._columns.used)
        ]

    def spread(self) -> Block:
        """Lines from all over the file, found by seeking; those that do not read are left out."""
        first = next(self._text.lines(rows=SPREAD), None)
        head, start = ((), 0) if first is None else (first.texts, first.end)
        lines = [*head]
        with self._text.path.open("rb") as file:
            for offset in np.linspace(start, self._text.size, SPREAD, endpoint=False).astype(int):
                file.seek(int(offset))
                file.readline()  # the rest of a line
                lines.append(text_of(file.readline()))
        used = self._columns.used
        good = [line for line in lines if line and not self._text.wrong_with(line, used)]
        if not good:
            return next(self.blocks())  # which says what is wrong with them
        return self._block([0] * len(good), good, 0.0)
