"""The two halves of a quaternion by the axes of its first and its last turn, p = p₊ + p₋."""

from __future__ import annotations

from collections.abc import Iterable

import sympy as sp

from rigidsym.kernels.formulas import QUATERNION, Line
from rigidsym.kernels.writing_lines import LineWriter, Vector
from rigidsym.mechanics.davenport import quaternion_product

POLES: tuple[Line, ...] = (  # where one half is not there, its angle is taken to be the other's
    ("half_difference", "$pick(near <= $tiny * far, half_sum, half_difference)"),
    ("half_sum", "$pick(far <= $tiny * near, half_difference, half_sum)"),
)


def halves(writer: LineWriter, parts: Vector, first: Vector, last: Vector) -> tuple[Vector, Vector]:
    """p₊ and p₋, their lengths as `far` and `near`, and twice the angle between as `swing`."""
    zero = sp.S.Zero
    across = quaternion_product(quaternion_product((zero, *first), parts), (zero, *last))
    found = []
    for name, sign, length in (("plus", -1, "far"), ("minus", 1, "near")):
        half = tuple((a + sign * b) / 2 for a, b in zip(parts, across, strict=True))
        found.append(writer.let([f"{name}_{part}" for part in QUATERNION], half))
        writer.lines += [
            (length, f"{name}_w * {name}_w + {name}_x * {name}_x"),
            (length, f"$sqrt({length} + {name}_y * {name}_y + {name}_z * {name}_z)"),
        ]
    writer.lines.append(("swing", "2.0 * $atan2(near, far)"))
    return found[0], found[1]


def dot(first: Iterable[sp.Expr], second: Iterable[sp.Expr]) -> sp.Expr:
    return sp.Add(*(a * b for a, b in zip(first, second, strict=True)))
