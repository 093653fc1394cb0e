"""The two halves of a quaternion by the axes of its first and its last turn, p = p₊ + p₋."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import sympy as sp

from rigidsym.kernels.conversions.formulas import QUATERNION, Line
from rigidsym.kernels.conversions.writing_lines import LineWriter, Local, Vector, number
from rigidsym.mechanics.conversions.davenport import dot, quaternion_product

_COSINE, _SINE = Local("cosine"), Local("sine")  # of half the middle angle
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


@dataclass(frozen=True, kw_only=True, slots=True)
class Components:
    """p± and m±, in one plane, by their components along a vector of it and across."""

    given: tuple[sp.Expr, sp.Expr]  # of p±
    by_cosine: tuple[sp.Expr, sp.Expr]  # of m± without the factor cos β/2
    by_sine: tuple[sp.Expr, sp.Expr]  # the same for sin β/2
    square: sp.Expr  # of the vector's length

    @property
    def compared(self) -> tuple[sp.Expr, ...]:
        """Those of p± and of m±."""
        pairs = zip(self.by_cosine, self.by_sine, strict=True)
        return (*self.given, *(_COSINE * a + _SINE * b for a, b in pairs))

    @property
    def matrix(self) -> tuple[sp.Expr, ...]:
        """That of m±, column by column, and the square that its entries are measured by."""
        return (*self.by_cosine, *self.by_sine, self.square)


Either = tuple[Components, Components]


def components(axes: Sequence[Vector], half: Vector, sign: int) -> Either:
    """By the vectors 1± and e₂±: the longer serves where p± and m± are short too."""
    first, middle, last = axes
    scalar, *vector = half
    cross = sp.Matrix(first).cross(sp.Matrix(middle))
    before, after, opposite = dot(first, middle), dot(middle, last), dot(first, last)
    mixed, skew = sign * dot(cross, last) / 2, (before + sign * after) / 2
    one = (1 + sign * opposite) / 2
    axis = (1 + sign * (2 * before * after - opposite)) / 2
    return (
        Components(
            given=(scalar, dot(vector, first)),
            by_cosine=(one, sp.S.Zero),
            by_sine=(mixed, skew),
            square=one,
        ),
        Components(
            given=(dot(vector, middle), dot(vector, cross) - before * scalar),
            by_cosine=(mixed, -skew),
            by_sine=(axis, sp.S.Zero),
            square=axis,
        ),
    )


def longer(
    writer: LineWriter,
    either: Either,
    values: Sequence[Sequence[sp.Expr]],
) -> list[str]:
    """Names for the values by the vector that is longer: by one vector where that is known."""
    of_one, of_axis = values
    names = [writer.fresh("v") for _ in of_one]
    lengths = [each.square for each in either]
    if all(length.is_number for length in lengths):
        writer.let(names, of_one if number(lengths[0]) >= number(lengths[1]) else of_axis)
        return names
    others = [writer.fresh("v") for _ in of_axis]
    is_one, size, other_size = (writer.fresh("v") for _ in range(3))
    writer.let([*names, *others, size, other_size], [*of_one, *of_axis, *lengths])
    writer.lines.append((is_one, f"{size} >= {other_size}"))
    writer.lines += [
        (name, f"$pick({is_one}, {name}, {other})")
        for name, other in zip(names, others, strict=True)
    ]
    return names
