"""How the mass of a body is spread, and its values in numbers."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property
from itertools import groupby
from typing import Any

import sympy as sp

from rigidsym.data.mass import MassProperties
from rigidsym.formula.letters import Letters
from rigidsym.formula.reader import decimal
from rigidsym.formula.scalars import formula_of
from rigidsym.formula.tree import equal
from rigidsym.mechanics.derivation import Derivation
from rigidsym.mechanics.mass.bodies import in_numbers
from rigidsym.mechanics.mass.moments import moments_of
from rigidsym.models import body as bodies
from rigidsym.notes.document import Figure
from rigidsym.notes.figure.body_drawing import body_drawing
from rigidsym.notes.figure.body_mesh import lengths_in, numbers_of
from rigidsym.notes.template import figure_with
from rigidsym.notes.words import number, unit_in_words
from rigidsym.system.records import Record

_KINDS = {bodies.Particles: "particles", bodies.Composite: "composite", bodies.Known: "measured"}


class MassFacts(Record):
    """The distribution of the mass, and the parameters of the body."""

    derivation: Derivation
    body: bodies.RigidBody
    letters: Letters

    @cached_property
    def figure(self) -> Figure | None:
        """The body with its principal axes; None where its shape is not known."""
        drawn = body_drawing(self.derivation)
        if drawn is None:
            return None
        drawing, are_own = drawn
        of_all = {p.symbol: p.value for p in (*self.body.declared, *self.body.parameters)}
        numbers = numbers_of(self.body) or {}
        free = [s for s in numbers if s in lengths_in(self.body) and of_all.get(s) is None]
        return figure_with(
            "en/body_figure",
            drawing,
            self.letters,
            axes=[label.symbol for label in drawing.labels],
            are_own=are_own,
            is_fixed=self.body.fixed_point is not None,
            is_to_scale=self.body.distribution is not None,
            lengths=[equal(formula_of(s, self.letters), decimal(float(numbers[s]))) for s in free],
        )

    @property
    def named(self) -> list[tuple[str, list[sp.Symbol], list[str]]]:
        """Meanings with the letters of the body; those with a value are in the table of numbers.

        A letter that shares its meaning with others comes with its parts of the body. The mass of a
        body on which forces act may not be in any equation.
        """
        told = [p for p in self.body.parameters if p.about and p.value is None]
        if self.derivation.forces is not None:
            expressions = [sp.Tuple(*step.expression) for step in self.derivation.steps]
            expressions += [integral.expression for integral in self.derivation.first_integrals]
            told = [p for p in told if any(entry.has(p.symbol) for entry in expressions)]
        groups = []
        for about, alike in groupby(told, key=lambda p: p.about):
            symbols = [p.symbol for p in alike]
            apart = [symbols] if about == "principal moment of inertia" else [[s] for s in symbols]
            is_shared = sum(p.about == about for p in told) > len(apart[0])
            groups += [(about, s, self._parts_with(s[0]) if is_shared else []) for s in apart]
        return groups

    def _parts_with(self, symbol: sp.Symbol) -> list[str]:
        """The parts that the symbol belongs to: their labels or kinds, with numbers if alike."""
        names = [part["of"].label or part["name"].lower() for part in self.parts]
        return [
            name if names.count(name) == 1 else f"{name} (part {k})"
            for k, (name, part) in enumerate(zip(names, self._parts, strict=True), start=1)
            if moments_of(part.what).matrix.has(symbol)
        ]

    @property
    def parts(self) -> list[dict[str, Any]]:
        return [
            {
                "of": part,
                "name": what.title if isinstance(what, bodies.Solid) else _KINDS[type(what)],
                "mass": moments_of(what).mass,
                "is_turned": part.turned != bodies.UPRIGHT,
            }
            for part, what in ((part, part.what) for part in self._parts)
        ]

    @property
    def _parts(self) -> tuple[bodies.Part, ...]:
        distribution = self.body.distribution
        return tuple(distribution.parts) if isinstance(distribution, bodies.Composite) else ()

    @property
    def particles(self) -> tuple[bodies.Particle, ...]:
        distribution = self.body.distribution
        return tuple(distribution.particles) if isinstance(distribution, bodies.Particles) else ()

    @property
    def solids(self) -> list[tuple[str, bodies.Solid]]:
        """The body, or the first part of each kind, with its name."""
        whole = self.body.distribution
        named = [("", whole), *((part.label, part.what) for part in self._parts)]
        firsts: dict[str, tuple[str, bodies.Solid]] = {}
        for label, what in named:
            if isinstance(what, bodies.Solid):
                firsts.setdefault(what.title, (label or what.title.lower(), what))
        return [*firsts.values()]

    @property
    def principal(self) -> list[dict[str, Any]]:
        """In ascending order of the moments, which need not be that of the formulas."""
        if self.numbers is None:
            return []
        moments, axes = self.numbers.principal.moments, self.numbers.principal.axes.T
        return [
            {"moment": number(moment), "radius": number(radius), "components": [*map(number, axis)]}
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
            about = ", ".join(axis["components"])
            yield f"principal moment {axis['moment']} kg m² about ({about})"
