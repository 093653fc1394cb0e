"""The note of a body: with its rotation, or alone."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from typing import Any

import sympy as sp

from rigidsym.formula.display import PAGE, display
from rigidsym.formula.letters import Letters
from rigidsym.formula.reader import decimal, formula
from rigidsym.formula.scalars import formula_of
from rigidsym.formula.tree import COMMA, Bracket, Formula, equal, joined
from rigidsym.mechanics.derivation import Derivation, Step
from rigidsym.mechanics.quantities.mass import OF_BODY, OF_INERTIA
from rigidsym.notes.compose import Composer
from rigidsym.notes.document import (
    Equation,
    Figure,
    NoteBlock,
    Paragraph,
    said,
)
from rigidsym.notes.facts.mass import MassFacts
from rigidsym.notes.figure.body_drawing import body_drawing
from rigidsym.notes.figure.body_mesh import lengths_of
from rigidsym.notes.fitting import definitions
from rigidsym.notes.named_body import OFFSET, OFFSET_IS, in_names, textbook_form
from rigidsym.notes.template import blocks_of, texts_of
from rigidsym.notes.words import is_body_alone

_DIAGONAL = formula("(I'_{11}, I'_{22}, I'_{33})")
_IN_A_ROW = ("radii_of_gyration", "inertia_ellipsoid")


class BodyComposer(Composer):
    """The sections on a body, in physical names; without those on the rotation if it is alone."""

    def __init__(self, derivation: Derivation, **options: Any) -> None:
        shown, self.moments = in_names(derivation)
        super().__init__(shown, **options)
        self.is_short = is_body_alone(derivation)

    @property
    def subtitle(self) -> str:
        return "" if self.is_short else super().subtitle

    def _body(self) -> Iterator[NoteBlock]:
        figure = figure_of_body(self.derivation, self.letters)
        if figure is not None:
            yield figure
        if self.derivation.body is not None:
            facts = MassFacts(self.derivation, self.derivation.body, self.letters)
            yield from blocks_of("en/body", self.letters, mass=facts)
        yield from self._steps(OF_BODY)
        if self.moments:
            blocks = list(self.fitter.whole(definitions(self.moments, self.letters)))
            if not isinstance(blocks[0], Paragraph):  # nor abbreviations first
                yield said("Here")
            yield from blocks
        if any(step.expression.has(*OFFSET) for step in self.derivation.steps):
            yield said("Let {} be the vector from the centre of mass to a point P.", OFFSET_IS)
        yield from self._steps(OF_INERTIA)

    def _equation(self, step: Step) -> Equation:
        equation, name = super()._equation(step), step.quantity.name
        if self.moments and name == "principal_moments":
            equation = _ended(equation, self._principal_moments())
        if name in _IN_A_ROW and equation.matrix is not None:
            row = _ended(equation, self._in_a_row(equation.matrix))
            equation = equation if display(row, self.letters, PAGE).done else row
        return replace(equation, sides=(*equation.sides, *textbook_form(name, self.derivation)))

    def _principal_moments(self) -> Formula:
        """(I₁, I₁, I₃), or the entries of I′ if they differ."""
        assert self.derivation.body is not None
        names = {moment: name for name, moment in self.moments}
        moments = [names.get(m, m) for m in self.derivation.body.inertia.diagonal()]
        return _DIAGONAL if len(set(moments)) == 3 else self._in_a_row(moments)

    def _in_a_row(self, entries: Iterable[sp.Expr]) -> Formula:
        return Bracket(joined([formula_of(entry, self.letters) for entry in entries], COMMA))


def _ended(equation: Equation, side: Formula) -> Equation:
    """The equation with one more side in place of its entries."""
    return replace(equation, sides=(*equation.sides, side), matrix=None, entries=())


def figure_of_body(derivation: Derivation, letters: Letters) -> Figure | None:
    """The body of a derivation with its principal axes; None where its shape is not known."""
    found = body_drawing(derivation)
    if found is None:
        return None
    drawing, are_own = found
    lengths = _chosen(derivation, letters)
    caption, *description = texts_of(
        "en/body_figure",
        letters,
        axes=[label.symbol for label in drawing.labels],
        are_own=are_own,
        lengths=lengths,
        is_to_scale=lengths is not None,
    )
    return Figure(drawing, caption, description[0] if description else ())


def _chosen(derivation: Derivation, letters: Letters) -> list[Formula] | None:
    """The lengths that were chosen for the drawing; None for a body without lengths."""
    body = derivation.body
    if body is None or body.distribution is None:
        return None
    values = {p.symbol: p.value for p in body.parameters}
    numbers = lengths_of(body.distribution, values) or {}
    return [
        equal(formula_of(symbol, letters), decimal(float(numbers[symbol])))
        for symbol in numbers
        if values.get(symbol) is None
    ]
