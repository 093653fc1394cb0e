"""A formula as a small tree: what is written and in which order, before any pen writes it.

Nodes are immutable and hashable. Products are rows of factors, sums are rows with signs between
the terms; the pens (LaTeX and Unicode) choose spaces and the sizes of brackets.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import fields, replace
from itertools import product
from typing import Any, Literal

from rigidsym.system.records import Record

Face = Literal["italic", "bold", "arrow", "upright", "sans"]
Prime = Literal["", "′"]


class Formula(Record):
    """Any node of the tree."""

    @property
    def latex(self) -> str:
        """In LaTeX, in the notation it was composed in."""
        return str(WRITERS["latex"].write(self).text)

    @property
    def text(self) -> str:
        """On one line of Unicode, in the notation it was composed in."""
        return str(WRITERS["text"].write(self).text)

    @property
    def markup(self) -> dict[str, str]:
        """Both, for programs."""
        return {"latex": self.latex, "text": self.text}

    def __repr__(self) -> str:
        """One line, for a prompt; the nodes would fill it."""
        return f"<{self.text}>"

    def __bool__(self) -> bool:
        return self != NOTHING


class Symbol(Formula):
    """A letter or a word, with dots above it, a prime and an index: Ω̇′₁, yaw₂."""

    letter: str  # in Unicode; several letters are one word
    face: Face = "italic"
    dots: int = 0
    prime: Prime = ""
    index: Formula | None = None


class Numeral(Formula):
    digits: str


class Sign(Formula):
    """An operation or a relation between two parts of a row, or a comma: + − = × · / , ≤."""

    character: str


class Words(Formula):
    """Text within a formula, with its blanks."""

    words: str


class Differential(Formula):
    """The d or ∂ before what is differentiated, or integrated over."""

    letter: Literal["d", "∂"] = "d"


class Row(Formula):
    """Parts side by side: factors of a product, or terms and sides with signs between them."""

    parts: tuple[Formula, ...]


class Fraction(Formula):
    above: Formula
    below: Formula


class Rate(Formula):
    """The derivative with respect to time as a quotient of differentials: dR/dt."""

    of: Formula
    order: int = 1


class Power(Formula):
    """A base with an exponent: a number, Symbol("T") for the transpose, Sign("+")."""

    base: Formula
    exponent: Formula


class Indexed(Formula):
    """An entry of something compound: (W⁻¹)₁₂."""

    base: Formula
    index: Formula


class Radical(Formula):
    inside: Formula


class Bracket(Formula):
    inside: Formula
    kind: Literal["()", "[]", "||"] = "()"


class FunctionCall(Formula):
    """A named function of an argument, which has its own brackets where it needs any: sin² θ."""

    function: str
    argument: Formula
    exponent: int = 1


class Apply(Formula):
    """A symbol with an argument: C(u), R(q)."""

    head: Formula
    inside: Formula


class Big(Formula):
    """The sign of a sum or an integral, with what stands below and above it."""

    sign: Literal["∑", "∫"]
    below: Formula | None = None
    above: Formula | None = None


class Matrix(Formula):
    rows: tuple[tuple[Formula, ...], ...]


WRITERS: dict[str, Any] = {}  # the package enters its pens here
NOTHING = Row(())
GAP = Sign("")  # wide space between two equations on a line
EQUALS, PLUS, MINUS, COMMA = Sign("="), Sign("+"), Sign("−"), Sign(",")
TRANSPOSE = Symbol("T", "sans")


def transpose_of(matrix: Formula) -> Formula:
    return Power(matrix, TRANSPOSE)


def row(*parts: Formula) -> Formula:
    """The parts side by side; rows within are taken apart."""
    flat: list[Formula] = []
    for part in parts:
        flat += part.parts if isinstance(part, Row) else [part]
    return flat[0] if len(flat) == 1 else Row(tuple(flat))


def joined(parts: tuple[Formula, ...] | list[Formula], sign: Formula) -> Formula:
    """The parts with a sign between each two."""
    return row(*[item for part in parts for item in (sign, part)][1:])


def equal(*sides: Formula) -> Formula:
    """The sides of an equation, with signs of equality between them."""
    return joined(sides, EQUALS)


def bracketed(formula: Formula, kinds: tuple[type, ...] = ()) -> Formula:
    """A sum, or a formula of one of these kinds, in brackets; anything else without."""
    return Bracket(formula) if is_sum(formula) or isinstance(formula, kinds) else formula


def is_sum(formula: Formula) -> bool:
    """Whether terms are added or subtracted outside all brackets."""
    return isinstance(formula, Row) and any(p in (PLUS, MINUS) for p in formula.parts)


def is_differential(formula: Formula) -> bool:
    """Whether a letter follows that is differentiated: d, ∂, d²."""
    base = formula.base if isinstance(formula, Power) else formula
    return isinstance(base, Differential)


def indexed(symbol: Formula, shape: tuple[int, ...]) -> tuple[Formula, ...]:
    """The symbol with the index of each entry, in light face; (a₁, a₂, a₃) lists its own.

    R₂₃, or L_R,1 where the symbol has an index of its own; brackets around what is compound.
    """
    if isinstance(symbol, Bracket) and isinstance(symbol.inside, Row):
        return tuple(part for part in symbol.inside.parts if not isinstance(part, Sign))
    places = product(*(range(1, count + 1) for count in shape))
    numbers = [Numeral("".join(map(str, place))) for place in places]
    if isinstance(symbol, Rate) and isinstance(symbol.of, Symbol):
        symbol = replace(symbol.of, dots=symbol.order)
    if not isinstance(symbol, Symbol):
        return tuple(Indexed(Bracket(symbol), number) for number in numbers)
    own = () if symbol.index is None else (symbol.index, COMMA)
    light = replace(symbol, face="italic")
    return tuple(replace(light, index=row(*own, number)) for number in numbers)


def with_names(node: Any, names: Mapping[Any, Any]) -> Any:
    """A tree of records with others in place of some of them, such as symbols; tuples, too."""
    if not names:
        return node
    if not isinstance(node, tuple) and node in names:
        return names[node]
    return with_parts(node, lambda part: with_names(part, names))


def with_parts(node: Any, changed: Callable[[Any], Any]) -> Any:
    """A record or a tuple with each of its parts changed; anything else as it is."""
    if isinstance(node, tuple):
        parts = map(changed, node)
        return type(node)(*parts) if hasattr(node, "_fields") else tuple(parts)
    if not isinstance(node, Record):
        return node
    return replace(node, **{f.name: changed(getattr(node, f.name)) for f in fields(node)})
