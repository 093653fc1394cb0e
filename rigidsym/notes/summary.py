"""The results of a derivation on one sheet."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from rigidsym.formula.display import PAGE, display, height
from rigidsym.formula.letters import Letters
from rigidsym.mechanics.derivation import Derivation, Step
from rigidsym.mechanics.quantities.energy import ENERGY_QUANTITIES
from rigidsym.mechanics.quantities.kinematics import KINEMATICS
from rigidsym.notes.document import (
    Equation,
    EquationReference,
    EquationRow,
    NoteBlock,
    Paragraph,
    Text,
    listed,
)
from rigidsym.notes.facts.convention import LengthFacts, convention_facts
from rigidsym.notes.facts.singular import singular_facts
from rigidsym.notes.template import blocks_of

_SENTENCES = 2  # what the coordinates are, and which way the rotation goes
_SENTENCE = 1.5  # lines that one more takes
SHEET = 40.0  # lines of a page that displays may take, beside their headings

_GROUPS = tuple(  # titles in the order of the entries
    dict.fromkeys(q.group for q in (*KINEMATICS.values(), *ENERGY_QUANTITIES.values()) if q.group)
)


def summary(
    derivation: Derivation, equations: Mapping[str, Equation], letters: Letters, room: float = SHEET
) -> Iterator[NoteBlock]:
    """Results that are short enough to fit on one sheet, others by the numbers of `equations`."""
    facts = convention_facts(derivation, letters)
    yield from blocks_of("en/convention", letters, **facts, angles=None)[:_SENTENCES]
    on_vectors = blocks_of("en/vector", letters, length=LengthFacts(derivation, letters))
    yield from on_vectors
    room -= _SENTENCE * len(on_vectors)
    steps = {step.quantity.name: step for step in derivation.steps}
    for title in _GROUPS:
        labels = [name for name, step in steps.items() if step.quantity.group == title]
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
    facts = singular_facts(derivation)
    if facts is None:
        return
    if facts.has_determinant:
        lead, determinant = blocks_of("en/singular_measure", letters, singular=facts)
        assert isinstance(determinant, Equation)
        if display(determinant, letters, PAGE).lines == 1:
            yield from (lead, determinant)
    yield from blocks_of("en/singular", letters, singular=facts)[:1]
