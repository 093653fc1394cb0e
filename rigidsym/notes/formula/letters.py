"""The letters that formulas are printed with, and the order in which a reader expects them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import lru_cache

import sympy as sp
from sympy.core.function import AppliedUndef

from rigidsym.errors import AlgebraError
from rigidsym.formula.notation import DEFAULT, Notation
from rigidsym.formula.symbol_names import named
from rigidsym.formula.tree import Formula, Symbol
from rigidsym.mechanics.derivation import Argument
from rigidsym.models.rotation import RotationModel
from rigidsym.notes.formula.lengths import VectorLength, length_of

Place = tuple[int, int]  # order of the time derivative, index of the component

_CONSTANTS: Mapping[sp.Expr, Formula] = {sp.pi: Symbol("π")}
_GIVEN_RATE = 1  # a given angular velocity is ordered as the rates are
_CONSTANT = "parameters"  # constants go before coordinates, in the order of their names
_ORDERS = {"q": 0, "q_dot": 1, "q_ddot": 2, "centre": 0, "centre_dot": 1}
_BEFORE = dict.fromkeys(("centre", "centre_dot"), -3)  # what translates before what turns


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Letters:
    """How symbols are printed, and which of them are coordinates, rates and accelerations.

    A symbol that is in neither table is a constant, printed by its name. Letters equal only
    themselves, so that what is written with them can be kept for the next printer.
    """

    names: Mapping[sp.Expr, Formula] = field(default_factory=dict)
    places: Mapping[sp.Expr, Place] = field(default_factory=dict)
    notation: Notation = DEFAULT
    length: VectorLength | None = None  # written in place of the components that make it up

    def shortened(self, expression: sp.Expr) -> sp.Expr:
        """What is printed in place of an expression: the same, with the length where it has one."""
        return self.length.shortened(expression) if self.length else expression

    def name(self, symbol: sp.Expr) -> Formula:
        """The name of a symbol; raises AlgebraError for what is neither known nor a symbol."""
        known = self.names.get(symbol) or _CONSTANTS.get(symbol)
        if known is not None:
            return known
        if not isinstance(symbol, sp.Symbol | AppliedUndef):
            raise AlgebraError(
                f"no printed form for {symbol} of type {type(symbol).__name__}: expected numbers, "
                "symbols, their sums, products and powers, and sin, cos, tan, cot"
            )
        return named(symbol.name if isinstance(symbol, sp.Symbol) else symbol.func.__name__)


def letters_of(
    arguments: Iterable[Argument], notation: Notation = DEFAULT, model: RotationModel | None = None
) -> Letters:
    """The letters of a derivation, from its arguments, in the notation of the user.

    With the model, the length of its vector is written for what its components make up.
    """
    length = length_of(model) if model is not None and model.vector else None
    return _letters(tuple(arguments), notation, length)


@lru_cache(maxsize=64)
def _letters(
    arguments: tuple[Argument, ...], notation: Notation, length: VectorLength | None
) -> Letters:
    return Letters(
        notation=notation,
        length=length,
        names={
            **(length.names if length else {}),
            **{
                symbol: name
                for argument in arguments
                for symbol, name in zip(argument.symbols, argument.notation, strict=True)
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
