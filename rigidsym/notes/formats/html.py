"""Document -> one HTML file with MathML, which needs neither network nor script.

The templates hold all elements but those of formulas and drawings. On a phone a wide display is set
in smaller type, and scrolls sideways if that is not enough.
"""

from __future__ import annotations

import re
from functools import cached_property, lru_cache
from html import escape as escape_markup

from math_core import LatexToMathML

from rigidsym.formula.latex_pen import WebPen
from rigidsym.formula.pen import Height
from rigidsym.formula.reader import text_of
from rigidsym.formula.tree import Formula
from rigidsym.notes import document as doc
from rigidsym.notes.formats.drawings import svg
from rigidsym.notes.formats.escape import cleaned
from rigidsym.notes.formats.printer import NotePrinter
from rigidsym.system import resources

TEMPLATE = "note.html.jinja"
BLOCKS = "blocks.html.jinja"
_PAGE = 39.5  # ems of a display on a page, some less than there are: browsers differ in fonts
_WITH_POINTS = re.compile(r"\(<math .*?</math>[.,;:)]*|<math (?:(?!</math>).)*</math>[.,;:)]+")
_PREFIX = '"><mo lspace="0" rspace="0">'  # a formula's first sign, without a term before it
_INFIX = '"><mo form="infix" lspace="0">'  # and with one
_INLINE = 13.0  # ems of a formula between words on a phone


def render(document: doc.Document) -> str:
    """The note as an HTML file; the same document gives the same bytes."""
    return rendered(TEMPLATE, printer_of(document))


def rendered(template: str, printer: HtmlPrinter, **more: object) -> str:
    """A template with the note in it; `more` is what else the template places."""
    parts = {"language": printer.document.language, "sections": printer.sections}
    parts |= printer.placed() | more
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
)
# and a large bracket with an exponent in the size of a letter
_RAISED = re.compile(r"<msup>(<mo minsize[^>]*>.</mo>)")


@lru_cache(maxsize=1 << 12)  # a note prints a symbol in many places
def math(latex: str, *, is_display: bool = False, is_tall: bool = False) -> str:
    """A `math` element, with its LaTeX for readers that know no MathML.

    Fractions between words keep the height of a display if `is_tall`.
    """
    text = str(_CONVERTER.convert_with_local_state(latex, displaystyle=is_display))
    for written, mended in _MENDED:
        text = text.replace(written, mended)
    text = _RAISED.sub(r'\1<msup><mspace height="1.1em"/>', text)
    kind = ' class="tall"' if is_tall else ""
    source = escape_markup(" ".join(latex.split()))
    return text.replace("<math", f'<math alttext="{source}"{kind}', 1)


class HtmlPrinter(NotePrinter):
    width = _PAGE
    words = staticmethod(escape)
    strong = "<strong>{}</strong>"
    emphasis = "<em>{}</em>"
    link = '<a href="{address}">{}</a>'
    reference = '<a href="#{label}">({number})</a>'
    figure_title = "<strong>Figure {number}.</strong>"
    citation = '[<a href="#{label}">{number}</a>{place}]'

    def __init__(self, document: doc.Document) -> None:
        super().__init__(document, WebPen(document.letters.notation))
        displays = self.displays.items()
        self.math = {equation: math(layout.text, is_display=True) for equation, layout in displays}
        self._blocks = resources.environment().get_template(BLOCKS).module

    @cached_property
    def sections(self) -> list[dict[str, str]]:
        return [
            {"title": escape(section.title), "key": f"section-{place}", "body": self.body(section)}
            for place, section in enumerate(self.document.sections, start=1)
        ]

    def block(self, block: doc.NoteBlock) -> str:
        return str(getattr(self._blocks, type(block).__name__.lower())(self, block)).strip()

    def drawing(self, figure: doc.Figure) -> str:
        number = self.document.figures.index(figure) + 1
        return svg(
            figure.drawing,
            title=f"Figure {number}",
            description=text_of((*figure.caption, " ", *figure.description)),
            name=f"figure-{number}",
        )

    def text(self, text: doc.Text) -> str:
        """No line may part a formula from the brackets and points beside it."""
        written = super().text(text)
        # A function takes half the time of a template such as r"<span>\g<0></span>".
        return _WITH_POINTS.sub(lambda whole: f'<span class="whole">{whole[0]}</span>', written)

    def formula(self, formula: Formula) -> str:
        """One too wide for a phone is cut before each sign outside all brackets."""
        piece = self.pen.write(formula)
        parts: list[str] = []
        for chunk in piece.chunks:
            if parts and (chunk.level or piece.width <= _INLINE):
                parts[-1] += f" {chunk.text}"
            else:
                parts.append(chunk.text)
        first, *others = (math(part, is_tall=piece.height > Height.FLAT) for part in parts)
        # a cut part begins with a sign that joins it to the part before
        return " ".join((first, *(part.replace(_PREFIX, _INFIX, 1) for part in others)))

    def code(self, text: str) -> str:
        # a line may end within the long name of a function
        breakable = escape(text).replace("_", "_<wbr>").replace("(", "<wbr>(")
        return f"<code>{breakable}</code>"


printer_of = lru_cache(maxsize=1)(HtmlPrinter)  # a page holds the note that has a file of its own
