"""How sentences, formulas and matrices are set on the lines of a terminal."""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import chain
from typing import Any, Literal, NamedTuple

import sympy as sp

from rigidsym.formula.display import Equation
from rigidsym.formula.letters import Letters
from rigidsym.formula.pen import break_lines
from rigidsym.formula.scalars import formula_of, listed_entries, matrix_of
from rigidsym.formula.tree import Formula
from rigidsym.formula.unicode_pen import UnicodePen, columns

INDENT = "  "
_DEEPER = "    "
_NO_BREAK = "\u00a0"

Style = Callable[[str, Literal["heading", "dim"]], str]
Spans = tuple[Any, ...]  # words, formulas, and what else has a text


class Headline(NamedTuple):
    """A heading, with an aside at the right margin."""

    words: Spans
    aside: str = ""


class Line(NamedTuple):
    """Words and formulas on one line, however long."""

    spans: Spans


Block = str | Headline | Line | Equation | Spans  # a line as it is; spans are a sentence


def unstyled(words: str, _: str) -> str:
    """The style of a terminal without any."""
    return words


def lines_of(
    blocks: Sequence[Block], letters: Letters, width: int, style: Style = unstyled
) -> list[str]:
    """The lines of the blocks, at most `width` columns wide where formulas allow."""
    console = _Console(letters, width, style)
    return list(chain.from_iterable(map(console.block, blocks)))


class _Console:
    """Lines of Unicode in one width."""

    def __init__(self, letters: Letters, width: int, style: Style) -> None:
        self.letters = letters
        self.width = width
        self.style = style
        self.pen = UnicodePen(letters.notation)

    def block(self, block: Block) -> list[str]:
        match block:
            case str():
                return [block]
            case Headline():
                return self.headline(block)
            case Line(spans):
                return ["".join(s if isinstance(s, str) else self.text(s) for s in spans)]
            case Equation():
                return self.equation(block)
        return self.sentence(block)

    def text(self, formula: Formula) -> str:
        return self.pen.write(formula).text

    def words(self, spans: Spans) -> str:
        """A sentence on one line; its formulas have blanks at which no line may end."""
        return "".join(
            self.text(span).replace(" ", _NO_BREAK)
            if isinstance(span, Formula)
            else (span if isinstance(span, str) else span.text)
            for span in spans
        )

    def headline(self, block: Headline) -> list[str]:
        """The aside on a line of its own, if there is no room for it."""
        left, right = self.words(block.words), block.aside
        room = self.width - columns(left)
        if not right:
            return [self.style(left, "heading")]
        if room - columns(right) < len(INDENT):
            return [self.style(left, "heading"), self.style(right.rjust(self.width), "dim")]
        return [self.style(left, "heading") + self.style(right.rjust(room), "dim")]

    def sentence(self, spans: Spans) -> list[str]:
        """A sentence on as many lines as it needs."""
        lines = textwrap.wrap(
            self.words(spans),
            self.width,
            initial_indent=INDENT,
            subsequent_indent=_DEEPER,
            break_long_words=False,
            break_on_hyphens=False,
        )
        return [line.replace(_NO_BREAK, " ") for line in lines]

    def equation(self, equation: Equation) -> list[str]:
        """Sides with their value; without sides, its entries by their names."""
        sides, matrix = equation.sides, equation.matrix
        if matrix is None:
            *heads, value = sides if equation.scalar is None else (*sides, equation.scalar)
            return self._scalar(heads, value)
        if not sides:
            return self._listing(equation.entries, matrix)
        rows = matrix_of(matrix, self.letters).rows
        for lines in _forms(self._heads(sides), self._texts(rows)):
            if max(map(columns, lines)) <= self.width:
                return lines
        return self._listing(*zip(*listed_entries(equation.names, matrix), strict=True))

    def _scalar(self, sides: Sequence[Formula], value: Formula | sp.Expr) -> list[str]:
        """The value behind its sides, or below them, where a long one is broken."""
        shown = value if isinstance(value, Formula) else formula_of(value, self.letters)
        heads = self._heads(sides)
        whole = f"{INDENT}{heads[0]}{self.text(shown)}"
        if columns(whole) <= self.width:
            return [whole]
        head = f"{INDENT}{heads[-1]}".removesuffix("= ")
        if len(heads) == 1:
            return self._hung(f"{head}= ", shown)
        first = f"{INDENT}{heads[0].removesuffix(' = ')}"
        return [first, *self._hung(f"{' ' * columns(head)}= ", shown)]

    def _listing(self, names: Iterable[Formula], entries: Iterable[sp.Expr]) -> list[str]:
        """A line an entry; long ones are broken."""
        lines: list[str] = []
        for name, entry in zip(names, entries, strict=True):
            head = f"{INDENT}{self.text(name)} = "
            lines += self._hung(head, formula_of(entry, self.letters))
        return lines

    def _texts(self, rows: Iterable[Iterable[Formula]]) -> list[list[str]]:
        return [[self.text(entry) for entry in line] for line in rows]

    def _heads(self, sides: Sequence[Formula]) -> list[str]:
        """ "Ω′ = Rᵀ Ω = " and, where that is too long, "Ω′ = "."""
        symbol, *definition = filter(None, dict.fromkeys(map(self.text, sides)))
        short = f"{symbol} = "
        return [f"{short}{definition[0]} = ", short] if definition else [short]

    def _hung(self, head: str, value: Formula) -> list[str]:
        """A value behind a head; where it is long, its other lines hang below its start."""
        room = self.width - columns(head)
        first, *others = break_lines(self.pen.write(value), room, len(INDENT), self.pen.blank)
        hanging = (" " * columns(head) + INDENT * line.level + line.text for line in others)
        return [head + first.text, *hanging]


def _forms(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> Iterator[list[str]]:
    """The matrix beside each head, or below the first one; with wide gaps or with narrow ones."""
    for head in heads:
        yield grid(INDENT + head, rows)
        yield grid(INDENT + head, rows, tight=True)
    below = [INDENT + heads[0].rstrip()]
    yield [*below, *grid(_DEEPER, rows)]
    yield [*below, *grid(_DEEPER, rows, tight=True)]


def grid(prefix: str, rows: Sequence[Sequence[str]], *, tight: bool = False) -> list[str]:
    """The lines of `prefix` followed by a matrix in brackets; the prefix stands half-way down.

    A single column is set flush left, several columns are centred.
    """
    gap, margin = ("  ", "") if tight else ("   ", " ")
    widths = [max(map(columns, column)) for column in zip(*rows, strict=True)]
    inside: list[str] = []
    for row in rows:
        rooms = [width - columns(text) for text, width in zip(row, widths, strict=True)]
        before = [room // 2 if len(widths) > 1 else 0 for room in rooms]
        cells = zip(row, before, rooms, strict=True)
        set_out = (" " * left + text + " " * (room - left) for text, left, room in cells)
        inside.append(margin + gap.join(set_out) + margin)
    brackets = [("⎡", "⎤"), *[("⎢", "⎥")] * (len(rows) - 2), ("⎣", "⎦")]
    brackets = brackets if len(rows) > 1 else [("[", "]")]
    middle = (len(rows) - 1) // 2
    blank = " " * columns(prefix)
    return [
        f"{prefix if place == middle else blank}{left}{line}{right}"
        for place, (line, (left, right)) in enumerate(zip(inside, brackets, strict=True))
    ]
