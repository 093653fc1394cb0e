"""The letters that formulas are printed with, and the order in which a reader expects them."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import field
from enum import IntEnum
from functools import lru_cache

import sympy as sp
from sympy.core.function import AppliedUndef

from rigidsym.errors import AlgebraError
from rigidsym.formula.notation import DEFAULT, Notation
from rigidsym.formula.reader import named
from rigidsym.formula.tree import Formula, Symbol
from rigidsym.system.records import NamedTuple, Record

Place = tuple[int, int]  # order of the time derivative, index of the component

TIME = sp.Symbol("t")
NO_RATE: Place = (0, 0)  # of what is neither coordinate nor rate
_MASS = re.compile(r"[mM](_?\d+)?")  # written before other constants: m g l, m R²
_CONSTANTS: Mapping[sp.Expr, Formula] = {sp.pi: Symbol("π")}


class VectorLength(NamedTuple):
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


@lru_cache(maxsize=4096)
def _shortened(node: sp.Expr, length: VectorLength) -> sp.Expr:
    if not node.args or not node.has(*length.components):
        return node
    whole = node.func(*(_shortened(argument, length) for argument in node.args))
    if not whole.is_Add:
        return whole
    squares = sp.Add(*(part**2 for part in length.components))
    moving = sp.Add(*(part * sp.diff(part, TIME) for part in length.components))
    for short, terms in ((length.symbol**2, squares), (length.symbol * length.rate, moving)):
        coefficients = whole.as_coefficients_dict()
        numbers = {coefficients.get(term) for term in terms.args}
        if len(numbers) == 1 and None not in numbers:  # all of them have one coefficient
            (number,) = numbers
            whole += number * short - sp.Add(*(number * term for term in terms.args))
    return whole


class Letters(Record, kw_only=True):
    """How symbols are printed, and which of them are coordinates, rates and accelerations.

    A symbol that is in neither table is a constant, printed by its name. Letters equal only
    themselves, so that what is written with them can be kept for the next printer.
    """

    names: Mapping[sp.Expr, Formula] = field(default_factory=dict)
    places: Mapping[sp.Expr, Place] = field(default_factory=dict)
    notation: Notation = DEFAULT
    length: VectorLength | None = None  # written in place of the components that make it up
    own: Mapping[Formula, Formula] = field(default_factory=dict)  # in place of those of the notes
    __eq__, __hash__ = object.__eq__, object.__hash__

    def shortened(self, expression: sp.Expr) -> sp.Expr:
        """What is printed in place of an expression: the same, with the length where it has one."""
        return self.length.shortened(expression) if self.length else expression

    def name(self, symbol: sp.Expr) -> Formula:
        """The name of a symbol; raises AlgebraError for what is neither known nor a symbol."""
        name = self.names.get(symbol) or _CONSTANTS.get(symbol)
        if name is not None:
            return name
        if not isinstance(symbol, sp.Symbol | AppliedUndef):
            raise AlgebraError(
                f"no printed form for {symbol} of type {type(symbol).__name__}: expected numbers, "
                "symbols, their sums, products and powers, and sin, cos, tan, cot"
            )
        return named(symbol.name if isinstance(symbol, sp.Symbol) else symbol.func.__name__)


Key = tuple[object, ...]

FUNCTIONS = {sp.sin: "sin", sp.cos: "cos", sp.tan: "tan", sp.cot: "cot", sp.atan: "arctan"}
_FUNCTION_ORDER = {function: place for place, function in enumerate(FUNCTIONS)}


class Rank(IntEnum):
    """The kinds of factors, in the order in which they stand."""

    NUMBER = 0
    UNIVERSAL = 1  # π
    CONSTANT = 2
    COORDINATE = 3
    RATE = 4
    FUNCTION = 5
    ROOT = 6
    SUM = 7


def is_application(node: sp.Expr) -> bool:
    """Whether a node is a function of something else than time alone: exp(θ), f(θ)."""
    return bool(node.is_Function and node.args != (TIME,))


def ordered_factors(factors: Iterable[sp.Expr], letters: Letters) -> list[sp.Expr]:
    return sorted(factors, key=lambda factor: _factor_key(factor, letters))


def ordered_terms(terms: Iterable[sp.Expr], letters: Letters) -> list[sp.Expr]:
    """The terms of a sum; the first one without a minus sign is brought to the front."""
    ordered = sorted(terms, key=lambda term: _term_key(term, letters))
    first = next((k for k, term in enumerate(ordered) if not is_negative(term)), 0)
    return [ordered[first], *ordered[:first], *ordered[first + 1 :]]


def power_of(factor: sp.Expr) -> tuple[sp.Expr, sp.Expr]:
    """Base and exponent as they are printed; SymPy's own take exp(θ) apart."""
    return (factor.base, factor.exp) if factor.is_Pow else (factor, sp.S.One)


def is_negative(term: sp.Expr) -> bool:
    """Whether a term is written with a minus sign."""
    return bool(term.as_coeff_Mul()[0].is_negative)


@lru_cache(maxsize=1 << 12)
def _factor_key(factor: sp.Expr, letters: Letters) -> Key:
    base, exponent = power_of(factor)
    if base.is_Add:
        return (Rank.SUM, len(base.args), base.sort_key())
    if base.is_Number:
        return (Rank.NUMBER, base.sort_key())
    if not exponent.is_Integer:
        return (Rank.ROOT, base.sort_key())
    if base.is_NumberSymbol:
        return (Rank.UNIVERSAL, base.sort_key(), exponent)
    if base.func in FUNCTIONS or is_application(base):
        # Angles in the order of their coordinates; an angle alone before its multiples.
        angle, function = base.args[0], _FUNCTION_ORDER.get(base.func, len(FUNCTIONS))
        symbols = angle.atoms(sp.Symbol, AppliedUndef) & letters.places.keys()
        places = sorted(letters.places[symbol] for symbol in symbols)
        return (Rank.FUNCTION, places, angle.sort_key(), function, exponent)
    place = letters.places.get(base)
    if place is None:
        return (Rank.CONSTANT, not _MASS.fullmatch(str(base)), base.sort_key(), exponent)
    order, index = place
    return (Rank.RATE if order else Rank.COORDINATE, -order, index, exponent)


@lru_cache(maxsize=1 << 15)  # a sum asks for the keys of what its own terms hold, at every depth
def _term_key(term: sp.Expr, letters: Letters) -> Key:
    factors = [factor for factor in sp.Mul.make_args(term) if not factor.is_Number]
    has_bracket = any(power_of(factor)[0].is_Add for factor in factors)
    rates = _rates(term, letters)
    keys = [_factor_key(factor, letters) for factor in ordered_factors(factors, letters)]
    # Products before brackets, the highest derivatives first, then short terms before long ones.
    return (has_bracket, rates, len(factors), keys)


def _rates(term: sp.Expr, letters: Letters) -> list[Place]:
    """The rates in a term, highest derivative first; of a bracket, those of its first term."""
    places: list[Place] = []
    for factor in sp.Mul.make_args(term):
        base, exponent = power_of(factor)
        order, index = letters.places.get(base, NO_RATE)
        if order:
            places += [(-order, index)] * int(abs(exponent))
        elif base.is_Add:
            inside = _rates(ordered_terms(base.args, letters)[0], letters)
            places += inside * (int(exponent) if exponent.is_Integer and exponent > 0 else 1)
    return sorted(places)
