"""Document -> one HTML file with MathML, which needs neither network nor script.

On a phone a wide display is set in smaller type, or scrolls sideways. The template only places the
pieces that are made here.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from html import escape as escape_markup
from itertools import pairwise

from rigidsym.formula.display import Display, display, inline_parts
from rigidsym.formula.mathml_pen import MathmlPen, math
from rigidsym.formula.scalars import formula_of, matrix_of
from rigidsym.formula.tree import Formula, Matrix, equal
from rigidsym.formula.unicode_pen import UnicodePen
from rigidsym.notes.document.document import (
    Cited,
    Code,
    CodeBlock,
    Document,
    Equation,
    EquationReference,
    EquationRow,
    Figure,
    NoteBlock,
    NoteTable,
    Paragraph,
    Section,
    Span,
    Strong,
    Text,
    plain,
)
from rigidsym.notes.figure.svg import svg
from rigidsym.notes.prose.prose import announcement
from rigidsym.notes.sanitize import cleaned
from rigidsym.system import resources

ENDING = "html"
TEMPLATE = "note.html.jinja"
_PAGE = 39.5  # ems of a display on a page, some less than there are: browsers differ in fonts
_IN_WORDS = 0.75  # of a display's ems: what a formula among words may take
_PHONE = 19.0  # ems of a display on a screen 360 pixels wide
_SAFE = 1.08  # fonts differ
_POINTS = ".,;:)"
_SMALLER = 1.45  # times as many on a phone in smaller type, which can still be read
_INLINE = 13.0  # ems of a formula between words on such a screen


def render(document: Document) -> str:
    """The note as an HTML file; the same document gives the same bytes."""
    return rendered(TEMPLATE, HtmlPrinter(document))


def rendered(template: str, printer: HtmlPrinter, **more: object) -> str:
    """A template with the note in it; `more` is what else the template places."""
    document = printer.document
    return (
        resources.environment()
        .get_template(template)
        .render(
            title=escape(document.title),
            subtitle=escape(document.subtitle),
            sections=[
                {
                    "title": escape(section.title),
                    "key": f"section-{place}",
                    "body": printer.body(section),
                }
                for place, section in enumerate(document.sections, start=1)
            ],
            sources=[
                {"key": f"source-{place}", "text": escape(source)}
                for place, source in enumerate(document.sources, start=1)
            ],
            **more,
        )
    )


def escape(words: str) -> str:
    """Any text as the text of an element or the value of an attribute."""
    return escape_markup(cleaned(words))


@dataclass(frozen=True, slots=True)
class _Written:
    """A formula that is HTML already."""

    html: str


class HtmlPrinter:
    """Blocks and spans of one document in HTML."""

    def __init__(self, document: Document) -> None:
        self.document = document
        self.notation = document.letters.notation
        self.pen = MathmlPen(self.notation)

    def body(self, section: Section) -> str:
        blocks = [self._block(block) for block in section.blocks]
        for place, (block, after) in enumerate(pairwise(section.blocks)):
            if isinstance(block, Paragraph) and isinstance(after, Equation | EquationRow):
                # no page ends between the words and the formula
                blocks[place] = blocks[place].replace("<p>", '<p class="lead">', 1)
        return "\n".join(blocks)

    def _block(self, block: NoteBlock) -> str:
        match block:
            case Paragraph():
                return f"<p>{self._text(block.text)}</p>"
            case Equation():
                return "\n".join(self._equation(block))
            case EquationRow():
                displays = (self.forms(equation) for equation in block.equations)
                return f'<div class="row">{"".join(displays)}</div>'
            case NoteTable():
                return self.table(block)
            case Figure():
                return self._figure(block)
            case CodeBlock():
                return f'<pre tabindex="0"><code>{escape_markup(block.code)}</code></pre>'

    def _equation(self, equation: Equation) -> Iterator[str]:
        if not equation.number:
            yield f'<div class="equation">{self.forms(equation)}</div>'
            return
        label, number = escape(equation.label), equation.number
        yield f'<div class="equation" id="{label}" role="group" aria-label="Equation {number}">'
        yield self.forms(equation)
        yield f'<a class="number" href="#{label}">({number})</a>'
        yield "</div>"
        yield f'<p class="remark">{self._claims(equation)}{self._function(equation)}</p>'
        yield from filter(None, [self.tools(equation)])

    def forms(self, equation: Equation) -> str:
        """The display, which scrolls sideways on a phone if it is too wide."""
        shown = display(equation, self.document.letters, _PAGE, self.pen)
        formula = math(shown.text, self._spoken(equation), is_display=True)
        return f'<div class="display">{self._lead(equation, shown)}{_fitted(formula, shown)}</div>'

    def tools(self, equation: Equation) -> str:  # noqa: ARG002  (a page has some)
        """What stands behind a numbered equation, to be used on it."""
        return ""

    def _lead(self, equation: Equation, shown: Display) -> str:
        """What is said before a display; sides too long for a line of words are set apart."""
        sides = display(Equation(sides=equation.sides), self.document.letters, _PAGE, self.pen)
        if shown.done == "listed" and (sides.lines > 1 or sides.width > _IN_WORDS * _PAGE):
            formula = math(sides.text, self.spoken(equal(*equation.sides)), is_display=True)
            return f"{_fitted(formula, sides)}<p>Its entries are</p>"
        announced = self._text(announcement(equation, shown.done))
        return f"<p>{announced}</p>" if announced else ""

    def _spoken(self, equation: Equation) -> str:
        """The equation on one line of Unicode; a matrix row by row."""
        letters = self.document.letters
        sides = list(equation.sides)
        if equation.scalar is not None:
            sides.append(formula_of(equation.scalar, letters))
        if equation.matrix is not None:
            sides.append(Matrix(tuple(map(tuple, matrix_of(equation.matrix, letters)))))
        return self.spoken(equal(*sides))

    def spoken(self, formula: Formula) -> str:
        """A formula for readers that do not know MathML."""
        return UnicodePen(self.notation).write(formula).text

    def _claims(self, equation: Equation) -> str:
        kinds = (("Proved", equation.proved), ("<strong>Unproved</strong>", equation.unproved))
        said = (
            f"{kind}: {', '.join(self._span(claim) for claim in claims)}."
            for kind, claims in kinds
            if claims
        )
        return f"<span>{' '.join(said)}</span>"

    def _function(self, equation: Equation) -> str:
        return f" {self._span(Code(equation.function))}" if equation.function else ""

    def table(self, table: NoteTable) -> str:
        head = "".join(f'<th scope="col">{self._text(cell)}</th>' for cell in table.head)
        rows = "\n".join(
            f"<tr>{''.join(f'<td>{self._text(cell)}</td>' for cell in row)}</tr>"
            for row in table.rows
        )
        caption = escape(table.caption)
        return (
            f'<div class="scroll" tabindex="0" role="group" aria-label="{caption}">\n'
            f"<table>\n<caption>{caption}</caption>\n"
            f"<thead><tr>{head}</tr></thead>\n<tbody>\n{rows}\n</tbody>\n</table>\n</div>"
        )

    def _figure(self, figure: Figure) -> str:
        number = self.document.figures.index(figure) + 1
        drawing = svg(
            figure.drawing,
            title=f"Figure {number}",
            description=plain((*figure.caption, " ", *figure.description)),
            name=f"figure-{number}",
        )
        words = self._text(
            (Strong(f"Figure {number}."), " ", *figure.caption, " ", *figure.description)
        )
        return f"<figure>\n{drawing}\n<figcaption>{words}</figcaption>\n</figure>"

    def _text(self, text: Text) -> str:
        """Words and formulas; no line may part a formula from the brackets and points beside it."""
        spans: list[Span | _Written] = list(text)
        for place, span in enumerate(spans):
            if isinstance(span, Formula):
                before, after = (self._words(spans, place + step) for step in (-1, 1))
                opening = before[-1:] if before.endswith("(") else ""
                points = after[: len(after) - len(after.lstrip(_POINTS))]
                spans[place] = _Written(self._inline(span, opening, points))
                if opening:
                    spans[place - 1] = before[:-1]
                if points:
                    spans[place + 1] = after[len(points) :]
        return "".join(s.html if isinstance(s, _Written) else self._span(s) for s in spans)

    def _words(self, spans: Sequence[Span | _Written], place: int) -> str:
        """The words at a place among spans; empty where there are none."""
        span = spans[place] if 0 <= place < len(spans) else ""
        return span if isinstance(span, str) else ""

    def formula(self, formula: Formula) -> str:
        """A formula as an element of its own."""
        return self.pen.element(formula, self.spoken(formula))

    def _inline(self, formula: Formula, opening: str = "", points: str = "") -> str:
        """A formula among words; one too wide for a phone in parts that may go on several lines."""
        piece, spoken = self.pen.write(formula), UnicodePen(self.notation).write(formula)
        parts, texts = [piece.text], [spoken.text]
        if piece.width > _INLINE and len(inline_parts(piece)) == len(inline_parts(spoken)):
            parts, texts = inline_parts(piece), inline_parts(spoken)
        is_tall = piece.height > 0
        written = [math(p, t, is_tall=is_tall) for p, t in zip(parts, texts, strict=True)]
        if opening:
            written[0] = f'<span class="whole">{opening}{written[0]}</span>'
        if points:
            written[-1] = f'<span class="whole">{written[-1]}{points}</span>'
        return " ".join(written)

    def _span(self, span: Span) -> str:
        match span:
            case str():
                return escape(self.notation.words(span))
            case Formula():
                return self._inline(span)
            case Code():
                return f"<code>{_breakable(escape(span.text))}</code>"
            case Strong():
                return f"<strong>{escape(span.text)}</strong>"
            case EquationReference():
                return f'<a href="#{escape(span.label)}">({self.document.number(span.label)})</a>'
            case Cited():
                return self._cited(span)

    def _cited(self, cited: Cited) -> str:
        number = self.document.source_number(cited)
        place = f", {escape(cited.place)}" if cited.place else ""
        return f'[<a href="#source-{number}">{number}</a>{place}]'


def _fitted(formula: str, shown: Display) -> str:
    """A formula in smaller type where it is too wide for a phone, as far as that can be read."""
    if shown.width <= _PHONE:
        return f'<div class="formula">{formula}</div>'
    if shown.width <= _SMALLER * _PHONE:
        size = f"min(1em, calc((100vw - 2rem) / {_SAFE * shown.width:.1f}))"
        return f'<div class="formula" style="font-size: {size}">{formula}</div>'
    # what has to be scrolled must be within reach of the keyboard
    reach = ' tabindex="0" role="group" aria-label="wide formula"'
    return f'<div class="formula"{reach}>{formula}</div>'


def _breakable(name: str) -> str:
    """A name in a program, with places where a line may end."""
    return name.replace("_", "_<wbr>").replace("(", "<wbr>(")
