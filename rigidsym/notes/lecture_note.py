"""The note of a derivation with its theory: the lecture's equations in order, then the rotation."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import chain, groupby

from rigidsym.formula.reader import formula
from rigidsym.mechanics.derivation import Statement, Step
from rigidsym.mechanics.quantities.kinematics import ANGULAR_VELOCITY, ROTATION
from rigidsym.notes.body_note import BodyComposer
from rigidsym.notes.compose import claims_of
from rigidsym.notes.document import (
    Equation,
    EquationReference,
    EquationRow,
    NoteBlock,
    NoteTable,
    Paragraph,
    Section,
    Span,
    Text,
    listed,
)
from rigidsym.notes.end_tables import Claim, symbols
from rigidsym.notes.summands import sums
from rigidsym.notes.summary import SHEET, row_height, summary
from rigidsym.notes.words import with_symbols

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
_LEAD = 2.0  # lines that the words before a row of equations take
# symbol | meaning | unit | equation
_OF_THE_THEORY = r"""
m_i | mass of a particle | kg |
M | mass of the body | kg |
\mathbf{r}_i | position of a particle | m |
\mathbf{r}_C | position of the centre of mass | m | centre_of_mass
\mathbf{x}_i | position of a particle relative to the centre of mass | m |
\mathbf{x}'_i | the same, body components | m |
\mathbf{e}_j | vectors of an orthonormal basis | 1 |
\mathbf{e}'_j | the same, turned | 1 | components_in_another_basis
\mathbf{I} | inertia tensor about the centre, space components | kg m² | inertia_of_particles
d^{\perp}_i | distance of a particle from a line | m |
"""
_OF_A_BODY = r"""
\mathbf{I}' | the inertia tensor, body components | kg m² | inertia_turns
E_C | kinetic energy of the centre-of-mass motion | J | energy_splits
E_R | kinetic energy of the rotation about the centre of mass | J | energy_splits
E_K | kinetic energy | J | energy_splits
\mathbf{L}_C | angular momentum of the centre-of-mass motion | kg m²/s | parts_of_the_momentum
\mathbf{L}_R | angular momentum of the rotation | kg m²/s | parts_of_the_momentum
\mathbf{L} | angular momentum about the origin | kg m²/s | momentum_splits
"""


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
        """The results of the theory, and under them the summary of the rotation and its body."""
        room = SHEET
        results = (s for s in self.derivation.theory if s.number and s.is_result)
        for title, group in groupby(results, key=lambda s: s.section):
            statements = list(group)
            numbers = listed([(EquationReference(s.name),) for s in statements])
            row = tuple(Equation(sides=s.sides) for s in statements)
            room -= _LEAD + row_height(row, self.letters)
            yield from (Paragraph((f"{title} ", *numbers, ":")), EquationRow(row))
        yield from summary(self.derivation, self.printed, self.letters, room)

    def _symbols(self) -> Iterator[NoteTable]:
        """Symbols of the theory before those of the rotation and the body, each once."""
        table = symbols(self.derivation, self.letters)
        theory = list(_rows(_OF_THE_THEORY))
        names = {row[0] for row in theory}
        others = [row for row in table.rows if row[0] not in names]
        names_of_others = {span for row in others for span in row[0]}
        theory += [row for row in _rows(_OF_A_BODY) if row[0][0] not in names_of_others]
        rows = (tuple(tuple(map(_where_shown, cell)) for cell in row) for row in others)
        yield table._replace(rows=(*theory, *rows))

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

    def _identities(self) -> Iterator[NoteBlock]:
        """Each claim once, in the order of the equations."""
        numbers = {s.name: s.number for s in self.derivation.theory if s.number}
        numbers |= {step.quantity.name: step.number for step in self.derivation.steps}
        proofs = [(s.name, p) for s in self.derivation.theory for p in s.proofs]
        proofs += [(step.quantity.name, p) for step in self.derivation.steps for p in step.proofs]
        claims = [(_WHERE_SHOWN.get(name, name), proof) for name, proof in proofs]
        once: dict[object, Claim] = {}
        for label, proof in sorted(claims, key=lambda claim: numbers[claim[0]]):
            once.setdefault((label, proof.claim), (label, proof))
        yield from self._claims([*once.values()])


def _rows(table: str) -> Iterator[tuple[Text, ...]]:
    for line in table.strip().splitlines():
        typed, about, unit, label = (part.strip() for part in line.split("|"))
        yield (formula(typed),), (about,), (unit,), (EquationReference(label),) if label else ()


def _where_shown(span: Span) -> Span:
    """A reference to the equation that shows what has none of its own; any other span as it is."""
    if isinstance(span, EquationReference):
        return EquationReference(_WHERE_SHOWN.get(span.label, span.label))
    return span
