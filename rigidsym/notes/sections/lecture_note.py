"""The note of a derivation with its theory: the lecture's equations in order, then the rotation."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import groupby

from rigidsym.formula.notation import DEFAULT, Notation
from rigidsym.formula.reader import formula
from rigidsym.mechanics.derivation import Derivation, Statement, Step
from rigidsym.mechanics.quantities.energy import ENERGIES, MOMENTA
from rigidsym.notes.document.document import (
    Document,
    Equation,
    NoteBlock,
    Paragraph,
    Section,
    words,
)
from rigidsym.notes.formula.summands import sums
from rigidsym.notes.prose.singular_words import singular_title
from rigidsym.notes.prose.words import with_source
from rigidsym.notes.sections.boxed import RESULTS
from rigidsym.notes.sections.claims_table import claims_in_a_table
from rigidsym.notes.sections.compose import ACCELERATION, FUNCTIONS, IDENTITIES, SYMBOLS, Composer
from rigidsym.notes.sections.lecture_end import summary_of_the_lecture, symbols_of_the_lecture

_WHERE_SHOWN = {  # what has no equation of its own, and the one that it belongs to
    "rotation_rate": "velocity_by_the_rotation",
    "spin_matrix": "velocity_by_the_rotation",
    "angular_velocity_space": "angular_velocity_of_the_rotation",
    "entries_of_inertia": "inertia_of_particles",
    "moment_about_a_line": "inertia_of_particles",
}
_SUMS = (
    "A statement about a sum over particles is proved for the generic summand. Factors common to "
    "all particles are taken out of the sum; only {} and {} with its derivative are used, so that "
    "the statement holds for a body of any number of particles."
)
_ROTATIONS = (
    "A general rotation {} is represented by a unit quaternion, without loss of generality. The "
    "position of the centre of mass is written {}, since {} is the rotation."
)


def compose_lecture(
    derivation: Derivation,
    *,
    module: str | None = None,
    functions: Sequence[str] = (),
    notation: Notation = DEFAULT,
) -> Document:
    """The note of a derivation with its theory; as `compose` otherwise."""
    notation.check(derivation.model)
    composer = _Lecture(derivation, module, tuple(functions), notation)
    return Document(
        name=derivation.name,
        title=derivation.title,
        subtitle=derivation.subject,
        letters=composer.letters,
        sections=tuple(composer.sections()),
    )


class _Lecture(Composer):
    """The sections of the theory, of the rotation, of the body."""

    def sections(self) -> Iterator[Section]:
        yield Section("How the equations are proved", tuple(self._method()))
        for title, statements in groupby(self.derivation.theory, key=lambda s: s.section):
            blocks = (block for statement in statements for block in self._statement(statement))
            yield Section(title, tuple(blocks))
        parts = {
            self.model.title: self._of_the_rotation(),
            "The rates of the coordinates": self._rates(),
            singular_title(self.derivation): self._singularities(),
            "The angular acceleration": self._steps(ACCELERATION),
            "The body": self._body(),
            "The kinetic energy of the body": self._steps(ENERGIES),
            "The angular momentum of the body": self._steps(MOMENTA),
            IDENTITIES: self._proofs(),
            SYMBOLS: self._symbols(),
            FUNCTIONS: self._functions(),
        }
        filled = ((title, tuple(blocks)) for title, blocks in parts.items())
        sections = [Section(title, blocks) for title, blocks in filled if blocks]
        yield from sections
        yield summary_of_the_lecture(self.derivation, sections, self.letters)

    def _symbols(self) -> Iterator[NoteBlock]:
        yield symbols_of_the_lecture(self.derivation, self.letters, _WHERE_SHOWN)

    def _method(self) -> Iterator[NoteBlock]:
        masses = formula(r"\sum_i m_i = M")
        places = formula(r"\sum_i m_i\,\mathbf{x}_i = \mathbf{0}")
        rotation, centre = formula(r"\mathbf{R}"), formula(r"\mathbf{r}_C")
        yield Paragraph(words(_SUMS, masses, places))
        yield Paragraph(words(_ROTATIONS, rotation, centre, rotation))

    def _statement(self, statement: Statement) -> Iterator[NoteBlock]:
        source = statement.source if statement.number else None
        yield Paragraph(with_source(statement.because, source))
        sides = statement.sides
        matrix = sums(statement, self.letters)
        if matrix is not None:
            sides = (*sides, matrix)
        yield Equation(
            sides=sides,
            number=statement.number,
            label=statement.name if statement.number else "",
            proved=tuple(proof.claim for proof in statement.proofs if proof.is_exact),
            unproved=tuple(proof.claim for proof in statement.proofs if not proof.is_exact),
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
        yield from claims_in_a_table(sorted(claims, key=lambda claim: self._number(claim[0])))

    def _number(self, label: str) -> int:
        """Of the equation with a label: claims stand in the order of the equations."""
        numbers = {s.name: s.number for s in self.derivation.theory if s.number}
        numbers |= {step.quantity.name: step.number for step in self.derivation.steps}
        return numbers[label]
