"""The letters that formulas are printed with, and the order in which a reader expects them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache

import sympy as sp
from sympy.core.function import AppliedUndef

from rigidsym.errors import AlgebraError
from rigidsym.formula.notation import DEFAULT, Notation
from rigidsym.formula.symbol_names import named
from rigidsym.formula.tree import Formula, Symbol

Place = tuple[int, int]  # order of the time derivative, index of the component

TIME = sp.Symbol("t")
_CONSTANTS: Mapping[sp.Expr, Formula] = {sp.pi: Symbol("π")}


@dataclass(frozen=True, slots=True)
class VectorLength:
    """The length n of a vector, as a symbol in place of its components: n for √(v·v).

    Formulas are derived in components; where those of one vector come up as its square, its length
    is shorter, and is what a reader thinks in.
    """

    components: tuple[sp.Expr, ...]  # functions of time
    symbol: sp.Symbol  # n
    rate: sp.Symbol  # ṅ
    letter: str  # how both are written

    @property
    def names(self) -> Mapping[sp.Expr, Formula]:
        return {self.symbol: Symbol(self.letter), self.rate: Symbol(self.letter, dots=1)}

    def shortened(self, expression: sp.Expr) -> sp.Expr:
        """The expression with n² in place of the sum of the squares, and n ṅ of its derivative."""
        return _shortened(expression, self)

    @property
    def sums(self) -> tuple[tuple[sp.Expr, sp.Expr], ...]:
        """(what takes the place of a sum, the sum)."""
        squares = sp.Add(*(part**2 for part in self.components))
        moving = sp.Add(*(part * sp.diff(part, TIME) for part in self.components))
        return ((self.symbol**2, squares), (self.symbol * self.rate, moving))


@lru_cache(maxsize=4096)
def _shortened(node: sp.Expr, length: VectorLength) -> sp.Expr:
    if not node.args or not node.has(*length.components):
        return node
    if node.is_Derivative or node in length.components:
        return node
    whole = node.func(*(_shortened(argument, length) for argument in node.args))
    if not whole.is_Add:
        return whole
    for short, terms in length.sums:
        whole = _without(whole, terms.args, short)
    return whole


def _without(whole: sp.Expr, terms: Sequence[sp.Expr], short: sp.Expr) -> sp.Expr:
    """The sum with `short` in place of these terms, where all of them have one coefficient."""
    parts = (term.as_coeff_Mul() for term in sp.Add.make_args(whole))
    held = {rest: number for number, rest in parts}
    numbers = {held.get(term) for term in terms}
    if len(numbers) != 1 or None in numbers:
        return whole
    (number,) = numbers
    rest = [factor * term for term, factor in held.items() if term not in terms]
    return sp.Add(*rest, number * short)


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
