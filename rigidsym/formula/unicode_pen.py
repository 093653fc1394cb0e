"""Formulas on one line of Unicode, for terminals, messages and docstrings."""

from __future__ import annotations

import unicodedata
from collections.abc import Sequence
from typing import ClassVar

from rigidsym.formula.pen import DIVISOR, Binding, Pen, Piece
from rigidsym.formula.tree import (
    Apply,
    Big,
    Bracket,
    Formula,
    Fraction,
    FunctionCall,
    Numeral,
    Power,
    Rate,
    Symbol,
    Words,
    is_differential,
)

_DOTS = ("", "\u0307", "\u0308")
_FRACTIONS = {("1", "2"): "½", ("1", "3"): "⅓", ("2", "3"): "⅔", ("1", "4"): "¼", ("3", "4"): "¾"}
_FRACTIONS[("1", "8")] = "⅛"
_ABOVE = str.maketrans("0123456789-−+TB", "⁰¹²³⁴⁵⁶⁷⁸⁹⁻⁻⁺ᵀᴮ")
_BELOW = str.maketrans(
    "0123456789+-−=()aeoruhklmnpstijβγρφχ", "₀₁₂₃₄₅₆₇₈₉₊₋₋₌₍₎ₐₑₒᵣᵤₕₖₗₘₙₚₛₜᵢⱼᵦᵧᵨᵩᵪ"
)
_SPACED = "+−±=≤<∈⇔×"


def columns(text: str) -> int:
    """Columns of a terminal: accents above a letter take none, wide characters two."""
    return sum(map(_character_columns, text))


def _character_columns(character: str) -> int:
    if unicodedata.combining(character):
        return 0
    return 2 if unicodedata.east_asian_width(character) in "WF" else 1


class UnicodePen(Pen):
    blank: ClassVar[float] = 1.0

    def _atom(self, text: str, binding: Binding = Binding.NAME) -> Piece:
        return self.atom(text, columns(text), binding)

    def symbol(self, symbol: Symbol) -> Piece:
        head, tail = symbol.letter[0], symbol.letter[1:]
        arrow = "\u20d7" if symbol.face == "arrow" else ""
        text = head + tail + arrow
        if symbol.dots:
            text = unicodedata.normalize("NFC", head + _DOTS[symbol.dots]) + tail + arrow
        stem = self._atom(text + symbol.prime)
        return stem if symbol.index is None else self.indexed(stem, self.indices(symbol.index))

    def indexed(self, base: Piece, index: Piece) -> Piece:
        """An index in small figures, or behind a low line."""
        close = index.text.replace(" ", "")
        is_small = all(ord(c) in _BELOW for c in close)
        below = close.translate(_BELOW) if is_small else f"_{index.text}"
        return self._atom(base.text + below)

    def number(self, digits: str) -> Piece:
        return self._atom(digits, Binding.NUMBER)

    def sign(self, character: str, *, is_binary: bool) -> Piece:
        if character in ",;":
            return self._atom(f"{character} " if is_binary else character)
        if character not in _SPACED or not is_binary:
            return self._atom(character)
        starts_a_line = character in "+−±=≤<⇔"
        return self._atom(f"{character} " if starts_a_line else f" {character} ")

    def between(self, before: Formula, after: Formula) -> Piece:
        return self._atom(_space(before, after))

    def factor(self, part: Formula) -> Piece:
        """A quotient beside another factor is ½, or stands in brackets."""
        if isinstance(part, Fraction):
            if isinstance(part.above, Numeral) and isinstance(part.below, Numeral):
                short = _FRACTIONS.get((part.above.digits, part.below.digits))
                if short:
                    return self._atom(short, Binding.NUMBER)
            return self.bracket(self.node(part), "()")
        return self.node(part)

    def call(self, function: str, argument: Piece, exponent: int, _: Formula) -> Piece:
        head = function + (str(exponent).translate(_ABOVE) if exponent != 1 else "")
        if argument.binding == Binding.QUOTIENT:
            argument = self.bracket(argument, "()")
        gap = "" if argument.binding == Binding.BRACKET else " "
        return self.glued((self._atom(head + gap), argument))

    def power(self, base: Formula, exponent: Formula) -> Piece:
        written = self._at_least(Binding.NAME, self.node(base))
        text = self.node(exponent).text
        if all(ord(c) in _ABOVE for c in text):
            raised = text.translate(_ABOVE)
        else:
            is_word = isinstance(exponent, Symbol | Numeral)
            raised = f"^{text}" if is_word else f"^({text})"
        return self.glued((written, self._atom(raised)), Binding.POWER)

    def fraction(self, above: Piece, below: Piece) -> Piece:
        top = self._at_least(Binding.PRODUCT, above)
        if below.binding < Binding.POWER:
            below = self.within(self._atom("("), below, self._atom(")"), DIVISOR)
        else:  # with brackets of its own
            below = self.deeper(below, DIVISOR - 1)
        return self.glued((top, self._atom("/"), below), Binding.QUOTIENT)

    def rate(self, rate: Rate) -> Piece:
        above, below = self.differentials(rate)
        return self.glued((self.node(above), self._atom("/"), self.node(below)))

    def bracket(self, inside: Piece, kind: str) -> Piece:
        return self.within(self._atom(kind[0]), inside, self._atom(kind[1]))

    def root(self, inside: Piece) -> Piece:
        is_bare = inside.binding in (Binding.NAME, Binding.NUMBER)
        shown = inside if is_bare else self.bracket(inside, "()")
        return self.glued((self._atom("√"), shown), Binding.POWER)

    def matrix(self, rows: Sequence[Sequence[Piece]]) -> Piece:
        inside = "; ".join(", ".join(entry.text for entry in row) for row in rows)
        return self._atom(f"({inside})", Binding.BRACKET)

    def big(self, sign: str, below: Piece | None, above: Piece | None) -> Piece:  # noqa: ARG002
        return self._atom("Σ" if sign == "∑" else sign)

    def words(self, words: str) -> Piece:
        return self._atom(words)

    def differential(self, letter: str) -> Piece:
        return self._atom(letter)

    def gap(self) -> Piece:
        return self._atom("")

    def _at_least(self, binding: Binding, piece: Piece) -> Piece:
        """The piece, in brackets where it is held together less tightly."""
        return piece if piece.binding >= binding else self.bracket(piece, "()")


def _space(before: Formula, after: Formula) -> str:
    """Factors stand apart, but for a number before its unit and a d before its letter."""
    if isinstance(before, Words) or isinstance(after, Words):
        return ""
    if is_differential(before):
        is_word = isinstance(after, Symbol) and len(after.letter) > 1
        return " " if is_word else ""
    if isinstance(before, Rate) and isinstance(after, Symbol | Power | Apply):
        return "·"
    if isinstance(before, Bracket) and isinstance(after, Bracket):
        return ""
    is_number = isinstance(before, Numeral) or (isinstance(before, Fraction) and before in _SHORT)
    if is_number and not isinstance(after, FunctionCall | Rate | Fraction | Big):
        return " " if isinstance(after, Symbol) and after.letter.isdigit() else ""
    return " "


_SHORT = {Fraction(Numeral(a), Numeral(b)) for a, b in _FRACTIONS}
