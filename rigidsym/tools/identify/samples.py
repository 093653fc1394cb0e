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
from rigidsym.data.tables import (
    MOST_SHOWN,
    ArrayTable,
    Batch,
    Table,
    names_of,
    open_table,
)
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
        super().__init__(
            place + (lines[0] if len(lines) == 1 else "\n  ".join(["bad samples", *lines]))
        )

    def of(self, path: Path) -> SampleError:
        """The same, with the file that the samples are from."""
        return SampleError(self.faults, count=self.count, path=path)


class OptionError(SampleError):
    """Samples in the options of a command that cannot be read, or no samples."""

    exit_code: ClassVar[int] = 2


@dataclass(frozen=True, slots=True)
class SampleBlock:
    """Some rows of the data: angles, a matrix or quaternion, and perhaps rates and Ω."""

    rows: NDArray[np.intp]  # their numbers in the data, (n,)
    table: Array  # (n, 7), (n, 12), or 6 columns more with rates and Ω
    done: float = 1.0  # share of the data that is read with this block

    def __len__(self) -> int:
        return len(self.rows)

    @property
    def is_matrix(self) -> bool:
        return self.table.shape[1] in (12, 18)

    @property
    def parts(self) -> dict[str, Array]:
        """The parts of the data by name: angles, matrix or quaternion, rates, omega."""
        attitude = ("matrix", 9) if self.is_matrix else ("quaternion", 4)
        sizes = dict([("angles", 3), attitude, ("rates", 3), ("omega", 3)])
        ends = np.cumsum([*sizes.values()])[:-1]
        parts = zip(sizes, np.split(self.table, ends, axis=1), strict=True)
        return {name: part for name, part in parts if part.shape[1]}

    @property
    def angles(self) -> Array:
        return self.table[:, :3]

    @property
    def attitude(self) -> Array:
        return self.table[:, 3:12] if self.is_matrix else self.table[:, 3:7]

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
        return SampleBlock(self.rows[which], self.table[which], self.done)

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
    finite = np.ones(len(block), bool)
    faults: list[tuple[int, str]] = []  # the first of each kind, since a log may have millions
    count = 0
    for name, part in block.parts.items():
        good = np.isfinite(part).all(axis=1)
        finite &= good
        missing = block.rows[~good].tolist()
        count += len(missing)
        lacks = f"{name}: a number that is missing or not finite"
        faults += [(row, lacks) for row in missing[:MOST_SHOWN]]
    rest = block.at(finite)
    turns = rest.defects() <= slack
    if block.is_matrix:
        turns &= np.linalg.det(rest.matrices) > 0
    wrong = np.flatnonzero(~turns).tolist()
    count += len(wrong)
    for k in wrong[:MOST_SHOWN]:
        faults.append((int(rest.rows[k]), _what_is_wrong(rest.at(slice(k, k + 1)))))
    messages = [f"{place(row)}: {fault}" for row, fault in sorted(faults)[:MOST_SHOWN]]
    return rest.at(turns), messages, count


def _what_is_wrong(row: SampleBlock) -> str:
    defect = float(row.defects()[0])
    if not row.is_matrix:
        length = float(np.linalg.norm(row.attitude))
        if not length:
            return "quaternion: zero, which is not a rotation"
        return f"quaternion: its length is {length:.4g}, expected 1"
    determinant = float(np.linalg.det(row.matrices[0]))
    if determinant < 0 and defect <= SLACK:
        return f"matrix: not a rotation but a reflection, its determinant is {determinant:.4g}"
    return (
        f"matrix: not a rotation, M Mᵀ differs from 1 by {defect:.2g} in an entry"
        f" (det M = {determinant:.4g})"
    )


_NUMBERED_RATES: Names = ("rate1", "rate2", "rate3")
_WITHOUT_HEADER = {
    7: "angles and a quaternion",
    12: "angles and a matrix",
    13: "angles, a quaternion, rates, omega",
    18: "angles, a matrix, rates, omega",
}


@dataclass(frozen=True, slots=True)
class Columns:
    """The columns of a table in the order of `SampleBlock`, counted from 0."""

    used: tuple[int, ...]
    names: Names = ANGLE_NAMES  # of the angles
    scalar_last: bool | None = None  # of a quaternion whose names tell which is the scalar
    factors: tuple[float, ...] = ()  # of all columns used; none if all are 1
    converted: tuple[str, ...] = ()  # the columns that they convert
    unused: str = ""  # columns of rates without Ω, or of Ω without rates, in words

    @property
    def layouts(self) -> tuple[bool | None, ...]:
        """Whether the scalar of a quaternion may be last; None for a matrix."""
        if len(self.used) in (12, 18):
            return (None,)
        return (False, True) if self.scalar_last is None else (self.scalar_last,)


def by_width(width: int) -> Columns:
    """The columns of an array without names; raises SampleError for other widths than 7, 12, ..."""
    if width not in _WITHOUT_HEADER:
        widths = "; ".join(f"{number} ({parts})" for number, parts in _WITHOUT_HEADER.items())
        raise SampleError(
            [
                f"{counted(width, 'column')} without names: expected {widths}; or name them with "
                "--columns"
            ]
        )
    return Columns(tuple(range(width)))


def by_name(names: Sequence[str]) -> Columns:
    """The columns that a header names; others are not read.

    Angles, and quaternions whose names do not tell which is the scalar, keep the order of the
    file. Raises SampleError for missing columns, with the nearest names that are there, and
    DataError for two columns of one name and for units that are not those of angles and their
    rates.
    """
    header = ColumnNames(names)
    angles = tuple(sorted(_nearest(ANGLES, header), key=_order(header)))
    attitude = _attitude(header)
    rates, omega = _rates_of(angles, header), _nearest(OMEGAS, header)
    has_rates, has_omega = (all(map(header.has, part)) for part in (rates, omega))
    has_velocity = has_rates and has_omega
    wanted = (*angles, *attitude, *((*rates, *omega) if has_velocity else ()))
    faults = _missing(wanted, header)
    if faults:
        faults.append("--columns names the columns in order, if their names are others")
    if {_share(_nearest(groups, header), header) for groups in (MATRICES, QUATERNIONS)} == {1.0}:
        faults.append("both a matrix and a quaternion are named; leave one out")
    if faults:
        raise SampleError(faults)
    used = tuple(header.find([name]) or 0 for name in wanted)
    factors = [*_factors(header, used[:3], ""), *[1.0] * len(attitude)]
    for part in (used[-6:-3], used[-3:]) if has_velocity else ():
        factors += _factors(header, part, "/s")
    changed = [header.names[k] for k, factor in zip(used, factors, strict=True) if factor != 1]
    return Columns(
        used,
        names=angles,
        scalar_last=_scalar_last(attitude),
        factors=tuple(factors) if changed else (),
        converted=tuple(changed),
        unused=_unused(header, rates if has_rates else (), omega if has_omega else ()),
    )


def _unused(header: ColumnNames, rates: Names, omega: Names) -> str:
    """Columns that say nothing without their counterpart, and what that would be."""
    if bool(rates) == bool(omega):
        return ""
    columns = [header.names[header.find([name]) or 0] for name in (*rates, *omega)]
    lacking = "an angular velocity" if rates else "rates of the angles"
    return f"{', '.join(columns)}, since there are no columns for {lacking}"


def _factors(header: ColumnNames, columns: Sequence[int], per: str) -> list[float]:
    """To radians if a unit is a multiple of them, and else to degrees: (columns,)."""
    stated = [header.unit(column).casefold() for column in columns]
    in_radians = any(unit.lstrip("numµ").startswith("rad") for unit in stated)
    unit = ("rad" if in_radians else "deg") + per
    factors = [header.factor(column, unit) or 1.0 for column in columns]
    return [1.0 if abs(factor - 1) < 1e-15 else factor for factor in factors]


def _attitude(header: ColumnNames) -> Names:
    """The names of the matrix or of the quaternion, whichever is there more fully."""
    matrix, quaternion = _nearest(MATRICES, header), _nearest(QUATERNIONS, header)
    if _share(matrix, header) >= _share(quaternion, header):
        return matrix
    in_file = tuple(sorted(quaternion, key=_order(header)))
    if quaternion in NAMED_QUATERNIONS and _scalar_last(in_file) is None:
        return quaternion
    return in_file


def _scalar_last(names: Names) -> bool | None:
    """Whether w comes after x, y, z; None if names or order do not tell."""
    for scalar, *vector in NAMED_QUATERNIONS:
        if names in ((scalar, *vector), (*vector, scalar)):
            return names[-1] == scalar
    return None


def _order(header: ColumnNames) -> Callable[[str], int]:
    """Sorts by the position in the file; missing names come last."""
    return lambda name: (header.find([name]) or 0) if header.has(name) else len(header.names)


def _nearest(groups: Iterable[Names], header: ColumnNames) -> Names:
    """The group of which the largest share is there; the first of equals."""
    return max(groups, key=lambda group: _share(group, header))


def _share(group: Names, header: ColumnNames) -> float:
    return sum(map(header.has, group)) / len(group)


def _rates_of(angles: Names, header: ColumnNames) -> Names:
    """The names of the rates in this header: of each angle, or numbered."""
    groups = [tuple(form.format(angle) for angle in angles) for form in RATES]
    return _nearest([*groups, _NUMBERED_RATES], header)


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


BLOCK = 16384  # rows that are in memory at once
SPREAD = 64  # rows that are looked at first
_THREE = ((3,),)
_SHAPES: dict[str, tuple[tuple[int, ...], ...]] = {"angles": _THREE, "matrix": ((3, 3), (9,))}
_SHAPES |= {"quaternion": ((4,),), "rates": _THREE, "omega": _THREE}


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
        for chunk in self.reader.batches(self.columns.used, BLOCK):
            yield self._block(chunk)

    def spread(self) -> SampleBlock:
        """A few rows from all over the data."""
        return self._block(self.reader.sample(self.columns.used, SPREAD))

    def _block(self, batch: Batch) -> SampleBlock:
        if self.drops_missing:
            batch = batch.at(np.asarray(~np.isnan(batch.table).any(axis=1)))
        table = np.asarray(batch.table, float) * (self.columns.factors or 1.0)
        return SampleBlock(batch.rows, table, batch.share)


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


def from_arrays(given: Mapping[str, Any], names: Sequence[str] = ANGLE_NAMES) -> SampleSource:
    """Samples from Python; raises SampleError for shapes that do not belong together.

    A table with names of columns is read as a file with this header.
    """
    labelled = [name for name, value in given.items() if names_of(value)]
    if labelled == ["angles"] and all(given[name] is None for name in given if name != "angles"):
        table = ArrayTable(given["angles"])
        return SampleSource(reader=table, columns=by_name(table.names or ()))
    if labelled:
        raise SampleError(
            [
                f"{name}: its columns have names; expected an array without names, or one table "
                "with the columns of all parts, as the only argument"
                for name in labelled
            ]
        )
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
        listed = ", ".join(f"{count} of {name}" for name, count in counts.items())
        faults.append(f"expected one row per sample in every array, got {listed}")
    if len(names) != 3 or len(set(names)) != 3:
        faults.append(f"expected three different names of angles, got {', '.join(names)}")
    if faults or not min(counts.values()):
        raise SampleError(faults or ["no samples"])
    width = 13 if "quaternion" in arrays else 18
    columns = replace(by_width(width - 6 * ("omega" not in arrays)), names=tuple(names))
    order = [arrays[name] for name in _SHAPES if name in arrays]
    return SampleSource(reader=ArrayTable(*order), columns=columns)


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
