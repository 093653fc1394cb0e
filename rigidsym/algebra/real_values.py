"""Real values of expressions, in numbers of many digits or in intervals that enclose them.

Roots of negative numbers, quotients by zero and logarithms of what is not positive have no real
value. In intervals a value exists only if it does for every point of the interval, so that what is
said of an interval is proved.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache
from typing import Any

import mpmath
import sympy as sp
from sympy.core.function import AppliedUndef

Point = Mapping[sp.Expr, Any]  # of functions of time, their derivatives and symbols
_MONOTONE = {"atan", "asin", "acos", "sinh", "tanh", "asinh", "acosh", "atanh", "erf"}
_LARGEST_EXPONENT = 10**5
_ENTIRE = {"sin", "cos"}
_IN_SINES: dict[type, Callable[[sp.Expr], sp.Expr]] = {
    sp.tan: lambda x: sp.sin(x) / sp.cos(x),
    sp.cot: lambda x: sp.cos(x) / sp.sin(x),
    sp.sec: lambda x: 1 / sp.cos(x),
    sp.csc: lambda x: 1 / sp.sin(x),
    sp.cosh: lambda x: (sp.exp(x) + sp.exp(-x)) / 2,
    sp.sech: lambda x: 2 / (sp.exp(x) + sp.exp(-x)),
    sp.coth: lambda x: (sp.exp(2 * x) + 1) / (sp.exp(2 * x) - 1),
    sp.csch: lambda x: 2 / (sp.exp(x) - sp.exp(-x)),
    sp.acot: lambda x: sp.atan(1 / x),
}


class NotReal(ValueError):
    """An expression without a real value: what it is, and the part that is at fault."""

    def __init__(self, reason: str, part: sp.Expr) -> None:
        super().__init__(f"{reason} {part}")
        self.reason, self.part = reason, part

    @property
    def is_sign(self) -> bool:
        """Whether the part would have to be positive, under a root or a logarithm."""
        return "root" in self.reason or "positive" in self.reason


class Unknown(ValueError):
    """A part of an expression of which no value is known."""

    def __init__(self, part: sp.Expr) -> None:
        super().__init__(f"no value is known of {part}")
        self.part = part


@cache
def _context(digits: int, intervals: bool) -> Any:
    """An arithmetic of mpmath by itself: making one takes milliseconds."""
    context = mpmath.iv.__class__() if intervals else mpmath.mp.__class__()
    context.dps = digits
    return context


class RealValues:
    """The values of expressions at one point, each worked out once.

    With `intervals` the values enclose the true ones, and a part that may be zero below a fraction
    bar, or negative below a root, raises NotReal.
    """

    def __init__(self, point: Point, *, digits: int, intervals: bool = False) -> None:
        self.context = _context(digits, intervals)
        self.is_interval = intervals
        self._known: dict[sp.Expr, Any] = {}
        for atom, value in point.items():
            self._known[atom] = self.number(value)

    def number(self, value: Any) -> Any:
        """A number of SymPy, Python or mpmath in this arithmetic."""
        if isinstance(value, sp.Expr):
            return self(value)
        return self.context.mpf(value)

    def around(self, middle: Any, radius: Any) -> Any:
        """The interval of a radius about a number."""
        return middle + self.number(radius) * self.context.mpf([-1, 1])

    def set(self, atom: sp.Expr, value: Any) -> None:
        """Give an atom its value, before anything that holds it is asked for."""
        self._known[atom] = value

    def __call__(self, expression: sp.Expr) -> Any:
        """The value; raises NotReal if there is none, Unknown if none is known."""
        if expression not in self._known:
            self._known[expression] = self._value(expression)
        return self._known[expression]

    def is_zero_possible(self, value: Any) -> bool:
        return bool(0 in value) if self.is_interval else value == 0

    def _value(self, e: sp.Expr) -> Any:
        context = self.context
        if e.is_Rational:
            return context.mpf(int(e.p)) / context.mpf(int(e.q))
        if e.is_Add:
            return sum(map(self, e.args), context.mpf(0))
        if e.is_Mul:
            product = context.mpf(1)
            for factor in e.args:
                product = product * self(factor)
            return product
        if e is sp.pi:
            return +context.pi
        if e is sp.E:
            return context.exp(context.mpf(1))
        if e.is_Pow:
            return self._power(e.base, e.exp)
        if isinstance(e, sp.exp):
            return self._exponential(e.args[0])
        if isinstance(e, sp.log):
            return context.log(self._positive(e.args[0], "the logarithm of"))
        if isinstance(e, sp.Abs):
            return abs(self(e.args[0]))
        if type(e) in _IN_SINES:
            return self(_IN_SINES[type(e)](e.args[0]))
        if isinstance(e, sp.atan2):
            return self(self._quarter(*e.args))
        return self._function(e)

    def _quarter(self, y: sp.Expr, x: sp.Expr) -> sp.Expr:
        """atan2 by the arc tangent of a quotient that stays finite."""
        if self._is_positive(x):
            return sp.atan(y / x)
        if self._is_positive(y):
            return sp.pi / 2 - sp.atan(x / y)
        if self._is_positive(-y):
            return -sp.pi / 2 - sp.atan(x / y)
        raise NotReal("no direction is known of", sp.Tuple(x, y))

    def _is_positive(self, e: sp.Expr) -> bool:
        value = self(e)
        return bool((value.a if self.is_interval else value) > 0)

    def _exponential(self, exponent: sp.Expr) -> Any:
        return self.context.exp(self._moderate(self(exponent), sp.exp(exponent)))

    def _moderate(self, exponent: Any, whole: sp.Expr) -> Any:
        if not abs(exponent) < _LARGEST_EXPONENT:
            raise NotReal("a number that is too large,", whole)
        return exponent

    def _power(self, base: sp.Expr, exponent: sp.Expr) -> Any:
        if exponent.is_Integer:
            value = self(base)
            if exponent < 0 and self.is_zero_possible(value):
                raise NotReal("division by", base)
            return value ** int(exponent)
        if not exponent.is_Rational:
            return self.context.exp(
                self(exponent) * self.context.log(self._positive(base, "a power of"))
            )
        value = self(base)
        if (value.a if self.is_interval else value) < 0:
            raise NotReal("a root of a negative number,", base)
        if exponent < 0 and self.is_zero_possible(value):
            raise NotReal("division by", base)
        root = self.context.sqrt(value) if exponent.q == 2 else self._root(value, int(exponent.q))
        return root ** int(exponent.p)

    def _root(self, value: Any, degree: int) -> Any:
        if self.is_zero_possible(value):
            if not self.is_interval or value.b == 0:
                return self.context.mpf(0)
            return self.context.mpf(
                [0, (self.context.mpf(value.b) ** (self.context.mpf(1) / degree)).b]
            )
        return self.context.exp(self.context.log(value) / degree)

    def _positive(self, part: sp.Expr, reason: str) -> Any:
        value = self(part)
        if not self._is_positive(part):
            raise NotReal(f"{reason} a number that is not positive,", part)
        return value

    def _function(self, e: sp.Expr) -> Any:
        name = e.func.__name__
        if isinstance(e, AppliedUndef) or not isinstance(e, sp.Function) or len(e.args) != 1:
            raise Unknown(e)
        value = self(e.args[0])
        if name in _ENTIRE:
            return getattr(self.context, name)(self._moderate(value, e))
        own = _context(self.context.dps + 10, False)
        function = getattr(own, name, None)
        if function is None or (self.is_interval and name not in _MONOTONE):
            raise Unknown(e)
        ends = (value.a.a, value.b.b) if self.is_interval else (value, value)
        found = [function(own.mpf(end)) for end in ends]
        if any(isinstance(f, own.mpc) or not own.isfinite(f) for f in found):
            raise NotReal("a value that is not real,", e)
        if not self.is_interval:
            return self.context.mpf(found[0])
        slack = own.mpf(10) ** (-self.context.dps) * (1 + max(map(abs, found)))
        return self.context.mpf([min(found) - slack, max(found) + slack])
