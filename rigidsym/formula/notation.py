"""The user's choices of notation, which act on the tree of a formula when it is printed.

Formulas are composed in one notation: a dot for a rate, bold vectors, a prime for the body, Ω.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import lru_cache
from typing import Any, Protocol

from rigidsym.errors import ModelError
from rigidsym.formula import tree
from rigidsym.system.records import Record

CHOICES: Mapping[str, tuple[str, ...]] = {
    "rates": ("dot", "fraction"),
    "vectors": ("bold", "arrow"),
    "angular_velocity": ("Omega", "omega"),
}

_VECTORS = frozenset("uvwxyrpmngscdLeabkΩω")  # bold matrices and columns of coordinates stay so


class HasNames(Protocol):
    """Something with symbols of its own."""

    @property
    def names(self) -> set[str]: ...


class Notation(Record, kw_only=True):
    """One choice each, the first of `CHOICES` by default."""

    rates: str = "dot"
    vectors: str = "bold"
    angular_velocity: str = "Omega"
    vector: str = "v"  # the letter of the vector that the coordinates are components of

    def __post_init__(self) -> None:
        for name, choices in CHOICES.items():
            chosen = getattr(self, name)
            if chosen not in choices:
                expected = " or ".join(choices)
                raise ModelError(f"notation, {name}: expected {expected}, got {chosen!r}")

    def applied(self, formula: tree.Formula) -> tree.Formula:
        """The formula in this notation; twice is the same as once."""
        return formula if self == DEFAULT else _applied(formula, self)

    def check(self, model: HasNames) -> None:
        """Raises ModelError for a name in a model that looks like R, W or the angular velocity."""
        other = next(word for word in CHOICES["angular_velocity"] if word != self.angular_velocity)
        meanings = {"R": "the rotation matrix", "W": "the rate matrix"}
        letters = {name: name.rstrip("_0123456789") for name in sorted(model.names)}
        also = "" if other in letters.values() else f", which can also be called {other}"
        meanings[self.angular_velocity] = f"the angular velocity{also}"
        for name, letter in letters.items():
            if meaning := meanings.get(letter):
                raise ModelError(f"notation: {name} is printed like {meaning}; choose another name")


@lru_cache(maxsize=4096)
def _applied(node: Any, notation: Notation) -> Any:
    match node:
        case tree.Symbol():
            return _symbol(node, notation)
        # A power of φ̇ becomes one of dφ/dt, which needs brackets as a base.
        case tree.Power(tree.Symbol(dots=dots), exponent) if dots and notation.rates == "fraction":
            return tree.Power(tree.Bracket(_applied(node.base, notation)), exponent)
        case tree.Fraction(above, tree.Row((tree.Differential("∂"), by))):
            by = _applied(by, notation)
            if isinstance(by, tree.Rate):  # (dq/dt): a fraction within one would be hard to read
                d = tree.Differential()
                by = tree.Bracket(tree.Row((d, by.of, tree.Sign("/"), d, tree.Symbol("t"))))
            below = tree.Row((tree.Differential("∂"), by))
            return tree.Fraction(_applied(above, notation), below)
    return tree.with_parts(node, lambda part: _applied(part, notation))


def _symbol(symbol: tree.Symbol, notation: Notation) -> tree.Formula:
    index = symbol.index and _applied(symbol.index, notation)
    symbol = replace(symbol, index=index)
    if symbol.letter == "v" and symbol.face == "bold":
        symbol = replace(symbol, letter=notation.vector)
    if notation.angular_velocity == "omega" and symbol.letter == "Ω":
        symbol = replace(symbol, letter="ω")
    if notation.vectors == "arrow" and symbol.face == "bold" and symbol.letter in _VECTORS:
        symbol = replace(symbol, face="arrow")
    if notation.rates == "fraction" and symbol.dots:
        return tree.Rate(replace(symbol, dots=0), symbol.dots)
    return symbol


DEFAULT = Notation()  # in which formulas are composed
