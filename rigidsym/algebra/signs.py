"""Signs of expressions whose variables stay within bounds, told by their form."""

from __future__ import annotations

from collections.abc import Mapping

import sympy as sp

Bounds = tuple[sp.Expr, sp.Expr]
_HALF = sp.pi / 2


def sign_within(expression: sp.Expr, bounds: Mapping[sp.Symbol, Bounds]) -> int | None:
    """1 if an expression is never negative, −1 if it is never positive, None if its form is silent.

    Symbols without bounds are constants, and positive.
    """
    if expression.is_number:
        return 1 if bool(expression >= 0) else -1
    if expression.is_Symbol:
        low, high = bounds.get(expression, (sp.S.Zero, sp.oo))
        if sign_within(low, bounds) == 1:
            return 1
        return -1 if sign_within(high, bounds) == -1 else None
    if expression.is_Add:
        signs = {sign_within(term, bounds) for term in expression.args}
        return signs.pop() if len(signs) == 1 else None
    if expression.is_Mul:
        product = 1
        for factor in expression.args:
            product *= sign_within(factor, bounds) or 0
        return product or None
    if expression.is_Pow and expression.exp.is_Rational:
        is_even = expression.exp.p % 2 == 0 or expression.exp.q % 2 == 0
        return 1 if is_even else sign_within(expression.base, bounds)
    if isinstance(expression, sp.sin | sp.cos):
        first = sp.S.Zero if isinstance(expression, sp.sin) else -_HALF
        return 1 if _lies_in(expression.args[0], (first, first + sp.pi), bounds) else None
    return None


def _lies_in(angle: sp.Expr, half: Bounds, bounds: Mapping[sp.Symbol, Bounds]) -> bool:
    """Whether a multiple of one variable stays within half a turn, in numbers."""
    number, variable = angle.as_coeff_Mul()
    ends = [number * end for end in bounds.get(variable, ())]
    return bool(ends) and all(end.is_number and half[0] <= end <= half[1] for end in ends)
