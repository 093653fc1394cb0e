"""A body whose corners follow its parameters: each corner is a point of a solid, by coordinates.

The faces are those of `body_mesh`, for the initial values of the parameters; the script evaluates
the place of each corner for others. Particles and lines keep their thickness: their corners have
an offset, in units of the figure.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

import sympy as sp

from rigidsym.formula.tree import Symbol
from rigidsym.mechanics.derivation import Argument
from rigidsym.models.body import RigidBody
from rigidsym.models.distribution import Composite, Part, Particles, Solid
from rigidsym.notes.figure.body_mesh import (
    HOLE,
    PALETTE,
    SWELL,
    Scale,
    lengths_of,
    near,
    octahedron,
    of_solid,
    vector_of,
)
from rigidsym.notes.figure.camera import Vector, combined

_SHARES = sp.symbols("share_1:4")  # coordinates of a solid, each from 0 to 1
SHARE = Argument(
    name="share",
    symbols=_SHARES,
    names=tuple(map(str, _SHARES)),
    notation=tuple(Symbol(str(share)) for share in _SHARES),
    units=("", "", ""),
    about="coordinates of a solid, from 0 to 1",
)


def growing_parts(body: RigidBody | None) -> tuple[Part, ...]:
    """The solids and the particles that the body is made of.

    None if it is made of anything else, has a value, or no length to change.
    """
    if body is None or body.distribution is None or body.values:
        return ()
    what = body.distribution
    whole = what.parts if isinstance(what, Composite) else (Part(what=what),)
    if not all(isinstance(part.what, Solid | Particles) for part in whole):
        return ()
    parts = tuple(single for part in whole for single in _singles(part))
    return parts if any(_place(part).free_symbols - {*_SHARES} for part in parts) else ()


def _singles(part: Part) -> Iterator[Part]:
    """The particles of a part, each as a part at its position; a solid is one already."""
    if not isinstance(part.what, Particles):
        yield part
        return
    for particle in part.what.particles:
        at = sp.ImmutableMatrix(part.at + part.turned * particle.position)
        yield replace(part, what=Particles(particles=(particle,)), at=at)


def places_of(body: RigidBody | None) -> dict[str, sp.ImmutableMatrix]:
    """name: the point of each part for coordinates from 0 to 1, in the axes of the body."""
    return {f"place_{k}": _place(part) for k, part in enumerate(growing_parts(body))}


def _place(part: Part) -> sp.ImmutableMatrix:
    solid = part.what
    if not isinstance(solid, Solid):
        return part.at
    known: dict[sp.Basic, sp.Expr] = {}
    for u, (low, high), share in zip(solid.coordinates, solid.bounds, _SHARES, strict=False):
        low, high = (sp.S(bound).xreplace(known) for bound in (low, high))
        known[u] = low + share * (high - low)
    point = sp.Matrix(solid.place).xreplace(known) * (sp.Rational(SWELL) if part.hole else 1)
    return sp.ImmutableMatrix(part.at + part.turned * point)


def growing(body: RigidBody | None) -> dict[str, Any] | None:
    """The faces by corners, and each corner by its part and coordinates; None if it cannot grow."""
    parts = growing_parts(body)
    if body is None or not parts or body.distribution is None:
        return None
    numbers = lengths_of(body.distribution, {p.symbol: p.value for p in body.parameters})
    if numbers is None:
        return None
    corners: dict[tuple[float, ...], int] = {}
    colors: dict[tuple[int, int, int], int] = {}
    faces: list[list[int]] = []
    for number, (part, tint) in enumerate(zip(parts, PALETTE * len(parts), strict=False)):
        color = HOLE if part.hole else tint
        for face in _faces_by_shares(part, numbers):
            ends = [corners.setdefault((number, *shares), len(corners)) for shares in face]
            faces.append([colors.setdefault(color, len(colors)), *ends])
    return {"corners": [*corners], "colors": [*colors], "faces": faces}


def _faces_by_shares(part: Part, numbers: Mapping[sp.Symbol, sp.Float]) -> Iterator[list[Any]]:
    """The faces of a part, their corners by coordinates from 0 to 1 and an offset, if any."""
    if not isinstance(part.what, Solid):
        for face in octahedron((0.0, 0.0, 0.0), HOLE):
            yield [(0, 0, 0, *near(corner)) for corner in face.corners]
        return
    axes = [vector_of(part.turned[:, k].xreplace({**numbers})) for k in range(3)]
    seen: dict[Vector, tuple[float, ...]] = {}
    for face in of_solid(part.what, Scale(numbers), HOLE, seen):
        found = [seen[near(corner)] for corner in face.corners]
        yield [(*s[:3], *(near(combined(s[3:], axes)) if s[3:] else ())) for s in found]
