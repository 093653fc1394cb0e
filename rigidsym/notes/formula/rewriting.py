"""A document in the user's notation: every formula in it rewritten, and nothing else."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from rigidsym.mechanics.derivation import Markup
from rigidsym.notes.document.document import (
    Block,
    Document,
    Equation,
    EquationRow,
    Figure,
    Paragraph,
    Program,
    Section,
    Span,
    Table,
    Text,
)
from rigidsym.notes.formula.manner import DEFAULT, Manner


def in_manner(document: Document, manner: Manner) -> Document:
    """The document with its formulas in another notation; its matrices follow their own."""
    if manner == DEFAULT:
        return document
    rewriter = _Rewriter(manner)
    return replace(document, sections=tuple(map(rewriter.section, document.sections)))


def equation_in_manner(equation: Equation, manner: Manner) -> Equation:
    """One equation in another notation."""

    def rewritten(formulas: Iterable[Markup]) -> tuple[Markup, ...]:
        return tuple(map(manner.symbol, formulas))

    return replace(
        equation,
        sides=tuple(dict.fromkeys(rewritten(equation.sides))),  # a rate may be its definition
        entries=rewritten(equation.entries),
        proved=rewritten(equation.proved),
        unproved=rewritten(equation.unproved),
    )


class _Rewriter:
    """Blocks of a document in one notation."""

    def __init__(self, manner: Manner) -> None:
        self.manner = manner

    def section(self, section: Section) -> Section:
        return replace(section, blocks=tuple(map(self._block, section.blocks)))

    def _block(self, block: Block) -> Block:
        match block:
            case Paragraph():
                return Paragraph(self._text(block.text))
            case Equation():
                return self._equation(block)
            case EquationRow():
                return EquationRow(tuple(map(self._equation, block.equations)))
            case Table():
                head, *rows = (tuple(map(self._text, row)) for row in (block.head, *block.rows))
                return replace(block, head=head, rows=tuple(rows))
            case Figure():
                return replace(
                    block,
                    caption=self._text(block.caption),
                    description=self._text(block.description),
                )
            case Program():
                return block

    def _equation(self, equation: Equation) -> Equation:
        return equation_in_manner(equation, self.manner)

    def _text(self, text: Text) -> Text:
        return tuple(map(self._span, text))

    def _span(self, span: Span) -> Span:
        match span:
            case Markup():
                return self.manner.symbol(span)
            case str():
                return self.manner.words(span)
        return span
