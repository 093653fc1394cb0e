"""Distribution of mass -> rigid body: its mass, its centre, its inertia tensor about the centre."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import sympy as sp

from rigidsym.algebra.present import Rationals
from rigidsym.algebra.ring import Quotient
from rigidsym.errors import BodyError
from rigidsym.mechanics.mass.moments import Moments, moments_of
from rigidsym.mechanics.mass.numbers import in_parameters, is_measured
from rigidsym.models.body import (
    KEYS,
    BodyDescription,
    Distribution,
    Parameter,
    RigidBody,
    Solid,
    described,
)
from rigidsym.models.rotation import symbolic
from rigidsym.models.solids import shape_of, shaped

_TITLES = {
    "Particles": "System of particles",
    "Composite": "Composite body",
    "Known": "Body with a given inertia tensor",
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
        centre, inertia = _central(moments)
        kind = type(distribution).__name__
        known = distribution.title if isinstance(distribution, Solid) else _TITLES.get(kind, kind)
        return RigidBody(
            name=name,
            title=title or known,
            mass=moments.mass,
            inertia=inertia,
            centre=centre,
            parameters=described(parameters, *((entry, "") for entry in moments.expressions)),
            declared=tuple(parameters),
            allow=allow,
            distribution=distribution,
        )
    except BodyError as error:
        place = error.place or (KEYS[type(distribution)],)
        raise BodyError(str(error), place=place) from error


def _central(moments: Moments) -> tuple[sp.ImmutableMatrix, sp.ImmutableMatrix]:
    """The centre c = S/M, (3, 1), and the inertia tensor tr(J) 1 − J about it, from J − S Sᵀ/M."""
    field = Rationals.of(moments.expressions)
    inverse = field.read(moments.mass).inverse()
    first = [field.read(entry) for entry in moments.first]
    second = field.read_matrix(moments.second)

    def about_centre(i: int, j: int) -> Quotient:
        return second[i][j] - first[i] * first[j] * inverse

    def entry(i: int, j: int) -> sp.Expr:
        if i != j:
            return field.write(-about_centre(i, j))
        return field.write(field.total(about_centre(k, k) for k in range(3) if k != i))

    centre = sp.ImmutableMatrix([field.write(part * inverse) for part in first])
    return centre, sp.ImmutableMatrix(3, 3, entry)


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
    values: list[sp.Expr] = []
    for length in chosen.lengths:
        given = lengths.get(length.key, [sp.Symbol(letter) for letter in length.names])
        values += [
            symbolic(e, length.key) for e in (given if isinstance(given, Sequence) else [given])
        ]
    total = sp.Symbol("M") if mass is None and density is None else mass
    exact = [None if e is None else symbolic(e, "mass or density") for e in (total, density)]
    made = shaped(shape, values, mass=exact[0], density=exact[1])
    # lengths, masses and densities are positive; coordinates of corners have any sign
    amounts = [*exact, *(() if chosen.has_corners else values)]
    parameters = [Parameter(symbol=e) for e in dict.fromkeys(amounts) if isinstance(e, sp.Symbol)]
    return body_of(made, name=name or shape, parameters=parameters, allow=allow)
