"""The note of a derivation with its theory: the lecture's equations in order, then the rotation."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import chain, groupby

from rigidsym.mechanics.derivation import Statement, Step, claims_of
from rigidsym.notes.document.document import (
    Equation,
    NoteBlock,
    NoteTable,
    Paragraph,
    Section,
    said,
)
from rigidsym.notes.formula.summands import sums
from rigidsym.notes.prose.words import with_source
from rigidsym.notes.sections.body_note import BodyComposer
from rigidsym.notes.sections.boxed import RESULTS
from rigidsym.notes.sections.claims_table import claims_in_a_table
from rigidsym.notes.sections.lecture_end import summary_of_the_lecture, symbols_of_the_lecture

_WHERE_SHOWN = {  # what has no equation of its own, and the one that it belongs to
    "rotation_rate": "velocity_by_the_rotation",
    "spin_matrix": "velocity_by_the_rotation",
    "angular_velocity_space": "angular_velocity_of_the_rotation",
    "entries_of_inertia": "inertia_of_particles",
    "moment_about_a_line": "inertia_of_particles",
}
_METHOD = (
    "A statement about a sum over particles is proved for the generic summand. Factors common to "
    r"all particles are taken out of the sum; only $\sum_i m_i = M$ and "
    r"$\sum_i m_i\,\mathbf{x}_i = \mathbf{0}$ with its derivative are used, so that the statement "
    "holds for a body of any number of particles.",
    r"A general rotation $\mathbf{R}$ is represented by a unit quaternion, without loss of "
    "generality.",
)
_CENTRE = (
    r"The position of the centre of mass is written $\mathbf{r}_C$, since $\mathbf{R}$ is the "
    "rotation."
)


class LectureComposer(BodyComposer):
    """The sections of the theory, of the rotation, of the body."""

    of_the_body = " of the body"

    def beginning(self) -> Iterator[tuple[str, Iterator[NoteBlock]]]:
        first = [said(_CENTRE)]
        for title, statements in groupby(self.derivation.theory, key=lambda s: s.section):
            yield title, chain(first, chain.from_iterable(map(self._statement, statements)))
            first = []
        yield self.model.title, self._of_the_rotation()

    def summary(self, sections: Sequence[Section]) -> Section:
        return summary_of_the_lecture(self.derivation, sections, self.letters)

    def symbol_table(self) -> NoteTable:
        return symbols_of_the_lecture(self.derivation, self.letters, _WHERE_SHOWN)

    def _statement(self, statement: Statement) -> Iterator[NoteBlock]:
        source = statement.source if statement.number else None
        yield Paragraph(with_source(statement.because, source))
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
            is_result=statement.name in RESULTS,
        )

    def _of_the_rotation(self) -> Iterator[NoteBlock]:
        yield from self._convention()
        yield from self._rotation()
        yield from self._steps(("rotation_rate", "spin_matrix", "angular_velocity_space"))
        yield from self._steps(("angular_velocity_body",))

    def _equation(self, step: Step) -> Equation:
        equation = super()._equation(step)
        is_apart = step.quantity.name not in _WHERE_SHOWN
        return equation if is_apart else replace(equation, number=None, label="")

    def _label(self, step: Step) -> str:
        return _WHERE_SHOWN.get(step.quantity.name, step.quantity.name)

    def _proofs(self) -> Iterator[NoteBlock]:
        claims = [
            (_WHERE_SHOWN.get(s.name, s.name), p) for s in self.derivation.theory for p in s.proofs
        ]
        claims += [(self._label(step), p) for step in self.derivation.steps for p in step.proofs]
        yield from (said(text) for text in _METHOD)
        yield from claims_in_a_table(sorted(claims, key=lambda claim: self._number(claim[0])))

    def _number(self, label: str) -> int:
        """Of the equation with a label: claims stand in the order of the equations."""
        numbers = {s.name: s.number for s in self.derivation.theory if s.number}
        numbers |= {step.quantity.name: step.number for step in self.derivation.steps}
        return numbers[label]
