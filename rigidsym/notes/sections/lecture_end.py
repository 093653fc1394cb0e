"""What ends the note of the lecture: its symbols with their units, its results on one sheet."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import groupby

from rigidsym.formula.letters import Letters
from rigidsym.formula.reader import formula
from rigidsym.mechanics.derivation import Derivation
from rigidsym.notes.document.document import (
    Equation,
    EquationReference,
    EquationRow,
    NoteBlock,
    NoteTable,
    Paragraph,
    Span,
    Text,
    listed,
)
from rigidsym.notes.sections.end_tables import symbols
from rigidsym.notes.sections.summary import SHEET, row_height, summary

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


def symbols_of_the_lecture(
    derivation: Derivation, letters: Letters, shown: Mapping[str, str]
) -> NoteTable:
    """Symbols of the theory before those of the rotation and the body.

    `shown` names, for a quantity without an equation of its own, the one that it belongs to.
    """

    def placed(span: Span) -> Span:
        if isinstance(span, EquationReference):
            return EquationReference(shown.get(span.label, span.label))
        return span

    table = symbols(derivation, letters)
    theory = list(_rows(_OF_THE_THEORY))
    known = {row[0] for row in theory}
    others = [row for row in table.rows if row[0] not in known]
    held = {span for row in others for span in row[0]}
    theory += [row for row in _rows(_OF_A_BODY) if row[0][0] not in held]
    rows = (tuple(tuple(map(placed, cell)) for cell in row) for row in others)
    return table._replace(rows=(*theory, *rows))


def _rows(table: str) -> Iterator[tuple[Text, ...]]:
    for line in table.strip().splitlines():
        typed, about, unit, label = (part.strip() for part in line.split("|"))
        yield (formula(typed),), (about,), (unit,), (EquationReference(label),) if label else ()


def summary_of_the_lecture(
    derivation: Derivation, equations: Mapping[str, Equation], letters: Letters
) -> Iterator[NoteBlock]:
    """The results of the theory, and under them the summary of the rotation and its body."""
    groups = dict(_results(derivation))
    room = SHEET - sum(_LEAD + row_height(row, letters) for row in groups.values())
    for lead, row in groups.items():
        yield from (Paragraph(lead), EquationRow(row))
    yield from summary(derivation, equations, letters, room)


def _results(derivation: Derivation) -> Iterator[tuple[Text, tuple[Equation, ...]]]:
    """The words before the results of each section of the theory, and these."""
    found = (s for s in derivation.theory if s.number and s.is_result)
    for title, group in groupby(found, key=lambda s: s.section):
        statements = list(group)
        numbers = listed([(EquationReference(s.name),) for s in statements])
        yield (f"{title} ", *numbers, ":"), tuple(Equation(sides=s.sides) for s in statements)
