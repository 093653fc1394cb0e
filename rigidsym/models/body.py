"""Bodies as data: distributions of mass, and what follows of them: mass, centre, inertia tensor.

A distribution is particles, a solid, or a composition of parts.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import isfinite
from operator import index
from typing import Any

import sympy as sp
from sympy.core.function import AppliedUndef

from rigidsym.algebra.generators import not_exact
from rigidsym.errors import BodyError
from rigidsym.models.rotation import SOURCES, TIME, Citation, symbolic

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


Distribution = Particles | Solid | Composite | Known
KEYS: Mapping[type, str] = {  # of a [body] table, and of its parts
    Particles: "particles",
    Solid: "shape",
    Composite: "parts",
    Known: "inertia",
}


_MODULE_NAME = re.compile(r"[a-z][a-z0-9_]*")
_AXES = ("x", "y", "z")
SOURCE = SOURCES["Landau 32"]
ABOUT_FIXED_POINT = (
    "The body turns about a fixed point, which may be its centre of mass, and its inertia tensor "
    "is about this point, along the axes of the body."
)
_ROUNDING = 1e-12  # of the sum of the moments: what arithmetic in double precision leaves


@dataclass(frozen=True, kw_only=True, slots=True)
class Parameter:
    """A constant of a body: a mass, a length, a density, a moment of inertia."""

    symbol: sp.Symbol
    about: str = ""
    unit: str = ""  # SI; "" for a pure number
    positive: bool = True
    value: float | None = None  # where the body was given in numbers

    def __post_init__(self) -> None:
        if self.value is not None and self.positive and not self.value > 0:
            raise BodyError(
                f"{self.symbol}, {self.about or 'a parameter'}, is {self.value:g}; expected a "
                "positive number"
            )


@dataclass(frozen=True, kw_only=True, slots=True)
class RigidBody:
    """The mass, the centre of mass and the inertia tensor about it, in axes fixed in the body.

    The off-diagonal entries of the inertia tensor are the products of inertia with a minus sign
    (lecture, section 2.2). Raises BodyError for an unphysical body; `allow` accepts it.
    """

    name: str  # lower case, digits, underscores
    title: str  # "Solid cylinder"
    mass: sp.Expr  # kg
    inertia: sp.ImmutableMatrix  # (3, 3), about the centre of mass, kg m²
    centre: sp.ImmutableMatrix = field(default_factory=lambda: sp.ImmutableMatrix.zeros(3, 1))
    parameters: tuple[Parameter, ...] = ()  # every symbol above, in the order of kernels
    source: Citation = SOURCE
    declared: tuple[Parameter, ...] = ()  # descriptions, also of symbols that only forces hold
    allow: bool = False
    distribution: Distribution | None = None  # of its mass, if that is known
    drawn: Distribution | None = None  # its distribution, where only moments in numbers are kept
    request: Mapping[str, Any] = field(
        default_factory=dict, hash=False
    )  # what asks for it in a file

    def __post_init__(self) -> None:
        if not _MODULE_NAME.fullmatch(self.name):
            raise BodyError(
                f"{self.name!r} cannot name a body: expected lower-case letters, digits and "
                "underscores, beginning with a letter"
            )
        shapes = {
            "the inertia tensor": (self.inertia, (3, 3)),
            "the centre of mass": (self.centre, (3, 1)),
        }
        for what, (matrix, shape) in shapes.items():
            if matrix.shape != shape:
                raise BodyError(
                    f"{self.name}: expected {what} of shape {shape}, got {matrix.shape}"
                )
        self._check_symbols()
        self._check_symmetry()
        if not self.allow:
            mass = self.in_numbers(self.mass)
            if mass.is_number and not (isfinite(mass) and mass > 0):
                raise BodyError(
                    f"{self.name}: the mass is {float(mass):g} kg; expected a positive number"
                )
            inertia = self.in_numbers(self.inertia)
            if all(entry.is_number for entry in inertia):
                check_moments(self.name, inertia.tolist())

    def sentences(self, *, about_fixed_point: bool) -> tuple[str, ...]:
        """The body in plain sentences, to follow the convention of its rotation."""
        if about_fixed_point:
            return (f"{self.title}. {ABOUT_FIXED_POINT}",)
        return (
            f"{self.title}, of mass {self.mass}; its inertia tensor is about the centre of mass, "
            "along the axes of x′.",
            "The centre of mass is at r_C = (X, Y, Z) in space.",
        )

    @property
    def values(self) -> dict[sp.Symbol, sp.Float]:
        """The parameters with a value, and their values."""
        return {p.symbol: sp.Float(p.value, 17) for p in self.parameters if p.value is not None}

    def in_numbers(self, expression: Any) -> Any:
        """An expression or a matrix after the known values are substituted."""
        return expression.xreplace(self.values)

    def _check_symbols(self) -> None:
        known = {parameter.symbol for parameter in self.parameters}
        if len(known) != len(self.parameters):
            raise BodyError(f"{self.name}: a parameter is named twice")
        for entry in (self.mass, *self.inertia, *self.centre):
            if entry.has(TIME, AppliedUndef) or entry.has(sp.I, sp.nan, sp.oo, sp.zoo):
                raise BodyError(f"{self.name}: {entry} is not a real constant")
            for number in entry.atoms(sp.Float):
                raise BodyError(f"{self.name}: {not_exact(number)}")
            for symbol in sorted(entry.free_symbols - known, key=str):
                raise BodyError(f"{self.name}: {symbol} is not among the parameters")

    def _check_symmetry(self) -> None:
        for row, column in ((0, 1), (0, 2), (1, 2)):
            left = sp.expand(self.inertia[row, column] - self.inertia[column, row])
            if left != 0:
                places = _AXES[row] + _AXES[column], _AXES[column] + _AXES[row]
                value = self.in_numbers(left)
                raise BodyError(
                    f"{self.name}: the inertia tensor is not symmetric: I_{places[0]} − "
                    f"I_{places[1]} = {format(float(value), 'g') if value.is_Float else value}"
                )

    def __str__(self) -> str:
        return self.name


def check_moments(name: str, inertia: Sequence[Sequence[Any]]) -> None:
    """Raises BodyError for an inertia tensor in numbers, (3, 3), that no body has, with the amount.

    For a mass distribution that is nowhere negative, the moments are not negative and no moment
    is larger than the sum of the other two, since Ix + Iy − Iz = 2 Σ m z² (L. D. Landau and
    E. M. Lifshitz, Mechanics, section 32).
    """
    import numpy as np

    numbers = np.array(inertia, dtype=float)
    if not np.isfinite(numbers).all():
        raise BodyError(f"{name}: the inertia tensor holds NaN or infinity: {numbers.tolist()}")
    low, middle, high = map(float, np.linalg.eigvalsh(numbers))
    slack = _ROUNDING * max(-low, high)
    if low < -slack:
        raise BodyError(
            f"{name}: the inertia tensor is not positive: its smallest principal moment "
            f"is {low:.6g} kg m²"
        )
    if low + middle < high - slack:
        raise BodyError(
            f"{name}: no body has the principal moments {low:.6g}, {middle:.6g}, "
            f"{high:.6g} kg m²: the largest exceeds the sum of the others by "
            f"{high - low - middle:.6g} kg m²"
        )


@dataclass(frozen=True, kw_only=True, slots=True)
class BodyDescription:
    """A body as a file or a user describes it: its distribution of mass and its parameters.

    Nothing is integrated yet, so a description is cheap; `derive` makes a RigidBody of it.
    """

    distribution: Distribution
    name: str = "body"
    title: str = ""
    parameters: tuple[Parameter, ...] = ()  # what is known of the symbols
    allow: bool = False  # whether unphysical numbers pass
    keeps_numbers: bool = False  # whether sums of numbers stay sums, and are not rounded once
    request: Mapping[str, Any] = field(default_factory=dict, hash=False)


def principal_moments(
    A: sp.Expr,
    B: sp.Expr,
    C: sp.Expr,
    *,
    mass: sp.Expr | None = None,
    name: str = "body",
    parameters: Sequence[Parameter] = (),
    allow: bool = False,
) -> RigidBody:
    """A body given by its principal moments A, B, C (kg m²), along its principal axes.

    The moments are about the centre of mass, or about the fixed point if there are forces. The
    mass is the symbol M by default. `parameters` describes further symbols. Raises BodyError.
    """
    moments = [symbolic(moment, "a principal moment") for moment in (A, B, C)]
    total = sp.Symbol("M") if mass is None else symbolic(mass, "the mass")
    kinds = {1: "Spherical body", 2: "Symmetric body", 3: "Body in its principal axes"}
    return RigidBody(
        name=name,
        title=kinds[len(set(moments))],
        mass=total,
        inertia=sp.ImmutableMatrix(sp.diag(*moments)),
        parameters=described(
            parameters, (total, "mass"), *((m, "principal moment of inertia") for m in moments)
        ),
        declared=tuple(parameters),
        allow=allow,
    )


def general_inertia(*, mass: sp.Expr | None = None, name: str = "body") -> RigidBody:
    """A body with a general inertia tensor: the symbols I_11, I_12, I_13, I_22, I_23, I_33."""
    total = sp.Symbol("M") if mass is None else symbolic(mass, "the mass")
    entries = sp.ImmutableMatrix(3, 3, lambda i, j: sp.Symbol(f"I_{min(i, j) + 1}{max(i, j) + 1}"))
    return given_inertia(entries, mass=total, name=name)


def given_inertia(
    inertia: sp.MatrixBase,
    *,
    mass: sp.Expr,
    centre: sp.MatrixBase | None = None,
    name: str = "body",
    parameters: Sequence[Parameter] = (),
    allow: bool = False,
) -> RigidBody:
    """A body by its inertia tensor about the centre of mass, (3, 3), in kg m². Raises BodyError."""
    place = sp.ImmutableMatrix.zeros(3, 1) if centre is None else sp.ImmutableMatrix(centre)
    return RigidBody(
        name=name,
        title="Body with a given inertia tensor",
        mass=mass,
        inertia=sp.ImmutableMatrix(inertia),
        centre=place,
        parameters=described(
            parameters,
            (mass, "mass"),
            *zip(inertia, _ENTRIES, strict=True),
            *((entry, "coordinate of the centre of mass") for entry in place),
        ),
        declared=tuple(parameters),
        allow=allow,
    )


_UNITS = {
    "mass": "kg",
    "principal moment of inertia": "kg m^2",
    "moment of inertia": "kg m^2",
    "product of inertia, with its sign": "kg m^2",
    "coordinate of the centre of mass": "m",
}
_MOMENT, _PRODUCT = "moment of inertia", "product of inertia, with its sign"
_ENTRIES = (*(_MOMENT, _PRODUCT, _PRODUCT, _PRODUCT) * 2, _MOMENT)  # row by row
_SIGNED = {_PRODUCT, "coordinate of the centre of mass"}


def described(given: Sequence[Parameter], *slots: tuple[sp.Expr, str]) -> tuple[Parameter, ...]:
    """The parameters of all expressions, in the order of their places.

    What is `given` goes before; a symbol that stands alone in its place is described by it.
    """
    declared = {parameter.symbol: parameter for parameter in given}
    parameters: dict[sp.Symbol, Parameter] = {}
    for expression, what in slots:
        for symbol in sorted(expression.free_symbols, key=str):
            about = what if expression == symbol else ""
            is_positive = bool(about) and about not in _SIGNED
            own = declared.get(symbol) or parameters.get(symbol) or Parameter(symbol=symbol)
            if symbol not in declared:
                known = symbol in parameters and own.positive
                own = replace(own, positive=known or is_positive)
            parameters[symbol] = replace(
                own, about=own.about or about, unit=own.unit or _UNITS.get(about, "")
            )
    return tuple(parameters.values())
