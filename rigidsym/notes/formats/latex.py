"""Document -> LaTeX. The template only places the pieces that are made here."""

from __future__ import annotations

import re

from rigidsym.formula.display import PAGE, pack
from rigidsym.formula.latex_pen import LatexPen
from rigidsym.formula.reader import text_of
from rigidsym.formula.tree import Formula
from rigidsym.notes import document as doc
from rigidsym.notes.formats.drawings import tikz
from rigidsym.notes.formats.escape import cleaned, escape
from rigidsym.notes.formats.printer import NotePrinter
from rigidsym.system import resources
from rigidsym.version import __version__

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
_TALL = 11  # lines of a display, of about 25 high ones on a page: more than these may part


def render(document: doc.Document) -> str:
    """The note as a LaTeX file; the same document gives the same bytes."""
    printer = _LatexPrinter(document, LatexPen(document.letters.notation))
    sections = [(escape(s.title), printer.body(s)) for s in document.sections]
    parts = {"sections": sections, "metadata": metadata(document), **printer.placed()}
    return resources.environment(**_DELIMITERS).get_template(TEMPLATE).render(parts)


def metadata(document: doc.Document) -> str:
    """What a PDF says of itself, as the entries of its information dictionary."""
    said = {
        "Title": text_of(document.title),
        "Subject": document.subtitle,
        "Author": document.author or "rigidsym",
        "Creator": f"rigidsym {__version__}",
    }
    # in UTF-16 a string of a PDF may be any text, and nothing in it is TeX
    codes = {
        key: ("\ufeff" + cleaned(text)).encode("utf-16-be", "replace").hex().upper()
        for key, text in said.items()
    }
    return " ".join(f"/{key} <{code}>" for key, code in codes.items())


class _LatexPrinter(NotePrinter):
    counter = 0  # the number of the last equation, as TeX counts them
    words = staticmethod(escape)
    width = _LINE
    beside_number = PAGE
    strong = r"\textbf{{{}}}"
    emphasis = r"\emph{{{}}}"
    link = r"\href{{{address}}}{{{}}}"
    reference = r"\eqref{{{label}}}"
    # as TeX counts them, which is the place of the figure in a larger document
    figure_number = r"\ref{{{label}}}"
    figure_title = r"\figuretitle{{Figure}}{{{label}}}"
    citation = r"\cite{place}{{{label}}}"
    place_in_source = "[{}]"

    def label(self, label: str) -> str:
        """Unique among the notes that may be bound together."""
        return f"{self.document.name}:{label}"

    def code(self, text: str) -> str:
        """A line may end within: names in it are long, and no word of them has a hyphen."""
        return _typed(text).replace(r"\_", r"\_\allowbreak ").replace("(", r"(\allowbreak ")

    def paragraph(self, block: doc.Paragraph) -> str:
        # no empty line: a display that follows belongs to the paragraph
        return "\n" + self.text(block.text)

    def address(self, address: str) -> str:
        return re.sub("[#%&_]", r"\\\g<0>", address)

    def listing(self, block: doc.Listing) -> str:
        marks = ("{}" if mark == "-" else f"[{mark}]" for mark in block.marks)
        pairs = zip(marks, map(self.text, block.items), strict=True)
        items = "\n".join(rf"\item{mark} {text}" for mark, text in pairs)
        return f"\\begin{{itemize}}\\setlength{{\\itemsep}}{{0pt}}\n{items}\n\\end{{itemize}}"

    def equationrow(self, block: doc.EquationRow) -> str:
        return f"\\[\n{pack(block.equations, self.document.letters, _LINE, self.pen)}\n\\]"

    def equation(self, equation: doc.Equation) -> str:
        layout, label = self.displays[equation], self.label(equation.label)
        lines = [announced] if (announced := self.announced(equation)) else []
        number, is_first = equation.number or 0, bool(equation.number and equation.label)
        tag = rf"\numbered{{{label}}}" if is_first else rf"\tag{{{number}}}" if number else ""
        # a theory leaves numbers out, a style may change the order, and TeX counts
        if is_first and number != self.counter + 1:
            lines.append(rf"\setcounter{{equation}}{{{number - 1}}}")
        self.counter = number if is_first else self.counter
        if layout.lines > _TALL:
            # lines between which a page may end, which a box would keep together
            environment = layout.environment.replace("ed", "*")  # align* for aligned
            lines += [rf"{{\freely\begin{{{environment}}}", layout.inside]
            lines += [tag] if tag else []
            lines.append(rf"\end{{{environment}}}}}")
        elif is_first:
            lines += [rf"\begin{{resultof}}{{{label}}}", layout.text, r"\end{resultof}"]
        else:
            lines.append(f"\\[\n{layout.text}{tag}\n\\]")
        remarks = " ".join(f"{claim}." for claim in self.claims(equation))
        function = _typed(equation.function) if equation.function else ""
        if remarks or function:
            lines = ["{\\followed", *lines, "}", rf"\remark{{{remarks}}}{{{function}}}"]
        return "\n".join(lines)

    def claim(self, claim: Formula) -> str:
        """A formula in a line of its own height; fractions in small type would be hard to read."""
        piece = self.pen.write(claim)
        return rf"$\displaystyle {piece.text}$" if piece.height else f"${piece.text}$"

    def notetable(self, table: doc.NoteTable) -> str:
        # l for a column of one line a cell, T for the one of words
        columns = "".join("T" if k == table.of_words else "l" for k in range(len(table.head)))
        rows = (" & ".join(map(self._cell, row)) for row in (table.head, *table.rows))
        lines = [rf"{row} \\" for row in rows]
        caption = escape(table.caption)
        begin = rf"\begin{{ruled}}{{{columns}}}{{{len(table.head)}}}{{{caption}}}"
        return "\n".join([begin, f"{{{lines[0]}}}", *lines[1:], r"\end{ruled}"])

    def _cell(self, text: doc.Text) -> str:
        written = ""
        for span in text:
            part = self.claim(span) if isinstance(span, Formula) else self.span(span)
            if isinstance(span, Formula) and self.pen.write(span).height:
                part = rf"\tall{{{part}}}"  # or the fractions of neighbouring rows would touch
            written += part
        is_number = len(text) == 1 and isinstance(text[0], doc.EquationReference)
        return rf"\numbercell{{{written}}}" if is_number else written

    def figure(self, figure: doc.Figure) -> str:
        drawing = f"\n\\begin{{drawing}}\n{tikz(figure.drawing)}\n\\end{{drawing}}"
        return f"{drawing}\n\\inthefigure{{{self.figure_words(figure)}}}"


def _typed(code: str) -> str:
    return rf"\texttt{{{escape(code)}}}"
