"""Samples: rows of angles, a matrix or quaternion, rates and angular velocity, read and checked."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence, Set
from dataclasses import dataclass, replace
from difflib import get_close_matches
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rigidsym.data.columns import ColumnNames, counted, names_for
from rigidsym.data.tables import MOST_SHOWN, ArrayTable, Batch, Table, names_of, open_table
from rigidsym.errors import DataError
from rigidsym.tools.identify.readings import ANGLE_NAMES
from rigidsym.tools.identify.turns import Array, quaternion_of
from rigidsym.tools.spellings import (
    ANGLES,
    MATRICES,
    NAMED_QUATERNIONS,
    OMEGAS,
    QUATERNIONS,
    RATES,
    Names,
)

SLACK = 0.05  # how far M Mᵀ may be from 1, and |q| from 1, before data are refused
BLOCK = 16384  # rows that are in memory at once
SPREAD = 64  # rows that are looked at first
SIZES = {"angles": 3, "matrix": 9, "quaternion": 4, "rates": 3, "omega": 3}  # numbers in a sample
_WITHOUT_HEADER = {
    7: ("angles", "quaternion"),
    12: ("angles", "matrix"),
    13: ("angles", "quaternion", "rates", "omega"),
    18: ("angles", "matrix", "rates", "omega"),
}
_NUMBERED_RATES: Names = ("rate1", "rate2", "rate3")


class SampleError(DataError):
    """Samples that cannot be read: all faults at once, each with its line or number."""

    def __init__(
        self, faults: Sequence[str], *, count: int | None = None, path: Path | None = None
    ) -> None:
        self.faults = tuple(faults)
        self.count = count or len(faults)
        more = self.count - len(faults[:MOST_SHOWN])
        lines = [*faults[:MOST_SHOWN], *([f"and {more} more"] if more else [])]
        place = "" if path is None or str(path) in lines[0] else f"{path}: "
        head = f"{place}the samples cannot be read"
        super().__init__(place + lines[0] if len(lines) == 1 else "\n  ".join([head, *lines]))

    def of(self, path: Path) -> SampleError:
        """The same, with the file that the samples are from."""
        return SampleError(self.faults, count=self.count, path=path)


class OptionError(SampleError):
    """Samples in the options of a command that cannot be read, or no samples."""

    exit_code: ClassVar[int] = 2


@dataclass(frozen=True, slots=True)
class SampleBlock:
    """Some rows of the data."""

    rows: NDArray[np.intp]  # their numbers in the data, (n,)
    parts: Mapping[str, Array]  # angles, matrix or quaternion, and perhaps rates and omega
    done: float = 1.0  # share of the data that is read with this block

    def __len__(self) -> int:
        return len(self.rows)

    @property
    def is_matrix(self) -> bool:
        return "matrix" in self.parts

    @property
    def angles(self) -> Array:
        return self.parts["angles"]

    @property
    def attitude(self) -> Array:
        return self.parts["matrix" if self.is_matrix else "quaternion"]

    @property
    def rates(self) -> Array | None:
        return self.parts.get("rates")

    @property
    def omega(self) -> Array | None:
        return self.parts.get("omega")

    @property
    def matrices(self) -> Array:
        return self.attitude.reshape(-1, 3, 3)

    def at(self, which: slice | NDArray[np.bool_]) -> SampleBlock:
        """Some of the rows."""
        parts = {name: part[which] for name, part in self.parts.items()}
        return SampleBlock(self.rows[which], parts, self.done)

    def defects(self) -> Array:
        """How far each matrix is from orthogonal, or each quaternion from unit length: (n,)."""
        if not self.is_matrix:
            return np.asarray(np.abs(np.linalg.norm(self.attitude, axis=1) - 1))
        m = self.matrices
        return np.asarray(np.abs(m @ m.swapaxes(1, 2) - np.eye(3)).max(axis=(1, 2)))

    def orientation(self) -> Array:
        """Unit quaternions (n, 4): of the nearest rotations, or those given, in their order."""
        if self.is_matrix:
            return quaternion_of(self.matrices)
        return np.asarray(self.attitude / np.linalg.norm(self.attitude, axis=1, keepdims=True))


@np.errstate(all="ignore")  # numbers that overflow here are far from a rotation
def check(
    block: SampleBlock, place: Callable[[int], str], slack: float = SLACK
) -> tuple[SampleBlock, list[str], int]:
    """The good rows, the first faults of the others, and the number of faults.

    Faults are numbers that are missing or not finite, matrices that are not rotations, and
    quaternions that are not of unit length; `slack` is how far off the last two may be.
    """
    finite = {name: np.isfinite(part).all(axis=1) for name, part in block.parts.items()}
    rest = block.at(np.all([*finite.values()], axis=0))
    turns = rest.defects() <= slack
    if block.is_matrix:
        turns &= np.linalg.det(rest.matrices) > 0
    wrong = np.flatnonzero(~turns)
    faults = [  # the first of each kind, since a log may have millions
        (row, f"{name}: a number that is missing or not finite")
        for name, good in finite.items()
        for row in block.rows[~good][:MOST_SHOWN].tolist()
    ]
    for k in wrong[:MOST_SHOWN].tolist():
        faults.append((int(rest.rows[k]), _what_is_wrong(rest.at(slice(k, k + 1)))))
    count = len(wrong) + sum(int((~good).sum()) for good in finite.values())
    messages = [f"{place(row)}: {fault}" for row, fault in sorted(faults)[:MOST_SHOWN]]
    return rest.at(turns), messages, count


def _what_is_wrong(row: SampleBlock) -> str:
    if not row.is_matrix:
        length = float(np.linalg.norm(row.attitude))
        if not length:
            return "quaternion: zero, which is not a rotation"
        return f"quaternion: its length is {length:.4g}, expected 1"
    defect, determinant = float(row.defects()[0]), float(np.linalg.det(row.matrices[0]))
    if determinant < 0 and defect <= SLACK:
        return f"matrix: not a rotation but a reflection, its determinant is {determinant:.4g}"
    return (
        f"matrix: not a rotation, M Mᵀ differs from 1 by {defect:.2g} in an entry"
        f" (det M = {determinant:.4g})"
    )


@dataclass(frozen=True, slots=True)
class Columns:
    """Where the parts of a sample are in the columns of a table, counted from 0."""

    parts: Mapping[str, tuple[int, ...]]  # in the order of SIZES
    names: Names = ANGLE_NAMES  # of the angles
    scalar_last: bool | None = None  # of a quaternion whose names tell which is the scalar
    factors: tuple[float, ...] = ()  # of all columns used; none if all are 1
    converted: tuple[str, ...] = ()  # the columns that they convert
    unused: str = ""  # columns of rates without Ω, or of Ω without rates, in words

    @property
    def used(self) -> tuple[int, ...]:
        return tuple(column for part in self.parts.values() for column in part)

    @property
    def layouts(self) -> tuple[bool | None, ...]:
        """Whether the scalar of a quaternion may be last; None for a matrix."""
        if "matrix" in self.parts:
            return (None,)
        return (False, True) if self.scalar_last is None else (self.scalar_last,)

    def split(self, batch: Batch) -> SampleBlock:
        """The parts of some rows, in one unit."""
        table = np.asarray(batch.table, float) * (self.factors or 1.0)
        ends = np.cumsum([len(part) for part in self.parts.values()])[:-1]
        parts = dict(zip(self.parts, np.split(table, ends, axis=1), strict=True))
        return SampleBlock(batch.rows, parts, batch.share)


def by_width(width: int) -> Columns:
    """The columns of an array without names; raises SampleError for other widths than 7, 12, ..."""
    if width not in _WITHOUT_HEADER:
        widths = "; ".join(f"{w} ({', '.join(parts)})" for w, parts in _WITHOUT_HEADER.items())
        names = f"{counted(width, 'column')} without names"
        raise SampleError([f"{names}: expected {widths}; or name them with --columns"])
    columns = iter(range(width))
    return Columns(
        {part: tuple(next(columns) for _ in range(SIZES[part])) for part in _WITHOUT_HEADER[width]}
    )


def by_name(names: Sequence[str]) -> Columns:
    """The columns that a header names; others are not read.

    Angles, and quaternions whose names do not tell which is the scalar, keep the order of the
    file. Raises SampleError for missing columns, with the nearest names that are there, and
    DataError for two columns of one name and for units that are not those of angles and their
    rates.
    """
    header = ColumnNames(names)

    def column(name: str) -> int:
        return (header.find([name]) or 0) if header.has(name) else len(header.names)

    def share(group: Names) -> float:
        return sum(map(header.has, group)) / len(group)

    def nearest(groups: Iterable[Names]) -> Names:
        return max(groups, key=share)  # the first of equals

    angles = tuple(sorted(nearest(ANGLES), key=column))
    matrix, quaternion = nearest(MATRICES), nearest(QUATERNIONS)
    in_order = tuple(sorted(quaternion, key=column))
    if _scalar_last(in_order) is not None or quaternion not in NAMED_QUATERNIONS:
        quaternion = in_order
    is_matrix = share(matrix) >= share(quaternion)
    rates = nearest([*(tuple(f.format(a) for a in angles) for f in RATES), _NUMBERED_RATES])
    omega = nearest(OMEGAS)
    attitude = {"matrix": matrix} if is_matrix else {"quaternion": quaternion}
    parts: dict[str, Names] = {"angles": angles, **attitude}
    velocity = {"rates": rates, "omega": omega}
    alone = {part: group for part, group in velocity.items() if share(group) == 1}
    if len(alone) == 2:
        parts, alone = parts | velocity, {}
    faults = _missing([name for group in parts.values() for name in group], header)
    if faults:
        faults.append("--columns names the columns in order, if their names are others")
    if share(matrix) == share(quaternion) == 1:
        faults.append("both a matrix and a quaternion are named; leave one out")
    if faults:
        raise SampleError(faults)
    places = {part: tuple(map(column, group)) for part, group in parts.items()}
    factors: list[float] = []
    for part, columns in places.items():
        factors += _factors(header, columns, "/s" if part in velocity else "", part in attitude)
    used = [header.names[k] for columns in places.values() for k in columns]
    changed = [name for name, factor in zip(used, factors, strict=True) if factor != 1]
    lacking = {"rates": "an angular velocity", "omega": "rates of the angles"}
    return Columns(
        places,
        names=angles,
        scalar_last=None if is_matrix else _scalar_last(quaternion),
        factors=tuple(factors) if changed else (),
        converted=tuple(changed),
        unused="".join(
            f"{', '.join(header.names[column(name)] for name in group)}, since there are no "
            f"columns for {lacking[part]}"
            for part, group in alone.items()
        ),
    )


def _factors(
    header: ColumnNames, columns: Sequence[int], per: str, is_attitude: bool
) -> list[float]:
    """To radians if a unit is a multiple of them, and else to degrees; 1 for an attitude."""
    if is_attitude:
        return [1.0] * len(columns)
    stated = [header.unit(column).casefold() for column in columns]
    in_radians = any(unit.lstrip("numµ").startswith("rad") for unit in stated)
    unit = ("rad" if in_radians else "deg") + per
    factors = [header.factor(column, unit) or 1.0 for column in columns]
    return [1.0 if abs(factor - 1) < 1e-15 else factor for factor in factors]


def _scalar_last(names: Names) -> bool | None:
    """Whether w comes after x, y, z; None if names or order do not tell."""
    for scalar, *vector in NAMED_QUATERNIONS:
        if names in ((scalar, *vector), (*vector, scalar)):
            return names[-1] == scalar
    return None


def _missing(wanted: Sequence[str], header: ColumnNames) -> list[str]:
    """Messages on missing columns: those with similar names first, then all others."""
    there = dict(zip(header.plain, header.names, strict=True))
    free = [name for name in there if name not in wanted]
    lacking = [name for name in wanted if not header.has(name)]
    near = {name: get_close_matches(name, free, n=2) for name in lacking}
    faults = [
        f"no column {name}: did you mean {' or '.join(there[match] for match in matches)}?"
        for name, matches in near.items()
        if matches
    ]
    if rest := ", ".join(name for name, matches in near.items() if not matches):
        rest = rest.replace(", ".join(MATRICES[0]), "r11, ..., r33 or qw, qx, qy, qz")
        faults.append(f"no column {rest} among {header.listed}")
    return faults


@dataclass(frozen=True, kw_only=True, slots=True)
class SampleSource:
    """The samples of a table, which can be read from the beginning more than once."""

    reader: Table
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
        for batch in self.reader.batches(self.columns.used, BLOCK):
            yield self._block(batch)

    def spread(self) -> SampleBlock:
        """A few rows from all over the data."""
        return self._block(self.reader.sample(self.columns.used, SPREAD))

    def _block(self, batch: Batch) -> SampleBlock:
        if self.drops_missing:
            batch = batch.at(np.asarray(~np.isnan(batch.table).any(axis=1)))
        return self.columns.split(batch)


def from_file(
    path: Path, names: Sequence[str] | None = None, *, drops_missing: bool = False
) -> SampleSource:
    """Samples from an NPY, Parquet or text file.

    `names` are those of the columns, with `-` for one to leave out. Raises SampleError for a file
    without samples, and for columns that are missing.
    """
    try:
        reader = open_table(path)
        named = names_for(names, reader.width, reader.names)
        columns = by_width(reader.width) if named is None else by_name(named)
    except SampleError:
        raise
    except DataError as error:
        raise SampleError([str(error)]) from None
    return SampleSource(reader=reader, columns=columns, drops_missing=drops_missing)


def from_arrays(parts: Mapping[str, Any], names: Sequence[str] = ANGLE_NAMES) -> SampleSource:
    """Samples from Python; raises SampleError for shapes that do not belong together.

    A table with names of columns is read as a file with this header.
    """
    labelled = [name for name, value in parts.items() if names_of(value)]
    present = {name: value for name, value in parts.items() if value is not None}
    if labelled == ["angles"] == [*present]:
        table = ArrayTable(parts["angles"])
        return SampleSource(reader=table, columns=by_name(table.names or ()))
    if labelled:
        expected = (
            "its columns have names; expected an array without names, or one table "
            "with the columns of all parts, as the only argument"
        )
        raise SampleError([f"{name}: {expected}" for name in labelled])
    arrays: dict[str, NDArray[Any]] = {}
    faults: list[str] = []
    for name, value in present.items():
        array, fault = _shaped(name, value)
        arrays[name] = array
        faults += fault
    faults += parts_missing(set(arrays))
    counts = {name: len(array) for name, array in arrays.items() if array.ndim}
    if not faults and len(set(counts.values())) > 1:
        listed = ", ".join(f"{count} of {name}" for name, count in counts.items())
        faults.append(f"expected one row per sample in every array, got {listed}")
    if len(names) != 3 or len(set(names)) != 3:
        faults.append(f"expected three different names of angles, got {', '.join(names)}")
    if faults or not min(counts.values()):
        raise SampleError(faults or ["no samples"])
    order = [name for name in SIZES if name in arrays]
    columns = replace(by_width(sum(SIZES[name] for name in order)), names=tuple(names))
    return SampleSource(reader=ArrayTable(*(arrays[name] for name in order)), columns=columns)


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
    shapes: list[tuple[int, ...]] = [(3, 3)] if name == "matrix" else []
    shapes += [(SIZES[name],)]
    for rows in (array[None], array):
        if rows.shape[1:] in shapes:
            return rows.reshape(len(rows), SIZES[name]), []
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
