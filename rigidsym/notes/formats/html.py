"""Document -> one HTML file with MathML, which needs neither network nor script.

On a phone a wide display is set in smaller type, or scrolls sideways. The template only places the
pieces that are made here.
"""

from __future__ import annotations

import re
from html import escape as escape_markup
from itertools import pairwise

from math_core import LatexToMathML

from rigidsym.formula.display import Display, display, spoken
from rigidsym.formula.latex_pen import WebPen
from rigidsym.formula.pen import Height, Piece
from rigidsym.formula.reader import text_of
from rigidsym.formula.tree import Formula
from rigidsym.formula.unicode_pen import UnicodePen
from rigidsym.notes.document import (
    Document,
    Equation,
    EquationRow,
    Figure,
    NoteTable,
    Paragraph,
    Section,
    Text,
)
from rigidsym.notes.formats.drawings import svg
from rigidsym.notes.formats.escape import cleaned
from rigidsym.notes.formats.printer import NotePrinter
from rigidsym.system import resources

TEMPLATE = "note.html.jinja"
_PAGE = 39.5  # ems of a display on a page, some less than there are: browsers differ in fonts
_IN_WORDS = 0.75  # of a display's ems: what a formula among words may take
_PHONE = 19.0  # ems of a display on a screen 360 pixels wide
_SAFE = 1.08  # fonts differ
_POINTS = ".,;:)"
_INLINE = 13.0  # ems of a formula between words on a phone
_SMALLER = 1.45  # times as many on a phone in smaller type, which can still be read


def render(document: Document) -> str:
    """The note as an HTML file; the same document gives the same bytes."""
    return rendered(TEMPLATE, HtmlPrinter(document))


def rendered(template: str, printer: HtmlPrinter, **more: object) -> str:
    """A template with the note in it; `more` is what else the template places."""
    document = printer.document
    sections = [
        {"title": escape(section.title), "key": f"section-{place}", "body": printer.body(section)}
        for place, section in enumerate(document.sections, start=1)
    ]
    parts = {"language": document.language, "sections": sections, **printer.placed(), **more}
    return resources.environment().get_template(template).render(parts)


def escape(words: str) -> str:
    """Any text as the text of an element or the value of an attribute."""
    return escape_markup(cleaned(words))


_CONVERTER = LatexToMathML(fancy_error=False)
_MENDED = (
    ('<menclose notation="box">', '<mrow class="boxed">'),  # menclose is not in MathML Core
    ("</menclose>", "</mrow>"),
    # the validator of the W3C knows these of mstyle only; the level is that of the display
    (' scriptlevel="0"', ""),
    ('<mrow displaystyle="true">', '<mrow class="tall">'),
    ("<mo>′</mo>", '<mo class="prime">′</mo>'),  # browsers set it too high
    # and a large bracket with an exponent in the size of a letter
    (r"<msup>(<mo minsize[^>]*>.</mo>)", r'\1<msup><mspace height="1.1em"/>'),
)


def math(latex: str, spoken: str, *, is_display: bool = False, is_tall: bool = False) -> str:
    """A `math` element, with `spoken` for readers that know no MathML.

    Fractions between words keep the height of a display if `is_tall`.
    """
    text = str(_CONVERTER.convert_with_local_state(latex, displaystyle=is_display))
    for written, mended in _MENDED:
        text = re.sub(written, mended, text)
    kind = ' class="tall"' if is_tall else ""
    return text.replace("<math", f'<math alttext="{escape_markup(spoken)}"{kind}', 1)


def _parts(piece: Piece) -> list[str]:
    """A formula among words, cut before each sign outside all brackets."""
    parts: list[str] = []
    for chunk in piece.chunks:
        if parts and chunk.level:
            parts[-1] += f" {chunk.text}"
        else:
            parts.append(chunk.text)
    return parts


class HtmlPrinter(NotePrinter):
    width = _PAGE
    words = staticmethod(escape)
    key = staticmethod("source-{}".format)

    def __init__(self, document: Document) -> None:
        self.notation = document.letters.notation
        super().__init__(document, WebPen(self.notation))
        self._math = {
            equation: math(shown.text, spoken(equation, document.letters), is_display=True)
            for equation, shown in self.shown.items()
        }

    def body(self, section: Section) -> str:
        blocks = list(map(self.block, section.blocks))
        for place, (block, after) in enumerate(pairwise(section.blocks)):
            if isinstance(block, Paragraph) and isinstance(after, Equation | EquationRow):
                # no page ends between the words and the formula
                blocks[place] = blocks[place].replace("<p>", '<p class="lead">', 1)
        return "\n".join(blocks)

    def paragraph(self, block: Paragraph) -> str:
        return f"<p>{self.text(block.text)}</p>"

    def equationrow(self, block: EquationRow) -> str:
        return f'<div class="row">{"".join(map(self.forms, block.equations))}</div>'

    def equation(self, equation: Equation) -> str:
        shown = self.forms(equation)
        if not equation.number:
            return f'<div class="equation">{shown}</div>'
        label, number = escape(equation.label), equation.number
        named = f"Equation {number}"
        said = " ".join(f"{claim}." for claim in self.claims(equation))
        function = f" {self.code(equation.function)}" if equation.function else ""
        lines = (
            f'<div class="equation" id="{label}" role="group" aria-label="{named}">',
            shown,
            f'<a class="number" href="#{label}">({number})</a>',
            "</div>",
            f'<p class="remark"><span>{said}</span>{function}</p>',
            self.tools(equation),
        )
        return "\n".join(filter(None, lines))

    def forms(self, equation: Equation) -> str:
        """The display, which scrolls sideways on a phone if it is too wide."""
        shown = self.shown[equation]
        inside = self._lead(equation, shown) + self._fitted(self._math[equation], shown)
        return f'<div class="display">{inside}</div>'

    def tools(self, equation: Equation) -> str:  # noqa: ARG002  (a page has some)
        """What stands behind a numbered equation, to be used on it."""
        return ""

    def _lead(self, equation: Equation, shown: Display) -> str:
        """What is said before a display; sides too long for a line of words are set apart."""
        if shown.done == "listed":
            letters, without = self.document.letters, Equation(sides=equation.sides)
            sides = display(without, letters, _PAGE, self.pen)
            if sides.lines > 1 or sides.width > _IN_WORDS * _PAGE:
                formula = math(sides.text, spoken(without, letters), is_display=True)
                return f"{self._fitted(formula, sides)}<p>Its entries are</p>"
        announced = self.announced(equation, shown.done)
        return f"<p>{announced}</p>" if announced else ""

    def _fitted(self, formula: str, shown: Display) -> str:
        """A formula in smaller type where it is too wide for a phone, if that can be read."""
        if shown.width <= _PHONE:
            return f'<div class="formula">{formula}</div>'
        if shown.width <= _SMALLER * _PHONE:
            size = f"min(1em, calc((100vw - 2rem) / {_SAFE * shown.width:.1f}))"
            return f'<div class="formula" style="font-size: {size}">{formula}</div>'
        # what has to be scrolled must be within reach of the keyboard
        label = "wide formula"
        return (
            f'<div class="formula" tabindex="0" role="group" aria-label="{label}">{formula}</div>'
        )

    def notetable(self, table: NoteTable) -> str:
        head = "".join(f'<th scope="col">{self.text(cell)}</th>' for cell in table.head)
        rows = "\n".join(
            f"<tr>{''.join(f'<td>{self.text(cell)}</td>' for cell in row)}</tr>"
            for row in table.rows
        )
        caption = escape(table.caption)
        return (
            f'<div class="scroll" tabindex="0" role="group" aria-label="{caption}">\n'
            f"<table>\n<caption>{caption}</caption>\n"
            f"<thead><tr>{head}</tr></thead>\n<tbody>\n{rows}\n</tbody>\n</table>\n</div>"
        )

    def figure(self, figure: Figure) -> str:
        number = self.document.figures.index(figure) + 1
        drawing = svg(
            figure.drawing,
            title=f"Figure {number}",
            description=text_of((*figure.caption, " ", *figure.description)),
            name=f"figure-{number}",
        )
        words = self.figure_words(figure)
        return f"<figure>\n{drawing}\n<figcaption>{words}</figcaption>\n</figure>"

    def text(self, text: Text) -> str:
        """No line may part a formula from the brackets and points beside it."""
        written: list[str] = []
        held = 0  # points of the words that stand with the formula before
        for place, span in enumerate(text):
            if isinstance(span, str):
                written.append(escape(span[held:]))
                held = 0
            elif isinstance(span, Formula):
                after = text[place + 1] if place + 1 < len(text) else ""
                words = after if isinstance(after, str) else ""
                held = len(words) - len(words.lstrip(_POINTS))
                parts = self.inline(span)
                if written and written[-1].endswith("("):
                    written[-1] = written[-1][:-1]
                    parts[0] = f'<span class="whole">({parts[0]}</span>'
                if held:
                    parts[-1] = f'<span class="whole">{parts[-1]}{words[:held]}</span>'
                written.append(" ".join(parts))
            else:
                written.append(self.span(span))
        return "".join(written)

    def formula_of(self, formula: Formula) -> str:
        return " ".join(self.inline(formula))

    def inline(self, formula: Formula) -> list[str]:
        """As elements; one too wide for a phone in parts that may go on several lines."""
        piece, said = self.pen.write(formula), UnicodePen(self.notation).write(formula)
        parts, texts = [piece.text], [said.text]
        if piece.width > _INLINE and len(_parts(piece)) == len(_parts(said)):
            parts, texts = _parts(piece), _parts(said)
        is_tall = piece.height > Height.FLAT
        return [math(p, t, is_tall=is_tall) for p, t in zip(parts, texts, strict=True)]

    def code(self, text: str) -> str:
        # a line may end within the long name of a function
        breakable = escape(text).replace("_", "_<wbr>").replace("(", "<wbr>(")
        return f"<code>{breakable}</code>"

    def strong(self, text: str) -> str:
        return f"<strong>{escape(text)}</strong>"

    def reference(self, label: str) -> str:
        return f'<a href="#{escape(label)}">({self.document.number(label)})</a>'

    def citation(self, number: int, place: str) -> str:
        return f'[<a href="#source-{number}">{number}</a>{f", {escape(place)}" if place else ""}]'
