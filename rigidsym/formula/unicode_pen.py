"""Formulas on one line of Unicode, for terminals, messages and docstrings."""

from __future__ import annotations

import unicodedata
from functools import lru_cache
from typing import ClassVar

from rigidsym.formula import tree
from rigidsym.formula.pen import BREAKS, DIVISOR, Binding, Pen, Piece, atom

_DOTS = ("", "\u0307", "\u0308")
_FRACTIONS: dict[tree.Formula, str] = {
    tree.Fraction(tree.Numeral(above), tree.Numeral(below)): short
    for above, below, short in ("12½", "13⅓", "23⅔", "14¼", "34¾", "18⅛")
}
_ABOVE = str.maketrans("0123456789-−+TB", "⁰¹²³⁴⁵⁶⁷⁸⁹⁻⁻⁺ᵀᴮ")
_BELOW = str.maketrans(  # no Greek: φ has a small letter, but θ and ψ beside it have none
    "0123456789+-−=()aeoruhklmnpstij", "₀₁₂₃₄₅₆₇₈₉₊₋₋₌₍₎ₐₑₒᵣᵤₕₖₗₘₙₚₛₜᵢⱼ"
)
_SPACED = "+−±=≤<∈⇔×"


@lru_cache(maxsize=4096)
def columns(text: str) -> int:
    """Columns of a terminal: accents above a letter take none, wide characters two."""
    return sum(map(_columns_of, text))


@lru_cache(maxsize=512)
def _columns_of(character: str) -> int:
    is_wide = unicodedata.east_asian_width(character) in "WF"
    return 1 + is_wide - (unicodedata.combining(character) > 0)


class UnicodePen(Pen):
    blank: ClassVar[float] = 1.0

    def symbol(self, node: tree.Symbol) -> Piece:
        head, tail = node.letter[0], node.letter[1:]
        arrow = "\u20d7" if node.face == "arrow" else ""
        text = head + tail + arrow
        if node.dots:
            text = unicodedata.normalize("NFC", head + _DOTS[node.dots]) + tail + arrow
        text += node.prime
        return _atom(text if node.index is None else self._with_index(text, node.index))

    def indexed(self, node: tree.Indexed) -> Piece:
        return _atom(self._with_index(self.node(node.base).text, node.index))

    def _with_index(self, base: str, index: tree.Formula) -> str:
        """An index in small figures, or behind a low line."""
        written = self.indices(index).text
        close = written.replace(" ", "")
        is_small = all(ord(c) in _BELOW for c in close)
        return base + (close.translate(_BELOW) if is_small else f"_{written}")

    def numeral(self, node: tree.Numeral) -> Piece:
        return _atom(node.digits, Binding.NUMBER)

    def sign(self, node: tree.Sign, *, is_binary: bool = False) -> Piece:
        character = node.character
        if character in ",;":
            return _atom(f"{character} " if is_binary else character)
        if character not in _SPACED or not is_binary:
            return _atom(character)
        return _atom(f"{character} " if character in BREAKS else f" {character} ")

    def between(self, before: tree.Formula, after: tree.Formula) -> Piece:
        return _atom(_space(before, after))

    def factor(self, part: tree.Formula) -> Piece:
        """A quotient beside another factor is ½, or stands in brackets."""
        if isinstance(part, tree.Fraction):
            short = _FRACTIONS.get(part)
            return _atom(short, Binding.NUMBER) if short else self.around(self.node(part))
        return self.node(part)

    def functioncall(self, node: tree.FunctionCall) -> Piece:
        head = node.function + (str(node.exponent).translate(_ABOVE) if node.exponent != 1 else "")
        argument = self.node(node.argument)
        if argument.binding == Binding.QUOTIENT:
            argument = self.around(argument)
        gap = "" if argument.binding == Binding.BRACKET else " "
        return self.glued((_atom(head + gap), argument))

    def power(self, node: tree.Power) -> Piece:
        written = self.node(node.base)
        if not isinstance(node.base, tree.Numeral):
            written = self._at_least(Binding.NAME, written)
        text = self.node(node.exponent).text
        if all(ord(c) in _ABOVE for c in text):
            raised = text.translate(_ABOVE)
        else:
            is_word = isinstance(node.exponent, tree.Symbol | tree.Numeral)
            raised = f"^{text}" if is_word else f"^({text})"
        return self.glued((written, _atom(raised)), Binding.POWER)

    def fraction(self, node: tree.Fraction) -> Piece:
        top, below = self._at_least(Binding.PRODUCT, self.node(node.above)), self.node(node.below)
        if below.binding < Binding.POWER:
            # Breaking a line inside a divisor is the last resort, and DIVISOR is the depth that
            # says so.
            below = self.within(_atom("("), below, _atom(")"), DIVISOR)
        else:  # with brackets of its own
            below = below.deeper(DIVISOR - 1)
        return self.glued((top, _atom("/"), below), Binding.QUOTIENT)

    def rate(self, node: tree.Rate) -> Piece:
        above, below = self.differentials(node)
        return self.glued((above, _atom("/"), below))

    def around(self, inside: Piece, kind: str = "()") -> Piece:
        return self.within(_atom(kind[0]), inside, _atom(kind[1]))

    def radical(self, node: tree.Radical) -> Piece:
        inside = self.node(node.inside)
        is_bare = inside.binding in (Binding.NAME, Binding.NUMBER)
        return self.glued((_atom("√"), inside if is_bare else self.around(inside)), Binding.POWER)

    def matrix(self, node: tree.Matrix) -> Piece:
        rows = (", ".join(self.write(entry).text for entry in line) for line in node.rows)
        return _atom(f"({'; '.join(rows)})", Binding.BRACKET)

    def big(self, node: tree.Big) -> Piece:
        return _atom("Σ" if node.sign == "∑" else node.sign)

    def words(self, node: tree.Words) -> Piece:
        return _atom(node.words)

    def differential(self, node: tree.Differential) -> Piece:
        return _atom(node.letter)

    def _at_least(self, binding: Binding, piece: Piece) -> Piece:
        """The piece, in brackets where it is held together less tightly."""
        return piece if piece.binding >= binding else self.around(piece)


def _atom(text: str, binding: Binding = Binding.NAME) -> Piece:
    return atom(text, columns(text), binding)


def _space(before: tree.Formula, after: tree.Formula) -> str:
    """Factors stand apart, but for a number before its unit and a d before its letter."""
    if isinstance(before, tree.Words) or isinstance(after, tree.Words):
        return ""
    if tree.is_differential(before):
        is_word = isinstance(after, tree.Symbol) and len(after.letter) > 1
        return " " if is_word else ""
    if isinstance(before, tree.Rate) and isinstance(after, tree.Symbol | tree.Power | tree.Apply):
        return "·"
    if isinstance(before, tree.Bracket) and isinstance(after, tree.Bracket):
        return ""
    is_number = isinstance(before, tree.Numeral) or before in _FRACTIONS
    if is_number and not isinstance(
        after, tree.FunctionCall | tree.Rate | tree.Fraction | tree.Big
    ):
        return " " if isinstance(after, tree.Symbol) and after.letter.isdigit() else ""
    return " "
