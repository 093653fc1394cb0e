"""Document -> LaTeX. The template only places the pieces that are made here."""

from __future__ import annotations

from rigidsym.formula.display import PAGE, Rows, display, pack
from rigidsym.formula.latex_pen import LatexPen
from rigidsym.formula.tree import Formula
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
)
from rigidsym.notes.figure.tikz import tikz
from rigidsym.notes.formats.escape import escape
from rigidsym.notes.formats.paging import paged
from rigidsym.notes.prose.prose import announcement
from rigidsym.notes.sanitize import cleaned
from rigidsym.system import resources
from rigidsym.version import __version__

ENDING = "tex"
TEMPLATE = "note.tex.jinja"
_DELIMITERS = {
    "block_start_string": "((*",
    "block_end_string": "*))",
    "variable_start_string": "(((",
    "variable_end_string": ")))",
    "comment_start_string": "((=",
    "comment_end_string": "=))",
}
_LINE = 41.5  # ems: 160 mm at 11 points
_TALL = 30  # lines of text, of about fifty on a page: more than these may part


def render(document: Document) -> str:
    """The note as a LaTeX file; the same document gives the same bytes."""
    printer = _LatexPrinter(document)
    template = resources.environment(**_DELIMITERS).get_template(TEMPLATE)
    return template.render(
        title=escape(document.title),
        subtitle=escape(document.subtitle),
        sections=[
            {"title": escape(section.title), "body": printer.body(section)}
            for section in document.sections
            if not section.on_own_page
        ],
        sheets=[
            {"title": escape(section.title), "body": printer.body(section)}
            for section in document.sections
            if section.on_own_page
        ],
        metadata=metadata(document),
        sources=[
            {"key": printer.key(place), "text": escape(source)}
            for place, source in enumerate(document.sources, start=1)
        ],
    )


def metadata(document: Document) -> str:
    """What a PDF says of itself, as the entries of its information dictionary."""
    said = {
        "Title": document.title,
        "Subject": document.subtitle,
        "Author": "rigidsym",
        "Creator": f"rigidsym {__version__}",
    }
    return " ".join(f"/{key} <{_utf16(text)}>" for key, text in said.items())


def _utf16(text: str) -> str:
    """Any text as a string of a PDF; nothing in it is TeX."""
    return ("\ufeff" + cleaned(text)).encode("utf-16-be", "replace").hex().upper()


class _LatexPrinter:
    """Blocks and spans of one document in LaTeX."""

    def __init__(self, document: Document) -> None:
        self.document = document
        self.notation = document.letters.notation
        self.pen = LatexPen(self.notation)

    def body(self, section: Section) -> str:
        return "\n".join(map(self._block, section.blocks))

    def _block(self, block: NoteBlock) -> str:
        match block:
            case Paragraph():
                # no empty line: a display that follows belongs to the paragraph
                return "\n" + self._text(block.text)
            case Equation():
                return self._equation(block)
            case EquationRow():
                packed = pack(block.equations, self.document.letters, _LINE, self.pen)
                return f"\\[\n{packed}\n\\]"
            case NoteTable():
                return "\n".join(map(self._table, paged(block)))
            case Figure():
                return self._figure(block)
            case CodeBlock():
                return f"{{\\keep\n\\begin{{verbatim}}\n{block.code}\n\\end{{verbatim}}\n}}"

    def _equation(self, equation: Equation) -> str:
        width = PAGE if equation.number else _LINE
        shown = display(equation, self.document.letters, width, self.pen)
        announced = self._text(announcement(equation, shown.done))
        lines = [announced] if announced else []
        if shown.rows and shown.rows.height > _TALL:
            lines += self._over_pages(equation, shown.rows)
        else:
            lines += self._at_once(equation, shown.text)
        if equation.number:
            lines.append(rf"\remark{{{self._claims(equation)}}}{{{self._function(equation)}}}")
        return "\n".join(lines)

    def _at_once(self, equation: Equation, inside: str) -> list[str]:
        if not equation.number:
            return [f"\\[\n{inside}\n\\]"]
        begin = f"\\begin{{resultof}}{{{equation.number}}}{{{self._label(equation.label)}}}"
        return [begin, inside, r"\end{resultof}"]

    def _over_pages(self, equation: Equation, rows: Rows) -> list[str]:
        """Lines between which a page may end, which a box would keep together."""
        environment = "align*" if rows.are_aligned else "gather*"
        pen, label = self.pen, self._label(equation.label)
        lines = [
            pen.line(line) if rows.are_aligned else pen.continued(line.body, line.indent)
            for line in rows.lines
        ]
        number = [rf"\tag{{{equation.number}}}\label{{{label}}}"] if equation.number else []
        return [
            rf"{{\freely\begin{{{environment}}}",
            self.pen.joined(lines, rows.is_high),
            *number,
            rf"\end{{{environment}}}}}",
        ]

    def _claims(self, equation: Equation) -> str:
        kinds = (("Proved", equation.proved), (r"\textbf{Unproved}", equation.unproved))
        return " ".join(
            f"{kind}: {', '.join(map(self._display_style, claims))}."
            for kind, claims in kinds
            if claims
        )

    def _function(self, equation: Equation) -> str:
        return rf"\texttt{{{escape(equation.function)}}}" if equation.function else ""

    def _table(self, table: NoteTable) -> str:
        head, *rows = (
            " & ".join(map(self._cell, row)) + r" \\" for row in (table.head, *table.rows)
        )
        return "\n".join(
            [
                rf"\begin{{ruled}}{{{_columns(table)}}}{{{escape(table.caption)}}}",
                head,
                r"\midrule",
                *rows,
                r"\end{ruled}",
            ]
        )

    def _figure(self, figure: Figure) -> str:
        number = self.document.figures.index(figure) + 1
        words = self._text(
            (Strong(f"Figure {number}."), " ", *figure.caption, " ", *figure.description)
        )
        drawing = f"\n\\begin{{drawing}}\n{tikz(figure.drawing)}\n\\end{{drawing}}"
        return f"{drawing}\n\\inthefigure{{{words}}}"

    def _cell(self, text: Text) -> str:
        return "".join(self._tall(s) if isinstance(s, Formula) else self._span(s) for s in text)

    def _text(self, text: Text) -> str:
        return "".join(map(self._span, text))

    def _span(self, span: Span) -> str:
        match span:
            case str():
                return escape(self.notation.words(span))
            case Formula():
                return f"${self.pen.write(span).text}$"
            case Code():
                return rf"\texttt{{{_breakable(escape(span.text))}}}"
            case Strong():
                return rf"\textbf{{{escape(span.text)}}}"
            case EquationReference():
                return rf"\eqref{{{self._label(span.label)}}}"
            case Cited():
                return self._cited(span)

    def _display_style(self, formula: Formula) -> str:
        """A formula in a line of its own height; fractions in small type would be hard to read."""
        written = self.pen.write(formula)
        style = r"\displaystyle " if written.height else ""
        return f"${style}{written.text}$"

    def _tall(self, formula: Formula) -> str:
        """The same in a table, where the fractions of neighbouring rows would touch."""
        written = self._display_style(formula)
        return rf"\tall{{{written}}}" if self.pen.write(formula).height else written

    def _cited(self, cited: Cited) -> str:
        place = f"[{escape(cited.place)}]" if cited.place else ""
        return rf"\cite{place}{{{self.key(self.document.source_number(cited))}}}"

    def key(self, source: int) -> str:
        """The key of a source, unique among the notes that may be bound together."""
        return self._label(f"source-{source}")

    def _label(self, label: str) -> str:
        return f"{self.document.name}:{label}"


def _breakable(code: str) -> str:
    """Code that a line may end in: names in it are long, and no word of them has a hyphen."""
    return code.replace(r"\_", r"\_\allowbreak ").replace("(", r"(\allowbreak ")


def _columns(table: NoteTable) -> str:
    """l for a column of one line a cell, T for the one of words."""
    return "".join("T" if place == table.of_words else "l" for place in range(len(table.head)))
