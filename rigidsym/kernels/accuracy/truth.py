"""Expressions of SymPy in numbers, at many points: to 50 digits and more, or in floats.

Every part of an expression is worked out once for all points and all functions that hold it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache, reduce
from operator import add, mul
from typing import Any

import numpy as np
import sympy as sp
from mpmath import MPContext
from numpy.typing import NDArray

from rigidsym.algebra.series import closed_form
from rigidsym.algebra.stumpff import Entire
from rigidsym.errors import KernelError

DIGITS = 50
_SPARE = 30  # for what cancels, beside a removable singularity say

Array = NDArray[Any]
Pair = tuple[Array, Array]


@dataclass(frozen=True, kw_only=True, slots=True)
class Numbers:
    """The arithmetic that arrays do not bring along; what has no value is NaN."""

    of: Callable[[Array], Array]  # from floats
    constant: Callable[[sp.Expr], Any]
    cosine_and_sine: Callable[[Array], Pair]
    root: Callable[[Array], Array]
    inverse: Callable[[Array], Array]


FLOATS = Numbers(
    of=np.asarray,
    constant=float,
    cosine_and_sine=lambda angle: (np.cos(angle), np.sin(angle)),
    root=np.sqrt,
    inverse=np.reciprocal,
)


@cache
def precise() -> Numbers:
    """Arrays of mpmath's numbers."""
    mp = MPContext()  # a context of its own, whose precision no other code changes
    mp.dps = DIGITS + _SPARE

    def each(function: Callable[[Any], Any], results: int = 1) -> Any:
        return np.frompyfunc(function, 1, results)

    def constant(value: sp.Expr) -> Any:
        if value.is_Rational:
            return mp.mpf(int(value.p)) / int(value.q)
        return mp.mpf(str(value.evalf(mp.dps)))

    return Numbers(
        of=each(lambda x: mp.mpf(float(x))),
        constant=constant,
        cosine_and_sine=each(lambda x: mp.cos_sin(x) if mp.isfinite(x) else (mp.nan, mp.nan), 2),
        root=each(lambda x: mp.sqrt(x) if x >= 0 else mp.nan),
        inverse=each(lambda x: 1 / x if x else mp.nan),
    )


_TRIGONOMETRIC: Mapping[Any, Callable[[Array, Array, Numbers], Array]] = {
    sp.cos: lambda c, _s, _n: c,
    sp.sin: lambda _c, s, _n: s,
    sp.tan: lambda c, s, n: s * n.inverse(c),
    sp.cot: lambda c, s, n: c * n.inverse(s),
    sp.sec: lambda c, _s, n: n.inverse(c),
    sp.csc: lambda _c, s, n: n.inverse(s),
}


class Truth:
    """The values of expressions at some points, from those of their symbols there."""

    def __init__(self, values: Mapping[sp.Expr, Array], numbers: Numbers) -> None:
        self._numbers = numbers
        self._known: dict[sp.Expr, Array] = {s: numbers.of(a) for s, a in values.items()}
        self._sizes: dict[sp.Expr, Array] = {}
        self._pairs: dict[sp.Expr, Pair] = {}
        self._shape = np.shape(next(iter(values.values())))

    def of(self, expression: sp.Expr) -> Array:
        """One value a point; raises KernelError for what no kernel holds."""
        if expression not in self._known:
            self._known[expression] = self._found(expression)
        return self._known[expression]

    def size(self, expression: sp.Expr) -> Array:
        """The expression with all that is added in it taken as positive, in doubles."""
        if expression not in self._sizes:
            self._sizes[expression] = self._size(expression)
        return self._sizes[expression]

    def _size(self, expression: sp.Expr) -> Array:
        if expression.is_Add:
            return reduce(add, map(self.size, expression.args))
        if expression.is_Mul:
            return reduce(mul, map(self.size, expression.args))
        if expression.is_Pow and expression.exp.is_positive:
            return self.size(expression.base) ** float(expression.exp)
        if isinstance(expression, sp.Abs):
            return self.size(expression.args[0])
        return np.abs(self.of(expression).astype(float))

    def _found(self, expression: sp.Expr) -> Array:
        if expression.is_number:
            return np.full(self._shape, self._numbers.constant(expression))
        if expression.is_Add:
            return reduce(add, map(self.of, expression.args))
        if expression.is_Mul:
            return reduce(mul, map(self.of, expression.args))
        if expression.is_Pow and (2 * expression.exp).is_Integer:
            return self._power(*expression.args)
        if isinstance(expression, sp.Abs):
            return abs(self.of(expression.args[0]))
        if isinstance(expression, Entire):
            order, square = expression.args
            return self.of(closed_form(int(order), sp.sqrt(square)))
        if expression.func in _TRIGONOMETRIC:
            pair = self._cosine_and_sine(expression.args[0])
            return _TRIGONOMETRIC[expression.func](*pair, self._numbers)
        raise KernelError(f"no value is known for {expression} ({type(expression).__name__})")

    def _power(self, base: sp.Expr, exponent: sp.Expr) -> Array:
        if exponent < 0:
            return self._numbers.inverse(self.of(base**-exponent))
        if exponent.is_Integer:
            return self.of(base) ** int(exponent)
        return self._numbers.root(self.of(base)) ** int(2 * exponent)

    def _cosine_and_sine(self, angle: sp.Expr) -> Pair:
        if angle not in self._pairs:
            self._pairs[angle] = self._numbers.cosine_and_sine(self.of(angle))
        return self._pairs[angle]
