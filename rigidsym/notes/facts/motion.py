"""What moves, what is constant, what follows from it, and the pictures of its examples."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property, partial, reduce
from typing import Any, NamedTuple

import sympy as sp

from rigidsym.formula.letters import Letters
from rigidsym.formula.reader import decimal, formula
from rigidsym.formula.scalars import formula_of
from rigidsym.formula.tree import Formula, equal
from rigidsym.mechanics.derivation import Derivation
from rigidsym.mechanics.quantities.dynamics import LETTERS
from rigidsym.models.forces import OMEGA_BODY, OMEGA_COMPONENTS, Example, MovingPart, initial_values
from rigidsym.models.rotation import TIME
from rigidsym.notes.document import Equation, EquationRow, Figure, NoteBlock
from rigidsym.notes.figure.motion_picture import MotionPicture, motion_picture
from rigidsym.notes.figure.phase_portrait import phase_portrait
from rigidsym.notes.template import texts_of


class MovingFacts(NamedTuple):
    """A part that moves with the body: a point of mass, or a body that turns."""

    part: MovingPart

    @property
    def is_point(self) -> bool:
        return self.part.rotation is None

    @property
    def mass(self) -> sp.Expr:
        return self.part.inertia[0]

    @property
    def velocity(self) -> tuple[sp.Expr, ...]:
        return self.part.velocity

    @property
    def angles(self) -> list[sp.Expr]:
        assert self.part.rotation is not None
        return [turn.angle for turn in self.part.rotation.turns]

    @property
    def moments(self) -> tuple[sp.Expr, ...]:
        return self.part.inertia


class ConsequenceFacts(NamedTuple):
    """What follows from the first integrals: an equation and what leads to it."""

    name: str  # of the macro
    spans: dict[str, Any]
    equation: Equation
    definitions: list[NoteBlock]
    portrait: Figure | None


class TraceFacts(NamedTuple):
    """What a curve in a picture is."""

    kind: str
    is_bounded: bool  # whether θ goes to and fro between the roots of the effective potential

    @property
    def is_nutation(self) -> bool:
        return self.kind == "axis" and self.is_bounded

    @property
    def is_axis(self) -> bool:
        return self.kind == "axis"

    @property
    def is_polhode(self) -> bool:
        return self.kind == "polhode"


@dataclass(frozen=True)
class PictureFacts:
    """The numbers of the motions that are drawn, in common and apart."""

    derivation: Derivation
    letters: Letters
    picture: MotionPicture

    @cached_property
    def _numbers(self) -> list[tuple[list[Formula], list[Formula]]]:
        """The parameters of each example, and its initial values."""
        assert self.derivation.forces is not None
        examples = self.derivation.forces.examples[: self.picture.told]
        return [_numbers(self.derivation, self.letters, example) for example in examples]

    def _shared(self, k: int) -> list[Formula]:
        first, *others = (numbers[k] for numbers in self._numbers)
        return [each for each in first if all(each in other for other in others)]

    @property
    def has_several(self) -> bool:
        return len(self._numbers) > 1

    @property
    def parameters(self) -> list[Formula]:
        return self._shared(0)

    @property
    def initial(self) -> list[Formula]:
        return self._shared(1)

    @property
    def differing(self) -> list[Formula]:
        """What each motion has of its own."""
        shared = [*self.parameters, *self.initial]
        own = [
            [each for part in one for each in part if each not in shared] for one in self._numbers
        ]
        return [reduce(partial(formula, "#1, #2"), each) for each in own if each]

    @property
    def traces(self) -> list[TraceFacts]:
        names = {step.quantity.name for step in self.derivation.steps}
        return [TraceFacts(kind, "effective_potential" in names) for kind in self.picture.traces]

    @property
    def is_on_a_surface(self) -> bool:
        return bool(self.picture.traces)


@dataclass(frozen=True)
class MotionFacts:
    """The motion of a body under forces."""

    derivation: Derivation
    letters: Letters

    @property
    def parts(self) -> list[MovingFacts]:
        assert self.derivation.forces is not None
        return [MovingFacts(part) for part in self.derivation.forces.parts]

    @property
    def is_of_angular_velocity(self) -> bool:
        """Whether Ω′ takes the place of the rates: Euler's equations."""
        return "torque_body" in {step.quantity.name for step in self.derivation.steps}

    @property
    def integrals(self) -> list[NoteBlock]:
        return [
            Equation(sides=(i.symbol, formula_of(i.expression, self.letters)))
            for i in self.derivation.first_integrals
        ]

    @property
    def are_proved(self) -> bool:
        return all(integral.proof.is_exact for integral in self.derivation.first_integrals)

    @property
    def consequences(self) -> Iterator[ConsequenceFacts]:
        """The motion as a whole: effective potential, steady motions, exact solutions."""
        letters = replace(self.letters, names={**self.letters.names, **LETTERS})

        def printed(span: Any) -> Any:
            if isinstance(span, tuple) and not isinstance(span, Formula):
                return [*map(printed, span)]
            return formula_of(span, letters) if isinstance(span, sp.Basic) else span

        for found in self.derivation.consequences:
            claims = tuple(proof.claim for proof in found.proofs)
            exact = all(proof.is_exact for proof in found.proofs)
            pairs = [Equation(sides=tuple(map(printed, pair))) for pair in found.where]
            is_potential = found.name == "effective_potential"
            yield ConsequenceFacts(
                found.name,
                {key: printed(span) for key, span in found.spans.items()},
                Equation(
                    sides=(printed(found.left), printed(found.value)),
                    proved=claims if exact else (),
                    unproved=() if exact else claims,
                ),
                [EquationRow(tuple(pairs))] if pairs else [],
                self._portrait(letters) if is_potential else None,
            )

    def _portrait(self, letters: Letters) -> Figure | None:
        portrait = phase_portrait(self.derivation, letters)
        if portrait is None:
            return None
        constants = self.derivation.argument("parameters").notation
        momenta = [
            formula("#1 = #2", letters.name(symbol), formula_of(value, letters))
            for symbol, value in portrait.momenta.items()
        ]
        caption, description = texts_of(
            "en/phase_portrait",
            letters,
            angle=portrait.name,
            constants=equal(*constants, formula("1")),
            momenta=momenta,
        )
        return Figure(portrait.drawing, caption, description)

    @property
    def pictures(self) -> list[NoteBlock]:
        """The examples, with their numbers in the caption."""
        letters = replace(self.letters, names={**self.letters.names, **LETTERS})
        picture = motion_picture(self.derivation, letters)
        if picture is None or self.derivation.forces is None:
            return []
        facts = PictureFacts(self.derivation, letters, picture)
        caption, *description = texts_of("en/motion_picture", letters, picture=facts)
        return [Figure(picture.drawing, caption, description[0] if description else ())]


def _numbers(
    derivation: Derivation, letters: Letters, example: Example
) -> tuple[list[Formula], list[Formula]]:
    """The parameters of an example, and its initial values but for those that are 0 in all."""
    forces = derivation.forces
    assert forces is not None
    q = derivation.model.coordinates
    known = {x.func.__name__: letters.name(x) for x in q}
    known |= {f"{x.func.__name__}_dot": letters.name(sp.diff(x, TIME)) for x in q}
    known |= {n: formula_of(w, letters) for n, w in zip(OMEGA_COMPONENTS, OMEGA_BODY, strict=True)}
    start = initial_values(derivation.model, example.initial)
    named = {name for each in forces.examples for name, value in each.initial.items() if value}
    named |= {name for name, value in start.items() if value}
    parameters = [
        formula("#1 = #2", formula_of(sp.Symbol(name), letters), decimal(value))
        for name, value in example.parameters.items()
    ]
    initial = [
        formula("#1 = #2", known[name], decimal(value))
        for name, value in start.items()
        if name in named
    ]
    return parameters, initial
