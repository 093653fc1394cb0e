"""The walk over a document, for every format that is one text: blocks, spans, what is beside them.

A subclass has a method for each kind of block and of span, named after it, and its pen.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any, ClassVar

from rigidsym.formula.display import Done, display
from rigidsym.formula.latex_pen import LatexPen
from rigidsym.formula.tree import Formula
from rigidsym.notes.document import (
    Cited,
    Code,
    Document,
    Equation,
    EquationReference,
    Figure,
    FigureReference,
    NoteBlock,
    Section,
    Span,
    Strong,
    Text,
)
from rigidsym.notes.words import announcement


class NotePrinter:
    """Blocks and spans of one document in one format."""

    separator: ClassVar[str] = "\n"  # between two blocks
    width: ClassVar[float]  # ems of a display
    beside_number: ClassVar[float | None] = None  # the same beside a number, if that takes room
    words: Callable[[str], str]

    code: Callable[[str], str]
    strong: Callable[[str], str]
    reference: Callable[[str], str]  # to an equation, by its label
    citation: Callable[[int, str], str]  # of a source, by its number, and a place in it
    key: Callable[[int], str]  # of a source, by its number

    def __init__(self, document: Document, pen: LatexPen) -> None:
        self.document = document
        self.pen = pen
        beside = self.beside_number or self.width
        self.shown = {
            equation: display(
                equation, document.letters, beside if equation.number else self.width, pen
            )
            for equation in document.displays
        }

    def placed(self) -> dict[str, Any]:
        """What every template places beside the sections."""
        document = self.document
        return {
            "title": self.words(document.title),
            "subtitle": self.words(document.subtitle),
            "byline": self.words(" · ".join(document.byline)),
            "sources": [
                {"key": self.key(place), "text": self.words(source)}
                for place, source in enumerate(document.sources, start=1)
            ],
        }

    def body(self, section: Section) -> str:
        return self.separator.join(map(self.block, section.blocks))

    def formula_of(self, formula: Formula) -> str:
        """A formula among words."""
        return f"${self.pen.write(formula).text}$"

    def block(self, block: NoteBlock) -> str:
        return str(getattr(self, type(block).__name__.lower())(block))

    def text(self, text: Text) -> str:
        return "".join(map(self.span, text))

    def span(self, span: Span) -> str:
        match span:
            case str():
                return self.words(span)
            case Formula():
                return self.formula_of(span)
            case Code(text):
                return self.code(text)
            case Strong(text):
                return self.strong(text)
            case EquationReference(label):
                return self.reference(label)
            case FigureReference(number):
                return self.figure_number(number)
            case Cited():
                return self.citation(self.document.source_number(span), span.place)

    def announced(self, equation: Equation, done: Done) -> str:
        """What is said before an equation of the way it is set."""
        return self.text(announcement(equation, done))

    def claims(self, equation: Equation) -> Iterator[str]:
        """What was proved of an equation, and what was not."""
        kinds = (("Proved", equation.proved), (self.strong("Unproved"), equation.unproved))
        for kind, claims in kinds:
            if claims:
                yield f"{kind}: {', '.join(map(self.claim, claims))}"

    def claim(self, claim: Formula) -> str:
        return self.span(claim)

    def figure_words(self, figure: Figure) -> str:
        """What is said below a figure."""
        number = self.document.figures.index(figure) + 1
        words = self.text((*figure.caption, " ", *figure.description))
        return f"{self.figure_title(number)} {words}"

    def figure_title(self, number: int) -> str:
        """What a caption begins with."""
        return self.strong(f"Figure {number}.")

    def figure_number(self, number: int) -> str:
        """A figure in the text."""
        return str(number)
