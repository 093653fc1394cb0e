"""Bodies in numbers: evaluated, or their sums replaced by parameters that have a value."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import TYPE_CHECKING

import sympy as sp

from rigidsym.mechanics.mass.moments import about_centre
from rigidsym.models.body import Composite, Parameter, RigidBody, given_inertia

if TYPE_CHECKING:
    from rigidsym.data.mass import MassProperties

_DIGITS = 30  # with which exact sums are evaluated
_ROUNDING = 1e-14  # of the largest moment: smaller numbers are what rounding leaves
_LONGEST = 10**6  # a larger denominator is a measured number's


def in_numbers(body: RigidBody) -> MassProperties | None:
    """Mass, centre, inertia tensor, principal moments and axes; None if a symbol is left."""
    import numpy as np  # which no derivation needs

    from rigidsym.data.mass import MassProperties

    mass, centre, inertia = map(body.in_numbers, (body.mass, body.centre, body.inertia))
    if not all(entry.is_number for entry in (mass, *centre, *inertia)):
        return None
    return MassProperties(
        count=0,
        mass=float(mass),
        centre=np.array(list(centre), dtype=float),
        inertia=np.array(inertia.tolist(), dtype=float),
    )


def parts_of(body: RigidBody) -> list[tuple[sp.Expr, sp.Matrix, sp.Matrix, sp.Matrix]]:
    """Mass, centre, tensor about it and turn of each part of a composite body; else none."""
    whole = body.distribution
    if not isinstance(whole, Composite):
        return []
    return [(*about_centre(part), part.turned) for part in whole.parts]


def is_measured(body: RigidBody) -> bool:
    """Whether a body is given in numbers that nobody wants to see in formulas."""
    entries = (body.mass, *body.inertia, *body.centre)
    has_long = any(number.q > _LONGEST for entry in entries for number in entry.atoms(sp.Rational))
    return len(body.values) == len(body.parameters) and (bool(body.parameters) or has_long)


def in_parameters(body: RigidBody) -> RigidBody:
    """A measured body with M, I_11, ... and x_C, ... as parameters that have a value.

    The sums over its parts were made exactly; they are rounded once.
    """
    values = {
        p.symbol: sp.Rational(*p.value.as_integer_ratio())
        for p in body.parameters
        if p.value is not None
    }

    def rounded(entries: Iterable[sp.Expr]) -> list[float]:
        return [float(entry.xreplace(values).evalf(_DIGITS)) for entry in entries]

    (mass,), centre, inertia = map(rounded, ([body.mass], body.centre, body.inertia))
    largest = max(map(abs, inertia))
    size = max(map(abs, centre)) + (largest / mass) ** 0.5
    parameters: dict[str, Parameter] = {}

    def named(name: str, value: float, scale: float) -> sp.Expr:
        if abs(value) <= scale * _ROUNDING:
            return sp.S.Zero
        symbol = sp.Symbol(name)
        parameters[name] = Parameter(symbol=symbol, positive=value > 0, value=value)
        return symbol

    moments = [
        named(f"I_{min(i, j)}{max(i, j)}", inertia[3 * (min(i, j) - 1) + max(i, j) - 1], largest)
        for i in (1, 2, 3)
        for j in (1, 2, 3)
    ]
    at = [named(name, v, size) for name, v in zip(("x_C", "y_C", "z_C"), centre, strict=True)]
    whole = given_inertia(
        sp.ImmutableMatrix(3, 3, moments),
        mass=named("M", mass, 0),
        centre=sp.ImmutableMatrix(at),
        name=body.name,
        parameters=tuple(parameters.values()),
        allow=body.allow,
    )
    return replace(whole, title=body.title)
