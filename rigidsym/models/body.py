"""Bodies as data: distributions of mass, and what follows of them: mass, centre, inertia tensor.

A distribution is particles, a solid, or a composition of parts.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import combinations
from math import isfinite
from typing import Any, ClassVar

import sympy as sp
from sympy.core.function import AppliedUndef

from rigidsym.algebra.generators import not_exact
from rigidsym.errors import BodyError
from rigidsym.models.rotation import SOURCES, TIME, WORDS, Citation, symbolic
from rigidsym.system.records import Record
from rigidsym.text.names import A_MODULE_NAME, MODULE_NAME

Bounds = tuple[sp.Expr, sp.Expr]
HERE = sp.ImmutableMatrix.zeros(3, 1)
UPRIGHT = sp.ImmutableMatrix(sp.eye(3))


class Particle(Record, kw_only=True):
    """A point mass, in kg, at a position (3, 1), in m."""

    mass: sp.Expr
    position: sp.ImmutableMatrix

    def __post_init__(self) -> None:
        if len(self.position) != 3:
            raise BodyError(f"a position has three components, got {len(self.position)}")


class Particles(Record, kw_only=True):
    """A rigid set of point masses."""

    particles: tuple[Particle, ...]

    def __post_init__(self) -> None:
        if not self.particles:
            raise BodyError("expected at least one particle")
        for particle in self.particles:
            if not isinstance(particle, Particle):
                raise BodyError(f"expected an rs.Particle, got {particle!r}")


class Solid(Record, kw_only=True):
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
        # A volume element follows from the map, du dv dw |det ∂x/∂(u, v, w)|. The element of a
        # surface is the root of a Gram determinant, whose short form is better given and then
        # proved.
        if (count == 3) == (self.element is not None):
            raise BodyError(f"{self.title}: lines and surfaces have an element, volumes have none")
        if (self.mass is None) == (self.density is None):
            raise BodyError(f"{self.title}: expected either the mass or the density")
        for place, pair in enumerate(self.bounds):
            # The last coordinate is integrated first, so its bounds may hold all those before it,
            # as in 0 ≤ v ≤ 1 − u for a triangle, and never those behind.
            later = set(self.coordinates[place:])
            for bound in pair:
                if bound.free_symbols & later:
                    raise BodyError(
                        f"{self.title}: the bounds of {self.coordinates[place]} contain "
                        f"{', '.join(map(str, bound.free_symbols & later))}; expected only "
                        "coordinates before it"
                    )


class Part(Record, kw_only=True):
    """A part of a composite body: turned about its origin, then moved by `at`."""

    what: Distribution
    at: sp.ImmutableMatrix = HERE  # (3, 1), m
    turned: sp.ImmutableMatrix = UPRIGHT  # R, from the axes of the part to those of the whole
    hole: bool = False  # its mass is taken away
    label: str = ""


class Composite(Record, kw_only=True):
    """A body composed of parts."""

    parts: tuple[Part, ...]

    def __post_init__(self) -> None:
        if not self.parts:
            raise BodyError("expected at least one part")


class Known(Record):
    """A part of which only mass, centre and inertia tensor about the centre are given."""

    mass: sp.Expr
    centre: sp.ImmutableMatrix
    inertia: sp.ImmutableMatrix


Distribution = Particles | Solid | Composite | Known
KEYS: Mapping[type, str] = {  # of a [body] table, and of its parts
    Particles: "particles",
    Solid: "shape",
    Composite: "parts",
    Known: "inertia",
}


SOURCE = SOURCES["Landau 32"]
PHRASES = WORDS["bodies"]
PRODUCT, COORDINATE = PHRASES["product_of_inertia"], PHRASES["coordinate_of_centre"]
_ROUNDING = 1e-12  # of the sum of the moments: what arithmetic in double precision leaves


class Parameter(Record, kw_only=True):
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

    def described_by(self, about: str) -> Parameter:
        """With a meaning, and its unit, if it has none of its own."""
        unit = self.unit or _UNITS.get(about, "")
        return replace(self, about=self.about or about, unit=unit)


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
    centre: sp.ImmutableMatrix = HERE  # (3, 1), m
    fixed_point: sp.ImmutableMatrix | None = None  # (3, 1), m; if stated, `inertia` is about it
    central: sp.ImmutableMatrix | None = None  # the tensor about the centre of mass, then
    parameters: tuple[Parameter, ...] = ()  # every symbol above, in the order of kernels
    source: Citation = SOURCE
    declared: tuple[Parameter, ...] = ()  # descriptions, also of symbols that only forces hold
    allow: bool = False
    distribution: Distribution | None = None  # of its mass, if that is known
    drawn: Distribution | None = None  # its distribution, where only moments in numbers are kept
    example: Mapping[str, float] = field(default_factory=dict, hash=False)  # values, for figures
    request: Mapping[str, Any] = field(default_factory=dict, hash=False)  # its tables in a file

    def __post_init__(self) -> None:
        if not MODULE_NAME.fullmatch(self.name):
            raise BodyError(f"{self.name!r} cannot name a body or its file: {A_MODULE_NAME}")
        try:
            self._check()
        except BodyError as error:
            raise BodyError(f"{self.name}: {error}") from None
        # The inequalities between the moments are decided in numbers only: with symbols they hold
        # for some values and fail for others. A sign is decided by the signs of the parameters.
        inertia = self.in_numbers(self.inertia)
        if not self.allow and all(entry.is_number for entry in inertia):
            check_moments(self.name, inertia.tolist())
        positive = {p.symbol: sp.Dummy(positive=True) for p in self.parameters if p.positive}
        moments = [(f"I_{axis}{axis}", self.inertia[k, k]) for k, axis in enumerate("xyz")]
        for what, entry in (("the mass", self.mass), *moments):
            if not self.allow and entry.xreplace(positive).is_negative:
                raise BodyError(f"{self.name}: {what} is {entry}, which is negative")

    def _check(self) -> None:
        """Raises BodyError for what is wrong; each check relies on those before it."""
        for what, matrix, shape in (
            ("the inertia tensor", self.inertia, (3, 3)),
            ("the centre of mass", self.centre, (3, 1)),
        ):
            if matrix.shape != shape:
                raise BodyError(f"expected {what} of shape {shape}, got {matrix.shape}")
        symbols = {parameter.symbol for parameter in self.parameters}
        if len(symbols) != len(self.parameters):
            raise BodyError("a parameter is named twice")
        for entry in (self.mass, *self.inertia, *self.centre, *(self.fixed_point or ())):
            if entry.has(TIME, AppliedUndef) or entry.has(sp.I, sp.nan, sp.oo, sp.zoo):
                raise BodyError(f"{entry} is not a real constant")
            for number in entry.atoms(sp.Float):
                raise BodyError(str(not_exact(number)))
            for symbol in sorted(entry.free_symbols - symbols, key=str):
                raise BodyError(f"{symbol} is not among the parameters")
        for i, j in combinations(range(3), 2):
            residual = sp.expand(self.inertia[i, j] - self.inertia[j, i])
            if residual != 0:
                value = self.in_numbers(residual)
                places = f"I_{'xyz'[i]}{'xyz'[j]} − I_{'xyz'[j]}{'xyz'[i]}"
                amount = f"{float(value):g}" if value.is_Float else value
                raise BodyError(f"the inertia tensor is not symmetric: {places} = {amount}")
        mass = self.in_numbers(self.mass)
        if not self.allow and mass.is_number and not (isfinite(mass) and mass > 0):
            raise BodyError(f"the mass is {float(mass):g} kg; expected a positive number")

    def sentences(self, *, about_fixed_point: bool) -> tuple[str, ...]:
        """The body in plain sentences, to follow the convention of its rotation."""
        if about_fixed_point:
            return (PHRASES["with_fixed_point"].format(title=self.title),)
        return PHRASES["free"].format(title=self.title, mass=self.mass), PHRASES["centre"]

    @property
    def as_described(self) -> RigidBody:
        """The body before a derivation took its tensor about a fixed point."""
        if self.central is None:
            return self
        return replace(self, inertia=self.central, central=None, fixed_point=None)

    @property
    def is_tensor(self) -> bool:
        """Whether only a tensor is described, and neither its mass nor a centre of mass."""
        has_centre = any(self.centre) or "centre" in self.request.get("body", ())
        return not (self.distribution or self.drawn or has_centre)

    @property
    def values(self) -> dict[sp.Symbol, sp.Float]:
        """The parameters with a value, and their values."""
        return {p.symbol: sp.Float(p.value, 17) for p in self.parameters if p.value is not None}

    def in_numbers(self, expression: Any) -> Any:
        """An expression or a matrix after the known values are substituted."""
        return expression.xreplace(self.values)

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
    # The principal moments, in ascending order. Of the three triangle inequalities Ix + Iy ≥ Iz
    # only the one for the largest can fail. Equality holds for a plate, so rounding needs some
    # slack.
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
    is_tensor: ClassVar[bool] = False


Body = RigidBody | BodyDescription | Distribution  # what `derive` takes


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

    The moments are about the centre of mass; with forces and without a stated fixed point, they are
    about the fixed point. The mass is the symbol M by default. `parameters` describes further
    symbols. Raises BodyError.
    """
    moments = [symbolic(moment, "a principal moment") for moment in (A, B, C)]
    return given_inertia(
        sp.diag(*moments),
        mass=mass,
        name=name,
        parameters=parameters,
        allow=allow,
        title=PHRASES[("spherical", "symmetric", "in_principal_axes")[len(set(moments)) - 1]],
        moment="principal moment of inertia",
    )


def general_inertia(*, mass: sp.Expr | None = None, name: str = "body") -> RigidBody:
    """A body with a general inertia tensor: the symbols I_11, I_12, I_13, I_22, I_23, I_33."""
    entries = sp.ImmutableMatrix(3, 3, lambda i, j: sp.Symbol(f"I_{min(i, j) + 1}{max(i, j) + 1}"))
    return given_inertia(entries, mass=mass, name=name)


def given_inertia(
    inertia: sp.MatrixBase,
    *,
    mass: sp.Expr | None = None,
    centre: sp.MatrixBase = HERE,
    name: str = "body",
    parameters: Sequence[Parameter] = (),
    allow: bool = False,
    title: str = PHRASES["by_tensor"],
    moment: str = "moment of inertia",
) -> RigidBody:
    """A body by its inertia tensor about the centre of mass, (3, 3), in kg m². Raises BodyError.

    `moment` is the meaning of the symbols on the diagonal.
    """
    mass = sp.Symbol("M") if mass is None else symbolic(mass, "the mass")
    # Entries 0, 4 and 8 of nine are the diagonal.
    meanings = [moment if k % 4 == 0 else PRODUCT for k in range(9)]  # row by row
    return RigidBody(
        name=name,
        title=title,
        mass=mass,
        inertia=sp.ImmutableMatrix(inertia),
        centre=sp.ImmutableMatrix(centre),
        parameters=described(
            parameters,
            (mass, "mass"),
            *zip(inertia, meanings, strict=True),
            *((entry, COORDINATE) for entry in centre),
        ),
        declared=tuple(parameters),
        allow=allow,
    )


_UNITS = {
    "mass": "kg",
    "mass of a particle": "kg",
    "principal moment of inertia": "kg m^2",
    "moment of inertia": "kg m^2",
    PRODUCT: "kg m^2",
    COORDINATE: "m",
}


def described(known: Sequence[Parameter], *slots: tuple[sp.Expr, str]) -> tuple[Parameter, ...]:
    """The parameters of all expressions, in the order of their places.

    Those `known` take precedence; otherwise, a symbol that is a whole expression is described by
    the words beside it.
    """
    declared = {parameter.symbol: parameter for parameter in known}
    parameters: dict[sp.Symbol, Parameter] = {}
    for expression, what in slots:
        for symbol in sorted(expression.free_symbols, key=str):
            about = what if expression == symbol else ""
            own = declared.get(symbol) or parameters.get(symbol)
            own = own or Parameter(symbol=symbol, positive=False)
            # A mass or a moment that is a symbol by itself is positive. Products of inertia and
            # coordinates have any sign, and so have symbols inside larger expressions.
            is_signed = about in ("", PRODUCT, COORDINATE)
            if symbol not in declared and not is_signed:
                own = replace(own, positive=True)
            parameters[symbol] = own.described_by(about)
    return tuple(parameters.values())
