"""The order of factors in a product and of terms in a sum.

Factors: numbers and their roots, constants, coordinates, rates and accelerations, trigonometric
functions in the order of the coordinates (the sine of an angle before its cosine), other roots, and
bracketed sums last; so no rate can be read as part of the argument of a sine.

Terms: bracketed sums last, the highest derivative first, then in the order of the coordinates of
their rates, the short before the long; and a sum starts with a term that has no minus sign, if
there is one.
"""

from __future__ import annotations

from collections.abc import Iterable
from enum import IntEnum
from functools import lru_cache

import sympy as sp
from sympy.core.function import AppliedUndef

from rigidsym.formula.letters import TIME, Letters, Place

Key = tuple[object, ...]

FUNCTIONS = {sp.sin: "sin", sp.cos: "cos", sp.tan: "tan", sp.cot: "cot"}
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


def _factor_key(factor: sp.Expr, letters: Letters) -> Key:
    base, exponent = power_of(factor)
    if base.is_Add:
        return (Rank.SUM, len(base.args), base.sort_key())
    if base.is_Number:
        return (Rank.NUMBER, 1, base.sort_key())
    if not exponent.is_Integer:
        return (Rank.ROOT, 0, base.sort_key())
    return (*_base_key(base, letters), exponent)


def _base_key(base: sp.Expr, letters: Letters) -> Key:
    if base.is_Number:
        return (Rank.NUMBER, 0, base.sort_key())
    if base.is_NumberSymbol:
        return (Rank.UNIVERSAL, 0, base.sort_key())
    if base.func in FUNCTIONS:
        return (Rank.FUNCTION, _angle_key(base.args[0], letters), _FUNCTION_ORDER[base.func])
    if is_application(base):
        return (Rank.FUNCTION, _angle_key(base.args[0], letters), len(FUNCTIONS))
    place = letters.places.get(base)
    if place is None:
        return (Rank.CONSTANT, 0, base.sort_key())
    order, index = place
    return (Rank.RATE if order else Rank.COORDINATE, (-order, index), 0)


def _angle_key(angle: sp.Expr, letters: Letters) -> Key:
    """Angles in the order of the coordinates they hold; an angle alone before its multiples."""
    symbols = angle.atoms(sp.Symbol, AppliedUndef)
    held = sorted(letters.places[symbol] for symbol in symbols if symbol in letters.places)
    return (held, angle.sort_key())


@lru_cache(maxsize=1 << 15)  # a sum asks for the keys of what its own terms hold, at every depth
def _term_key(term: sp.Expr, letters: Letters) -> Key:
    factors = [factor for factor in sp.Mul.make_args(term) if not factor.is_Number]
    has_bracket = any(_is_sum(factor) for factor in factors)
    rates = _rates(term, letters)
    keys = [_factor_key(factor, letters) for factor in ordered_factors(factors, letters)]
    return (has_bracket, rates, len(factors), keys)


def _rates(term: sp.Expr, letters: Letters) -> list[Place]:
    """The rates in a term, highest derivative first; of a bracket, those of its first term."""
    found: list[Place] = []
    for factor in sp.Mul.make_args(term):
        base, exponent = power_of(factor)
        order, index = letters.places.get(base, (0, 0))
        if order:
            found += [(-order, index)] * int(abs(exponent))
        elif base.is_Add:
            inside = _rates(ordered_terms(base.args, letters)[0], letters)
            found += inside * (int(exponent) if exponent.is_Integer and exponent > 0 else 1)
    return sorted(found)


def _is_sum(factor: sp.Expr) -> bool:
    return bool(power_of(factor)[0].is_Add)
