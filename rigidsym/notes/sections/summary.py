"""The results of a derivation on one sheet."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from rigidsym.formula.display import PAGE, display, height
from rigidsym.formula.letters import Letters
from rigidsym.formula.scalars import formula_of
from rigidsym.mechanics.derivation import Derivation, Step
from rigidsym.mechanics.quantities.energy import ENERGIES, MOMENTA
from rigidsym.notes.document.document import (
    Equation,
    EquationReference,
    EquationRow,
    NoteBlock,
    Paragraph,
    Section,
    Text,
    listed,
)
from rigidsym.notes.prose.singular_words import failures, meaning, measured
from rigidsym.notes.prose.words import convention, symbols_of, vector_in_words

TITLE = "Summary"
_SENTENCES = 2  # what the coordinates are, and which way the rotation goes
_SENTENCE = 1.5  # lines that one more takes
SHEET = 40.0  # lines of a page that displays may take, beside their headings

_GROUPS: Sequence[tuple[str, tuple[str, ...]]] = (
    ("The rotation", ("rotation_matrix",)),
    ("The angular velocity", ("angular_velocity_space", "angular_velocity_body")),
    ("The rate matrices", ("rate_matrix_space", "rate_matrix_body")),
    ("Their inverses", ("inverse_rate_matrix_space", "inverse_rate_matrix_body")),
    (
        "The rates of the coordinates",
        ("rates_from_angular_velocity_space", "rates_from_angular_velocity_body"),
    ),
    ("The angular acceleration", ("angular_acceleration_space", "angular_acceleration_body")),
    ("The kinetic energy", ENERGIES),
    ("The angular momentum", MOMENTA),
)


def summary(
    derivation: Derivation, sections: Sequence[Section], letters: Letters, room: float = SHEET
) -> Section:
    """A section that fits on one sheet: results that are short enough, others by their numbers."""
    blocks = tuple(_blocks(derivation, _numbered(sections), letters, room))
    return Section(TITLE, blocks, on_own_page=True)


def _numbered(sections: Sequence[Section]) -> Mapping[str, Equation]:
    blocks = (block for section in sections for block in section.blocks)
    return {b.label: b for b in blocks if isinstance(b, Equation) and b.number}


def _blocks(
    derivation: Derivation, equations: Mapping[str, Equation], letters: Letters, room: float
) -> Iterator[NoteBlock]:
    said = convention(derivation, symbols_of(derivation), letters.notation)[:_SENTENCES]
    on_vectors = tuple(vector_in_words(derivation, letters.notation))
    yield from map(Paragraph, (*said, *on_vectors))
    room -= _SENTENCE * len(on_vectors)
    steps = {step.quantity.name: step for step in derivation.steps}
    for title, labels in _GROUPS:
        there = [equations[label] for label in labels if label in equations]
        if not there:
            continue
        whole = [e for e in there if _is_whole(e, steps[e.label])]
        short = _fitting({e: _result(e, steps[e.label]) for e in whole}, letters)
        needed = row_height(list(short.values()), letters)
        if short and needed <= room:
            room -= needed
            others = [equation for equation in there if equation not in short]
            also = ("; see also ", *_numbers(others)) if others else ()
            yield Paragraph((f"{title} ", *_numbers(list(short)), *also, ":"))
            yield EquationRow(tuple(short.values()))
    yield from _where_it_fails(derivation, letters)


def row_height(equations: Sequence[Equation], letters: Letters) -> float:
    """Of a row of equations, which may share a line."""
    heights = [height(equation, letters) for equation in equations]
    widths = [display(equation, letters, PAGE).width for equation in equations]
    return max(heights, default=0.0) if sum(widths) + 2 * len(widths) <= PAGE else sum(heights)


def _numbers(equations: Sequence[Equation]) -> Text:
    return listed([(EquationReference(equation.label),) for equation in equations])


def _result(equation: Equation, step: Step) -> Equation:
    """The symbol and what it comes to, without the steps between and what was proved of it.

    Vectors say it without components.
    """
    has_value = equation.matrix is not None or equation.scalar is not None
    ends = (equation.sides[0], equation.sides[-1])
    if step.vector_form is not None:
        return Equation(sides=ends)
    sides = equation.sides[:1] if has_value else ends
    return Equation(
        sides=sides, matrix=equation.matrix, scalar=equation.scalar, entries=equation.entries
    )


def _is_whole(equation: Equation, step: Step) -> bool:
    """Whether it needs no abbreviations that were explained beside it."""
    value = step.expression
    if equation.scalar is not None:
        return bool(equation.scalar == value[0])
    return equation.matrix is None or equation.matrix == value


def _fitting(results: Mapping[Equation, Equation], letters: Letters) -> Mapping[Equation, Equation]:
    """The results, by their equations, that fit on a page as they are."""
    shown = {e: display(result, letters, PAGE) for e, result in results.items()}
    return {e: results[e] for e, d in shown.items() if not d.done and d.width <= PAGE}


def _where_it_fails(derivation: Derivation, letters: Letters) -> Iterator[NoteBlock]:
    """What vanishes there, and where it does; what is lost there stands in the note."""
    found = derivation.singularities
    if found is None:
        return
    if found.determinant is not None:
        determinant = Equation(sides=(*measured(found), formula_of(found.determinant, letters)))
        if display(determinant, letters, PAGE).lines == 1:
            yield Paragraph(meaning(found))
            yield determinant
    yield Paragraph(failures(derivation, found)[0])
