"""What a derivation is about: its coordinates, its body, and the conditions that bind them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import sympy as sp

from rigidsym.formula.letters import Letters
from rigidsym.formula.reader import formula
from rigidsym.formula.scalars import formula_of
from rigidsym.formula.tree import Formula, equal
from rigidsym.mechanics.derivation import Derivation
from rigidsym.mechanics.quantities.energy import CENTRE
from rigidsym.mechanics.quantities.mass import MASS
from rigidsym.mechanics.quantities.table import is_quaternion
from rigidsym.notes.document import Text
from rigidsym.notes.letters import VECTOR
from rigidsym.notes.words import symbols_of, unit_in_words, with_symbols

COORDINATES = formula(r"\mathbf{q}")


@dataclass(frozen=True)
class ConventionFacts:
    """The coordinates, and which form of the rotation is shown."""

    derivation: Derivation
    letters: Letters

    @property
    def sentences(self) -> list[Text]:
        """What the model says of its coordinates."""
        symbols = symbols_of(self.derivation)
        return [with_symbols(words, symbols) for words in self.derivation.model.convention]

    @property
    def is_passive(self) -> bool:
        return self.derivation.model.passive

    @property
    def names(self) -> tuple[Formula, ...]:
        return self.derivation.argument("q").notation

    @property
    def has_several(self) -> bool:
        return len(self.names) > 1

    @property
    def unit(self) -> str:
        """The unit that all have in common."""
        first, *others = sorted(set(self.derivation.argument("q").units))
        return "" if others or not first else unit_in_words(first)

    @property
    def programs(self) -> tuple[str, ...]:
        """The names in programs, if those of the note are others."""
        q = self.derivation.argument("q")
        return q.names if is_quaternion(q.names, q.units) else ()

    @property
    def has_dots(self) -> bool:
        return self.letters.notation.rates == "dot"

    @property
    def conditions(self) -> list[Formula]:
        """What binds the coordinates and constants, which the proofs make use of."""
        pairs = (c.as_coeff_Add() for c in self.derivation.model.constraints)
        return [
            equal(formula_of(rest, self.letters), formula_of(-number, self.letters))
            for number, rest in pairs
        ]


@dataclass(frozen=True)
class LengthFacts:
    """The vector of the coordinates, and the letter for its length."""

    derivation: Derivation
    letters: Letters

    @property
    def is_vector_written(self) -> bool:
        return any(step.vector_form for step in self.derivation.steps)

    @property
    def components(self) -> tuple[sp.Expr, ...]:
        return self.derivation.model.vector

    @property
    def letter(self) -> Formula | None:
        return self._names[0] if self._names else None

    @property
    def rate(self) -> Formula:
        return self._names[1]

    @property
    def _names(self) -> list[Formula]:
        length = self.letters.length
        return [*length.names.values()] if length else []

    @property
    def of(self) -> Formula:
        """The vector, or all coordinates."""
        length = self.letters.length
        assert length is not None
        return VECTOR if length.components == self.components else COORDINATES


@dataclass(frozen=True)
class BodyFacts:
    """What the inertia tensor is about, and where the centre of mass is."""

    derivation: Derivation

    @property
    def is_about_fixed_point(self) -> bool:
        return self.derivation.about_fixed_point

    @property
    def is_centre_unused(self) -> bool:
        used = {name for step in self.derivation.steps for name in step.quantity.inputs}
        return bool(self.derivation.forces) and used.isdisjoint(("centre", "centre_dot"))

    @property
    def mass(self) -> Formula | sp.Expr:
        assert self.derivation.body is not None
        names = {step.quantity.name for step in self.derivation.steps}
        return MASS if "mass" in names else self.derivation.body.mass

    @property
    def centre(self) -> Formula:
        return CENTRE

    @property
    def place(self) -> tuple[Formula, ...]:
        return self.derivation.argument("centre").notation


def body_facts(derivation: Derivation) -> BodyFacts | None:
    return BodyFacts(derivation) if derivation.body is not None else None


def convention_facts(derivation: Derivation, letters: Letters) -> dict[str, Any]:
    """The facts of the template on conventions, by their names there."""
    return {
        "convention": ConventionFacts(derivation, letters),
        "length": LengthFacts(derivation, letters),
        "body": body_facts(derivation),
    }
