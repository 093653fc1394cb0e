"""The angles of one to three turns about any axes, from the quaternion of their product.

See `turn_chain` for the geometry: p₊ and p₋ are the halves of the quaternion by the first and the
last axis, m₊ and m₋ those of what is between. The middle one of three angles follows from a
spherical triangle, or from one half of the quaternion.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import sympy as sp

from rigidsym.mechanics.conversions.function import (
    NamedValues,
    Vector,
    Where,
    dot,
    nearest,
    number,
    rounded,
    square,
)
from rigidsym.mechanics.conversions.unit_quaternions import QUATERNION, in_halves

ACROSS = (sp.S.One, sp.S.Zero, sp.S.Zero, sp.S.One)  # cosines and sines of 0 and π/2, exactly
_STEPS = 2  # of least squares, from a start that is off by √eps at most


def _halves(
    values: NamedValues, parts: Vector, first: Vector, last: Vector
) -> tuple[Vector, Vector, sp.Expr, sp.Expr]:
    """p₊ and p₋, and their lengths."""
    plus, minus = (
        values.each([f"{name}_{part}" for part in QUATERNION], map(rounded, half))
        for name, half in zip(("plus", "minus"), in_halves(parts, first, last), strict=True)
    )
    return plus, minus, values.length("far", plus), values.length("near", minus)


def angle_of_one(values: NamedValues, axes: Sequence[Vector], parts: Vector) -> Vector:
    plus, _, far, near = _halves(values, parts, axes[0], axes[0])
    sine = values.let("sine", rounded(dot(plus[1:], axes[0])))
    half = values.let("half", sp.atan2(sine, plus[0]))
    beyond = values.let("swing", 2 * sp.atan2(near, far))
    half = values.let("half", Where(beyond > values.reach, sp.nan, half))
    return (values.wrapped("angle", 2 * half),)


def angles_of_two(values: NamedValues, axes: Sequence[Vector], parts: Vector) -> Vector:
    first, last = axes
    _, _, far, near = _halves(values, parts, first, last)
    total, difference = _from_one(values, parts, *_across_each_other(values, first, last))
    swing = values.let("swing", 2 * sp.atan2(near, far))
    beyond = values.let("beyond", sp.Abs(swing - angle_between(values, first, last)))
    total, difference = at_poles(values, (near, far), (total, difference))
    total = values.let("half_sum", Where(beyond > values.reach, sp.nan, total))
    return outer_angles(values, total, difference)


def angles_of_three(
    values: NamedValues,
    axes: Sequence[Vector],
    parts: Vector,
    *,
    is_across: bool,
    has_two_sets: bool,
    mirror: int,
) -> Vector:
    """The angles of three turns; the first two if the third is by the first angle times `mirror`.

    `is_across` says that the middle axis is across the others, `has_two_sets` that the middle
    angle follows from the triangle.
    """
    plus, minus, far, near = _halves(values, parts, axes[0], axes[2])
    by_sum, by_difference = _halves_between(axes, plus, 1), _halves_between(axes, minus, -1)
    swing = values.let("swing", 2 * sp.atan2(near, far))
    # The middle angle by the three sides, in the interval that ends at the flat triangle and holds
    # 0; the other one is twice the flat angle less it. Two sides of π/2 leave the third as the
    # angle between them.
    base = flat_angle(values, *axes)
    bend, beyond = (swing, sp.S.Zero) if is_across else _bend(values, axes, swing)
    middle = values.let("middle", base + Where(base > 0, -bend, bend))
    if not has_two_sets:
        fixed, free = (by_difference, by_sum) if mirror > 0 else (by_sum, by_difference)
        length = far if mirror > 0 else near
        whole = values.length("whole", (near, far))
        guesses = (middle, 2 * base - middle)
        middle, beyond = _middle_of_half(values, fixed, free, length, whole, guesses)
    half = values.let("half_middle", middle / 2)
    turned = (sp.cos(half), sp.sin(half))
    total = _outer(values, "half_sum", by_sum, turned)
    difference = _outer(values, "half_difference", by_difference, turned)
    if mirror:
        total, difference, apart = _alike(values, mirror, (near, far), (total, difference))
        beyond = values.let("beyond", Where(apart > beyond, apart, beyond)) if beyond else apart
    else:
        total, difference = at_poles(values, (near, far), (total, difference))
    if beyond:
        is_beyond = beyond > values.reach
        total = values.let("half_sum", Where(is_beyond, sp.nan, total))
        middle = values.let("middle", Where(is_beyond, sp.nan, middle))
    first, last = outer_angles(values, total, difference)
    return (first, middle) if mirror else (first, middle, last)


def _outer(values: NamedValues, name: str, halves: tuple[Half, Half], turned: Vector) -> sp.Expr:
    """The angle from m± to p±: half the sum or half the difference of the outer angles."""
    a, b, c, d = _longer(values, halves, [half.compared(turned) for half in halves])
    return values.let(name, sp.atan2(b * c - a * d, a * c + b * d))


def outer_angles(values: NamedValues, total: sp.Expr, difference: sp.Expr) -> Vector:
    """The outer angles from half their sum and half their difference."""
    return (
        values.wrapped("first", total + difference),
        values.wrapped("last", total - difference),
    )


def at_poles(values: NamedValues, lengths: Vector, angles: Vector, sign: int = 1) -> Vector:
    """Where a half of the quaternion vanishes, its angle is taken to be the other's, or minus it.

    So one outer angle is zero: the last turn's, or the first's for sign −1. The lengths are those
    of p₋ and p₊, the angles half the sum and half the difference of the outer ones.
    """
    (near, far), (total, difference) = lengths, angles
    is_low, is_high = near <= values.tiny * far, far <= values.tiny * near
    chosen = values.let("half_difference", Where(is_low, sign * total, difference))
    return values.let("half_sum", Where(is_high, sign * difference, total)), chosen


def _alike(values: NamedValues, mirror: int, lengths: Vector, angles: Vector) -> Vector:
    """Outer angles that are equal, or opposite: the half that is 0 or π is made so.

    Returns also how far it was from that.
    """
    (near, far), (total, difference) = lengths, angles
    fixed, free = (difference, total) if mirror > 0 else (total, difference)
    short, long = (near, far) if mirror > 0 else (far, near)
    apart = values.let("apart", sp.Abs(sp.sin(fixed)) * short / values.length("whole", (near, far)))
    is_turned = Where(sp.Abs(fixed) > sp.pi / 2, sp.pi, sp.S.Zero)
    fixed = values.let("fixed", Where(short > values.tiny * long, is_turned, sp.S.Zero))
    free = values.let("free", Where(long <= values.tiny * short, sp.S.Zero, free))
    return (free, fixed, apart) if mirror > 0 else (fixed, free, apart)


def _from_one(values: NamedValues, parts: Vector, sums: Vector, differences: Vector) -> Vector:
    """Half the sum and half the difference of two angles: from 1± to p±, counted about e₁.

    1± and e₁ 1± have the parts (s·s, ∓ d × s)/4 and (0, s)/2 with the sum s and the difference d
    of the axes, d in place of s for 1₋. So nothing cancels where the axes are nearly parallel or
    nearly opposite, and p± are short.
    """
    scalar, *vector = parts
    cross = sp.Matrix(differences).cross(sp.Matrix(sums))
    found = []
    for name, sign, along in (("half_sum", -1, sums), ("half_difference", 1, differences)):
        by_one = [_whole(values, part / 2) for part in (dot(along, along), *(sign * cross))]
        across = [_whole(values, part) for part in along]
        sine = values.let("sine", dot(vector, across))
        found.append(values.let(name, sp.atan2(sine, dot((scalar, *vector), by_one))))
    return tuple(found)


def _whole(values: NamedValues, value: sp.Expr) -> sp.Expr:
    """A number rounded once, so that the terms it is a sum of do not part; else a named value."""
    return nearest(value) if value.is_number else values.let("v", value)


def _across_each_other(values: NamedValues, first: Vector, last: Vector) -> tuple[Vector, Vector]:
    """The sum and the difference of two unit vectors.

    Axes that are rounded are not of one length, and the shorter of the two would hold some of the
    _longer: that is taken off.
    """
    pairs = tuple(zip(first, last, strict=True))
    sums, differences = (tuple(a + sign * b for a, b in pairs) for sign in (1, -1))
    if all(part.is_number for part in (*first, *last)):
        return sums, differences
    s, d = values.each(["s"] * 3, sums), values.each(["d"] * 3, differences)
    sizes = [values.let("size", dot(vector, vector)) for vector in (s, d)]
    longest = values.let("longest", Where(sizes[0] > sizes[1], *sizes))
    common = values.let("common", dot(s, d) / longest)
    return (
        tuple(a - common * b for a, b in zip(s, d, strict=True)),
        tuple(b - common * a for a, b in zip(s, d, strict=True)),
    )


@dataclass(frozen=True, kw_only=True, slots=True)
class Half:
    """p± and m±, in one plane, by their components along a vector of it and across."""

    given: Vector  # of p±
    by_cosine: Vector  # of m±, the coefficients of cos(β/2)
    by_sine: Vector  # the coefficients of sin(β/2)
    square: sp.Expr  # of the vector's length

    def compared(self, turned: Vector) -> Vector:
        """Those of p± and of m±, for the cosine and the sine of β/2."""
        cosine, sine = turned
        pairs = zip(self.by_cosine, self.by_sine, strict=True)
        return (*self.given, *(cosine * a + sine * b for a, b in pairs))

    @property
    def matrix(self) -> Vector:
        """That of m±, column by column, and the square that its entries are measured by."""
        return (*self.by_cosine, *self.by_sine, self.square)


def _halves_between(axes: Sequence[Vector], half: Vector, sign: int) -> tuple[Half, Half]:
    """By the vectors 1± and e₂±: the longer serves where p± and m± are short too."""
    first, middle, last = axes
    scalar, *vector = half
    cross = sp.Matrix(first).cross(sp.Matrix(middle))
    before, after, opposite = dot(first, middle), dot(middle, last), dot(first, last)
    mixed, skew = sign * dot(cross, last) / 2, (before + sign * after) / 2
    one = (1 + sign * opposite) / 2
    axis = (1 + sign * (2 * before * after - opposite)) / 2
    return (
        Half(
            given=(scalar, dot(vector, first)),
            by_cosine=(one, sp.S.Zero),
            by_sine=(mixed, skew),
            square=one,
        ),
        Half(
            given=(dot(vector, middle), dot(vector, cross) - before * scalar),
            by_cosine=(mixed, -skew),
            by_sine=(axis, sp.S.Zero),
            square=axis,
        ),
    )


def _longer(values: NamedValues, halves: tuple[Half, Half], found: Sequence[Vector]) -> Vector:
    """The values by the vector that is longer: by one vector where that is known."""
    names = "abcdefgh"
    lengths = [half.square for half in halves]
    if all(length.is_number for length in lengths):
        chosen = found[0] if number(lengths[0]) >= number(lengths[1]) else found[1]
        return values.each(names[: len(chosen)], map(rounded, chosen))
    sizes = values.each(("size", "size"), map(rounded, lengths))
    is_first = sizes[0] >= sizes[1]
    pairs = [[values.let("v", rounded(part)) for part in pair] for pair in zip(*found, strict=True)]
    return tuple(
        values.let(name, Where(is_first, *pair))
        for name, pair in zip(names[: len(pairs)], pairs, strict=True)
    )


def angle_between(values: NamedValues, first: Vector, second: Vector) -> sp.Expr:
    """The angle between two unit vectors."""
    cosine, cross = dot(first, second), sp.Matrix(first).cross(sp.Matrix(second))
    if all(part.is_number for part in (*first, *second)):
        return nearest(sp.atan2(sp.sqrt(cross.dot(cross)), cosine))
    sine = values.length("sine", values.each("xyz", map(rounded, cross)))
    return values.let("side", sp.atan2(sine, values.let("cosine", rounded(cosine))))


def flat_angle(values: NamedValues, first: Vector, middle: Vector, last: Vector) -> sp.Expr:
    """The middle angle at which the first axis, the middle one and the turned last are in one
    plane, the outer ones on one side: atan2(B, A)."""
    one, two, three = map(sp.Matrix, (first, middle, last))
    across, along = one.dot(two.cross(three)), one.dot(three) - one.dot(two) * two.dot(three)
    if all(part.is_number for part in (*first, *middle, *last)):
        return nearest(sp.atan2(nearest(across), nearest(along)))
    sine, cosine = values.each(("across", "along"), map(rounded, (across, along)))
    return values.let("base", sp.atan2(sine, cosine))


def _bend(values: NamedValues, axes: Sequence[Vector], swing: sp.Expr) -> tuple[sp.Expr, sp.Expr]:
    """The angle between two sides from that of the flat triangle on, by the half-angle formulas."""
    first, middle, last = axes
    sides = angle_between(values, first, middle), angle_between(values, middle, last)
    apart = values.let("apart", sp.Abs(sides[0] - sides[1]) / 2)
    together = values.let("together", (sides[0] + sides[1]) / 2)
    half = values.let("half", swing / 2)
    opened, closed = (
        values.positive(name, sp.Mul(*map(sp.sin, values.each(("sum", "difference"), angles))))
        for name, *angles in (
            ("opened", half + apart, half - apart),
            ("closed", together + half, together - half),
        )
    )
    bend = values.let("bend", 2 * sp.atan2(sp.sqrt(opened), sp.sqrt(closed)))
    near = values.let("near_side", apart - half)
    far = values.let("far_side", half - Where(together > sp.pi / 2, sp.pi - together, together))
    return bend, values.let("beyond", 2 * Where(near > far, near, far))


def _middle_of_half(
    values: NamedValues,
    fixed: tuple[Half, Half],
    free: tuple[Half, Half],
    length: sp.Expr,
    whole: sp.Expr,
    guesses: Sequence[sp.Expr],
) -> tuple[sp.Expr, sp.Expr]:
    """The one of the triangle's two middle angles for which the fixed half of p is that of m.

    Returns the angle, and how far the fixed half is from what the turns reach. The components of
    m± are a matrix times cos(β/2) and sin(β/2): an ellipse. By its first component alone follows a
    third angle to choose from, for the triangle is none where e₂ is e₁ or e₃. Then steps of least
    squares (Gauss, Newton) compare the fixed halves, and the lengths of the free ones, which tell
    more where these are short.
    """
    *given, m = _measured(values, _longer(values, fixed, [(*h.given, *h.matrix) for h in fixed]))
    (n,) = _measured(values, _longer(values, free, [half.matrix for half in free]))
    size = m[-1]
    a, b = values.each("ab", (part / (size * whole) for part in given))
    half = _nearest(values, (a, b), m, guesses)
    for _ in range(_STEPS):
        cosine, sine = turned = values.each(("cosine", "sine"), (sp.cos(half), sp.sin(half)))
        onwards = (-sine, cosine)
        x, y = _on_ellipse(m, turned)
        misses = values.each(("miss", "miss"), (a - x, b - y))
        slopes = values.each(("slope", "slope"), _on_ellipse(m, onwards))
        reached = values.each(("along", "across"), _on_ellipse(n, turned))
        radius = values.length("radius", reached)
        grows = values.let("grows", dot(reached, _on_ellipse(n, onwards)))
        slope = values.let("slope", grows / Where(sp.Eq(radius, 0), sp.S.One, radius))
        miss = values.let("miss", length / whole - radius)
        step = values.let("step", dot((*misses, miss), (*slopes, slope)))
        weight = values.let("weight", square((*slopes, slope)))
        half = values.let("half", half + step / (weight + values.tiny))  # not rounding alone
    beyond = values.let("beyond", 2 * values.length("missed", misses))
    return values.wrapped("middle", 2 * half), beyond


def _on_ellipse(m: Vector, turned: Vector) -> Vector:
    """The components of m± by its matrix, column by column, for the cosine and the sine of β/2."""
    cosine, sine = turned
    return cosine * m[0] + sine * m[2], cosine * m[1] + sine * m[3]


def _measured(values: NamedValues, found: Vector) -> tuple[sp.Expr | Vector, ...]:
    """What is before the matrix, and the matrix over the length that measures it, with that."""
    *before, c, d, e, f, size = found
    root = values.let("size", sp.sqrt(Where(size > 0, size, sp.S.One)))
    return (*before, (*values.each("mnpq", (entry / root for entry in (c, d, e, f))), root))


def _nearest(values: NamedValues, given: Vector, m: Vector, guesses: Sequence[sp.Expr]) -> sp.Expr:
    """Half the middle angle for which the given components are nearest to those of m±."""
    a, b = given
    base = values.let("base", m[0] * m[0] + m[2] * m[2])
    turn = values.let("turn", m[0] * m[3] - m[1] * m[2])
    skew = values.let("skew", base * b - (m[0] * m[1] + m[2] * m[3]) * a)
    side = values.let("side", skew * turn)
    opened = values.let("opened", sp.sqrt(values.positive("opened", base - a * a)))
    signed = Where(side < 0, -opened, opened)
    third = values.let("third", sp.atan2(m[2], m[0]) + sp.atan2(signed, a))
    half, least = sp.S.Zero, sp.oo
    for guess, handicap in ((guesses[0] / 2, 0), (guesses[1] / 2, 0), (third, values.reach)):
        angle = values.let("guess", guess)
        turned = values.each(("cosine", "sine"), (sp.cos(angle), sp.sin(angle)))
        along, across = values.each(("along", "across"), _on_ellipse(m, turned))
        is_opposite = values.let("agreement", a * along + b * across) < 0
        angle = values.let("guess", Where(is_opposite, angle + sp.pi, angle))
        differences = (
            values.let("off", a - Where(is_opposite, -along, along)),
            values.let("off", b - Where(is_opposite, -across, across)),
        )
        miss = values.length("miss", differences)
        if least is sp.oo:
            half, least = angle, miss
        else:  # the triangle is better where it is one
            is_nearer = values.let("raised", miss + handicap) < least
            half = values.let("half", Where(is_nearer, angle, half))
            least = values.let("least", Where(is_nearer, miss, least))
    return half
