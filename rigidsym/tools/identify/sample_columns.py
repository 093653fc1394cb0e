"""The columns of a table: by the names in its header or by those the user gives."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from itertools import chain

from rigidsym.data.columns import ColumnNames, counted
from rigidsym.tools.identify.readings import ANGLE_NAMES
from rigidsym.tools.identify.samples import SampleError
from rigidsym.tools.spellings import (
    ANGLES,
    MATRICES,
    NAMED_QUATERNIONS,
    OMEGAS,
    QUATERNIONS,
    RATES,
    Names,
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
    """The position of each part in a row, counted from 0."""

    angles: tuple[int, ...]
    attitude: tuple[int, ...]  # nine for a matrix, row by row; four for a quaternion
    rates: tuple[int, ...] = ()
    omega: tuple[int, ...] = ()
    names: Names = ANGLE_NAMES  # of the angles
    scalar_last: bool | None = None  # of a quaternion whose names tell which is the scalar
    factors: tuple[float, ...] = ()  # of all columns used; none if all are 1
    converted: tuple[str, ...] = ()  # what they convert: "yaw from cdeg to deg"

    @property
    def used(self) -> list[int]:
        return [*self.angles, *self.attitude, *self.rates, *self.omega]

    @property
    def is_matrix(self) -> bool:
        return len(self.attitude) == 9

    @property
    def layouts(self) -> tuple[bool | None, ...]:
        """Whether the scalar of a quaternion may be last; None for a matrix."""
        if self.is_matrix:
            return (None,)
        return (False, True) if self.scalar_last is None else (self.scalar_last,)


def by_width(width: int) -> Columns:
    """The columns of an array without names; raises SampleError for other widths than 7, 12, ..."""
    if width not in _WITHOUT_HEADER:
        known = "; ".join(f"{number} ({parts})" for number, parts in _WITHOUT_HEADER.items())
        found = f"{counted(width, 'column')} without names"
        raise SampleError([f"{found}: expected {known}; or name them with --columns"])
    start = 3 + (9 if width in (12, 18) else 4)
    angles, attitude = (0, 1, 2), tuple(range(3, start))
    if width == start:
        return Columns(angles, attitude)
    return Columns(angles, attitude, (start, start + 1, start + 2), tuple(range(start + 3, width)))


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
    has_velocity = any(map(header.has, (*rates, *omega)))
    wanted = (*angles, *attitude, *((*rates, *omega) if has_velocity else ()))
    faults = _missing(wanted, header)
    if faults:
        faults.append("--columns names the columns in order, if their names are others")
    if {_share(_nearest(groups, header), header) for groups in (MATRICES, QUATERNIONS)} == {1.0}:
        faults.append("both a matrix and a quaternion are named; leave one out")
    if faults:
        raise SampleError(faults)
    of_motion = (rates, omega) if has_velocity else ((), ())
    a, b, c, d = parts = [
        tuple(header.find([name]) or 0 for name in part) for part in (angles, attitude, *of_motion)
    ]
    used = list(chain.from_iterable(parts))
    factors = [*_factors(header, parts[0], ""), *[1.0] * len(attitude)]
    factors += [factor for part in parts[2:] for factor in _factors(header, part, "/s")]
    changed = [header.names[k] for k, factor in zip(used, factors, strict=True) if factor != 1]
    return Columns(
        angles=a,
        attitude=b,
        rates=c,
        omega=d,
        names=angles,
        scalar_last=_scalar_last(attitude),
        factors=tuple(factors) if changed else (),
        converted=tuple(changed),
    )


def _factors(header: ColumnNames, columns: Sequence[int], per: str) -> list[float]:
    """To radians if a unit is a multiple of them, and else to degrees: (columns,)."""
    stated = [header.unit(column).casefold() for column in columns]
    in_radians = any(unit.lstrip("numµ").startswith("rad") for unit in stated)
    unit = ("rad" if in_radians else "deg") + per
    found = [header.factor(column, unit) for column in columns]
    return [1.0 if factor is None or abs(factor - 1) < 1e-15 else factor for factor in found]


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
        f"no column {name}: did you mean {' or '.join(there[match] for match in found)}?"
        for name, found in near.items()
        if found
    ]
    rest = [name for name, found in near.items() if not found]
    if rest:
        said = ", ".join(rest).replace(", ".join(MATRICES[0]), "r11, ..., r33 or qw, qx, qy, qz")
        faults.append(f"no column {said} among {header.listed}")
    return faults
