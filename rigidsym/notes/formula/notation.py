"""The names that formulas are printed with, and the order in which a reader expects them."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import lru_cache

import sympy as sp
from sympy.core.function import AppliedUndef
from sympy.printing.pretty.pretty_symbology import pretty_symbol

from rigidsym.errors import AlgebraError
from rigidsym.mechanics.derivation import Argument, Markup
from rigidsym.models.rotation import RotationModel
from rigidsym.notes.formula.lengths import Length, length_of
from rigidsym.notes.formula.manner import DEFAULT, Manner

Place = tuple[int, int]  # order of the time derivative, index of the component

_CONSTANTS = {sp.pi: Markup(r"\pi", "π")}
_GIVEN_RATE = 1  # a given angular velocity stands where the rates stand
_CONSTANT = "parameters"  # constants stand before coordinates, in the order of their names
_ORDERS = {"q": 0, "q_dot": 1, "q_ddot": 2, "centre": 0, "centre_dot": 1}
_BEFORE = dict.fromkeys(("centre", "centre_dot"), -3)  # what translates before what turns
_WORDS = re.compile(r"(\\(?:math|text|operator)\w*\{[^}]*\}|\\[A-Za-z]+)|([A-Za-z]{2,})")


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Notation:
    """How symbols are printed, and which of them are coordinates, rates and accelerations.

    A symbol that is in neither table is a constant, printed as SymPy prints its name. A notation
    equals itself alone, so that what is written in it can be kept for the next printer.
    """

    names: Mapping[sp.Expr, Markup] = field(default_factory=dict)
    places: Mapping[sp.Expr, Place] = field(default_factory=dict)
    manner: Manner = DEFAULT
    length: Length | None = None  # written in place of the components that make it up

    def shortened(self, expression: sp.Expr) -> sp.Expr:
        """What is printed in place of an expression: the same, with the length where it has one."""
        return self.length.shortened(expression) if self.length else expression

    def name(self, symbol: sp.Expr) -> Markup:
        """The name of a symbol; raises AlgebraError for what is neither known nor a symbol."""
        known = self.names.get(symbol) or _CONSTANTS.get(symbol)
        if known is not None:
            return known
        if not isinstance(symbol, sp.Symbol | AppliedUndef):
            raise AlgebraError(
                f"no printed form for {symbol} of type {type(symbol).__name__}: expected numbers, "
                "symbols, their sums, products and powers, and sin, cos, tan, cot"
            )
        label = symbol.name if isinstance(symbol, sp.Symbol) else symbol.func.__name__
        return Markup(words_in_italics(sp.latex(sp.Symbol(label))), pretty_symbol(label))


def notation_of(
    arguments: Iterable[Argument], manner: Manner = DEFAULT, model: RotationModel | None = None
) -> Notation:
    """The notation of a derivation, from its arguments, in the manner of the user.

    With the model, the length of its vector is written for what its components make up.
    """
    length = length_of(model) if model is not None and model.vector else None
    return _notation(tuple(arguments), manner, length)


@lru_cache(maxsize=64)
def _notation(arguments: tuple[Argument, ...], manner: Manner, length: Length | None) -> Notation:
    known = length.names if length else {}
    return Notation(
        manner=manner,
        length=length,
        names={
            **{symbol: manner.rate(markup) for symbol, markup in known.items()},
            **{
                symbol: (manner.rate if argument.name in _ORDERS else manner.symbol)(markup)
                for argument in arguments
                for symbol, markup in zip(argument.symbols, argument.notation, strict=True)
            },
        },
        places={
            **({length.rate: (_GIVEN_RATE, -1)} if length else {}),
            **{
                symbol: (
                    _ORDERS.get(argument.name, _GIVEN_RATE),
                    index + _BEFORE.get(argument.name, 0),
                )
                for argument in arguments
                if argument.name != _CONSTANT
                for index, symbol in enumerate(argument.symbols)
            },
        },
    )


def words_in_italics(latex: str) -> str:
    """LaTeX in which names of several letters are set as words, not as products of letters."""
    return _WORDS.sub(lambda m: m[1] or rf"\mathit{{{m[2]}}}", latex)
