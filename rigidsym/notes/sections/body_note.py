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
from rigidsym.mechanics.quantities.mass import INERTIA_QUANTITIES
from rigidsym.notes.document.document import (
    Equation,
    Figure,
    NoteBlock,
    Paragraph,
    Text,
    listed,
    said,
)
from rigidsym.notes.figure.body_drawing import body_drawing
from rigidsym.notes.figure.body_mesh import lengths_of
from rigidsym.notes.prose.words import is_body_alone
from rigidsym.notes.sections.body_sections import blocks_of_body
from rigidsym.notes.sections.compose import Composer
from rigidsym.notes.sections.fitting import definitions
from rigidsym.notes.sections.named_body import OFFSET, OFFSET_IS, in_names, textbook_form

_DIAGONAL = formula("(I'_{11}, I'_{22}, I'_{33})")
_IN_A_ROW = ("radii_of_gyration", "inertia_ellipsoid")
_FIRST = ("mass", "centre_of_mass", "inertia_tensor")


class BodyComposer(Composer):
    """The sections on a body, in physical names; without those on the rotation if it is alone."""

    def __init__(self, derivation: Derivation, **options: Any) -> None:
        shown, self.moments = in_names(derivation)
        super().__init__(shown, **options)
        self.is_short = is_body_alone(derivation)

    @property
    def subtitle(self) -> str:
        return "" if self.is_short else super().subtitle

    def beginning(self) -> Iterator[tuple[str, Iterator[NoteBlock]]]:
        if not self.is_short:
            yield from super().beginning()

    def _body(self) -> Iterator[NoteBlock]:
        figure = figure_of_body(self.derivation, self.letters)
        if figure is not None:
            yield figure
        yield from blocks_of_body(self.derivation, self.letters)
        yield from self._steps(_FIRST)
        if self.moments:
            blocks = list(self.fitter.whole(definitions(self.moments, self.letters)))
            if not isinstance(blocks[0], Paragraph):  # nor abbreviations first
                yield said("Here")
            yield from blocks
        if any(step.expression.has(*OFFSET) for step in self.derivation.steps):
            yield said("Let {} be the vector from the centre of mass to a point P.", OFFSET_IS)
        yield from self._steps([name for name in INERTIA_QUANTITIES if name not in _FIRST])

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
    drawing, is_principal = found
    names = listed([(label.symbol,) for label in drawing.labels])
    axes = "The axes {} of the body, through its centre of mass, are its principal axes."
    others = "The principal axes through the centre of mass are named after their moments, {}."
    before, after = (axes if is_principal else others).split("{}")
    caption = (before, *names, after) if names else ("The body.",)
    return Figure(drawing=drawing, caption=caption, description=_chosen(derivation, letters))


def _chosen(derivation: Derivation, letters: Letters) -> Text:
    """The lengths that were chosen for the drawing."""
    body = derivation.body
    if body is None or body.distribution is None:
        return ()
    values = {p.symbol: p.value for p in body.parameters}
    numbers = lengths_of(body.distribution, values) or {}
    chosen = [symbol for symbol in numbers if values.get(symbol) is None]
    if not chosen:
        return ("All lengths are to scale.",)
    equations = [
        (equal(formula_of(symbol, letters), decimal(float(numbers[symbol]))),) for symbol in chosen
    ]
    return ("It is drawn for ", *listed(equations), ".")
