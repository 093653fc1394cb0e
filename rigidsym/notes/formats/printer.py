"""The walk over a document, for every format that is one text: blocks, spans, what is beside them.

A subclass has its forms of spans, a method named after each kind of block, and its pen.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any, ClassVar

from rigidsym.formula.display import display
from rigidsym.formula.latex_pen import LatexPen
from rigidsym.formula.reader import text_of
from rigidsym.formula.tree import Formula
from rigidsym.notes import document as doc
from rigidsym.notes.words import announcement


class NotePrinter:
    """Blocks and spans of one document in one format."""

    width: ClassVar[float]  # ems of a display
    beside_number: ClassVar[float | None] = None  # the same beside a number, if that takes room
    words: Callable[[str], str]
    code: Callable[[str], str]
    # forms of spans; {label} is unique in the document
    strong: ClassVar[str]
    emphasis: ClassVar[str]
    link: ClassVar[str]
    reference: ClassVar[str]
    figure_number: ClassVar[str] = "{number}"
    figure_title: ClassVar[str]
    citation: ClassVar[str]
    place_in_source: ClassVar[str] = ", {}"

    def __init__(self, document: doc.Document, pen: LatexPen) -> None:
        self.document = document
        self.pen = pen
        beside = self.beside_number or self.width
        self.displays = {
            each: display(each, document.letters, beside if each.number else self.width, pen)
            for each in document.displays
        }

    def placed(self) -> dict[str, Any]:
        """What every template places beside the sections."""
        document = self.document
        return {
            "title": self.words(text_of(document.title)),
            "heading": self.text(document.title),
            "subtitle": self.words(document.subtitle),
            "byline": self.words(" · ".join(document.byline)),
            "sources": [
                {"key": self.label(f"source-{place}"), "text": self.words(source)}
                for place, source in enumerate(document.sources, start=1)
            ],
        }

    def body(self, section: doc.Section) -> str:
        return "\n".join(map(self.block, section.blocks))

    def block(self, block: doc.NoteBlock) -> str:
        return str(getattr(self, type(block).__name__.lower())(block))

    def label(self, label: str) -> str:
        return self.words(label)

    def address(self, address: str) -> str:
        return self.words(address)

    def text(self, text: doc.Text) -> str:
        return "".join(map(self.span, text))

    def span(self, span: doc.Span) -> str:
        match span:
            case str():
                return self.words(span)
            case Formula():
                return self.formula(span)
            case doc.Code(text):
                return self.code(text)
            case doc.Styled(style, inside, address):
                form = getattr(self, style)
                return str(form.format(self.text(inside), address=self.address(address)))
            case doc.EquationReference(label):
                number = self.document.number(label)
                return self.reference.format(label=self.label(label), number=number)
            case doc.FigureReference(number):
                return self._of_figure(self.figure_number, number)
            case doc.Cited():
                number = self.document.source_number(span)
                place = self.place_in_source.format(self.words(span.place)) if span.place else ""
                label = self.label(f"source-{number}")
                return self.citation.format(label=label, number=number, place=place)

    def formula(self, formula: Formula) -> str:
        """A formula among words."""
        return f"${self.pen.write(formula).text}$"

    def announced(self, equation: doc.Equation) -> str:
        """What is said before an equation of the way it is set."""
        return self.text(announcement(equation, self.displays[equation].is_listed))

    def claims(self, equation: doc.Equation) -> Iterator[str]:
        """What was proved of an equation, and what was not."""
        unproved = self.strong.format("Unproved")
        for kind, claims in (("Proved", equation.proved), (unproved, equation.unproved)):
            if claims:
                yield f"{kind}: {', '.join(map(self.claim, claims))}"

    def claim(self, claim: Formula) -> str:
        return self.formula(claim)

    def figure_words(self, figure: doc.Figure) -> str:
        """What is said below a figure."""
        number = self.document.figures.index(figure) + 1
        words = self.text((*figure.caption, " ", *figure.description))
        return f"{self._of_figure(self.figure_title, number)} {words}"

    def _of_figure(self, form: str, number: int) -> str:
        return form.format(label=self.label(f"figure-{number}"), number=number)
