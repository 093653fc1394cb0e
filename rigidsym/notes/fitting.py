"""Long quantities made to fit: parts of them named, or in short where that says more."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import sympy as sp

from rigidsym.mechanics.derivation import Derivation, Markup, Step
from rigidsym.notes.document import Block, Equation, Paragraph
from rigidsym.notes.formula import markup
from rigidsym.notes.layout import PAGE, display
from rigidsym.notes.naming import Namer, Part
from rigidsym.notes.notation import Notation
from rigidsym.notes.short import in_short
from rigidsym.notes.vector_words import sum_of_vectors

_LINES_AN_ENTRY = 1.5  # of a listing; with more of them, parts get names
_MOST_LINES = 24  # of one quantity, where there is a short way to say it
_ROOM_OF_A_NAME = 6.0  # ems


class Fitter:
    """The equations of one note, each as short as can be."""

    def __init__(self, derivation: Derivation, notation: Notation) -> None:
        self.derivation = derivation
        self.notation = notation
        self._namer = Namer(notation)

    def fitted(self, equation: Equation, step: Step) -> Iterator[Block]:
        """An equation; where it would be long, in short, or its parts with their names first."""
        equation = self._as_vectors(equation, step)
        if equation.matrix is None or not self._is_long(equation):
            yield equation
            return
        short = in_short(step, self.derivation, self.notation)
        if short is not None and self.derivation.model.vector:
            yield _without_entries(equation, short)
        elif short is None:
            yield from self._named(equation)
        else:
            named = list(self._named(equation))
            lines = sum(self._lines(block) for block in named)
            yield from self._said(equation, short, lines) if lines > _MOST_LINES else named

    def _as_vectors(self, equation: Equation, step: Step) -> Equation:
        """With its vector form; where there is one, the entries are shown only if they fit."""
        if step.vector_form is None:
            return equation
        sides = (*equation.sides, sum_of_vectors(step.vector_form, self.notation))
        whole = replace(equation, sides=sides)
        fits = not display(whole, self.notation, PAGE).done
        return whole if fits else _without_entries(equation, sides[-1:])

    def _is_long(self, equation: Equation) -> bool:
        shown = display(equation, self.notation, PAGE)
        fits = shown.width <= PAGE and shown.lines <= _LINES_AN_ENTRY * len(equation.entries)
        return shown.done == "listed" and not fits

    def _named(self, equation: Equation) -> Iterator[Block]:
        assert equation.matrix is not None
        named = self._namer.named(equation.matrix, PAGE - _ROOM_OF_A_NAME)
        if named.parts:
            yield Paragraph(("With the abbreviations",))
            yield definitions(named.parts, self.notation)
        yield replace(equation, matrix=named.matrix)

    def _said(self, equation: Equation, short: Sequence[Markup], lines: int) -> Iterator[Block]:
        """What it is, and how long it would be; the function evaluates it all the same."""
        yield _without_entries(equation, short)
        yield Paragraph((f"Its entries, written out, would fill {lines} lines.",))

    def _lines(self, block: Block) -> int:
        if isinstance(block, Equation):
            return display(block, self.notation, PAGE).lines
        return 1


def definitions(parts: Sequence[Part], notation: Notation) -> Equation:
    """k₁ = ..., k₂ = ...: what the names of parts stand for."""
    names, values = zip(*parts, strict=True)
    return Equation(
        sides=(),
        matrix=sp.ImmutableMatrix(values),
        entries=tuple(markup(name, notation) for name in names),
    )


def _without_entries(equation: Equation, sides: Sequence[Markup]) -> Equation:
    """Ended by these sides in place of its entries; where nothing is left, it is a definition."""
    return replace(
        equation,
        sides=(*equation.sides, *sides),
        matrix=None,
        entries=(),
        is_result=equation.is_result and bool(sides),
    )
