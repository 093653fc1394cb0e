"""What solves three turns about any three axes, as claims for the ring to decide."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, reduce

import sympy as sp

from rigidsym.mechanics.conversions.function import dot, square
from rigidsym.mechanics.conversions.inverse import Claim, claim, vanishing
from rigidsym.mechanics.conversions.unit_quaternions import half_turn, in_halves, product
from rigidsym.mechanics.derivation import Proof
from rigidsym.models.chain import axis_turn, chain
from rigidsym.models.rotation import RotationModel, time_function


def of_any_axes(solved: int, *, has_two_sets: bool) -> tuple[Proof, ...]:
    """What solves so many turns about any axes, with one or two middle angles."""
    outer = _proved(_three_axes, _outer_claims)
    if solved < 3:
        return outer
    if not has_two_sets:
        return outer + _proved(_three_axes, _half_claims)
    middle = _proved(_three_axes, _middle_claims)
    return (*outer, *middle, *_proved(_triangle, _triangle_claims))


@cache
def _proved(
    build: Callable[[], RotationModel], claims: Callable[[RotationModel], list[Claim]]
) -> tuple[Proof, ...]:
    """Proved once for all models."""
    model = build()
    return vanishing(model, claims(model))


def _three_axes() -> RotationModel:
    """Three turns about any three unit axes, in a frame with the first along x.

    The second is in the x-y plane, so that the ring has fewer constants to hold.
    """
    zero, one = sp.S.Zero, sp.S.One
    axes = [(one, zero, zero), (*sp.symbols("b_x b_y"), zero), sp.symbols("c_x c_y c_z")]
    angles = [time_function(name) for name in ("alpha", "beta", "gamma")]
    turns = [axis_turn(axis, angle) for axis, angle in zip(axes, angles, strict=True)]
    return chain(turns, name="three_axes")


def _outer_claims(model: RotationModel) -> list[Claim]:
    """How the halves of the quaternion turn with the outer angles, and how long they are."""
    first, _, last = (sp.Matrix(turn.direction) for turn in model.turns)
    alpha, _, gamma = (turn.angle for turn in model.turns)
    turns = [half_turn(turn.direction, turn.angle) for turn in model.turns]
    found = in_halves(reduce(product, turns), first, last)
    between = in_halves(turns[1], first, last)
    cosine = first.dot(model.matrix * last)

    def turned(place: int, twice: sp.Expr, text: str) -> Claim:
        """p± = exp(e₁ angle) m±, for twice the angle."""
        expected = product(half_turn(first, twice), between[place])
        return claim(text, *(a - b for a, b in zip(found[place], expected, strict=True)))

    return [
        turned(0, alpha + gamma, r"\mathbf{p}_+ = e^{\mathbf{e}_1\sigma}\,\mathbf{m}_+"),
        turned(1, alpha - gamma, r"\mathbf{p}_- = e^{\mathbf{e}_1\delta}\,\mathbf{m}_-"),
        claim(
            r"2\,|\mathbf{p}_\pm|^2 = 1 \pm \mathbf{e}_1\cdot\mathbf{R}\,\mathbf{e}_3",
            *(2 * square(half) - 1 - s * cosine for half, s in zip(found, (1, -1), strict=True)),
        ),
    ]


def _middle_claims(model: RotationModel) -> list[Claim]:
    """The middle angle in the angle between the first axis and the turned last one."""
    first, middle, last = (sp.Matrix(turn.direction) for turn in model.turns)
    beta = model.turns[1].angle
    cosine = first.dot(model.matrix * last)
    before, after = first.dot(middle), middle.dot(last)
    along, across = first.dot(last) - before * after, first.dot(middle.cross(last))
    return [
        claim(
            r"\mathbf{e}_1\cdot\mathbf{R}\,\mathbf{e}_3 = k_1 k_3 + A\cos\beta + B\sin\beta",
            cosine - before * after - along * sp.cos(beta) - across * sp.sin(beta),
        ),
        claim(
            "A^2 + B^2 = (1 - k_1^2)(1 - k_3^2)",
            along**2 + across**2 - (1 - before**2) * (1 - after**2),
        ),
    ]


def _half_claims(model: RotationModel) -> list[Claim]:
    """What m± = 1± cos(β/2) + e₂± sin(β/2) is by its components along 1± and e₁ 1±."""
    first, middle, last = (sp.Matrix(turn.direction) for turn in model.turns)
    zero, one = sp.S.Zero, (sp.S.One, sp.S.Zero, sp.S.Zero, sp.S.Zero)
    squares, alongs, across = [], [], []
    units, axes = (in_halves(whole, first, last) for whole in (one, (zero, *middle)))
    for sign, unit, axis in zip((1, -1), units, axes, strict=True):
        turned = product((zero, *first), unit)
        squares.append(dot(unit, unit) - (1 + sign * first.dot(last)) / 2)
        alongs.append(dot(unit, axis) - sign * first.dot(middle.cross(last)) / 2)
        across.append(dot(turned, axis) - (first.dot(middle) + sign * middle.dot(last)) / 2)
    return [
        claim(r"2\,|\mathbf{1}_\pm|^2 = 1 \pm \mathbf{e}_1\cdot\mathbf{e}_3", *squares),
        claim(r"2\,\mathbf{1}_\pm\cdot\mathbf{e}_{2\pm} = \pm B", *alongs),
        claim(r"2\,(\mathbf{e}_1\mathbf{1}_\pm)\cdot\mathbf{e}_{2\pm} = k_1 \pm k_3", *across),
    ]


def _triangle() -> RotationModel:
    """The sides of a spherical triangle, as angles of turns, for the ring to hold them."""
    return chain([axis_turn((0, 0, 1), time_function(n)) for n in ("chi", "theta_1", "theta_3")])


def _triangle_claims(model: RotationModel) -> list[Claim]:
    """The half-angle formulas of a spherical triangle with two sides θ₁ and θ₃, and χ opposite."""
    side, first, last = model.coordinates
    cosines, sines = sp.cos(first) * sp.cos(last), sp.sin(first) * sp.sin(last)
    apart = sp.sin((side + first - last) / 2) * sp.sin((side - first + last) / 2)
    together = sp.sin((first + last + side) / 2) * sp.sin((first + last - side) / 2)
    return [
        claim(
            r"\cos(\theta_1 - \theta_3) - \cos\chi = 2 \sin\tfrac{\chi + \theta_1 "
            r"- \theta_3}{2} \sin\tfrac{\chi - \theta_1 + \theta_3}{2}",
            sines + cosines - sp.cos(side) - 2 * apart,
        ),
        claim(
            r"\cos\chi - \cos(\theta_1 + \theta_3) = 2 \sin\tfrac{\theta_1 + "
            r"\theta_3 + \chi}{2} \sin\tfrac{\theta_1 + \theta_3 - \chi}{2}",
            sines - cosines + sp.cos(side) - 2 * together,
        ),
    ]
