"""How the mass of a body is spread, and its values in numbers."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import groupby
from typing import NamedTuple

import sympy as sp

from rigidsym.data.mass import MassProperties
from rigidsym.formula.letters import Letters
from rigidsym.formula.reader import decimal
from rigidsym.formula.scalars import formula_of
from rigidsym.formula.tree import NOTHING, Big, Differential, Formula, bracketed, equal, row
from rigidsym.mechanics.derivation import Derivation
from rigidsym.mechanics.mass.bodies import in_numbers
from rigidsym.mechanics.mass.moments import moments_of
from rigidsym.models.body import (
    UPRIGHT,
    Composite,
    Known,
    Part,
    Particle,
    Particles,
    RigidBody,
    Solid,
)
from rigidsym.notes.document import Figure
from rigidsym.notes.figure.body_drawing import body_drawing
from rigidsym.notes.figure.body_mesh import lengths_of
from rigidsym.notes.template import figure_with
from rigidsym.notes.words import number, unit_in_words

_KINDS = {
    Particles: "particles",
    Composite: "composite",
    Known: "measured",
}


class PartFacts(NamedTuple):
    """A part of a composite body."""

    of: Part
    name: str
    mass: sp.Expr
    is_turned: bool


class AxisFacts(NamedTuple):
    """A principal axis in numbers."""

    moment: str
    radius: str
    components: list[str]


@dataclass(frozen=True)
class SolidFacts:
    """The map of a solid, the element of its volume, area or length, and its integral."""

    solid: Solid
    letters: Letters
    label: str = ""

    @property
    def is_of_volume(self) -> bool:
        return len(self.solid.coordinates) == 3

    @property
    def is_of_area(self) -> bool:
        return len(self.solid.coordinates) == 2

    @cached_property
    def factor(self) -> sp.Expr:
        element = moments_of(self.solid).element
        assert element is not None
        return sp.factor(element)

    @property
    def element(self) -> Formula:
        """The element of volume, area or length: r dr dφ dz."""
        factor = [formula_of(self.factor, self.letters)] if self.factor != 1 else []
        return row(*factor, *self._differentials(self.solid.coordinates))

    @property
    def integral(self) -> Formula:
        """The integral of the density, or of the element alone, and its value."""
        solid, letters = self.solid, self.letters
        value = (sp.S.One if solid.density is None else solid.density) * self.factor
        integrand = NOTHING if value == 1 else bracketed(formula_of(value, letters))
        signs = (Big("∫", *(formula_of(end, letters) for end in ends)) for ends in solid.bounds)
        spread = self._differentials(solid.coordinates[::-1])
        plain = solid if solid.mass is None else replace(solid, mass=None, density=sp.S.One)
        total = formula_of(moments_of(plain).mass, letters)
        return equal(row(*signs, integrand, *spread), total)

    def _differentials(self, coordinates: tuple[sp.Symbol, ...]) -> list[Formula]:
        """du dv dw."""
        return [x for u in coordinates for x in (Differential(), formula_of(u, self.letters))]


@dataclass(frozen=True)
class MassFacts:
    """The distribution of the mass, and the parameters of the body."""

    derivation: Derivation
    body: RigidBody
    letters: Letters

    @property
    def figure(self) -> Figure | None:
        """The body with its principal axes; None where its shape is not known."""
        drawn = body_drawing(self.derivation)
        if drawn is None:
            return None
        drawing, are_own = drawn
        values = {p.symbol: p.value for p in self.body.parameters}
        numbers = lengths_of(self.body.distribution, values) if self.body.distribution else None
        return figure_with(
            "en/body_figure",
            drawing,
            self.letters,
            axes=[label.symbol for label in drawing.labels],
            are_own=are_own,
            is_to_scale=self.body.distribution is not None,
            lengths=[  # that were chosen for the drawing
                equal(formula_of(symbol, self.letters), decimal(float(number)))
                for symbol, number in (numbers or {}).items()
                if values.get(symbol) is None
            ],
        )

    @property
    def named(self) -> list[tuple[str, list[sp.Symbol]]]:
        """Meanings with the letters of the body; those with a value are in the table of numbers.

        The mass of a body on which forces act may not be in any equation.
        """
        told = [p for p in self.body.parameters if p.about and p.value is None]
        if self.derivation.forces is not None:
            shown = [step.expression for step in self.derivation.steps]
            told = [p for p in told if any(entry.has(p.symbol) for entry in shown)]
        groups = []
        for about, alike in groupby(told, key=lambda p: p.about):
            symbols = [p.symbol for p in alike]
            apart = [symbols] if about == "principal moment of inertia" else [[s] for s in symbols]
            groups += [(about, same) for same in apart]
        return groups

    @property
    def parts(self) -> list[PartFacts]:
        return [
            PartFacts(
                part,
                part.what.title if isinstance(part.what, Solid) else _KINDS[type(part.what)],
                moments_of(part.what).mass,
                part.turned != UPRIGHT,
            )
            for part in self._parts
        ]

    @property
    def _parts(self) -> tuple[Part, ...]:
        distribution = self.body.distribution
        return tuple(distribution.parts) if isinstance(distribution, Composite) else ()

    @property
    def particles(self) -> tuple[Particle, ...]:
        distribution = self.body.distribution
        return tuple(distribution.particles) if isinstance(distribution, Particles) else ()

    @property
    def solids(self) -> list[SolidFacts]:
        """The body, or the first part of each kind."""
        distribution = self.body.distribution
        if isinstance(distribution, Solid):
            return [SolidFacts(distribution, self.letters)]
        firsts: dict[str, SolidFacts] = {}
        for part in self._parts:
            if isinstance(part.what, Solid):
                facts = SolidFacts(part.what, self.letters, part.label)
                firsts.setdefault(part.what.title, facts)
        return [*firsts.values()]

    @property
    def principal(self) -> list[AxisFacts]:
        """In ascending order of the moments, which need not be that of the formulas."""
        if self.numbers is None:
            return []
        moments, axes = self.numbers.principal.moments, self.numbers.principal.axes.T
        return [
            AxisFacts(number(moment), number(radius), list(map(number, axis)))
            for moment, radius, axis in zip(moments, self.numbers.radii, axes, strict=True)
        ]

    @cached_property
    def numbers(self) -> MassProperties | None:
        return in_numbers(self.body)

    def lines(self) -> Iterator[str]:
        """For a terminal: the values, and the principal axes in numbers."""
        for p in self.body.parameters:
            if p.value is not None:
                unit = f" {unit_in_words(p.unit)}" if p.unit else ""
                about = f"   {p.about}" if p.about else ""
                yield f"{formula_of(p.symbol, self.letters).text} = {number(p.value)}{unit}{about}"
        for axis in self.principal:
            yield f"principal moment {axis.moment} kg m² about ({', '.join(axis.components)})"
        if self.numbers and self.numbers.principal.repeated:
            yield self.numbers.principal.repeated


def mass_facts(derivation: Derivation, letters: Letters) -> MassFacts | None:
    return None if derivation.body is None else MassFacts(derivation, derivation.body, letters)
