"""What solves three turns about any three axes, as claims for the ring to decide."""

from __future__ import annotations

from collections.abc import Iterable
from functools import reduce

import sympy as sp

from rigidsym.formula.reader import formula
from rigidsym.formula.tree import Formula
from rigidsym.models.chain import axis_turn, chain
from rigidsym.models.rotation import RotationModel
from rigidsym.models.so3 import time_function

Claim = tuple[tuple[sp.Expr, ...], Formula]


def three_axes() -> RotationModel:
    """Three turns about any three unit axes, in a frame with the first along x.

    The second is in the x-y plane, so that the ring has fewer constants to hold.
    """
    zero, one = sp.S.Zero, sp.S.One
    axes = [(one, zero, zero), (*sp.symbols("b_x b_y"), zero), sp.symbols("c_x c_y c_z")]
    angles = [time_function(name) for name in ("alpha", "beta", "gamma")]
    turns = [axis_turn(axis, angle) for axis, angle in zip(axes, angles, strict=True)]
    return chain(turns, name="three_axes")


def outer_claims(model: RotationModel) -> list[Claim]:
    """How the halves of the quaternion turn with the outer angles, and how long they are."""
    first, _, last = (sp.Matrix(turn.direction) for turn in model.turns)
    alpha, _, gamma = (turn.angle for turn in model.turns)
    halves = [
        (sp.cos(turn.angle / 2), *(sp.sin(turn.angle / 2) * part for part in turn.direction))
        for turn in model.turns
    ]
    whole = reduce(quaternion_product, halves)
    plus, minus = (_half(whole, first, last, sign) for sign in (-1, 1))
    between_plus, between_minus = (_half(halves[1], first, last, sign) for sign in (-1, 1))
    turned_plus = _turned(first, (alpha + gamma) / 2, between_plus)
    turned_minus = _turned(first, (alpha - gamma) / 2, between_minus)
    cosine = first.dot(model.matrix * last)
    lengths = [2 * sum(part**2 for part in half) - 1 for half in (plus, minus)]
    return [
        (
            _difference(plus, turned_plus),
            formula(r"\mathbf{p}_+ = e^{\mathbf{e}_1\sigma}\,\mathbf{m}_+"),
        ),
        (
            _difference(minus, turned_minus),
            formula(r"\mathbf{p}_- = e^{\mathbf{e}_1\delta}\,\mathbf{m}_-"),
        ),
        (
            (lengths[0] - cosine, lengths[1] + cosine),
            formula(r"2\,|\mathbf{p}_\pm|^2 = 1 \pm \mathbf{e}_1\cdot\mathbf{R}\,\mathbf{e}_3"),
        ),
    ]


def middle_claims(model: RotationModel) -> list[Claim]:
    """The middle angle in the angle between the first axis and the turned last one."""
    first, middle, last = (sp.Matrix(turn.direction) for turn in model.turns)
    beta = model.turns[1].angle
    cosine = first.dot(model.matrix * last)
    before, after = first.dot(middle), middle.dot(last)
    along, across = first.dot(last) - before * after, first.dot(middle.cross(last))
    return [
        (
            (cosine - before * after - along * sp.cos(beta) - across * sp.sin(beta),),
            formula(
                r"\mathbf{e}_1\cdot\mathbf{R}\,\mathbf{e}_3 = k_1 k_3 + A\cos\beta + B\sin\beta"
            ),
        ),
        (
            (along**2 + across**2 - (1 - before**2) * (1 - after**2),),
            formula("A^2 + B^2 = (1 - k_1^2)(1 - k_3^2)"),
        ),
    ]


def half_claims(model: RotationModel) -> list[Claim]:
    """What m± = 1± cos(β/2) + e₂± sin(β/2) is by its components along 1± and e₁ 1±."""
    first, middle, last = (sp.Matrix(turn.direction) for turn in model.turns)
    zero, one = sp.S.Zero, (sp.S.One, sp.S.Zero, sp.S.Zero, sp.S.Zero)
    squares, alongs, across = [], [], []
    for sign in (1, -1):
        unit = _half(one, first, last, -sign)
        turned = quaternion_product((zero, *first), unit)
        axis = _half((zero, *middle), first, last, -sign)
        squares.append(dot(unit, unit) - (1 + sign * first.dot(last)) / 2)
        alongs.append(dot(unit, axis) - sign * first.dot(middle.cross(last)) / 2)
        across.append(dot(turned, axis) - (first.dot(middle) + sign * middle.dot(last)) / 2)
    return [
        (
            tuple(squares),
            formula(r"2\,|\mathbf{1}_\pm|^2 = 1 \pm \mathbf{e}_1\cdot\mathbf{e}_3"),
        ),
        (
            tuple(alongs),
            formula(r"2\,\mathbf{1}_\pm\cdot\mathbf{e}_{2\pm} = \pm B"),
        ),
        (
            tuple(across),
            formula(r"2\,(\mathbf{e}_1\mathbf{1}_\pm)\cdot\mathbf{e}_{2\pm} = k_1 \pm k_3"),
        ),
    ]


def triangle() -> RotationModel:
    """The sides of a spherical triangle, as angles of turns, for the ring to hold them."""
    return chain([axis_turn((0, 0, 1), time_function(n)) for n in ("chi", "theta_1", "theta_3")])


def triangle_claims(model: RotationModel) -> list[Claim]:
    """The half-angle formulas of a spherical triangle with two sides θ₁ and θ₃, and χ opposite."""
    side, first, last = model.coordinates
    cosines, sines = sp.cos(first) * sp.cos(last), sp.sin(first) * sp.sin(last)
    apart = sp.sin((side + first - last) / 2) * sp.sin((side - first + last) / 2)
    together = sp.sin((first + last + side) / 2) * sp.sin((first + last - side) / 2)
    return [
        (
            (sines + cosines - sp.cos(side) - 2 * apart,),
            formula(
                r"\cos(\theta_1 - \theta_3) - \cos\chi = 2 \sin\tfrac{\chi + \theta_1 "
                r"- \theta_3}{2} \sin\tfrac{\chi - \theta_1 + \theta_3}{2}"
            ),
        ),
        (
            (sines - cosines + sp.cos(side) - 2 * together,),
            formula(
                r"\cos\chi - \cos(\theta_1 + \theta_3) = 2 \sin\tfrac{\theta_1 + "
                r"\theta_3 + \chi}{2} \sin\tfrac{\theta_1 + \theta_3 - \chi}{2}"
            ),
        ),
    ]


Parts = tuple[sp.Expr, ...]


def quaternion_product(first: Parts, second: Parts) -> Parts:
    """The product of two quaternions, scalar first, as it comes."""
    w, *v = first
    scalar, *u = second
    one, two = sp.Matrix(v), sp.Matrix(u)
    return (w * scalar - one.dot(two), *(w * two + scalar * one + one.cross(two)))


def _half(whole: Parts, first: sp.Matrix, last: sp.Matrix, sign: int) -> Parts:
    """x₊ = (x − e₁ x e₃)/2 for the sign −1, x₋ for +1."""
    zero = sp.S.Zero
    across = quaternion_product(quaternion_product((zero, *first), whole), (zero, *last))
    return tuple((a + sign * b) / 2 for a, b in zip(whole, across, strict=True))


def _turned(axis: sp.Matrix, angle: sp.Expr, parts: Parts) -> Parts:
    """exp(e angle) parts."""
    return quaternion_product((sp.cos(angle), *(sp.sin(angle) * axis)), parts)


def dot(first: Iterable[sp.Expr], second: Iterable[sp.Expr]) -> sp.Expr:
    """The sum of products, part by part, as it comes."""
    return sp.Add(*(a * b for a, b in zip(first, second, strict=True)))


def _difference(first: Parts, second: Parts) -> Parts:
    return tuple(a - b for a, b in zip(first, second, strict=True))
