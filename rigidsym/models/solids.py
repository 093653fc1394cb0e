"""The shipped solids: each is a map, bounds and, for lines and surfaces, an element.

No moment of inertia stands here; all are integrated.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import inf
from types import MappingProxyType

import sympy as sp
from sympy import Rational, cos, pi, sin

from rigidsym.errors import BodyError, offer
from rigidsym.models.distribution import Bounds, Solid
from rigidsym.models.so3 import symbolic

_HALF = Rational(1, 2)
Geometry = tuple[Sequence[sp.Symbol], Sequence[sp.Expr], Sequence[Bounds], sp.Expr | None]
Form = Callable[..., Geometry]


@dataclass(frozen=True, kw_only=True, slots=True)
class Length:
    """A length that a solid asks for, or several of a kind."""

    key: str  # in a file: radius
    names: tuple[str, ...]  # of its symbols, by default
    about: str


@dataclass(frozen=True, kw_only=True, slots=True)
class Shape:
    """One kind of solid: its lengths, and its geometry in terms of them and of u, v, w."""

    title: str
    about: str  # where its origin and axes are
    lengths: tuple[Length, ...]
    form: Form
    larger: tuple[tuple[str, str], ...] = ()  # keys, the first at least as long as the second

    @property
    def has_corners(self) -> bool:
        """Whether it is described by points, whose coordinates may have any sign."""
        return any(length.key == "corners" for length in self.lengths)

    @property
    def names(self) -> tuple[str, ...]:
        return tuple(name for length in self.lengths for name in length.names)


def _cylinder(
    u: sp.Symbol, v: sp.Symbol, w: sp.Symbol, inner: sp.Expr, outer: sp.Expr, height: sp.Expr
) -> Geometry:
    place = (u * cos(v), u * sin(v), w)
    return (u, v, w), place, ((inner, outer), (0, 2 * pi), _about_zero(height)), None


def _frustum(
    u: sp.Symbol, v: sp.Symbol, w: sp.Symbol, bottom: sp.Expr, top: sp.Expr, height: sp.Expr
) -> Geometry:
    radius = u * (bottom + (top - bottom) * w)
    place = (radius * cos(v), radius * sin(v), height * w)
    return (u, v, w), place, ((0, 1), (0, 2 * pi), (0, 1)), None


def _ball(
    u: sp.Symbol, v: sp.Symbol, w: sp.Symbol, inner: sp.Expr, outer: sp.Expr, down_to: sp.Expr = pi
) -> Geometry:
    place = (u * sin(v) * cos(w), u * sin(v) * sin(w), u * cos(v))
    return (u, v, w), place, ((inner, outer), (0, down_to), (0, 2 * pi)), None


def _ellipsoid(u: sp.Symbol, v: sp.Symbol, w: sp.Symbol, *axes: sp.Expr) -> Geometry:
    coordinates, place, _, _ = _ball(u, v, w, sp.S.Zero, sp.S.One)
    scaled = [axis * part for axis, part in zip(axes, place, strict=True)]
    return coordinates, scaled, ((0, 1), (0, pi), (0, 2 * pi)), None


def _torus(u: sp.Symbol, v: sp.Symbol, w: sp.Symbol, radius: sp.Expr, tube: sp.Expr) -> Geometry:
    distance = radius + u * cos(w)
    place = (distance * cos(v), distance * sin(v), u * sin(w))
    return (u, v, w), place, ((0, tube), (0, 2 * pi), (0, 2 * pi)), None


def _box(u: sp.Symbol, v: sp.Symbol, w: sp.Symbol, *sides: sp.Expr) -> Geometry:
    return (u, v, w), (u, v, w), tuple(map(_about_zero, sides)), None


def _plate(u: sp.Symbol, v: sp.Symbol, _: sp.Symbol, *sides: sp.Expr) -> Geometry:
    return (u, v), (u, v, sp.S.Zero), tuple(map(_about_zero, sides)), sp.S.One


def _rod(u: sp.Symbol, _v: sp.Symbol, _w: sp.Symbol, length: sp.Expr) -> Geometry:
    return (u,), (sp.S.Zero, sp.S.Zero, u), (_about_zero(length),), sp.S.One


def _disc(u: sp.Symbol, v: sp.Symbol, _: sp.Symbol, radius: sp.Expr) -> Geometry:
    return (u, v), (u * cos(v), u * sin(v), sp.S.Zero), ((0, radius), (0, 2 * pi)), u


def _ring(u: sp.Symbol, _v: sp.Symbol, _w: sp.Symbol, radius: sp.Expr) -> Geometry:
    return (u,), (radius * cos(u), radius * sin(u), sp.S.Zero), ((0, 2 * pi),), radius


def _tube(u: sp.Symbol, v: sp.Symbol, _: sp.Symbol, radius: sp.Expr, height: sp.Expr) -> Geometry:
    place = (radius * cos(u), radius * sin(u), v)
    return (u, v), place, ((0, 2 * pi), _about_zero(height)), radius


def _shell(u: sp.Symbol, v: sp.Symbol, _: sp.Symbol, radius: sp.Expr) -> Geometry:
    place = (radius * sin(u) * cos(v), radius * sin(u) * sin(v), radius * cos(u))
    return (u, v), place, ((0, pi), (0, 2 * pi)), radius**2 * sin(u)


def _tetrahedron(u: sp.Symbol, v: sp.Symbol, w: sp.Symbol, *corners: sp.Expr) -> Geometry:
    first, *others = (sp.Matrix(corners[k : k + 3]) for k in (0, 3, 6, 9))
    place = first + sum(
        (s * (other - first) for s, other in zip((u, v, w), others, strict=True)), sp.zeros(3, 1)
    )
    return (u, v, w), tuple(place), ((0, 1), (0, 1 - u), (0, 1 - u - v)), None


def _about_zero(length: sp.Expr) -> Bounds:
    return -length * _HALF, length * _HALF


_ABOUT_Z = "centred, about the z-axis"
_RADIUS = Length(key="radius", names=("a",), about="radius")
_HEIGHT = Length(key="height", names=("h",), about="height")
_INNER = Length(key="inner_radius", names=("a",), about="inner radius")
_OUTER = Length(key="outer_radius", names=("b",), about="outer radius")
_HOLLOW = (("outer_radius", "inner_radius"),)
_LETTERS = ("a", "b", "c")

SHAPES: Mapping[str, Shape] = MappingProxyType(
    {
        "box": Shape(
            title="Box",
            about="centred, sides along x, y and z",
            lengths=(Length(key="sides", names=_LETTERS, about="side"),),
            form=_box,
        ),
        "plate": Shape(
            title="Rectangular plate",
            about="thin, centred, sides along x and y",
            lengths=(Length(key="sides", names=("a", "b"), about="side"),),
            form=_plate,
        ),
        "rod": Shape(
            title="Rod",
            about="thin, centred, along z",
            lengths=(Length(key="length", names=("l",), about="length"),),
            form=_rod,
        ),
        "disc": Shape(title="Disc", about=f"thin, {_ABOUT_Z}", lengths=(_RADIUS,), form=_disc),
        "ring": Shape(title="Ring", about=f"thin, {_ABOUT_Z}", lengths=(_RADIUS,), form=_ring),
        "cylinder": Shape(
            title="Solid cylinder",
            about=_ABOUT_Z,
            lengths=(_RADIUS, _HEIGHT),
            form=lambda u, v, w, a, h: _cylinder(u, v, w, sp.S.Zero, a, h),
        ),
        "hollow_cylinder": Shape(
            title="Hollow cylinder",
            about=_ABOUT_Z,
            lengths=(_INNER, _OUTER, _HEIGHT),
            form=_cylinder,
            larger=_HOLLOW,
        ),
        "tube": Shape(
            title="Cylindrical shell",
            about=f"thin, open, {_ABOUT_Z}",
            lengths=(_RADIUS, _HEIGHT),
            form=_tube,
        ),
        "cone": Shape(
            title="Solid cone",
            about="base in the plane z = 0, apex on the z-axis at z = height",
            lengths=(_RADIUS, _HEIGHT),
            form=lambda u, v, w, a, h: _frustum(u, v, w, a, sp.S.Zero, h),
        ),
        "frustum": Shape(
            title="Frustum of a cone",
            about="base in the plane z = 0, top at z = height, about the z-axis",
            lengths=(
                _RADIUS,
                Length(key="top_radius", names=("b",), about="radius of the top"),
                _HEIGHT,
            ),
            form=_frustum,
        ),
        "sphere": Shape(
            title="Solid sphere",
            about="centred",
            lengths=(_RADIUS,),
            form=lambda u, v, w, a: _ball(u, v, w, sp.S.Zero, a),
        ),
        "hollow_sphere": Shape(
            title="Hollow sphere",
            about="centred",
            lengths=(_INNER, _OUTER),
            form=_ball,
            larger=_HOLLOW,
        ),
        "hemisphere": Shape(
            title="Solid hemisphere",
            about="base in the plane z = 0, above it",
            lengths=(_RADIUS,),
            form=lambda u, v, w, a: _ball(u, v, w, sp.S.Zero, a, pi * _HALF),
        ),
        "shell": Shape(
            title="Spherical shell", about="thin, centred", lengths=(_RADIUS,), form=_shell
        ),
        "ellipsoid": Shape(
            title="Solid ellipsoid",
            about="centred, semi-axes along x, y and z",
            lengths=(Length(key="semi_axes", names=_LETTERS, about="semi-axis"),),
            form=_ellipsoid,
        ),
        "torus": Shape(
            title="Solid torus",
            about=_ABOUT_Z,
            lengths=(
                Length(key="radius", names=("a",), about="radius of the circle in the tube"),
                Length(key="tube_radius", names=("b",), about="radius of the tube"),
            ),
            form=_torus,
            larger=(("radius", "tube_radius"),),
        ),
        "tetrahedron": Shape(
            title="Tetrahedron",
            about="by its four corners",
            lengths=(
                Length(
                    key="corners",
                    names=tuple(f"{axis}_{k}" for k in range(4) for axis in "xyz"),
                    about="coordinate of a corner",
                ),
            ),
            form=_tetrahedron,
        ),
    }
)


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
    check_lengths(name, [float(e) if e.is_number else None for e in lengths])
    coordinates = free_coordinates(("u", "v", "w"), [*lengths, mass, density])
    chosen, place, bounds, element = shape.form(*coordinates, *lengths)
    return Solid(
        title=shape.title,
        coordinates=tuple(chosen),
        place=sp.ImmutableMatrix(place),
        bounds=tuple((sp.sympify(low), sp.sympify(high)) for low, high in bounds),
        element=element,
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


def free_coordinates(names: Sequence[str], used: Sequence[sp.Expr | None]) -> tuple[sp.Symbol, ...]:
    """Symbols of these names, with a number behind if an expression has the name already."""
    taken = {
        s.name for expression in used if expression is not None for s in expression.free_symbols
    }
    return tuple(
        sp.Symbol(next(n for n in (name, *(f"{name}_{k}" for k in range(1, 99))) if n not in taken))
        for name in names
    )
