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
from rigidsym.formula.sheet_pen import Inline
from rigidsym.notes.document.document import (
    CodeBlock,
    Document,
    Equation,
    EquationRow,
    Figure,
    NoteTable,
    Paragraph,
    Section,
    Text,
)
from rigidsym.notes.formats.printer import NotePrinter, cleaned
from rigidsym.notes.prose.prose import announcement

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


class _MarkdownPrinter(NotePrinter):
    def __init__(self, document: Document) -> None:
        super().__init__(document, MarkdownPen(document.letters.notation))

    def section(self, section: Section) -> Iterator[str | CodeBlock]:
        prose = [f"## {escape(section.title)}"]
        for block in section.blocks:
            if isinstance(block, CodeBlock):
                yield "\n\n".join(prose)
                yield block
                prose = []
            else:
                prose.append(self.block(block))
        if prose:
            yield "\n\n".join(prose)

    def sources(self) -> str:
        lines = (f"{place}. {escape(s)}" for place, s in enumerate(self.document.sources, start=1))
        return "\n".join(["## Sources", "", *lines])

    def paragraph(self, block: Paragraph) -> str:
        return _LINE_START.sub(_unlisted, self.text(block.text).lstrip())

    def equation(self, equation: Equation) -> str:
        shown = display(equation, self.document.letters, _WIDTH, self.pen)
        announced = self.text(announcement(equation, shown.done))
        tag = f"\n\\tag{{{equation.number}}}" if equation.number else ""
        function = [_code(equation.function)] if equation.function else []
        remarks = " · ".join([*self.claims(equation), *function])
        return "\n\n".join(filter(None, [announced, _display(shown.text + tag), remarks]))

    def equationrow(self, block: EquationRow) -> str:
        return _display(pack(block.equations, self.document.letters, _WIDTH, self.pen))

    def figure(self, figure: Figure) -> str:
        return self.text(figure.description)

    def notetable(self, table: NoteTable) -> str:
        rows = [self._row(table.head), "|---" * len(table.head) + "|", *map(self._row, table.rows)]
        return f"*{escape(table.caption)}*\n\n" + "\n".join(rows)

    def _row(self, cells: Sequence[Text]) -> str:
        return f"| {' | '.join(map(self.text, cells))} |"

    def words(self, words: str) -> str:
        return _inside(words)

    def formula_of(self, inline: Inline) -> str:
        return f"${inline.parts[0]}$"

    def code(self, text: str) -> str:
        return _code(text)

    def strong(self, text: str) -> str:
        return f"**{escape(text)}**"

    def reference(self, label: str) -> str:
        return f"({self.document.number(label)})"

    def citation(self, number: int, place: str) -> str:
        return f"[{number}{f', {_inside(place)}' if place else ''}]"


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
