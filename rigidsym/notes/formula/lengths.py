"""The length of a vector in formulas: n for √(v·v), n² for v·v, n ṅ for v·v̇.

Formulas are derived in components; where those of one vector come up as its square, its length is
shorter, and is what a reader thinks in.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache

import sympy as sp

from rigidsym.formula.reader import formula
from rigidsym.formula.tree import Formula, Symbol
from rigidsym.mechanics.kinematics.vector_forms import LENGTH
from rigidsym.models.rotation import RotationModel
from rigidsym.models.so3 import TIME

VECTOR = formula(r"\mathbf{v}")
_LETTERS = ("n", "l", "r")  # one that nothing in the model is called by is taken


@dataclass(frozen=True, slots=True)
class VectorLength:
    """The length n of a vector, as a symbol in place of its components."""

    components: tuple[sp.Expr, ...]  # functions of time
    symbol: sp.Symbol  # n
    rate: sp.Symbol  # ṅ
    letter: str  # how both are written

    @property
    def names(self) -> Mapping[sp.Expr, Formula]:
        letter = self.letter
        return {
            self.symbol: Symbol(letter),
            self.rate: Symbol(letter, dots=1),
        }

    def shortened(self, expression: sp.Expr) -> sp.Expr:
        """The expression with n² in place of the sum of the squares, and n ṅ of its derivative."""
        return _shortened(expression, self)

    @property
    def sums(self) -> tuple[tuple[sp.Expr, sp.Expr], ...]:
        """(what takes the place of a sum, the sum)."""
        squares = sp.Add(*(part**2 for part in self.components))
        moving = sp.Add(*(part * sp.diff(part, TIME) for part in self.components))
        return ((self.symbol**2, squares), (self.symbol * self.rate, moving))


@lru_cache(maxsize=64)
def length_of(model: RotationModel) -> VectorLength | None:
    """The length that comes up in the matrix of a model: of its vector, or of all coordinates."""
    if not model.vector:
        return None
    taken = {q.func.__name__ for q in model.coordinates} | {c.name for c in model.constants}
    letter = next(letter for letter in _LETTERS if letter not in taken)
    for components in (model.vector, model.coordinates):
        symbol = _symbol(letter, components, model)
        length = VectorLength(components, symbol, sp.Symbol(f"{symbol.name}_dot"), letter)
        if any(symbol in length.shortened(entry).free_symbols for entry in model.matrix):
            return length
    return None


def _symbol(letter: str, components: Sequence[sp.Expr], model: RotationModel) -> sp.Symbol:
    """That of the length of the vector itself, or another one, however it is written."""
    is_of_vector = components == model.vector and letter == LENGTH.name
    return LENGTH if is_of_vector else sp.Symbol(f"{letter}_q", positive=True)


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
