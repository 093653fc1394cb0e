"""What is constant along a motion, what follows from it, and the pictures of its examples."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from dataclasses import dataclass
from functools import reduce

import sympy as sp

from rigidsym.errors import MissingExtra
from rigidsym.formula.letters import Letters
from rigidsym.formula.reader import decimal, formula
from rigidsym.formula.scalars import formula_of
from rigidsym.formula.tree import Formula, equal
from rigidsym.mechanics.derivation import Consequence, Derivation
from rigidsym.models.forces import OMEGA_BODY, OMEGA_COMPONENTS, Example, Forces, initial_values
from rigidsym.models.rotation import TIME
from rigidsym.notes.document import Equation, Figure
from rigidsym.notes.equations import claims_of
from rigidsym.notes.figure.motion_picture import motion_picture
from rigidsym.notes.template import figure_with


@dataclass(frozen=True)
class MotionFacts:
    """The motion of a body under forces."""

    derivation: Derivation
    forces: Forces
    letters: Letters

    @property
    def is_of_angular_velocity(self) -> bool:
        """Whether Ω′ takes the place of the rates: Euler's equations."""
        return any(step.quantity.name == "torque_body" for step in self.derivation.steps)

    @property
    def are_proved(self) -> bool:
        return all(integral.proof.is_exact for integral in self.derivation.first_integrals)

    @property
    def consequences(self) -> Iterator[tuple[Consequence, Equation]]:
        """The motion as a whole: effective potential, steady motions, exact solutions."""
        for each in self.derivation.consequences:
            proved, unproved = claims_of(each.proofs)
            sides = (
                side if isinstance(side, Formula) else formula_of(side, self.letters)
                for side in (each.left, each.value)
            )
            yield each, Equation(sides=tuple(sides), proved=proved, unproved=unproved)

    @property
    def picture(self) -> Figure | None:
        """The examples, with their numbers, in common and apart, in the caption."""
        try:
            picture = motion_picture(self.derivation, self.letters)
        except MissingExtra as error:
            warnings.warn(f"a note without the picture of its examples: {error}", stacklevel=2)
            return None
        if picture is None:
            return None
        numbers = [self._numbers(example) for example in self.forces.examples[: picture.told]]
        parameters, initial = (
            [each for each in first if all(each in other for other in others)]
            for first, *others in zip(*numbers, strict=True)
        )
        own = [
            [each for part in one for each in part if each not in (*parameters, *initial)]
            for one in numbers
        ]
        return figure_with(
            "en/motion_picture",
            picture.drawing,
            self.letters,
            has_several=len(numbers) > 1,
            parameters=parameters,
            initial=initial,
            differing=[reduce(lambda a, b: formula("#1, #2", a, b), each) for each in own if each],
            polhodes=picture.polhodes,
            # whether θ goes to and fro between the roots of the effective potential
            is_bounded=any(s.quantity.name == "effective_potential" for s in self.derivation.steps),
        )

    def _numbers(self, example: Example) -> tuple[list[Formula], list[Formula]]:
        """The parameters of an example, and its initial values but for those that are 0 in all."""
        model, letters = self.derivation.model, self.letters
        symbols = {q.func.__name__: letters.name(q) for q in model.coordinates}
        symbols |= {f"{q.func.__name__}_dot": letters.name(q.diff(TIME)) for q in model.coordinates}
        omega = zip(OMEGA_COMPONENTS, OMEGA_BODY, strict=True)
        symbols |= {name: formula_of(component, letters) for name, component in omega}
        start = initial_values(model, example.initial)
        moving = {n for e in self.forces.examples for n, value in e.initial.items() if value}
        moving |= {name for name, value in start.items() if value}
        parameters = [
            equal(formula_of(sp.Symbol(name), letters), decimal(value))
            for name, value in example.parameters.items()
        ]
        initial = [equal(symbols[n], decimal(v)) for n, v in start.items() if n in moving]
        return parameters, initial


def motion_facts(derivation: Derivation, letters: Letters) -> MotionFacts | None:
    acting = derivation.forces
    return None if acting is None else MotionFacts(derivation, acting, letters)
