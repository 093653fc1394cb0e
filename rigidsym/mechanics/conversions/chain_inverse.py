"""From a quaternion to the angles of one to three turns about any axes, among known turns.

See `turn_chain` for the geometry: p₊ and p₋ are the halves of the quaternion by the first and the
last axis, m₊ and m₋ those of what is between.
"""

from __future__ import annotations

from collections.abc import Sequence

import sympy as sp

from rigidsym.mechanics.conversions.middle_angle import (
    Half,
    angle_between,
    halves_between,
    longer,
    middle_of_half,
    middle_of_triangle,
)
from rigidsym.mechanics.conversions.three_axes import dot, quaternion_product
from rigidsym.mechanics.conversions.turn_chain import TurnChain
from rigidsym.mechanics.conversions.values import (
    QUATERNION,
    NamedValues,
    Vector,
    Where,
    nearest,
    rounded,
)
from rigidsym.models.rotation import Turn


def chain_coordinates(values: NamedValues, rule: TurnChain, quaternion: Vector) -> Vector:
    """The coordinates that follow, in the order of `rule.places`."""
    parts = _without_known_turns(values, rule, quaternion)
    axes = [values.each(("axis_x", "axis_y", "axis_z"), axis) for axis in rule.axes]
    if len(axes) == 3:
        angles = _three(values, rule, parts, axes)
    else:
        angles = (_one, _two)[len(axes) - 1](values, parts, axes)
    return tuple(rule.inverse * (sp.Matrix(angles) - sp.Matrix(rule.offsets)))


def _without_known_turns(values: NamedValues, rule: TurnChain, parts: Vector) -> Vector:
    for turn in rule.before:
        parts = values.each(QUATERNION, map(rounded, quaternion_product(_undone(turn), parts)))
    for turn in reversed(rule.right):
        parts = values.each(QUATERNION, map(rounded, quaternion_product(parts, _undone(turn))))
    return parts


def _undone(turn: Turn) -> Vector:
    """The quaternion of the turn by −β."""
    half = -turn.angle / 2
    return (sp.cos(half), *(sp.sin(half) * part for part in turn.direction))


def _halves(
    values: NamedValues, parts: Vector, first: Vector, last: Vector
) -> tuple[Vector, Vector, sp.Expr, sp.Expr]:
    """p₊ and p₋, and their lengths."""
    zero = sp.S.Zero
    across = quaternion_product(quaternion_product((zero, *first), parts), (zero, *last))
    plus, minus = (
        values.each(
            [f"{name}_{part}" for part in QUATERNION],
            [rounded((a + sign * b) / 2) for a, b in zip(parts, across, strict=True)],
        )
        for name, sign in (("plus", -1), ("minus", 1))
    )
    return plus, minus, values.length("far", plus), values.length("near", minus)


def _one(values: NamedValues, parts: Vector, axes: Sequence[Vector]) -> Vector:
    plus, _, far, near = _halves(values, parts, axes[0], axes[0])
    sine = values.let("sine", rounded(dot(plus[1:], axes[0])))
    half = values.let("half", sp.atan2(sine, plus[0]))
    beyond = values.let("swing", 2 * sp.atan2(near, far))
    half = values.let("half", Where(beyond > values.reach, sp.nan, half))
    return (values.wrapped("angle", 2 * half),)


def _two(values: NamedValues, parts: Vector, axes: Sequence[Vector]) -> Vector:
    first, last = axes
    _, _, far, near = _halves(values, parts, first, last)
    total, difference = _from_one(values, parts, *_across_each_other(values, first, last))
    swing = values.let("swing", 2 * sp.atan2(near, far))
    beyond = values.let("beyond", sp.Abs(swing - angle_between(values, first, last)))
    total, difference = at_poles(values, (near, far), (total, difference))
    total = values.let("half_sum", Where(beyond > values.reach, sp.nan, total))
    return outer_angles(values, total, difference)


def _three(values: NamedValues, rule: TurnChain, parts: Vector, axes: Sequence[Vector]) -> Vector:
    plus, minus, far, near = _halves(values, parts, axes[0], axes[2])
    by_sum, by_difference = halves_between(axes, plus, 1), halves_between(axes, minus, -1)
    swing = values.let("swing", 2 * sp.atan2(near, far))
    middle, base, beyond = middle_of_triangle(values, axes, swing, is_across=rule.is_across)
    if not rule.has_two_sets:
        fixed, free = (by_difference, by_sum) if rule.mirror > 0 else (by_sum, by_difference)
        length = far if rule.mirror > 0 else near
        whole = values.length("whole", (near, far))
        guesses = (middle, 2 * base - middle)
        middle, beyond = middle_of_half(values, fixed, free, length, whole, guesses)
    half = values.let("half_middle", middle / 2)
    turned = (sp.cos(half), sp.sin(half))
    total = _outer(values, "half_sum", by_sum, turned)
    difference = _outer(values, "half_difference", by_difference, turned)
    if rule.mirror:
        total, difference, apart = _alike(values, rule.mirror, (near, far), (total, difference))
        beyond = values.let("beyond", Where(apart > beyond, apart, beyond)) if beyond else apart
    else:
        total, difference = at_poles(values, (near, far), (total, difference))
    if beyond:
        is_beyond = beyond > values.reach
        total = values.let("half_sum", Where(is_beyond, sp.nan, total))
        middle = values.let("middle", Where(is_beyond, sp.nan, middle))
    first, last = outer_angles(values, total, difference)
    return (first, middle) if rule.mirror else (first, middle, last)


def _outer(values: NamedValues, name: str, halves: tuple[Half, Half], turned: Vector) -> sp.Expr:
    """The angle from m± to p±: half the sum or half the difference of the outer angles."""
    a, b, c, d = longer(values, halves, [half.compared(turned) for half in halves])
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
    longer: that is taken off.
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
