"""A body whose corners follow its parameters: each corner is a point of a solid, by coordinates.

The faces are those of `body_mesh`, for the initial values of the parameters; the script evaluates
the place of each corner for others.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import sympy as sp

from rigidsym.formula.tree import Symbol
from rigidsym.mechanics.derivation import Argument
from rigidsym.models.body import RigidBody
from rigidsym.models.distribution import Composite, Part, Solid
from rigidsym.notes.figure.body_mesh import HOLE, PALETTE, SWELL, lengths_of, near, of_solid
from rigidsym.notes.figure.camera import Vector

_SHARES = sp.symbols("share_1:4")  # coordinates of a solid, each from 0 to 1
SHARE = Argument(
    name="share",
    symbols=_SHARES,
    names=tuple(map(str, _SHARES)),
    notation=tuple(Symbol(str(share)) for share in _SHARES),
    units=("", "", ""),
    about="coordinates of a solid, from 0 to 1",
)


def solid_parts(body: RigidBody | None) -> tuple[Part, ...]:
    """The solids that the body is made of; none if it is made of anything else, or has a value."""
    if body is None or body.distribution is None or body.values:
        return ()
    what = body.distribution
    parts = what.parts if isinstance(what, Composite) else (Part(what=what),)
    are_solids = all(isinstance(p.what, Solid) and len(p.what.coordinates) > 1 for p in parts)
    has_lengths = any(_place(p).free_symbols - {*_SHARES} for p in parts) if are_solids else False
    return parts if are_solids and has_lengths else ()


def places_of(body: RigidBody | None) -> dict[str, sp.ImmutableMatrix]:
    """name: the point of each part for coordinates from 0 to 1, in the axes of the body."""
    return {f"place_{k}": _place(part) for k, part in enumerate(solid_parts(body))}


def _place(part: Part) -> sp.ImmutableMatrix:
    solid = part.what
    assert isinstance(solid, Solid)
    known: dict[sp.Basic, sp.Expr] = {}
    for u, (low, high), share in zip(solid.coordinates, solid.bounds, _SHARES, strict=False):
        low, high = (sp.S(bound).xreplace(known) for bound in (low, high))
        known[u] = low + share * (high - low)
    point = sp.Matrix(solid.place).xreplace(known) * (sp.Rational(SWELL) if part.hole else 1)
    return sp.ImmutableMatrix(part.at + part.turned * point)


def growing(body: RigidBody | None) -> dict[str, Any] | None:
    """The faces by corners, and each corner by its part and coordinates; None if it cannot grow."""
    parts = solid_parts(body)
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
        for face in _faces_by_shares(part.what, numbers):
            ends = [corners.setdefault((number, *shares), len(corners)) for shares in face]
            faces.append([colors.setdefault(color, len(colors)), *ends])
    return {"corners": [*corners], "colors": [*colors], "faces": faces}


def _faces_by_shares(solid: Any, numbers: Mapping[sp.Symbol, sp.Float]) -> Iterator[list[Any]]:
    """The faces of a solid, their corners by coordinates from 0 to 1."""
    seen: dict[Vector, tuple[float, ...]] = {}
    for face in of_solid(solid, numbers, HOLE, seen):
        yield [seen[near(corner)] for corner in face.corners]
