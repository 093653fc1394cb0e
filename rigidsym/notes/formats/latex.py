"""Document -> LaTeX. The template only places the pieces that are made here."""

from __future__ import annotations

from rigidsym.formula.display import PAGE, Display, pack
from rigidsym.formula.latex_pen import LatexPen
from rigidsym.formula.tree import Formula
from rigidsym.notes.document import (
    Document,
    Equation,
    EquationReference,
    EquationRow,
    Figure,
    NoteTable,
    Paragraph,
    Section,
    Span,
    Text,
)
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
_LINE_OF_A_SOURCE = 95  # letters
_TALL = 30  # lines of text, of about fifty on a page: more than these may part


def render(document: Document) -> str:
    """The note as a LaTeX file; the same document gives the same bytes."""
    printer = _LatexPrinter(document)
    sections = [
        {
            "title": escape(section.title),
            "body": printer.body(section),
            # that stay on one page: more if it begins with a table
            "lines": 14 if any(isinstance(b, NoteTable) for b in section.blocks[:2]) else 6,
        }
        for section in document.sections
    ]
    lines = 4 + sum(1 + len(source) // _LINE_OF_A_SOURCE for source in document.sources)
    parts = {
        "sections": sections,
        "metadata": metadata(document),
        "source_lines": min(30, lines),  # a list that is not long stays on one page
        **printer.placed(),
    }
    return resources.environment(**_DELIMITERS).get_template(TEMPLATE).render(parts)


def metadata(document: Document) -> str:
    """What a PDF says of itself, as the entries of its information dictionary."""
    said = {
        "Title": document.title,
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
    pen: LatexPen
    heading = ""  # of the section; a table need not repeat it as its caption
    words = staticmethod(escape)
    width = _LINE
    beside_number = PAGE

    def __init__(self, document: Document) -> None:
        super().__init__(document, LatexPen(document.letters.notation))
        blocks = [block for section in document.sections for block in section.blocks]
        rows = [block for block in blocks if isinstance(block, EquationRow)]
        self.rows = {r: pack(r.equations, document.letters, _LINE, self.pen) for r in rows}

    def body(self, section: Section) -> str:
        self.heading = section.title
        return super().body(section)

    def paragraph(self, block: Paragraph) -> str:
        # no empty line: a display that follows belongs to the paragraph
        return "\n" + self.text(block.text)

    def equationrow(self, block: EquationRow) -> str:
        return f"\\[\n{self.rows[block]}\n\\]"

    def equation(self, equation: Equation) -> str:
        shown = self.shown[equation]
        announced = self.announced(equation, shown.done)
        lines = [announced] if announced else []
        if shown.height > _TALL:
            lines += self._over_pages(equation, shown)
        elif equation.number:
            begin = rf"\begin{{resultof}}{{{self._label(equation.label)}}}"
            lines += [*self._from(equation.number), begin, shown.text, r"\end{resultof}"]
        else:
            lines.append(f"\\[\n{shown.text}\n\\]")
        said = " ".join(f"{claim}." for claim in self.claims(equation))
        function = self._typed(equation.function) if equation.function else ""
        if said or function:
            lines = ["{\\followed", *lines, "}", rf"\remark{{{said}}}{{{function}}}"]
        return "\n".join(lines)

    def _from(self, number: int) -> list[str]:
        """TeX counts the equations; where the numbers of a theory leave some out, so does TeX."""
        numbers = (equation.number or 0 for equation in self.document.equations)
        before = max((n for n in numbers if n < number), default=0)
        is_next = number == before + 1
        return [] if is_next else [rf"\setcounter{{equation}}{{{number - 1}}}"]

    def _over_pages(self, equation: Equation, shown: Display) -> list[str]:
        """Lines between which a page may end, which a box would keep together."""
        environment = shown.environment.replace("ed", "*")  # align* for aligned
        number = [rf"\numbered{{{self._label(equation.label)}}}"] if equation.number else []
        return [
            *(self._from(equation.number) if equation.number else []),
            rf"{{\freely\begin{{{environment}}}",
            shown.inside,
            *number,
            rf"\end{{{environment}}}}}",
        ]

    def claim(self, claim: Formula) -> str:
        """A formula in a line of its own height; fractions in small type would be hard to read."""
        piece = self.pen.write(claim)
        return rf"$\displaystyle {piece.text}$" if piece.height else f"${piece.text}$"

    def notetable(self, table: NoteTable) -> str:
        head, *rows = (list(map(self._cell, row)) for row in (table.head, *table.rows))
        # l for a column of one line a cell, T for the one of words
        columns = "".join("T" if k == table.of_words else "l" for k in range(len(table.head)))
        parts = self._parts(table)
        if parts > 1:
            high = -(-len(rows) // parts)
            rows += [[""] * len(head)] * (parts * high - len(rows))
            beside = zip(*(rows[k : k + high] for k in range(0, len(rows), high)), strict=True)
            rows = [[cell for row in line for cell in row] for line in beside]
            head = head * parts
            columns = rf"@{{\hspace{{{_GAPS[parts]}em}}}}".join([columns] * parts)
        lines = [" & ".join(row) + r" \\" for row in (head, *rows)]
        is_said = table.caption.lower() in self.heading.lower()
        caption = "" if is_said else escape(table.caption)
        height = 3 + sum(2.5 if r"\tall" in line else 1.2 for line in lines)
        is_short = bool(caption) and len(lines) <= _TOGETHER
        room = [rf"\room{{{height:.1f}\baselineskip}}"] if is_short else []
        begin = rf"\begin{{ruled}}{{{columns}}}{{{len(head)}}}{{{caption}}}"
        return "\n".join([*room, begin, f"{{{lines[0]}}}", *lines[1:], r"\end{ruled}"])

    def _parts(self, table: NoteTable) -> int:
        """In how many parts beside one another a narrow table is set."""
        if len(table.rows) < _MANY or len(table.head) > 2:
            return 1
        for parts in (3, 2):
            high = -(-len(table.rows) // parts)
            beside = (table._replace(rows=table.rows[k * high :][:high]) for k in range(parts))
            width = sum(map(self._width, beside)) + _GAPS[parts] * (parts - 1)
            if width <= _SLACK * _LINE / _SMALL:
                return parts
        return 1

    def _width(self, table: NoteTable) -> float:
        """About how wide a table is, in ems."""
        columns = zip(table.head, *table.rows, strict=True)
        return sum(
            _COLUMN_GAP + max(sum(map(self._width_of_span, cell)) for cell in column)
            for column in columns
        )

    def _width_of_span(self, span: Span) -> float:
        if isinstance(span, Formula):
            return self.pen.write(span).width
        words = span if isinstance(span, str) else span.text
        return _LETTER * (4 if isinstance(span, EquationReference) else len(words))

    def _cell(self, text: Text) -> str:
        written = ""
        for span in text:
            part = self.claim(span) if isinstance(span, Formula) else self.span(span)
            if isinstance(span, Formula) and self.pen.write(span).height:
                part = rf"\tall{{{part}}}"  # or the fractions of neighbouring rows would touch
            written += part
        is_number = len(text) == 1 and isinstance(text[0], EquationReference)
        return rf"\numbercell{{{written}}}" if is_number else written

    def figure(self, figure: Figure) -> str:
        drawing = f"\n\\begin{{drawing}}\n{tikz(figure.drawing)}\n\\end{{drawing}}"
        return f"{drawing}\n\\inthefigure{{{self.figure_words(figure)}}}"

    def figure_title(self, number: int) -> str:
        return rf"\figuretitle{{Figure}}{{{self._label(f'figure-{number}')}}}"

    def figure_number(self, number: int) -> str:
        """As TeX counts them, which is the place of the figure in a larger document."""
        return rf"\ref{{{self._label(f'figure-{number}')}}}"

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


_TOGETHER = 8  # lines of a table that stay on one page
_MANY = 8  # rows of a narrow table that are set in two parts or three
_GAPS = {2: 3, 3: 1}  # ems between them
_SLACK = 1.05  # by which they may seem too wide: the widths of formulas are upper bounds
_SMALL = 0.9  # size of a table
_COLUMN_GAP = 1.1  # ems
_LETTER = 0.5  # ems
