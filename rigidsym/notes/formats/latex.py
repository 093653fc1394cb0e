"""Document -> LaTeX. The template only places the pieces that are made here."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from math import ceil

from rigidsym.formula.display import PAGE, Rows, display, pack
from rigidsym.formula.latex_pen import LatexPen
from rigidsym.formula.sheet_pen import Inline
from rigidsym.formula.tree import Formula
from rigidsym.notes.document.document import (
    CodeBlock,
    Document,
    Equation,
    EquationRow,
    Figure,
    NoteTable,
    Paragraph,
    Text,
    plain,
)
from rigidsym.notes.figure.tikz import tikz
from rigidsym.notes.formats.escape import escape
from rigidsym.notes.formats.printer import NotePrinter, cleaned
from rigidsym.notes.prose.prose import announcement
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


class _LatexPrinter(NotePrinter):
    pen: LatexPen
    words = staticmethod(escape)

    def __init__(self, document: Document) -> None:
        super().__init__(document, LatexPen(document.letters.notation))

    def paragraph(self, block: Paragraph) -> str:
        # no empty line: a display that follows belongs to the paragraph
        return "\n" + self.text(block.text)

    def equationrow(self, block: EquationRow) -> str:
        return f"\\[\n{pack(block.equations, self.document.letters, _LINE, self.pen)}\n\\]"

    def codeblock(self, block: CodeBlock) -> str:
        return f"{{\\keep\n\\begin{{verbatim}}\n{block.code}\n\\end{{verbatim}}\n}}"

    def equation(self, equation: Equation) -> str:
        width = PAGE if equation.number else _LINE
        shown = display(equation, self.document.letters, width, self.pen)
        announced = self.text(announcement(equation, shown.done))
        lines = [announced] if announced else []
        if shown.rows and shown.rows.height > _TALL:
            lines += self._over_pages(equation, shown.rows)
        else:
            lines += self._at_once(equation, shown.text)
        if equation.number:
            said = " ".join(f"{claim}." for claim in self.claims(equation))
            function = self._typed(equation.function) if equation.function else ""
            lines.append(rf"\remark{{{said}}}{{{function}}}")
        return "\n".join(lines)

    def _at_once(self, equation: Equation, inside: str) -> list[str]:
        if not equation.number:
            return [f"\\[\n{inside}\n\\]"]
        begin = f"\\begin{{resultof}}{{{equation.number}}}{{{self._label(equation.label)}}}"
        return [begin, inside, r"\end{resultof}"]

    def _over_pages(self, equation: Equation, rows: Rows) -> list[str]:
        """Lines between which a page may end, which a box would keep together."""
        environment = "align*" if rows.are_aligned else "gather*"
        label = self._label(equation.label)
        number = [rf"\tag{{{equation.number}}}\label{{{label}}}"] if equation.number else []
        return [
            rf"{{\freely\begin{{{environment}}}",
            rows.joined(self.pen),
            *number,
            rf"\end{{{environment}}}}}",
        ]

    def claim(self, claim: Formula) -> str:
        """A formula in a line of its own height; fractions in small type would be hard to read."""
        (text,), is_tall = self.inline(claim)
        return rf"$\displaystyle {text}$" if is_tall else f"${text}$"

    def notetable(self, table: NoteTable) -> str:
        return "\n".join(map(self._table, self._paged(table)))

    def _paged(self, table: NoteTable) -> Iterator[NoteTable]:
        """The table, or its parts; those after the first say in the caption that they go on."""
        heights = [max(map(self._height, row)) for row in table.rows]
        room = sum(heights) / max(1, ceil(sum(heights) / _ROWS))  # parts of about one height
        part: list[tuple[Text, ...]] = []
        used, caption = 0, table.caption
        for row, height in zip(table.rows, heights, strict=True):
            if part and used >= room:
                yield replace(table, caption=caption, rows=tuple(part))
                part, used, caption = [], 0, f"{table.caption}, continued"
            part.append(row)
            used += height
        yield replace(table, caption=caption, rows=tuple(part))

    def _height(self, cell: Text) -> int:
        """In lines: a fraction is as high as two."""
        if any(isinstance(span, Formula) and self.inline(span).is_tall for span in cell):
            return 2
        words = any(isinstance(span, str) and " " in span for span in cell)
        return ceil(len(plain(cell)) / _WORDS) or 1 if words else 1

    def _table(self, table: NoteTable) -> str:
        head, *rows = (
            " & ".join(map(self._cell, row)) + r" \\" for row in (table.head, *table.rows)
        )
        # l for a column of one line a cell, T for the one of words
        columns = "".join("T" if k == table.of_words else "l" for k in range(len(table.head)))
        begin = rf"\begin{{ruled}}{{{columns}}}{{{escape(table.caption)}}}"
        return "\n".join([begin, head, r"\midrule", *rows, r"\end{ruled}"])

    def _cell(self, text: Text) -> str:
        return "".join(self._tall(s) if isinstance(s, Formula) else self.span(s) for s in text)

    def _tall(self, formula: Formula) -> str:
        """In a table, where the fractions of neighbouring rows would touch."""
        written = self.claim(formula)
        return rf"\tall{{{written}}}" if self.inline(formula).is_tall else written

    def figure(self, figure: Figure) -> str:
        drawing = f"\n\\begin{{drawing}}\n{tikz(figure.drawing)}\n\\end{{drawing}}"
        return f"{drawing}\n\\inthefigure{{{self.figure_words(figure)}}}"

    def formula_of(self, inline: Inline) -> str:
        return f"${inline.parts[0]}$"

    def _typed(self, code: str) -> str:
        return rf"\texttt{{{escape(code)}}}"

    def code(self, text: str) -> str:
        """A line may end within: names in it are long, and no word of them has a hyphen."""
        typed = self._typed(text)
        return typed.replace(r"\_", r"\_\allowbreak ").replace("(", r"(\allowbreak ")

    def strong(self, text: str) -> str:
        return rf"\textbf{{{escape(text)}}}"

    def reference(self, label: str) -> str:
        return rf"\eqref{{{self._label(label)}}}"

    def citation(self, number: int, place: str) -> str:
        return rf"\cite{f'[{escape(place)}]' if place else ''}{{{self.key(number)}}}"

    def key(self, source: int) -> str:
        """The key of a source, unique among the notes that may be bound together."""
        return self._label(f"source-{source}")

    def _label(self, label: str) -> str:
        return f"{self.document.name}:{label}"


_ROWS = 40  # on a page, beside a heading
_WORDS = 44  # letters of a column of words
