"""Document -> Markdown with mathematics between dollar signs, as GitHub and Jupyter read it.

Some readers take out the mathematics before they look for Markdown, some after. So formulas are
written without what Markdown would change: no backslash before punctuation, and no underscore
that could end an emphasis.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

from rigidsym.formula.display import display, pack
from rigidsym.formula.latex_pen import MarkdownPen
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
    NoteTable,
    Paragraph,
    Section,
    Span,
    Strong,
    Text,
)
from rigidsym.notes.prose.prose import announcement
from rigidsym.notes.sanitize import cleaned

ENDING = "md"
_WIDTH = 40.0  # ems
_SPECIAL = re.compile(r"([\\`*_{}\[\]<>#&~|!@])")
_DOLLARS = re.compile(r"\$+")
_LINE_START = re.compile(r"^(\s*)(?:([-+=])|(\d+)([.)]))")
_TICKS = re.compile(r"`+")


def render(document: Document) -> str:
    """The note as Markdown; the same document gives the same bytes."""
    pieces = (_fenced(p) if isinstance(p, CodeBlock) else p for p in parts(document))
    return "\n\n".join(pieces) + "\n"


def parts(document: Document) -> Iterator[str | CodeBlock]:
    """The note in pieces, in order: Markdown text, and the programs between."""
    printer = _MarkdownPrinter(document)
    yield f"# {escape(document.title)}\n\n{escape(document.subtitle)}"
    for section in document.sections:
        yield from printer.section(section)
    yield printer.sources()


def escape(text: str) -> str:
    """Any text as Markdown text, on a line of its own."""
    return _LINE_START.sub(_unlisted, _inside(text).strip())


def _unlisted(start: re.Match[str]) -> str:
    """The start of a line that would begin a list, a quotation or a heading."""
    blank, mark, number, point = start.groups()
    return f"{blank}\\{mark}" if mark else f"{blank}{number}\\{point}"


class _MarkdownPrinter:
    """Blocks and spans of one document in Markdown."""

    def __init__(self, document: Document) -> None:
        self.document = document
        self.notation = document.letters.notation
        self.pen = MarkdownPen(self.notation)

    def section(self, section: Section) -> Iterator[str | CodeBlock]:
        prose = [f"## {escape(section.title)}"]
        for block in section.blocks:
            if isinstance(block, CodeBlock):
                yield "\n\n".join(prose)
                yield block
                prose = []
            else:
                prose.append(self._block(block))
        if prose:
            yield "\n\n".join(prose)

    def sources(self) -> str:
        lines = (f"{place}. {escape(s)}" for place, s in enumerate(self.document.sources, start=1))
        return "\n".join(["## Sources", "", *lines])

    def _block(self, block: Paragraph | Equation | EquationRow | Figure | NoteTable) -> str:
        match block:
            case Paragraph():
                return _LINE_START.sub(_unlisted, self._text(block.text).lstrip())
            case Equation():
                return "\n\n".join(self._equation(block))
            case EquationRow():
                return _display(pack(block.equations, self.document.letters, _WIDTH, self.pen))
            case Figure():
                return self._text(block.description)
            case NoteTable():
                return self._table(block)

    def _equation(self, equation: Equation) -> Iterator[str]:
        shown = display(equation, self.document.letters, _WIDTH, self.pen)
        announced = announcement(equation, shown.done)
        if announced:
            yield self._text(announced)
        tag = f"\n\\tag{{{equation.number}}}" if equation.number else ""
        yield _display(shown.text + tag)
        remarks = [*self._claims(equation), *self._function(equation)]
        if remarks:
            yield " · ".join(remarks)

    def _claims(self, equation: Equation) -> Iterator[str]:
        kinds = (("Proved", equation.proved), ("**Unproved**", equation.unproved))
        for kind, claims in kinds:
            if claims:
                yield f"{kind}: {', '.join(map(self._span, claims))}"

    def _function(self, equation: Equation) -> Iterator[str]:
        if equation.function:
            yield self._span(Code(equation.function))

    def _table(self, table: NoteTable) -> str:
        rows = [self._row(table.head), "|---" * len(table.head) + "|", *map(self._row, table.rows)]
        return f"*{escape(table.caption)}*\n\n" + "\n".join(rows)

    def _row(self, cells: Sequence[Text]) -> str:
        return f"| {' | '.join(map(self._text, cells))} |"

    def _text(self, text: Text) -> str:
        return "".join(map(self._span, text))

    def _span(self, span: Span) -> str:
        match span:
            case str():
                return _inside(self.notation.words(span))
            case Formula():
                return f"${self.pen.write(span).text}$"
            case Code():
                return _code(span.text)
            case Strong():
                return f"**{escape(span.text)}**"
            case EquationReference():
                return f"({self.document.number(span.label)})"
            case Cited():
                return self._cited(span)

    def _cited(self, cited: Cited) -> str:
        place = f", {_inside(cited.place)}" if cited.place else ""
        return f"[{self.document.source_number(cited)}{place}]"


def _inside(text: str) -> str:
    """Text within a line: blanks at its ends part it from what is beside it.

    Escaped dollar signs are mathematics to Jupyter after Markdown has taken the escapes away;
    inside code they never are.
    """
    return _DOLLARS.sub(r"`\g<0>`", _SPECIAL.sub(r"\\\1", cleaned(text)))


def _display(latex: str) -> str:
    return f"$$\n{latex}\n$$"


def _code(text: str) -> str:
    """A code span, in more ticks than the text holds."""
    ticks = "`" * (1 + max(map(len, _TICKS.findall(text)), default=0))
    inside = f" {text} " if text.startswith("`") or text.endswith("`") else text
    return f"{ticks}{inside}{ticks}"


def _fenced(program: CodeBlock) -> str:
    return f"```python\n{program.code}\n```"
