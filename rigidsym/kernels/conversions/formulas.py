"""Lines that take a rotation matrix to a quaternion, and a quaternion to coordinates.

They are assignments in the arithmetic that all targets share; a target spells `$sqrt`, `$atan2`,
`$hypot`, `$sin`, `$cos`, `$pick(condition, then, otherwise)`, `$wrapped(angle)` into (−π, π], and
`$tiny`, four times the spacing of floats at one.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

Line = tuple[str, str]  # what is assigned, and its value

QUATERNION = ("w", "x", "y", "z")
MATRIX = tuple(f"r{row}{column}" for row in (1, 2, 3) for column in (1, 2, 3))

# From R: the column of 4 p pᵀ with the largest diagonal entry, so that nothing cancels.

_OUTER: tuple[Line, ...] = (
    ("kw", "1.0 + r11 + r22 + r33"),
    ("kx", "1.0 + r11 - r22 - r33"),
    ("ky", "1.0 - r11 + r22 - r33"),
    ("kz", "1.0 - r11 - r22 + r33"),
    ("wx", "r32 - r23"),
    ("wy", "r13 - r31"),
    ("wz", "r21 - r12"),
    ("xy", "r21 + r12"),
    ("xz", "r13 + r31"),
    ("yz", "r32 + r23"),
    ("by_x", "kx > kw"),
    ("by_z", "kz > ky"),
    ("second", "$pick(by_z, kz, ky) > $pick(by_x, kx, kw)"),
)
_COLUMNS = (("kw", "wx", "wy", "wz"), ("wx", "kx", "xy", "xz"))
_OTHERS = (("wy", "xy", "ky", "yz"), ("wz", "xz", "yz", "kz"))


def shepperd(names: Sequence[str]) -> tuple[Line, ...]:
    """Lines that take r11 to r33 to a quaternion of some length, its scalar not negative."""
    picked = [
        (
            name,
            f"$pick(second, $pick(by_z, {_OTHERS[1][k]}, {_OTHERS[0][k]}), "
            f"$pick(by_x, {_COLUMNS[1][k]}, {_COLUMNS[0][k]}))",
        )
        for k, name in enumerate(names)
    ]
    return (*_OUTER, *picked)


SHORT_WAY: tuple[Line, ...] = (
    ("flip", "$pick(w < 0.0, -1.0, 1.0)"),
    ("w", "flip * w"),
    ("x", "flip * x"),
    ("y", "flip * y"),
    ("z", "flip * z"),
)
SCALED: tuple[Line, ...] = (  # any length will do, and zero gives NaN
    ("size", "0.25 * abs(w) + 0.25 * abs(x) + 0.25 * abs(y) + 0.25 * abs(z)"),
    ("w", "w / size"),
    ("x", "x / size"),
    ("y", "y / size"),
    ("z", "z / size"),
)
LENGTH: tuple[Line, ...] = (("length", "$sqrt(w * w + x * x + y * y + z * z)"),)
_VECTOR: tuple[Line, ...] = (
    ("vector", "$sqrt(x * x + y * y + z * z)"),
    ("divisor", "$pick(vector == 0.0, 1.0, vector)"),
)


# What follows from a scaled quaternion (w, x, y, z): lines, and what they give.


def of_quaternion() -> tuple[tuple[Line, ...], tuple[str, ...]]:
    return LENGTH, ("w / length", "x / length", "y / length", "z / length")


def _of_cayley_klein() -> tuple[tuple[Line, ...], tuple[str, ...]]:
    return LENGTH, ("w / length", "z / length", "y / length", "x / length")


def _of_axis_angle() -> tuple[tuple[Line, ...], tuple[str, ...]]:
    axis = ("$pick(vector == 0.0, 1.0, x / divisor)", "y / divisor", "z / divisor")
    return (*SHORT_WAY, *_VECTOR), (*axis, "2.0 * $atan2(vector, w)")


def _of_rotation_vector() -> tuple[tuple[Line, ...], tuple[str, ...]]:
    lines: tuple[Line, ...] = (
        ("limit", "2.0 / $pick(w == 0.0, 1.0, w)"),
        ("factor", "$pick(vector == 0.0, limit, 2.0 * $atan2(vector, w) / divisor)"),
    )
    return (*SHORT_WAY, *_VECTOR, *lines), ("factor * x", "factor * y", "factor * z")


def _of_gibbs_vector() -> tuple[tuple[Line, ...], tuple[str, ...]]:
    return (), tuple(f"{v} / $pick((w == 0.0) & ({v} == 0.0), 1.0, w)" for v in "xyz")


def _of_modified_rodrigues() -> tuple[tuple[Line, ...], tuple[str, ...]]:
    lines = (*SHORT_WAY, *LENGTH, ("divisor", "length + w"))
    return lines, ("x / divisor", "y / divisor", "z / divisor")


def _of_direction_cosines() -> tuple[tuple[Line, ...], tuple[str, ...]]:
    lines = (("square", "w * w + x * x + y * y + z * z"),)
    return lines, (
        "(w * w + x * x - y * y - z * z) / square",
        "2.0 * (x * y - w * z) / square",
        "2.0 * (x * z + w * y) / square",
        "2.0 * (x * y + w * z) / square",
        "(w * w - x * x + y * y - z * z) / square",
        "2.0 * (y * z - w * x) / square",
        "2.0 * (x * z - w * y) / square",
        "2.0 * (y * z + w * x) / square",
        "(w * w - x * x - y * y + z * z) / square",
    )


RULES: Mapping[str, Callable[[], tuple[tuple[Line, ...], tuple[str, ...]]]] = {
    "quaternion": of_quaternion,
    "cayley_klein": _of_cayley_klein,
    "axis_angle": _of_axis_angle,
    "rotation_vector": _of_rotation_vector,
    "gibbs_vector": _of_gibbs_vector,
    "modified_rodrigues": _of_modified_rodrigues,
    "direction_cosines": _of_direction_cosines,
}
BOTH_SIGNS = frozenset({"quaternion", "cayley_klein"})  # these tell p from −p
