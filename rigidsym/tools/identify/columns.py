"""The columns of a file: by the names in its header or by those the user gives."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from itertools import product

from rigidsym.data.column_names import counted, plain
from rigidsym.tools.identify.readings import ANGLE_NAMES
from rigidsym.tools.identify.samples import SampleError

Names = tuple[str, ...]

_INDICES = tuple(f"{row}{column}" for row, column in product("123", repeat=2))
ANGLES: tuple[Names, ...] = (
    ("angle1", "angle2", "angle3"),
    ("a1", "a2", "a3"),
    ("roll", "pitch", "yaw"),
    ("roll", "pitch", "heading"),
    ("phi", "theta", "psi"),
    ("alpha", "beta", "gamma"),
    ("rx", "ry", "rz"),
)
MATRICES: tuple[Names, ...] = tuple(
    tuple(letter + index for index in _INDICES) for letter in ("r", "m", "a", "c", "dcm")
)
NAMED_QUATERNIONS: tuple[Names, ...] = (("qw", "qx", "qy", "qz"), ("w", "x", "y", "z"))
QUATERNIONS: tuple[Names, ...] = (
    *NAMED_QUATERNIONS,
    ("q0", "q1", "q2", "q3"),
    ("q1", "q2", "q3", "q4"),
)
OMEGAS: tuple[Names, ...] = (
    ("omega1", "omega2", "omega3"),
    ("omegax", "omegay", "omegaz"),
    ("wx", "wy", "wz"),
    ("gyrox", "gyroy", "gyroz"),
    ("p", "q", "r"),
)
_RATES = ("{}dot", "{}rate", "d{}")
_NUMBERED_RATES: Names = ("rate1", "rate2", "rate3")
_WITHOUT_HEADER = {
    7: "angles and a quaternion",
    12: "angles and a matrix",
    13: "angles, a quaternion, rates, omega",
    18: "angles, a matrix, rates, omega",
}


@dataclass(frozen=True, kw_only=True, slots=True)
class Columns:
    """Where in a row each part stands, counted from 0."""

    angles: tuple[int, ...]
    attitude: tuple[int, ...]  # nine for a matrix, row by row; four for a quaternion
    rates: tuple[int, ...] = ()
    omega: tuple[int, ...] = ()
    names: Names = ANGLE_NAMES  # of the angles
    scalar_last: bool | None = None  # of a quaternion whose names tell which is the scalar

    @property
    def used(self) -> list[int]:
        return [*self.angles, *self.attitude, *self.rates, *self.omega]


def by_width(width: int) -> Columns:
    """The columns of an array without names; raises SampleError for a width that says nothing."""
    if width not in _WITHOUT_HEADER:
        known = "; ".join(f"{number} ({parts})" for number, parts in _WITHOUT_HEADER.items())
        raise SampleError(
            [
                f"{counted(width, 'column')} without names: expected {known}; "
                "or name them with --columns"
            ]
        )
    start = 3 + (9 if width in (12, 18) else 4)
    has_velocity = width > start
    return Columns(
        angles=(0, 1, 2),
        attitude=tuple(range(3, start)),
        rates=tuple(range(start, start + 3)) if has_velocity else (),
        omega=tuple(range(start + 3, start + 6)) if has_velocity else (),
    )


def by_name(header: Sequence[str]) -> Columns:
    """The columns that a header names; others are left alone.

    Angles, and quaternions whose names do not tell which is the scalar, keep the order of the
    file. Raises SampleError for what is missing, with the nearest names that are there.
    """
    names = [plain(name) for name in header]
    angles = tuple(sorted(_nearest(ANGLES, names), key=_order(names)))
    attitude = _attitude(names)
    rates, omega = _rates_of(angles, names), _nearest(OMEGAS, names)
    has_velocity = bool({*rates, *omega} & set(names))
    wanted = (*angles, *attitude, *((*rates, *omega) if has_velocity else ()))
    faults = _missing(wanted, header)
    if faults:
        faults.append("--columns names the columns in their order, for a file with other names")
    if {_share(_nearest(groups, names), names) for groups in (MATRICES, QUATERNIONS)} == {1.0}:
        faults.append("both a matrix and a quaternion are named; leave one out")
    if faults:
        raise SampleError(faults)
    return Columns(
        angles=tuple(map(names.index, angles)),
        attitude=tuple(map(names.index, attitude)),
        rates=tuple(map(names.index, rates)) if has_velocity else (),
        omega=tuple(map(names.index, omega)) if has_velocity else (),
        names=angles,
        scalar_last=_scalar_last(attitude),
    )


def _attitude(names: Sequence[str]) -> Names:
    """The names of the matrix or of the quaternion, whichever is there more fully."""
    matrix, quaternion = _nearest(MATRICES, names), _nearest(QUATERNIONS, names)
    if _share(matrix, names) >= _share(quaternion, names):
        return matrix
    in_file = tuple(sorted(quaternion, key=_order(names)))
    if quaternion in NAMED_QUATERNIONS and _scalar_last(in_file) is None:
        return quaternion
    return in_file


def _scalar_last(names: Names) -> bool | None:
    """Whether w stands behind x, y, z; None where names or order tell nothing."""
    for scalar, *vector in NAMED_QUATERNIONS:
        if names in ((scalar, *vector), (*vector, scalar)):
            return names[-1] == scalar
    return None


def _order(names: Sequence[str]) -> Callable[[str], int]:
    """Sorts by the place in the file; what is not there comes last."""
    return lambda name: names.index(name) if name in names else len(names)


def _nearest(trios: Iterable[Names], names: Sequence[str]) -> Names:
    """The group of which the largest share is there; the first of equals."""
    return max(trios, key=lambda trio: _share(trio, names))


def _share(group: Names, names: Sequence[str]) -> float:
    return sum(name in names for name in group) / len(group)


def _rates_of(angles: Names, names: Sequence[str]) -> Names:
    """The names of the rates in this header: of each angle, or numbered."""
    groups = [tuple(form.format(angle) for angle in angles) for form in _RATES]
    return _nearest([*groups, _NUMBERED_RATES], names)


def _missing(wanted: Sequence[str], header: Sequence[str]) -> list[str]:
    """What to say of the columns that are not there: those that are nearly, then all others."""
    there = {plain(name): name.strip() for name in header}
    free = [name for name in there if name not in wanted]
    lacking = [name for name in wanted if name not in there]
    near = {name: get_close_matches(name, free, n=2) for name in lacking}
    faults = [
        f"no column {name}: did you mean {' or '.join(there[match] for match in found)}?"
        for name, found in near.items()
        if found
    ]
    rest = [name for name, found in near.items() if not found]
    if rest:
        said = ", ".join(rest).replace(", ".join(MATRICES[0]), "r11, ..., r33 or qw, qx, qy, qz")
        faults.append(f"no column {said} among {', '.join(there.values())}")
    return faults
