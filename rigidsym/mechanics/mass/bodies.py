"""Distribution of mass -> rigid body: its mass, its centre, its inertia tensor about the centre.

A body in numbers is integrated exactly, and keeps its sums as parameters that have a value.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import sympy as sp

from rigidsym.errors import BodyError
from rigidsym.mechanics.mass.moments import moments_of
from rigidsym.models.body import (
    KEYS,
    PHRASES,
    BodyDescription,
    Distribution,
    Parameter,
    RigidBody,
    Solid,
    described,
    given_inertia,
)
from rigidsym.models.rotation import symbolic
from rigidsym.models.solids import shape_of, shaped

if TYPE_CHECKING:
    from rigidsym.data.mass import MassProperties

_DIGITS = 30  # with which exact sums are evaluated
_ROUNDING = 1e-14  # of the largest moment: smaller numbers are what rounding leaves
_LONGEST = 10**6  # a larger denominator is a measured number's
_TITLES = {
    "Particles": "System of particles",
    "Composite": "Composite body",
    "Known": PHRASES["by_tensor"],
}


def rigid_body(body: RigidBody | BodyDescription | Distribution) -> RigidBody:
    """The mass, the centre and the inertia tensor of anything that `derive` takes for a body.

    The moments of a description are integrated here; a description in numbers keeps them as
    parameters that have a value. Raises BodyError, with the place, for a body that cannot be.
    """
    if isinstance(body, RigidBody):
        return body
    given = body if isinstance(body, BodyDescription) else BodyDescription(distribution=body)
    made = body_of(
        given.distribution,
        name=given.name,
        title=given.title,
        parameters=given.parameters,
        allow=given.allow,
    )
    if not given.keeps_numbers and is_measured(made):
        # Forces may use the lengths and masses of the description, though the formulas no longer
        # do.
        of_all = (*made.declared, *made.parameters)
        made = replace(in_parameters(made), drawn=made.distribution, declared=of_all)
    return replace(made, request=given.request)


def body_of(
    distribution: Distribution,
    *,
    name: str = "body",
    title: str = "",
    parameters: Sequence[Parameter] = (),
    allow: bool = False,
) -> RigidBody:
    """The rigid body with a distribution of mass; the inertia tensor is about its centre of mass.

    `parameters` describes the symbols. Raises BodyError if the mass is zero, and for unphysical
    numbers unless `allow` is set.
    """
    if not isinstance(distribution, Distribution):
        raise BodyError(f"expected a distribution of mass, got {distribution!r}")
    try:
        moments = moments_of(distribution)
        if moments.mass == 0:
            raise BodyError(f"{name}: the mass is zero; expected a positive mass")
        centre, inertia = moments.central()
        kind = type(distribution).__name__
        known = distribution.title if isinstance(distribution, Solid) else _TITLES.get(kind, kind)
        return RigidBody(
            name=name,
            title=title or known,
            mass=moments.mass,
            inertia=inertia,
            centre=centre,
            parameters=described(
                parameters,
                *((entry, "") for entry in (moments.mass, *moments.first, *moments.second)),
            ),
            declared=tuple(parameters),
            allow=allow,
            distribution=distribution,
        )
    except BodyError as error:
        place = error.place or (KEYS[type(distribution)],)
        raise BodyError(str(error), place=place) from error


def solid(
    shape: str,
    *,
    mass: sp.Expr | None = None,
    density: sp.Expr | None = None,
    name: str = "",
    allow: bool = False,
    **lengths: sp.Expr | Sequence[sp.Expr],
) -> RigidBody:
    """A shipped solid as a rigid body: `solid("cylinder", radius=a, height=h)`.

    Lengths (m) that are not given are symbols; so is the mass M (kg), unless there is a density
    (kg per m, m² or m³). Raises BodyError for an unknown shape or length, and for numbers that are
    not positive.
    """
    chosen = shape_of(shape)
    unknown = set(lengths) - {length.key for length in chosen.lengths}
    if unknown:
        known = ", ".join(length.key for length in chosen.lengths)
        raise BodyError(f"{shape} has no {', '.join(sorted(unknown))}; it has {known}")
    # Missing lengths are symbols, by their usual letters.
    by_key = {each.key: lengths.get(each.key, sp.symbols(each.names)) for each in chosen.lengths}
    listed = ((k, e if isinstance(e, Sequence) else [e]) for k, e in by_key.items())
    values = [symbolic(e, key) for key, entries in listed for e in entries]
    total = sp.Symbol("M") if mass is None and density is None else mass
    exact = [None if e is None else symbolic(e, "mass or density") for e in (total, density)]
    made = shaped(shape, values, mass=exact[0], density=exact[1])
    # lengths, masses and densities are positive; coordinates of corners have any sign
    amounts = [*exact, *(() if chosen.has_corners else values)]
    parameters = [Parameter(symbol=e) for e in dict.fromkeys(amounts) if isinstance(e, sp.Symbol)]
    return body_of(made, name=name or shape, parameters=parameters, allow=allow)


# Bodies in numbers: evaluated, or their sums replaced by parameters that have a value


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


def is_measured(body: RigidBody) -> bool:
    """Whether a body is given in numbers that nobody wants to see in formulas."""
    entries = (body.mass, *body.inertia, *body.centre)
    has_long = any(number.q > _LONGEST for entry in entries for number in entry.atoms(sp.Rational))
    return len(body.values) == len(body.parameters) and (bool(body.parameters) or has_long)


def in_parameters(body: RigidBody) -> RigidBody:
    """A measured body with M, I_11, ... and x_C, ... as parameters that have a value.

    The sums over its parts were made exactly; they are rounded once.
    """
    entries = {f"I_{i + 1}{j + 1}": body.inertia[i, j] for i in range(3) for j in range(i, 3)}
    entries |= {**dict(zip(("x_C", "y_C", "z_C"), body.centre, strict=True)), "M": body.mass}
    exact = {p.symbol: sp.Rational(p.value) for p in body.parameters if p.value is not None}
    values = {n: float(e.xreplace(exact).evalf(_DIGITS)) for n, e in entries.items()}
    largest = max(abs(value) for name, value in values.items() if name[0] == "I")
    # A length of the body: √(I/M) is a radius of gyration. Coordinates that are tiny compared with
    # it are rounding errors.
    size = max(abs(values[name]) for name in ("x_C", "y_C", "z_C")) + (largest / values["M"]) ** 0.5
    # An entry that is zero up to rounding becomes an exact zero, which keeps formulas short.
    scales = {"M": 0.0, "I": largest}
    parameters = {
        name: Parameter(symbol=sp.Symbol(name), positive=value > 0, value=value)
        for name, value in values.items()
        if abs(value) > scales.get(name[0], size) * _ROUNDING
    }

    def named(name: str) -> sp.Expr:
        return parameters[name].symbol if name in parameters else sp.S.Zero

    whole = given_inertia(
        sp.ImmutableMatrix(3, 3, lambda i, j: named(f"I_{min(i, j) + 1}{max(i, j) + 1}")),
        mass=named("M"),
        centre=sp.ImmutableMatrix([named("x_C"), named("y_C"), named("z_C")]),
        name=body.name,
        parameters=tuple(parameters.values()),
        allow=body.allow,
    )
    return replace(whole, title=body.title)
