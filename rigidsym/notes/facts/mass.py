"""How the mass of a body is spread, and its values in numbers."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import groupby
from typing import NamedTuple

import sympy as sp

from rigidsym.data.mass import MassProperties
from rigidsym.formula.letters import Letters
from rigidsym.formula.reader import formula
from rigidsym.formula.scalars import formula_of
from rigidsym.formula.tree import NOTHING, Big, Differential, Formula, bracketed, row
from rigidsym.mechanics.derivation import Derivation
from rigidsym.mechanics.mass.moments import moments_of
from rigidsym.mechanics.mass.numbers import in_numbers
from rigidsym.mechanics.quantities.mass import PLACE
from rigidsym.models.body import (
    UPRIGHT,
    Composite,
    Known,
    Particle,
    Particles,
    Polyhedron,
    RigidBody,
    Solid,
)
from rigidsym.notes.document import Equation
from rigidsym.notes.words import unit_in_words

_DIGITS = 6
_KINDS = {
    Particles: "particles",
    Composite: "composite",
    Polyhedron: "polyhedron",
    Known: "measured",
}


class NamedFacts(NamedTuple):
    """Letters of the body that mean the same."""

    symbols: tuple[sp.Symbol, ...]
    about: str

    @property
    def are_moments(self) -> bool:
        return len(self.symbols) > 1


class PartFacts(NamedTuple):
    """A part of a composite body."""

    name: str
    kind: str
    mass: sp.Expr
    at: Sequence[sp.Expr]
    is_hole: bool
    is_turned: bool


class ValueFacts(NamedTuple):
    """A parameter in numbers."""

    symbol: sp.Symbol
    about: str
    value: str
    unit: str


class AxisFacts(NamedTuple):
    """A principal axis in numbers."""

    moment: str
    radius: str
    components: tuple[str, ...]


@dataclass(frozen=True)
class SolidFacts:
    """The map, its bounds, the element and the integrals of a solid."""

    solid: Solid
    letters: Letters
    label: str = ""

    @property
    def name(self) -> str:
        return self.label or self.solid.title.lower()

    @property
    def map(self) -> Equation:
        return Equation(sides=(PLACE,), matrix=self.solid.place)

    @property
    def bounds(self) -> list[Formula]:
        pairs = zip(self.solid.coordinates, self.solid.bounds, strict=True)
        return [
            formula(r"#1 \le #2 \le #3", *(formula_of(x, self.letters) for x in (low, u, high)))
            for u, (low, high) in pairs
        ]

    @property
    def is_of_volume(self) -> bool:
        return len(self.solid.coordinates) == 3

    @property
    def is_of_area(self) -> bool:
        return len(self.solid.coordinates) == 2

    @property
    def element(self) -> Formula:
        """The element of volume, area or length: r dr dφ dz."""
        factor = [formula_of(self._factor, self.letters)] if self.has_factor else []
        return row(*factor, *self._differentials(self.solid.coordinates))

    @property
    def has_factor(self) -> bool:
        return bool(self._factor != 1)

    @cached_property
    def _factor(self) -> sp.Expr:
        element = moments_of(self.solid).element
        assert element is not None
        return sp.factor(element)

    @property
    def mass(self) -> sp.Expr | None:
        """The mass of a body of uniform density."""
        return self.solid.mass

    @property
    def integral(self) -> Equation:
        """The integral of the density, or of the element alone, and what it comes to."""
        solid, letters = self.solid, self.letters
        density = sp.S.One if solid.density is None else solid.density
        value = density * self._factor
        integrand = NOTHING if value == 1 else bracketed(formula_of(value, letters))
        bounds = (
            (formula_of(low, letters), formula_of(high, letters)) for low, high in solid.bounds
        )
        signs = (Big("∫", low, high) for low, high in bounds)
        spread = self._differentials(solid.coordinates[::-1])
        plain = solid if solid.mass is None else replace(solid, mass=None, density=sp.S.One)
        total = formula_of(moments_of(plain).mass, letters)
        return Equation(sides=(row(*signs, integrand, *spread), total))

    def _differentials(self, coordinates: Sequence[sp.Symbol]) -> list[Formula]:
        """du dv dw."""
        return [x for u in coordinates for x in (Differential(), formula_of(u, self.letters))]


@dataclass(frozen=True)
class MassFacts:
    """The distribution of the mass, and the parameters of the body."""

    derivation: Derivation
    body: RigidBody
    letters: Letters

    @property
    def named(self) -> list[NamedFacts]:
        """What the letters of the body are; those with a value are in the table of numbers.

        The mass of a body on which forces act may not be in any equation.
        """
        told = [p for p in self.body.parameters if p.about and p.value is None]
        if self.derivation.forces is not None:
            shown = [step.expression for step in self.derivation.steps]
            told = [p for p in told if any(entry.has(p.symbol) for entry in shown)]
        kinds = []
        for about, alike in groupby(told, key=lambda p: p.about):
            symbols = tuple(p.symbol for p in alike)
            are_moments = about == "principal moment of inertia"
            groups = [symbols] if are_moments else [(symbol,) for symbol in symbols]
            kinds += [NamedFacts(group, about) for group in groups]
        return kinds

    @property
    def parts(self) -> list[PartFacts]:
        distribution = self.body.distribution
        parts = distribution.parts if isinstance(distribution, Composite) else ()
        return [
            PartFacts(
                part.label,
                part.what.title if isinstance(part.what, Solid) else _KINDS[type(part.what)],
                moments_of(part.what).mass,
                part.at,
                part.hole,
                part.turned != UPRIGHT,
            )
            for part in parts
        ]

    @property
    def particles(self) -> Sequence[Particle]:
        distribution = self.body.distribution
        return distribution.particles if isinstance(distribution, Particles) else ()

    @property
    def has_plane_faces(self) -> bool:
        return isinstance(self.body.distribution, Polyhedron)

    @property
    def solids(self) -> Iterator[SolidFacts]:
        """The body, or the first part of each kind."""
        distribution = self.body.distribution
        if isinstance(distribution, Solid):
            yield SolidFacts(distribution, self.letters)
        parts = distribution.parts if isinstance(distribution, Composite) else ()
        shown: set[str] = set()
        for part in parts:
            if isinstance(part.what, Solid) and part.what.title not in shown:
                shown.add(part.what.title)
                yield SolidFacts(part.what, self.letters, part.label)

    @property
    def values(self) -> list[ValueFacts]:
        return [
            ValueFacts(p.symbol, p.about, number(p.value), unit_in_words(p.unit))
            for p in self.body.parameters
            if p.value is not None
        ]

    @property
    def principal(self) -> list[AxisFacts]:
        """In ascending order of the moments."""
        if self._in_numbers is None:
            return []
        principal = self._in_numbers.principal
        axes = zip(principal.moments, self._in_numbers.radii, principal.axes.T, strict=True)
        return [
            AxisFacts(
                number(float(moment)),
                number(float(radius)),
                tuple(number(float(part)) for part in axis),
            )
            for moment, radius, axis in axes
        ]

    @property
    def repeated(self) -> str:
        """What is said of equal moments."""
        return self._in_numbers.principal.repeated if self._in_numbers is not None else ""

    @cached_property
    def _in_numbers(self) -> MassProperties | None:
        return in_numbers(self.body)


def number(value: float) -> str:
    """A number as a reader wants it."""
    return f"{value + 0.0:.{_DIGITS}g}".replace("-", "−")


def lines_of_body(derivation: Derivation, letters: Letters) -> Iterator[str]:
    """For a terminal: the values, and the principal axes in numbers."""
    body = derivation.body
    if body is None:
        return
    for p in body.parameters:
        if p.value is not None:
            unit = f" {unit_in_words(p.unit)}" if p.unit else ""
            about = f"   {p.about}" if p.about else ""
            yield f"{formula_of(p.symbol, letters).text} = {number(p.value)}{unit}{about}"
    found = in_numbers(body)
    if found is None:
        return
    principal = found.principal  # ascending, which the numbers of a formula's moments need not be
    for moment, axis in zip(principal.moments, principal.axes.T, strict=True):
        along = ", ".join(number(float(part)) for part in axis)
        yield f"principal moment {number(float(moment))} kg m² about ({along})"
    if principal.repeated:
        yield principal.repeated
