"""Distributions of mass as data: particles, solids, and bodies composed of them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from operator import index
from typing import Any

import sympy as sp

from rigidsym.errors import BodyError

Bounds = tuple[sp.Expr, sp.Expr]
HERE = sp.ImmutableMatrix.zeros(3, 1)
UPRIGHT = sp.ImmutableMatrix(sp.eye(3))


@dataclass(frozen=True, kw_only=True, slots=True)
class Particle:
    """A point mass, in kg, at a position (3, 1), in m."""

    mass: sp.Expr
    position: sp.ImmutableMatrix

    def __post_init__(self) -> None:
        if len(self.position) != 3:
            raise BodyError(f"a position has three components, got {len(self.position)}")


@dataclass(frozen=True, kw_only=True, slots=True)
class Particles:
    """A rigid set of point masses."""

    particles: tuple[Particle, ...]

    def __post_init__(self) -> None:
        if not self.particles:
            raise BodyError("expected at least one particle")
        for particle in self.particles:
            if not isinstance(particle, Particle):
                raise BodyError(f"expected an rs.Particle, got {particle!r}")


@dataclass(frozen=True, kw_only=True, slots=True)
class Solid:
    """A line, a surface or a volume: a map from coordinates within bounds to its points.

    The bounds of a coordinate may contain the coordinates before it. `element` is the length or
    area element of a line or surface; the volume element is derived, as the Jacobian determinant.
    If the `mass` is given, the density is uniform; `density` (kg per m, m² or m³) may contain the
    coordinates, and x, y, z.
    """

    title: str
    coordinates: tuple[sp.Symbol, ...]
    place: sp.ImmutableMatrix  # (3, 1), in the coordinates
    bounds: tuple[Bounds, ...]
    element: sp.Expr | None = None
    mass: sp.Expr | None = None
    density: sp.Expr | None = None

    def __post_init__(self) -> None:
        count = len(self.coordinates)
        if count not in (1, 2, 3) or len(self.bounds) != count or self.place.shape != (3, 1):
            raise BodyError(
                f"{self.title}: expected one to three coordinates, bounds for each, and three "
                "components of the position"
            )
        if (count == 3) == (self.element is not None):
            raise BodyError(f"{self.title}: lines and surfaces have an element, volumes have none")
        if (self.mass is None) == (self.density is None):
            raise BodyError(f"{self.title}: expected either the mass or the density")
        for place, pair in enumerate(self.bounds):
            later = set(self.coordinates[place:])
            for bound in pair:
                if bound.free_symbols & later:
                    raise BodyError(
                        f"{self.title}: the bounds of {self.coordinates[place]} contain "
                        f"{', '.join(map(str, bound.free_symbols & later))}; expected only "
                        "coordinates before it"
                    )


@dataclass(frozen=True, kw_only=True, slots=True)
class Polyhedron:
    """A solid of uniform density, bounded by plane faces.

    A face is a list of its corners, counterclockwise as seen from outside.
    """

    vertices: tuple[sp.ImmutableMatrix, ...]  # (3, 1) each
    faces: tuple[tuple[int, ...], ...]
    mass: sp.Expr | None = None
    density: sp.Expr | None = None

    def __post_init__(self) -> None:
        if (self.mass is None) == (self.density is None):
            raise BodyError("polyhedron: expected either the mass or the density")
        edges: dict[tuple[int, int], int] = {}
        for place, face in enumerate(self.faces):
            if len(face) < 3 or len(set(face)) != len(face):
                raise BodyError(f"face {place}: expected three or more different corners")
            if not all(0 <= corner < len(self.vertices) for corner in face):
                raise BodyError(
                    f"face {place}: corners are numbered from 0 to {len(self.vertices) - 1}"
                )
            for edge in zip(face, (*face[1:], face[0]), strict=True):
                if edge in edges:
                    raise BodyError(
                        f"faces {edges[edge]} and {place} go along the edge {edge[0]}–{edge[1]} in "
                        "the same direction; one of them is turned over"
                    )
                edges[edge] = place
        for (start, end), place in edges.items():
            if (end, start) not in edges:
                raise BodyError(
                    f"the surface is open: the edge {start}–{end} of face {place} has no other face"
                )


@dataclass(frozen=True, kw_only=True, slots=True)
class Part:
    """A part of a composite body: turned about its origin, then moved by `at`."""

    what: Distribution
    at: sp.ImmutableMatrix = HERE  # (3, 1), m
    turned: sp.ImmutableMatrix = UPRIGHT  # R, from the axes of the part to those of the whole
    hole: bool = False  # its mass is taken away
    label: str = ""


@dataclass(frozen=True, kw_only=True, slots=True)
class Composite:
    """A body composed of parts."""

    parts: tuple[Part, ...]
    conditions: tuple[sp.Expr, ...] = ()  # each vanishes: on the symbols in the turns

    def __post_init__(self) -> None:
        if not self.parts:
            raise BodyError("expected at least one part")


@dataclass(frozen=True, slots=True)
class Outline:
    """Roughly the surface of a body, to draw it: corners in m, and faces by their numbers."""

    corners: tuple[tuple[float, float, float], ...] = ()
    faces: tuple[tuple[int, ...], ...] = ()

    def __post_init__(self) -> None:
        if not all(0 <= k < len(self.corners) for face in self.faces for k in face):
            raise BodyError("the faces of an outline refer to missing corners")


def outline_from(data: Mapping[str, Any]) -> Outline:
    """The outline in a file: corners = [[x, y, z], ...], faces = [[0, 1, 2], ...]."""
    try:
        return Outline(
            tuple((float(x), float(y), float(z)) for x, y, z in data.get("corners", ())),
            tuple(tuple(map(index, face)) for face in data.get("faces", ())),
        )
    except (TypeError, ValueError, OverflowError):
        message = "expected an outline of corners [x, y, z], and faces by numbers of corners"
        raise BodyError(message) from None


@dataclass(frozen=True, slots=True)
class Known:
    """A part of which only mass, centre and inertia tensor about the centre are given."""

    mass: sp.Expr
    centre: sp.ImmutableMatrix
    inertia: sp.ImmutableMatrix
    outline: Outline = field(default_factory=Outline)


Distribution = Particles | Solid | Polyhedron | Composite | Known
KEYS: Mapping[type, str] = {  # of a [body] table, and of its parts
    Particles: "particles",
    Solid: "shape",
    Polyhedron: "shape",
    Composite: "parts",
    Known: "inertia",
}
