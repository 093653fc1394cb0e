"""What ends the note of the lecture: its symbols with their units, its results on one sheet."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import groupby

from rigidsym.mechanics.derivation import Derivation, Markup
from rigidsym.notes.document import (
    Equation,
    EquationReference,
    EquationRow,
    Paragraph,
    Section,
    Span,
    Table,
    Text,
)
from rigidsym.notes.notation import Notation
from rigidsym.notes.results import RESULTS
from rigidsym.notes.summary import SHEET, row_height, summary
from rigidsym.notes.tables import symbols
from rigidsym.notes.words import listed

_LEAD = 2.0  # lines that the words before a row of equations take
_OF_THE_THEORY: Sequence[tuple[Markup, str, str, str]] = (  # symbol, meaning, unit, equation
    (Markup("m_i", "mᵢ"), "mass of a particle", "kg", ""),
    (Markup("M", "M"), "mass of the body", "kg", ""),
    (Markup(r"\mathbf{r}_i", "rᵢ"), "place of a particle", "m", ""),
    (Markup(r"\mathbf{r}_C", "r_C"), "place of the centre of mass", "m", "centre_of_mass"),
    (
        Markup(r"\mathbf{x}_i", "xᵢ"),
        "place of a particle seen from the centre of mass",
        "m",
        "",
    ),
    (Markup(r"\mathbf{x}'_i", "x′ᵢ"), "the same, body components", "m", ""),
    (Markup(r"\mathbf{e}_j", "e_j"), "vectors of an orthonormal basis", "1", ""),
    (Markup(r"\mathbf{e}'_j", "e′_j"), "the same, turned", "1", "components_in_another_basis"),
    (
        Markup(r"\mathbf{I}", "I"),
        "inertia tensor about the centre of mass, space components",
        "kg m²",
        "inertia_of_particles",
    ),
    (
        Markup(r"d^{\perp}_i", "d⊥ᵢ"),
        "distance of a particle from a line",
        "m",
        "",
    ),
)


def symbols_of_the_lecture(
    derivation: Derivation, notation: Notation, shown: Mapping[str, str]
) -> Table:
    """Symbols of the theory before those of the rotation and the body.

    `shown` names, for a quantity without an equation of its own, the one that it belongs to.
    """

    def placed(span: Span) -> Span:
        if isinstance(span, EquationReference):
            return EquationReference(shown.get(span.label, span.label))
        return span

    table = symbols(derivation, notation)
    theory: list[tuple[Text, ...]] = [
        ((symbol,), (about,), (unit,), (EquationReference(label),) if label else ())
        for symbol, about, unit, label in _OF_THE_THEORY
    ]
    known = {str(row[0]) for row in theory}
    others = (row for row in table.rows if str(row[0]) not in known)
    rows = (tuple(tuple(map(placed, cell)) for cell in row) for row in others)
    return replace(table, rows=(*theory, *rows))


def summary_of_the_lecture(
    derivation: Derivation, sections: Sequence[Section], notation: Notation
) -> Section:
    """The results of the theory, and under them the summary of the rotation and its body."""
    groups = dict(_results(derivation))
    room = SHEET - sum(_LEAD + row_height(equations, notation) for equations in groups.values())
    rest = summary(derivation, sections, notation, room)
    theory = (
        block for lead, row in groups.items() for block in (Paragraph(lead), EquationRow(row))
    )
    return replace(rest, blocks=(*theory, *rest.blocks))


def _results(derivation: Derivation) -> Iterator[tuple[Text, tuple[Equation, ...]]]:
    """The words before the results of each section of the theory, and these."""
    found = (s for s in derivation.theory if s.number and s.name in RESULTS)
    for title, group in groupby(found, key=lambda s: s.section):
        statements = list(group)
        numbers = listed([(EquationReference(s.name),) for s in statements])
        yield (f"{title} ", *numbers, ":"), tuple(Equation(sides=s.sides) for s in statements)
