"""What is common to the pens that typeset: sizes of brackets, widths, lines below one another."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from rigidsym.formula import widths
from rigidsym.formula.pen import Binding, Height, Pen, Piece
from rigidsym.formula.tree import (
    Bracket,
    Differential,
    Formula,
    FunctionCall,
    Numeral,
    Power,
    Rate,
    Symbol,
    Words,
    is_differential,
    row,
)

Size = Literal["flat", "large", "stretched"]


@dataclass(frozen=True, slots=True)
class Aligned:
    """A line of a display: what stands before its first sign, and what behind; or all in one."""

    head: str
    body: str
    sign: str = ""  # "=" where the line starts a side
    indent: int = 0  # quads, of a line that goes on
    height: Height = Height.FLAT


class SheetPen(Pen):
    """Subclasses spell; widths are those of the note's font in ems."""

    def symbol(self, symbol: Symbol) -> Piece:
        index = None
        width = widths.letter_width(symbol)
        if symbol.prime:
            width += widths.PRIME if symbol.prime == "′" else widths.SCRIPT
        if symbol.index is not None:
            written = self.indices(symbol.index)
            index = written.text
            width += widths.SCRIPT * written.width
        return self.atom(self.spelt_symbol(symbol, index), width)

    def indexed(self, base: Piece, index: Piece) -> Piece:
        width = base.width + widths.SCRIPT * index.width
        return self.atom(self.spelt_index(base.text, index.text), width, height=base.height)

    def number(self, digits: str) -> Piece:
        return self.atom(self.spelt_number(digits), widths.DIGIT * len(digits), Binding.NUMBER)

    def sign(self, character: str, *, is_binary: bool) -> Piece:
        return self.atom(self.spelt_sign(character, is_binary), widths.sign_width(character))

    def between(self, before: Formula, after: Formula) -> Piece:
        is_thin = _is_thin(before, after) or self._is_short(after)
        return self.atom(self.spelt_gap(before, after, is_thin), widths.THIN if is_thin else 0.0)

    def call(self, function: str, argument: Piece, exponent: int, given: Formula) -> Piece:
        if self._is_short(FunctionCall(function, given)):
            letter = Symbol(function[0], index=given)
            return self.node(letter if exponent == 1 else Power(letter, Numeral(str(exponent))))
        width = widths.function_width(function)
        if exponent != 1:
            width += widths.SCRIPT * widths.DIGIT
        head = self.spelt_function(function, exponent, argument)
        return self.glued((self.atom(head, width), argument))

    def _is_short(self, part: Formula) -> bool:
        """Whether a function is abbreviated to a letter, and so stands as one among factors."""
        return self.short and isinstance(part, FunctionCall) and part.function in ("sin", "cos")

    def power(self, base: Formula, exponent: Formula) -> Piece:
        raised = self.node(exponent)
        if isinstance(base, Bracket):
            within = self.node(base.inside)
            if self.size_around(within) != "stretched":
                return self.bracket(within, base.kind, raised)
        inside = self.node(base)
        text = self.spelt_power(base, inside.text, raised.text)
        width = inside.width + widths.SCRIPT * raised.width
        return self.atom(text, width, Binding.POWER, inside.height)

    def fraction(self, above: Piece, below: Piece) -> Piece:
        width = max(above.width, below.width) + widths.FRACTION
        height = max(above.height, below.height, Height.TALL)
        return self.atom(self.spelt_fraction(above.text, below.text), width, height=height)

    def rate(self, rate: Rate) -> Piece:
        if isinstance(rate.of, Bracket):
            quotient = Rate(row(), rate.order)
            return self.glued((self.rate(quotient), self.node(rate.of)))
        above, below = map(self.node, self.differentials(rate))
        width = max(above.width, below.width) + widths.FRACTION
        height = Height.RATE
        return self.atom(self.spelt_fraction(above.text, below.text), width, height=height)

    def bracket(self, inside: Piece, kind: str, exponent: Piece | None = None) -> Piece:
        size = self.size_around(inside)
        width = widths.BRACKET + widths.LARGE[size]
        left = self.atom(self.spelt_bracket(kind[0], size, is_open=True), width)
        end = self.spelt_bracket(kind[1], size, is_open=False)
        if exponent is not None:  # the last line may hold nothing else of the bracket
            end = self.spelt_power(Bracket(row()), end, exponent.text)
            width += widths.SCRIPT * exponent.width
        whole = self.within(left, inside, self.atom(end, width))
        return whole.solid() if size == "stretched" else whole

    def size_around(self, inside: Piece) -> Size:
        """No line can end within brackets that are stretched."""
        if inside.height == Height.FLAT:
            return "flat"
        return "large" if inside.height == Height.RATE or self.loose else "stretched"

    def root(self, inside: Piece) -> Piece:
        height = Height.ROOTED if inside.height >= Height.TALL else inside.height
        return self.atom(self.spelt_root(inside.text), inside.width + widths.ROOT, height=height)

    def matrix(self, rows: Sequence[Sequence[Piece]]) -> Piece:
        columns = [max(entry.width for entry in column) for column in zip(*rows, strict=True)]
        gaps = widths.COLUMN_GAP * (len(columns) - 1)
        width = sum(columns) + gaps + widths.TALL_BRACKETS
        return self.atom(self.spelt_matrix(rows), width, Binding.BRACKET, Height.TALL)

    def big(self, sign: str, below: Piece | None, above: Piece | None) -> Piece:
        return self.atom(
            self.spelt_big(sign, below.text if below else "", above.text if above else ""),
            widths.BIG,
        )

    def words(self, words: str) -> Piece:
        return self.atom(self.spelt_words(words), widths.words_width(words))

    def differential(self, letter: str) -> Piece:
        return self.atom(self.spelt_differential(letter), 0.62)

    def gap(self) -> Piece:
        return self.atom(self.wide_gap, 2 * widths.QUAD)

    wide_gap: str

    @abstractmethod
    def spelt_symbol(self, symbol: Symbol, index: str | None) -> str: ...

    @abstractmethod
    def spelt_index(self, base: str, index: str) -> str: ...

    @abstractmethod
    def spelt_number(self, digits: str) -> str: ...

    @abstractmethod
    def spelt_sign(self, character: str, is_binary: bool) -> str: ...

    @abstractmethod
    def spelt_gap(self, before: Formula, after: Formula, is_thin: bool) -> str: ...

    @abstractmethod
    def spelt_function(self, function: str, exponent: int, argument: Piece) -> str: ...

    @abstractmethod
    def spelt_power(self, base: Formula, inside: str, exponent: str) -> str: ...

    @abstractmethod
    def spelt_fraction(self, above: str, below: str) -> str: ...

    @abstractmethod
    def spelt_bracket(self, bracket: str, size: Size, *, is_open: bool) -> str: ...

    @abstractmethod
    def spelt_root(self, inside: str) -> str: ...

    @abstractmethod
    def spelt_matrix(self, rows: Sequence[Sequence[Piece]]) -> str: ...

    @abstractmethod
    def spelt_big(self, sign: str, below: str, above: str) -> str: ...

    @abstractmethod
    def spelt_words(self, words: str) -> str: ...

    @abstractmethod
    def spelt_differential(self, letter: str) -> str: ...

    @abstractmethod
    def boxed(self, inside: str) -> str:
        """A result that a reader looks up."""

    @abstractmethod
    def continued(self, text: str, indent: int) -> str:
        """A line that goes on, so many quads to the right."""

    @abstractmethod
    def aligned(self, lines: Sequence[Aligned], *, is_high: bool) -> str:
        """Lines below one another, aligned at their signs."""

    @abstractmethod
    def gathered(self, lines: Sequence[str], *, is_high: bool) -> str:
        """Lines below one another, each in the middle."""


def _is_thin(before: Formula, after: Formula) -> bool:
    """A thin space stands between letters; numbers, functions and signs bring their own."""
    if isinstance(before, Words) or isinstance(after, Words | FunctionCall):
        return False
    if isinstance(before, Bracket) and isinstance(after, Bracket):
        return False
    if is_differential(before):
        return isinstance(after, Symbol) and len(after.letter) > 1 and before == Differential()
    return not isinstance(before, Numeral)
