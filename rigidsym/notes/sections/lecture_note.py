"""The note of a derivation with its theory: the lecture's equations in order, then the rotation."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import chain, groupby

from rigidsym.mechanics.derivation import Statement, Step
from rigidsym.mechanics.quantities.kinematics import ANGULAR_VELOCITY, ROTATION
from rigidsym.notes.document.document import (
    Equation,
    NoteBlock,
    NoteTable,
    Paragraph,
    Section,
    Text,
)
from rigidsym.notes.formula.summands import sums
from rigidsym.notes.prose.words import with_symbols
from rigidsym.notes.sections.body_note import BodyComposer
from rigidsym.notes.sections.compose import claims_of
from rigidsym.notes.sections.end_tables import Claim
from rigidsym.notes.sections.lecture_end import summary_of_the_lecture, symbols_of_the_lecture

_WHERE_SHOWN = {  # what has no equation of its own, and the one that it belongs to
    "rotation_rate": "velocity_by_the_rotation",
    "spin_matrix": "velocity_by_the_rotation",
    "angular_velocity_space": "angular_velocity_of_the_rotation",
    "energy_expanded": "energy_splits",
    "energy_as_a_form": "inertia_of_particles",
    "products_of_turned_vectors": "rotation_goes_over",
    "momentum_expanded": "momentum_splits",
    "momentum_by_the_tensor": "momentum_of_rotation",
    "entries_of_inertia": "inertia_of_particles",
    "moment_about_a_line": "inertia_of_particles",
}
_NUMBER_OF_ROTATION = 17


class LectureComposer(BodyComposer):
    """The sections of the theory, of the rotation, of the body."""

    def theory(self) -> Sequence[Section]:
        sections = []
        for title, statements in groupby(self.derivation.theory, key=lambda s: s.section):
            blocks = [*chain.from_iterable(map(self._statement, statements))]
            self.printed |= {b.label: b for b in blocks if isinstance(b, Equation) and b.number}
            sections.append(Section(title, tuple(blocks)))
        return sections

    def _summary(self) -> Iterator[NoteBlock]:
        yield from summary_of_the_lecture(self.derivation, self.printed, self.letters)

    def _symbols(self) -> Iterator[NoteTable]:
        yield symbols_of_the_lecture(self.derivation, self.letters, _WHERE_SHOWN)

    def _statement(self, statement: Statement) -> Iterator[NoteBlock]:
        yield Paragraph(statement.because)
        sides = statement.sides
        matrix = sums(statement, self.letters)
        if matrix is not None:
            sides = (*sides, matrix)
        proved, unproved = claims_of(statement.proofs)
        yield Equation(
            sides=sides,
            number=statement.number,
            label=statement.name if statement.number else "",
            proved=proved,
            unproved=unproved,
            is_result=statement.is_result,
        )

    def _rotation_of_the_lecture(self) -> Iterator[NoteBlock]:
        yield from self._convention()
        yield from self._rotation()
        yield from self._steps(ANGULAR_VELOCITY)

    def _rotation(self) -> Iterator[NoteBlock]:
        """With the number of the lecture at the product of turns, and not at its entries."""
        for block in super()._rotation():
            if not isinstance(block, Equation) or not self.model.turns:
                yield block
            elif block.label == "rotation_matrix":
                yield replace(block, number=None, label="", is_result=False, proved=(), function="")
            elif block.sides[0] == ROTATION:
                (step,) = (s for s in self.derivation.steps if s.number == _NUMBER_OF_ROTATION)
                yield replace(self._equation(step), sides=block.sides, matrix=None, entries=())
            else:
                yield block

    def _equation(self, step: Step) -> Equation:
        equation = super()._equation(step)
        is_apart = step.quantity.name not in _WHERE_SHOWN
        apart = replace(equation, number=None, label="", is_result=False)
        return equation if is_apart else apart

    def _lead(self, step: Step) -> Text:
        """How the quantity follows; what the theory has derived needs no other source."""
        return with_symbols(step.because, self.symbols)

    def _label(self, step: Step) -> str:
        return _WHERE_SHOWN.get(step.quantity.name, step.quantity.name)

    def _identities(self) -> Iterator[NoteBlock]:
        claims = [
            (_WHERE_SHOWN.get(s.name, s.name), p) for s in self.derivation.theory for p in s.proofs
        ]
        claims += [(self._label(step), p) for step in self.derivation.steps for p in step.proofs]
        once: dict[object, Claim] = {}
        for label, proof in sorted(claims, key=lambda claim: self._number(claim[0])):
            once.setdefault((label, proof.claim), (label, proof))
        yield from self._claims([*once.values()])

    def _number(self, label: str) -> int:
        """Of the equation with a label: claims stand in the order of the equations."""
        numbers = {s.name: s.number for s in self.derivation.theory if s.number}
        numbers |= {step.quantity.name: step.number for step in self.derivation.steps}
        return numbers[label]
