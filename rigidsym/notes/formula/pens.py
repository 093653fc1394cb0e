"""Pens for one formula: LaTeX, of the macros that MathML converters know too, and Unicode."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum
from itertools import pairwise
from typing import ClassVar, Protocol

from rigidsym.mechanics.derivation import Markup

_BRACES = r"(?:[^{}]|\{(?:[^{}]|\{[^{}]*\})*\})*"  # what may stand in braces, up to two deep
_RATES = re.compile(rf"\\frac\{{d{_BRACES}\}}\{{dt(?:\^\{{2\}})?\}}")
_FRACTIONS = {(1, 2): "½", (1, 3): "⅓", (2, 3): "⅔", (1, 4): "¼", (3, 4): "¾", (1, 8): "⅛"}
_SUPERSCRIPTS = str.maketrans("0123456789-", "⁰¹²³⁴⁵⁶⁷⁸⁹⁻")


class Binding(IntEnum):
    """How tightly the outermost operation of a piece holds it together."""

    SUM = 0
    QUOTIENT = 1
    PRODUCT = 2
    POWER = 3
    CALL = 4
    NUMBER = 5
    FRACTION = 6  # \frac{1}{2}: whole as a factor, not as a base
    NAME = 7
    BRACKET = 8


@dataclass(frozen=True, slots=True)
class Piece:
    """Part of a formula that has been written, and what holds it together."""

    text: str
    binding: Binding


class Pen(Protocol):
    """What a language must be able to write. What is written, in which order, is settled before."""

    minus: ClassVar[str]
    above: ClassVar[Binding]  # the least that stands above a fraction line without brackets
    below: ClassVar[Binding]

    def name(self, markup: Markup) -> str: ...

    def bracket(self, inside: str) -> str: ...

    def power(self, base: str, exponent: str) -> str: ...

    def root(self, inside: Piece) -> Piece: ...

    def call(self, function: str, exponent: int, argument: Piece) -> Piece: ...

    def application(self, function: str, arguments: Sequence[str]) -> str: ...

    def product(self, factors: Sequence[Piece]) -> str: ...

    def quotient(self, above: str, below: str) -> Piece: ...

    def fraction(self, above: int, below: int) -> Piece:
        """A number before a product."""
        ...


class LatexPen:
    """LaTeX mathematics."""

    minus: ClassVar[str] = "-"
    above: ClassVar[Binding] = Binding.SUM
    below: ClassVar[Binding] = Binding.SUM

    def name(self, markup: Markup) -> str:
        return markup.latex

    def bracket(self, inside: str) -> str:
        if r"\frac" not in inside:
            return f"({inside})"
        if r"\frac" not in _RATES.sub("", inside):
            # no line can end between \left and \right
            return rf"\Bigl({inside}\Bigr)"
        return rf"\left({inside}\right)"

    def power(self, base: str, exponent: str) -> str:
        # a prime is a superscript, and TeX takes one superscript only
        is_raised = "'" in base or r"^{\mathrm{B}}" in base
        return rf"{{{base}}}^{{{exponent}}}" if is_raised else rf"{base}^{{{exponent}}}"

    def root(self, inside: Piece) -> Piece:
        return Piece(rf"\sqrt{{{inside.text}}}", Binding.NAME)

    def call(self, function: str, exponent: int, argument: Piece) -> Piece:
        head = f"\\{function}" + (f"^{{{exponent}}}" if exponent > 1 else "")
        gap = " " if argument.text[0].isalnum() else ""
        return Piece(head + gap + argument.text, Binding.CALL)

    def application(self, function: str, arguments: Sequence[str]) -> str:
        return rf"\operatorname{{{function.replace('_', '')}}}({', '.join(arguments)})"

    def product(self, factors: Sequence[Piece]) -> str:
        text = factors[0].text
        for before, factor in pairwise(factors):
            # TeX sets the space around \sin itself, and after a number none is wanted
            is_spaced = factor.binding == Binding.CALL or before.binding == Binding.NUMBER
            text += (" " if is_spaced else r"\,") + factor.text
        return text

    def quotient(self, above: str, below: str) -> Piece:
        return Piece(rf"\frac{{{above}}}{{{below}}}", Binding.FRACTION)

    def fraction(self, above: int, below: int) -> Piece:
        return self.quotient(str(above), str(below))


class ShorthandPen(LatexPen):
    """LaTeX with s_θ and c_θ for sin θ and cos θ; the note says so where it is used."""

    def call(self, function: str, exponent: int, argument: Piece) -> Piece:
        if function not in ("sin", "cos"):
            return LatexPen.call(self, function, exponent, argument)
        short = f"{function[0]}_{{{argument.text}}}"
        if exponent > 1:
            return Piece(self.power(short, str(exponent)), Binding.POWER)
        return Piece(short, Binding.NAME)


class TextPen:
    """One line of Unicode."""

    minus: ClassVar[str] = "−"
    above: ClassVar[Binding] = Binding.PRODUCT
    below: ClassVar[Binding] = Binding.POWER

    def name(self, markup: Markup) -> str:
        return markup.text

    def bracket(self, inside: str) -> str:
        return f"({inside})"

    def power(self, base: str, exponent: str) -> str:
        is_integer = exponent.lstrip("-").isdigit()
        return base + (exponent.translate(_SUPERSCRIPTS) if is_integer else f"^({exponent})")

    def root(self, inside: Piece) -> Piece:
        is_bare = inside.binding in (Binding.NAME, Binding.NUMBER)
        return Piece("√" + (inside.text if is_bare else f"({inside.text})"), Binding.POWER)

    def call(self, function: str, exponent: int, argument: Piece) -> Piece:
        head = function if exponent == 1 else self.power(function, str(exponent))
        gap = "" if argument.binding == Binding.BRACKET else " "
        return Piece(head + gap + argument.text, Binding.CALL)

    def application(self, function: str, arguments: Sequence[str]) -> str:
        return f"{function}({', '.join(arguments)})"

    def product(self, factors: Sequence[Piece]) -> str:
        text = factors[0].text
        for before, factor in pairwise(factors):
            is_apart = factor.binding in (Binding.CALL, Binding.FRACTION)  # sin θ, d yaw/dt
            is_close = before.binding == Binding.NUMBER and not is_apart
            text += ("" if is_close else " ") + factor.text
        return text

    def quotient(self, above: str, below: str) -> Piece:
        return Piece(f"{above}/{below}", Binding.QUOTIENT)

    def fraction(self, above: int, below: int) -> Piece:
        short = _FRACTIONS.get((above, below))
        return (
            Piece(short, Binding.NUMBER) if short else Piece(f"({above}/{below})", Binding.BRACKET)
        )
