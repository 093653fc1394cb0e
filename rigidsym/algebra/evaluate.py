"""Values of SymPy expressions in any arithmetic: `evaluate(expression, arithmetic, values)`.

An arithmetic makes a `number` of numerator and denominator, and has `functions` by their names in
SymPy, of values; the exponent of a power is a rational number of SymPy. `Intervals` are proved to
enclose the true values: roots of negative numbers, quotients by zero and logarithms of numbers that
are not positive have no real value there, and a value is returned only if it exists at every point
of the intervals. `Floats` are NumPy arrays or plain numbers.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache, partial
from math import prod
from operator import truediv
from typing import Any

import mpmath
import sympy as sp
from sympy.core.function import AppliedUndef
from sympy.functions.elementary.hyperbolic import HyperbolicFunction, InverseHyperbolicFunction

from rigidsym.algebra.generators import as_sine_cosine

_SUMS: dict[str, Callable[..., Any]] = {"Add": lambda *x: sum(x), "Mul": lambda *x: prod(x)}
_LARGEST_EXPONENT = 10**5  # of exp, and angle of sin and cos: mpmath would need ever more digits


class NotReal(ValueError):
    """An expression without a real value: what it is, and the part that is at fault."""

    def __init__(self, reason: str, part: sp.Expr | None = None) -> None:
        super().__init__(reason)
        self.reason, self.part = reason, part

    def __str__(self) -> str:
        return f"{self.reason} in {self.part}"


class Unknown(ValueError):
    """A part of an expression of which no value is known."""

    def __init__(self, part: sp.Expr) -> None:
        super().__init__(f"no value is known of {part}")
        self.part = part


def evaluate(
    expression: sp.Expr, arithmetic: Intervals | Floats, values: dict[sp.Expr, Any]
) -> Any:
    """The value of an expression; `values` holds those of symbols, and remembers those of parts."""
    if expression not in values:
        try:
            values[expression] = _value(expression, arithmetic, values)
        except NotReal as error:  # from the functions of the arithmetic, which know values only
            error.part = error.part or expression
            raise
    return values[expression]


def _value(e: sp.Expr, arithmetic: Intervals | Floats, values: dict[sp.Expr, Any]) -> Any:
    if e.is_Rational or e.is_Float:
        number = sp.Rational(e)
        return arithmetic.number(int(number.p), int(number.q))
    function = arithmetic.functions.get(e.func.__name__)
    if e.is_Pow:
        if e.exp.is_Rational:
            return arithmetic.functions["Pow"](evaluate(e.base, arithmetic, values), e.exp)
        # bᵉ = exp(e log b), unevaluated, since SymPy may turn it back into bᵉ.
        return evaluate(sp.exp(e.exp * sp.log(e.base), evaluate=False), arithmetic, values)
    if function and not isinstance(e, AppliedUndef):
        return function(*(evaluate(part, arithmetic, values) for part in e.args))
    quotient, target = as_sine_cosine(e), sp.atan
    if isinstance(e, HyperbolicFunction | InverseHyperbolicFunction):
        target = sp.exp if isinstance(e, HyperbolicFunction) else sp.log
    plain = quotient[0] / quotient[1] if quotient else e.rewrite(target, deep=False)
    if plain == e:
        raise Unknown(e)
    return evaluate(plain, arithmetic, values)


class Intervals:
    """Intervals of so many digits, by mpmath."""

    def __init__(self, digits: int) -> None:
        self.context = iv = context(digits, of_intervals=True)
        self.functions: Mapping[str, Callable[..., Any]] = {
            **_SUMS,
            **{name: partial(self._bounded, getattr(iv, name)) for name in ("exp", "sin", "cos")},
            **{name: partial(self._monotone, name) for name in ("atan", "log", "erf")},
            "Pi": lambda: +iv.pi,
            "Exp1": lambda: +iv.e,
            "Abs": abs,
            "Pow": self._power,
            "atan2": self._direction,
        }

    def number(self, numerator: int, denominator: int) -> Any:
        return self.context.mpf(numerator) / denominator

    def _power(self, base: Any, exponent: sp.Rational) -> Any:
        if exponent.q != 1 and base.a < 0:
            raise NotReal("a root of a negative number")
        if exponent < 0 and 0 in base:
            raise NotReal("division by zero")
        if exponent.q != 1:
            root, degree = self.context.sqrt, int(exponent.q)
            base = root(base) if degree == 2 else self._monotone("root", base, degree)
        return base ** int(exponent.p)

    def _bounded(self, function: Callable[[Any], Any], value: Any) -> Any:
        if not abs(value) < _LARGEST_EXPONENT:
            raise NotReal("a number that is too large")
        return function(value)

    def _direction(self, y: Any, x: Any) -> Any:
        """atan2, by the arc tangent of a quotient that stays finite."""
        if x.a > 0:
            return self._monotone("atan", y / x)
        if y.a > 0 or y.b < 0:
            quarter = self.context.pi / 2 if y.a > 0 else -self.context.pi / 2
            return quarter - self._monotone("atan", x / y)
        raise NotReal("an unknown direction")

    def _monotone(self, name: str, value: Any, *more: int) -> Any:
        """A monotone function, by its values at both ends."""
        digits = self.context.dps
        # The image of [a, b] under a monotone function lies between f(a) and f(b). mpmath's
        # floating-point functions do not bound their errors; ten more digits and the slack below
        # leave room for these.
        own = context(digits + 10)
        ends = [getattr(own, name)(own.mpf(end), *more) for end in (value.a, value.b)]
        if any(isinstance(end, own.mpc) or not own.isfinite(end) for end in ends):
            raise NotReal("a value that is not real")
        slack = own.mpf(10) ** -digits * (1 + max(map(abs, ends)))
        return self.context.mpf([min(ends) - slack, max(ends) + slack])


@cache
def context(digits: int, *, of_intervals: bool = False) -> Any:
    """mpmath's numbers or intervals of so many digits; it takes milliseconds to make them."""
    # A context of its own, since the precision of mpmath's global contexts is shared by all
    # callers.
    numbers = mpmath.iv.__class__() if of_intervals else mpmath.mp.__class__()
    numbers.dps = digits
    return numbers


class RealValues:
    """Bounds on the values of expressions at one point, each worked out once."""

    def __init__(self, point: Mapping[sp.Expr, Any], digits: int) -> None:
        self.intervals = Intervals(digits)
        self._values: dict[sp.Expr, Any] = {}
        for atom, value in point.items():
            is_exact = isinstance(value, sp.Expr)
            self._values[atom] = self(value) if is_exact else self.intervals.context.mpf(value)

    def set(self, atom: sp.Expr, value: Any) -> None:
        """Give an atom its value, before anything that holds it is asked for."""
        self._values[atom] = value

    def __call__(self, expression: sp.Expr) -> Any:
        """The bounds; raises NotReal if there is no value, Unknown if none is known."""
        return evaluate(expression, self.intervals, self._values)


class Floats:
    """Floats, one or an array of them, by NumPy."""

    number = staticmethod(truediv)

    def __init__(self, numpy: Any) -> None:
        names = {name: name for name in ("sin", "cos", "tan", "sinh", "cosh", "tanh", "exp", "log")}
        names |= {f"a{name}": f"arc{name}" for name in ("sin", "cos", "tan", "tan2")}
        self.functions: Mapping[str, Callable[..., Any]] = {
            **_SUMS,
            **{name: getattr(numpy, own) for name, own in names.items()},
            "Pi": lambda: numpy.pi,
            "Exp1": lambda: numpy.e,
            "Abs": numpy.abs,
            # a float, since NumPy takes no whole number to a negative whole power
            "Pow": lambda base, n: (base + 0.0) ** (int(n) if n.is_Integer else float(n)),
        }


# The sign of an expression whose variables stay within bounds


Bounds = tuple[sp.Expr, sp.Expr]


def is_never_negative(expression: sp.Expr, bounds: Mapping[sp.Symbol, Bounds]) -> bool:
    """Whether the form of an expression tells that it is never negative within bounds.

    Symbols without bounds are constants, and positive. SymPy decides by the signs of the parts;
    the sine of a multiple of one variable has one if it stays within half a turn.
    """
    # Dummies with assumptions in place of the symbols; SymPy then knows the signs of sums and
    # products.
    plain: dict[sp.Expr, sp.Expr] = {}
    # sin u ≥ 0 for 0 ≤ u ≤ π, as in the volume element r² sin θ, and cos u ≥ 0 for |u| ≤ π/2, as in
    # r² cos(latitude).
    for function in expression.atoms(sp.sin, sp.cos):
        number, variable = function.args[0].as_coeff_Mul()
        ends = [number * end for end in bounds.get(variable, ())]
        first = sp.S.Zero if isinstance(function, sp.sin) else -sp.pi / 2
        if ends and all(end.is_number and first <= end <= first + sp.pi for end in ends):
            plain[function] = sp.Dummy(nonnegative=True)
    for symbol in expression.free_symbols:
        low, high = bounds.get(symbol, (sp.S.Zero, sp.oo))
        is_positive = symbol not in low.free_symbols and is_never_negative(low, bounds)
        is_negative = not is_positive and is_never_negative(-high, bounds)
        plain[symbol] = sp.Dummy(
            real=True, nonnegative=is_positive or None, nonpositive=is_negative or None
        )
    return bool(expression.xreplace(plain).is_nonnegative)
