"""The shipped solids as data: a map, bounds and, for lines and surfaces, an element, as texts.

Moments of inertia are not stored; all are integrated.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import inf
from typing import NamedTuple

import sympy as sp

from rigidsym.errors import BodyError, offer
from rigidsym.models.body import Solid
from rigidsym.models.rotation import symbolic
from rigidsym.text.expression import parse_expression


class Length(NamedTuple):
    """A length that a solid asks for, or several of a kind."""

    key: str  # in a file: radius
    names: tuple[str, ...]  # of its symbols, by default
    about: str


class Shape(NamedTuple):
    """One kind of solid: its lengths, and its geometry in terms of them and of u, v, w."""

    title: str
    about: str  # where its origin and axes are
    lengths: tuple[Length, ...]
    place: str  # x, y, z, between commas
    bounds: str  # of u, v, w, as far as they are used
    element: str = ""  # of lines and surfaces
    larger: tuple[tuple[str, str], ...] = ()  # keys, the first at least as long as the second

    @property
    def has_corners(self) -> bool:
        """Whether it is described by points, whose coordinates may have any sign."""
        return any(length.key == "corners" for length in self.lengths)

    @property
    def names(self) -> tuple[str, ...]:
        return tuple(name for length in self.lengths for name in length.names)


_RADIUS, _HEIGHT = Length("radius", ("a",), "radius"), Length("height", ("h",), "height")
_RADII = (
    Length("inner_radius", ("a",), "inner radius"),
    Length("outer_radius", ("b",), "outer radius"),
)
_HOLLOW = (("outer_radius", "inner_radius"),)
_SIDES = Length("sides", ("a", "b", "c"), "side")
_CORNERS = "x_0 y_0 z_0 x_1 y_1 z_1 x_2 y_2 z_2 x_3 y_3 z_3"
_ABOUT_Z = "centred, about the z-axis"
_ROUND = "u*cos(v), u*sin(v), w"  # u from the z-axis
_BALL = "u*sin(v)*cos(w), u*sin(v)*sin(w), u*cos(v)"  # v from the z-axis

SHAPES: Mapping[str, Shape] = {
    "box": Shape(
        "Box",
        "centred, sides along x, y and z",
        (_SIDES,),
        "u, v, w",
        "-a/2..a/2, -b/2..b/2, -c/2..c/2",
    ),
    "plate": Shape(
        "Rectangular plate",
        "thin, centred, sides along x and y",
        (Length("sides", ("a", "b"), "side"),),
        "u, v, 0",
        "-a/2..a/2, -b/2..b/2",
        "1",
    ),
    "rod": Shape(
        "Rod",
        "thin, centred, along z",
        (Length("length", ("l",), "length"),),
        "0, 0, u",
        "-l/2..l/2",
        "1",
    ),
    "disc": Shape(
        "Disc", f"thin, {_ABOUT_Z}", (_RADIUS,), "u*cos(v), u*sin(v), 0", "0..a, 0..2*pi", "u"
    ),
    "ring": Shape("Ring", f"thin, {_ABOUT_Z}", (_RADIUS,), "a*cos(u), a*sin(u), 0", "0..2*pi", "a"),
    "cylinder": Shape(
        "Solid cylinder", _ABOUT_Z, (_RADIUS, _HEIGHT), _ROUND, "0..a, 0..2*pi, -h/2..h/2"
    ),
    "hollow_cylinder": Shape(
        "Hollow cylinder",
        _ABOUT_Z,
        (*_RADII, _HEIGHT),
        _ROUND,
        "a..b, 0..2*pi, -h/2..h/2",
        larger=_HOLLOW,
    ),
    "tube": Shape(
        "Cylindrical shell",
        f"thin, open, {_ABOUT_Z}",
        (_RADIUS, _HEIGHT),
        "a*cos(u), a*sin(u), v",
        "0..2*pi, -h/2..h/2",
        "a",
    ),
    "cone": Shape(
        "Solid cone",
        "base in the plane z = 0, apex on the z-axis at z = height",
        (_RADIUS, _HEIGHT),
        "a*u*(1 - w)*cos(v), a*u*(1 - w)*sin(v), h*w",
        "0..1, 0..2*pi, 0..1",
    ),
    "frustum": Shape(
        "Frustum of a cone",
        "base in the plane z = 0, top at z = height, about the z-axis",
        (_RADIUS, Length("top_radius", ("b",), "radius of the top"), _HEIGHT),
        "u*(a + (b - a)*w)*cos(v), u*(a + (b - a)*w)*sin(v), h*w",
        "0..1, 0..2*pi, 0..1",
    ),
    "sphere": Shape("Solid sphere", "centred", (_RADIUS,), _BALL, "0..a, 0..pi, 0..2*pi"),
    "hollow_sphere": Shape(
        "Hollow sphere", "centred", _RADII, _BALL, "a..b, 0..pi, 0..2*pi", larger=_HOLLOW
    ),
    "hemisphere": Shape(
        "Solid hemisphere",
        "base in the plane z = 0, above it",
        (_RADIUS,),
        _BALL,
        "0..a, 0..pi/2, 0..2*pi",
    ),
    "shell": Shape(
        "Spherical shell",
        "thin, centred",
        (_RADIUS,),
        "a*sin(u)*cos(v), a*sin(u)*sin(v), a*cos(u)",
        "0..pi, 0..2*pi",
        "a**2*sin(u)",
    ),
    "ellipsoid": Shape(
        "Solid ellipsoid",
        "centred, semi-axes along x, y and z",
        (Length("semi_axes", ("a", "b", "c"), "semi-axis"),),
        "a*u*sin(v)*cos(w), b*u*sin(v)*sin(w), c*u*cos(v)",
        "0..1, 0..pi, 0..2*pi",
    ),
    "torus": Shape(
        "Solid torus",
        _ABOUT_Z,
        (
            Length("radius", ("a",), "radius of the circle in the tube"),
            Length("tube_radius", ("b",), "radius of the tube"),
        ),
        "(a + u*cos(w))*cos(v), (a + u*cos(w))*sin(v), u*sin(w)",
        "0..b, 0..2*pi, 0..2*pi",
        larger=(("radius", "tube_radius"),),
    ),
    "tetrahedron": Shape(
        "Tetrahedron",
        "by its four corners",
        (Length("corners", tuple(_CORNERS.split()), "coordinate of a corner"),),
        "x_0 + u*(x_1 - x_0) + v*(x_2 - x_0) + w*(x_3 - x_0), "
        "y_0 + u*(y_1 - y_0) + v*(y_2 - y_0) + w*(y_3 - y_0), "
        "z_0 + u*(z_1 - z_0) + v*(z_2 - z_0) + w*(z_3 - z_0)",
        "0..1, 0..1 - u, 0..1 - u - v",
    ),
}


def shape_of(name: str) -> Shape:
    """A shipped shape; raises BodyError for another name."""
    if not isinstance(name, str) or name not in SHAPES:
        raise BodyError(f"no shape {name!r}; {offer(str(name), SHAPES)}")
    return SHAPES[name]


def shaped(
    name: str,
    lengths: Sequence[sp.Expr],
    *,
    mass: sp.Expr | None = None,
    density: sp.Expr | None = None,
) -> Solid:
    """The solid of a shape with all its lengths (m), in their order. Raises BodyError."""
    shape = shape_of(name)
    if len(lengths) != len(shape.names):
        raise BodyError(f"{name}: expected {', '.join(shape.names)}, got {len(lengths)} lengths")
    lengths = [symbolic(length, f"{name}: a length") for length in lengths]
    for length in lengths:
        if length.is_real is False:
            raise BodyError(f"{name}: {length} is not a length")
    check_lengths(name, [float(e) if e.is_number else None for e in lengths])
    coordinates = _free_coordinates([*lengths, mass, density])
    names = dict(zip(shape.names, lengths, strict=True)) | coordinates

    def read(text: str) -> list[sp.Expr]:
        return [parse_expression(part.strip(), names) for part in text.split(",")]

    bounds = [bound.split("..") for bound in shape.bounds.split(",")]
    return Solid(
        title=shape.title,
        coordinates=tuple(coordinates.values())[: len(bounds)],
        place=sp.ImmutableMatrix(read(shape.place)),
        bounds=tuple((*read(low), *read(high)) for low, high in bounds),
        element=read(shape.element)[0] if shape.element else None,
        mass=mass,
        density=density,
    )


def check_lengths(name: str, values: Sequence[float | None]) -> None:
    """Raises BodyError for a number that cannot be a length of the shape; None is not checked."""
    shape = shape_of(name)
    keys = [length.key for length in shape.lengths for _ in length.names]
    known = {key: v for key, v in zip(keys, values, strict=True) if v is not None}
    for key, value in zip(keys, values, strict=True):
        if value is not None and not value > 0 and not shape.has_corners:
            raise BodyError(f"{name}: {key} is {value:g} m; expected a positive length")
    for larger, smaller in shape.larger:
        if known.get(larger, inf) < known.get(smaller, 0):
            raise BodyError(
                f"{name}: {larger} is {known[larger]:g} m, less than {smaller} with "
                f"{known[smaller]:g} m"
            )


def _free_coordinates(used: Sequence[sp.Expr | None]) -> dict[str, sp.Symbol]:
    """Symbols for u, v and w, with a number behind if an expression has the name already."""
    taken = {
        str(s) for expression in used if expression is not None for s in expression.free_symbols
    }
    return {
        name: sp.Symbol(
            next(n for n in (name, *(f"{name}_{k}" for k in range(1, 99))) if n not in taken)
        )
        for name in ("u", "v", "w")
    }
