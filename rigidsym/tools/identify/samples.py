"""Samples: rows of angles, a matrix or quaternion, rates and angular velocity, read and checked."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence, Set
from dataclasses import replace
from math import ceil
from pathlib import Path
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rigidsym.data.columns import COLUMNS, ColumnNames, Names, counted, names_for
from rigidsym.data.tables import MOST_SHOWN, ArrayTable, Batch, Table, listed, names_of, open_table
from rigidsym.errors import DataError
from rigidsym.system.records import Record
from rigidsym.tools.identify.readings import ANGLE_NAMES
from rigidsym.tools.spellings import ANGLES, MATRICES, NAMED_QUATERNIONS, OMEGAS, QUATERNIONS, RATES

Array = NDArray[np.float64]
SLACK = 0.05  # how far M Mᵀ may be from 1, and |q| from 1, before data are refused
SIZES = {"angles": 3, "matrix": 9, "quaternion": 4, "rates": 3, "omega": 3}  # numbers in a sample
_WITHOUT_HEADER = {
    7: ("angles", "quaternion"),
    12: ("angles", "matrix"),
    13: ("angles", "quaternion", "rates", "omega"),
    18: ("angles", "matrix", "rates", "omega"),
}
_PER = {"angles": "", "rates": "/s", "omega": "/s"}  # what their units are of radians
_NUMBERED_RATES: Names = ("rate1", "rate2", "rate3")


class SampleError(DataError):
    """Samples that cannot be read: all faults at once, each with its line or number."""

    def __init__(self, faults: Sequence[str], *, count: int = 0, source: str = "") -> None:
        super().__init__(listed(source, faults, count))


class Columns(NamedTuple):
    """Where the parts of a sample are in the columns of a table, counted from 0."""

    parts: Mapping[str, Sequence[int]]
    names: Names = ANGLE_NAMES  # of the angles
    scalar_last: bool | None = None  # of a quaternion whose names tell which is the scalar
    factors: Sequence[float] = (1.0,)  # of all columns used, in order
    converted: Names = ()  # the columns that they convert
    stated: Mapping[str, str] = MappingProxyType({})  # units in their names, by part: deg/s
    unused: str = ""  # columns of rates without Ω, or of Ω without rates, in words

    @property
    def layouts(self) -> tuple[bool | None, ...]:
        """Whether the scalar of a quaternion may be last; None for a matrix."""
        if "matrix" in self.parts:
            return (None,)
        return (False, True) if self.scalar_last is None else (self.scalar_last,)


class Samples(Record, kw_only=True):
    """The samples of a table in one unit, (n, ...) each."""

    rows: NDArray[np.intp]  # their numbers in the data, (n,)
    parts: Mapping[str, Array]  # angles, matrix or quaternion, and perhaps rates and omega
    columns: Columns
    place: Callable[[int], str]  # how messages name a row
    source: str = ""  # the file
    eps: float = 0.0  # relative precision of the numbers if it is below double

    def __len__(self) -> int:
        return len(self.rows)

    @property
    def attitude(self) -> Array:
        return self.parts["matrix" if "matrix" in self.parts else "quaternion"]

    def some(self, count: int) -> Samples:
        """About so many of them, evenly spaced."""
        step = slice(None, None, max(1, ceil(len(self) / count)))
        parts = {name: part[step] for name, part in self.parts.items()}
        return replace(self, rows=self.rows[step], parts=parts)

    def defects(self) -> Array:
        """How far each matrix is from orthogonal, or each quaternion from unit length: (n,)."""
        if "quaternion" in self.parts:
            return np.asarray(np.abs(np.linalg.norm(self.attitude, axis=1) - 1))
        m = self.attitude.reshape(-1, 3, 3)
        return np.asarray(np.abs(m @ m.swapaxes(1, 2) - np.eye(3)).max(axis=(1, 2)))

    def orientation(self, scalar_last: bool | None) -> Array:
        """The matrices, or those of the quaternions: (n, 3, 3)."""
        if scalar_last is None:
            return self.attitude.reshape(-1, 3, 3)
        q = self.attitude / np.linalg.norm(self.attitude, axis=1, keepdims=True)
        q, one = np.roll(q, int(scalar_last), axis=1)[..., None], np.eye(3)
        w, column, row = q[:, :1], q[:, 1:], q[:, 1:].swapaxes(1, 2)
        # R = (2 w² − 1) 1 + 2 v vᵀ + 2 w C(v), and row k of C(v) is e_k × v.
        return np.asarray((2 * w**2 - 1) * one + 2 * column @ row + 2 * w * np.cross(one, row))

    @np.errstate(all="ignore")  # numbers that overflow here are far from a rotation
    def check(self, slack: float) -> None:
        """Raise SampleError, with the first faults, for samples that are no rotations.

        `slack` is how far M Mᵀ may be from 1, and |q| from 1.
        """
        infinite = {name: ~np.isfinite(part).all(axis=1) for name, part in self.parts.items()}
        defects = self.defects()
        # Rows that are not finite have their own message, and are no wrong rotations.
        wrong = ~np.any([*infinite.values()], axis=0) & ~(defects <= slack)
        if is_matrix := "matrix" in self.parts:
            sizes = np.linalg.det(self.attitude.reshape(-1, 3, 3))
            wrong |= ~infinite["matrix"] & (sizes <= 0)
        else:
            sizes = np.linalg.norm(self.attitude, axis=1)
        faults = [  # the first of each kind, since a log may have millions
            (k, f"{name}: a number that is missing or not finite")
            for name, rows in infinite.items()
            for k in np.flatnonzero(rows)[:MOST_SHOWN].tolist()
        ]
        for k in np.flatnonzero(wrong)[:MOST_SHOWN].tolist():
            fault = f"quaternion: its length is {sizes[k]:.4g}, expected 1"
            if is_matrix and sizes[k] < 0 and defects[k] <= SLACK:
                size = f"{sizes[k]:.4g}"
                fault = f"matrix: not a rotation but a reflection, its determinant is {size}"
            elif is_matrix:
                fault = (
                    f"matrix: not a rotation, M Mᵀ differs from 1 by {defects[k]:.2g} in an entry "
                    f"(det M = {sizes[k]:.4g})"
                )
            faults.append((k, fault))
        if faults:
            messages = [f"{self.place(int(self.rows[k]))}: {fault}" for k, fault in sorted(faults)]
            count = int(sum(rows.sum() for rows in (wrong, *infinite.values())))
            raise SampleError(messages, count=count, source=self.source)


# Which column is which part


def by_width(width: int) -> Columns:
    """The columns of an array without names; raises SampleError for other widths than 7, 12, ..."""
    if width not in _WITHOUT_HEADER:
        widths = "; ".join(f"{w} ({', '.join(parts)})" for w, parts in _WITHOUT_HEADER.items())
        names = f"{counted(width, 'column')} without names"
        raise SampleError([f"{names}: expected {widths}; or name them with {COLUMNS}"])
    columns = iter(range(width))
    parts = _WITHOUT_HEADER[width]
    return Columns({part: [next(columns) for _ in range(SIZES[part])] for part in parts})


def by_name(names: Sequence[str]) -> Columns:
    """The columns that a header names; others are not read.

    Angles, and quaternions whose names do not tell which is the scalar, keep the order of the
    file. Raises SampleError for missing columns, with the nearest names that are there, and
    DataError for two columns of one name and for units that are not those of angles and their
    rates.
    """
    header = ColumnNames(names)

    def in_order(group: Names) -> Names:
        return tuple(sorted(group, key=lambda name: header.find([name]) or 0))

    def share(group: Names) -> float:
        return sum(map(header.has, group)) / len(group)

    def nearest(groups: Iterable[Names]) -> Names:
        return max(groups, key=share)  # the first of equals

    matrix, quaternion, scalar_last = nearest(MATRICES), nearest(QUATERNIONS), None
    has_two = share(matrix) == share(quaternion) == 1
    if quaternion in NAMED_QUATERNIONS:
        w, *vector = quaternion
        scalar_last = in_order(quaternion) == (*vector, w)
        quaternion = (*vector, w) if scalar_last else quaternion
    else:
        quaternion = in_order(quaternion)
    angles = in_order(nearest(ANGLES))
    groups = {"angles": angles, "matrix": matrix}
    if share(quaternion) > share(matrix):
        groups = {"angles": angles, "quaternion": quaternion}
    rates = nearest([*(tuple(f.format(a) for a in angles) for f in RATES), _NUMBERED_RATES])
    velocity = {"rates": rates, "omega": nearest(OMEGAS)}
    complete = [part for part, group in velocity.items() if share(group) == 1]
    groups |= velocity if len(complete) == 2 else {}
    faults = ["both a matrix and a quaternion are named; leave one out"] if has_two else []
    if missing := [n for group in groups.values() for n in group if not header.has(n)]:
        lacking = ", ".join(missing)
        lacking = lacking.replace(", ".join(MATRICES[0]), "r11, ..., r33 or qw, qx, qy, qz")
        lacking = f"no column {lacking} among {header.listed}"
        faults.append(f"{lacking}; {COLUMNS} names them in order")
    if faults:
        raise SampleError(faults)

    def columns_of(group: Names) -> list[int]:
        return [column for name in group if (column := header.find([name])) is not None]

    parts = {part: columns_of(group) for part, group in groups.items()}
    factors: dict[int, float] = {}
    stated: dict[str, str] = {}
    for part, columns in parts.items():
        # to radians if a unit is a multiple of them, and else to degrees
        units = [header.unit(column).casefold().lstrip("numµ") for column in columns]
        base = "rad" if any(unit.startswith("rad") for unit in units) else "deg"
        stated |= {part: base + _PER[part]} if part in _PER and any(units) else {}
        for k in columns:
            factor = header.factor(k, base + _PER[part]) if part in _PER else None
            factors[k] = factor or 1.0
    unused = ""
    if len(complete) == 1:
        named = ", ".join(header.names[k] for k in columns_of(velocity[complete[0]]))
        other = {"rates": "an angular velocity", "omega": "rates of the angles"}[complete[0]]
        unused = f"{named}, since there are no columns for {other}"
    return Columns(
        parts=parts,
        names=angles,
        scalar_last=scalar_last,
        factors=[*factors.values()],
        stated=stated,
        converted=tuple(header.names[k] for k, factor in factors.items() if factor != 1),
        unused=unused,
    )


# Reading


def samples_of(
    table: Table, columns: Columns, batch: Batch | None = None, *, drops_missing: bool = False
) -> Samples:
    """The samples of a table, or of a batch of it that has just these columns."""
    batch = batch or table.read([k for part in columns.parts.values() for k in part])
    if drops_missing:
        batch = batch.at(np.asarray(~np.isnan(batch.table).any(axis=1)))
    numbers = np.asarray(batch.table, float) * columns.factors
    ends = np.cumsum([len(part) for part in columns.parts.values()])[:-1]
    return Samples(
        rows=batch.rows,
        parts=dict(zip(columns.parts, np.split(numbers, ends, axis=1), strict=True)),
        columns=columns,
        place=table.place if table.source else lambda row: f"sample {row + 1}",
        source=table.source,
        eps=table.eps,
    )


def from_file(
    path: Path, names: Sequence[str] | None = None, *, drops_missing: bool = False
) -> Samples:
    """Samples from an NPY, Parquet or text file.

    `names` are those of the columns, with `-` for one to leave out. Raises SampleError for a file
    without samples, and for columns that are missing.
    """
    try:
        table = open_table(path)
        named = names_for(names, table.width, table.names)
        columns = by_width(table.width) if named is None else by_name(named)
    except DataError as error:
        place = "" if str(path) in str(error) else f"{path}: "
        raise SampleError([f"{place}{error}"]) from None
    return samples_of(table, columns, drops_missing=drops_missing)


def from_arrays(parts: Mapping[str, Any], names: Sequence[str] = ANGLE_NAMES) -> Samples:
    """Samples from Python; raises SampleError for shapes that do not belong together.

    A table with names of columns is read as a file with this header.
    """
    present = {name: value for name, value in parts.items() if value is not None}
    labelled = [name for name, value in present.items() if names_of(value)]
    if labelled == ["angles"] == [*present]:
        table = ArrayTable(present["angles"])
        return samples_of(table, by_name(table.names or ()))
    expected = (
        "its columns have names; expected an array without names, or one table "
        "with the columns of all parts, as the only argument"
    )
    faults = [f"{name}: {expected}" for name in labelled] + parts_missing(present.keys())
    if not len(names) == len({*names}) == 3:
        faults.append(f"expected three different names of angles, got {', '.join(names)}")
    if faults:
        raise SampleError(faults)
    arrays = {name: _rows(name, present[name]) for name in SIZES if name in present}
    if len({*map(len, arrays.values())}) > 1:
        sizes = ", ".join(f"{len(array)} of {name}" for name, array in arrays.items())
        raise SampleError([f"expected one row per sample in every array, got {sizes}"])
    columns = by_width(sum(SIZES[name] for name in arrays))
    return samples_of(ArrayTable(*arrays.values()), columns._replace(names=tuple(names)))


def _rows(name: str, value: ArrayLike) -> NDArray[Any]:
    """The array with samples on the first axis and numbers on the second."""
    if hasattr(value, "as_matrix") and hasattr(value, "as_quat"):  # a Rotation of SciPy
        value = value.as_quat() if name == "quaternion" else value.as_matrix()
    try:
        array = np.asanyarray(value)
    except ValueError as error:  # rows of different lengths
        raise SampleError([f"{name}: not an array of numbers ({error})"]) from None
    if array.dtype.kind not in "fiub" or np.ma.is_masked(array):
        what = "masked entries" if np.ma.is_masked(array) else array.dtype
        raise SampleError([f"{name}: expected real numbers, got {what}"])
    shapes = [(3, 3), (9,)] if name == "matrix" else [(SIZES[name],)]
    # A single sample may come without the axis of samples.
    for rows in (array[None], array):
        if rows.shape[1:] in shapes:
            return rows.reshape(len(rows), SIZES[name])
    expected = " or ".join(str(("n", *shape)).replace("'", "") for shape in shapes)
    raise SampleError([f"{name}: expected the shape {expected}, got {array.shape}"])


def parts_missing(parts: Set[str]) -> list[str]:
    """Messages on a choice of parts that is not enough, or too much."""
    faults = [] if "angles" in parts else ["angles are missing"]
    if len(parts & {"matrix", "quaternion"}) != 1:
        both = "give a matrix or a quaternion, not both"
        faults.append(both if "matrix" in parts else "a matrix or a quaternion is missing")
    if len(parts & {"rates", "omega"}) == 1:
        faults.append("expected both rates and omega, or neither")
    return faults
