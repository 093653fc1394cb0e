"""Values of SymPy expressions in any arithmetic: `evaluate(expression, arithmetic, values)`.

An arithmetic gives a `number` of the value numerator/denominator, a `constant` ("pi" or "e"), a
rational `power`, and `apply`, which takes the names of its `functions`; it is given the expressions
too, for errors to name them. `Intervals` are proved to enclose the
true values: roots of negative numbers, quotients by zero and logarithms of numbers that are not
positive have no real value there, and a value is returned only if it exists at every point of the
intervals. `Floats` are NumPy arrays or plain numbers; `function_of` walks the expression once, and
makes it a function of floats to be called thousands of times.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from functools import cache
from operator import itemgetter
from typing import Any

import mpmath
import sympy as sp
from sympy.core.function import AppliedUndef

_REWRITTEN: dict[str, Callable[..., sp.Expr]] = {  # where an arithmetic has no such function
    "tan": lambda x: sp.sin(x) / sp.cos(x),
    "cot": lambda x: sp.cos(x) / sp.sin(x),
    "sec": lambda x: 1 / sp.cos(x),
    "csc": lambda x: 1 / sp.sin(x),
    "cosh": lambda x: (sp.exp(x) + sp.exp(-x)) / 2,
    "sech": lambda x: 2 / (sp.exp(x) + sp.exp(-x)),
    "coth": lambda x: (sp.exp(2 * x) + 1) / (sp.exp(2 * x) - 1),
    "csch": lambda x: 2 / (sp.exp(x) - sp.exp(-x)),
    "acot": lambda x: sp.atan(1 / x),
}
_MONOTONE = frozenset(
    {"atan", "asin", "acos", "sinh", "tanh", "asinh", "acosh", "atanh", "erf", "log"}
)
_LARGEST_EXPONENT = 10**5  # of exp, and angle of sin and cos: mpmath would need ever more digits


class NotReal(ValueError):
    """An expression without a real value: what it is, and the part that is at fault."""

    def __init__(self, reason: str, part: sp.Expr) -> None:
        super().__init__(f"{reason} {part}")
        self.reason, self.part = reason, part


class Unknown(ValueError):
    """A part of an expression of which no value is known."""

    def __init__(self, part: sp.Expr) -> None:
        super().__init__(f"no value is known of {part}")
        self.part = part


def evaluate(
    expression: sp.Expr, arithmetic: Intervals | Floats, values: dict[sp.Expr, Any]
) -> Any:
    """The value of an expression; `values` holds those of symbols, and remembers those of parts.

    Raises Unknown for a part that has none.
    """
    if expression not in values:
        values[expression] = _value(expression, arithmetic, values)
    return values[expression]


def _value(e: sp.Expr, arithmetic: Intervals | Floats, values: dict[sp.Expr, Any]) -> Any:
    if e.is_Rational:
        return arithmetic.number(int(e.p), int(e.q))
    if e.is_Float:
        return arithmetic.number(*float(e).as_integer_ratio())
    if e is sp.pi or e is sp.E:
        return arithmetic.constant("pi" if e is sp.pi else "e")
    name = e.func.__name__
    if e.is_Add or e.is_Mul:
        first, *others = (evaluate(part, arithmetic, values) for part in e.args)
        for other in others:
            first = first + other if e.is_Add else first * other
        return first
    if e.is_Pow:
        if e.exp.is_Rational:
            return arithmetic.power(evaluate(e.base, arithmetic, values), e.exp, e)
        # bᵉ = exp(e log b), unevaluated, since SymPy may turn it back into bᵉ.
        return evaluate(sp.exp(e.exp * sp.log(e.base), evaluate=False), arithmetic, values)
    if isinstance(e, AppliedUndef) or not e.args:
        raise Unknown(e)
    if name in arithmetic.functions:
        parts = (evaluate(part, arithmetic, values) for part in e.args)
        return arithmetic.apply(name, e, *parts)
    if name in _REWRITTEN:
        return evaluate(_REWRITTEN[name](*e.args), arithmetic, values)
    raise Unknown(e)


class Intervals:
    """Intervals of so many digits, by mpmath."""

    functions = _MONOTONE | {"exp", "sin", "cos", "Abs", "atan2"}

    def __init__(self, digits: int) -> None:
        self.context = context(digits, of_intervals=True)

    def number(self, numerator: int, denominator: int) -> Any:
        return self.context.mpf(numerator) / self.context.mpf(denominator)

    def constant(self, name: str) -> Any:
        return +getattr(self.context, name)

    def power(self, base: Any, exponent: sp.Rational, whole: sp.Expr) -> Any:
        if exponent.q != 1 and base.a < 0:
            raise NotReal("a root of a negative number,", whole.base)
        if exponent < 0 and 0 in base:
            raise NotReal("division by", whole.base)
        degree = int(exponent.q)
        if degree == 2:
            base = self.context.sqrt(base)
        elif degree > 2:
            base = self._monotone("root", base, whole, degree)
        return base ** int(exponent.p)

    def apply(self, name: str, whole: sp.Expr, *values: Any) -> Any:
        (value, *others), context = values, self.context
        if name in ("exp", "sin", "cos"):
            if not abs(value) < _LARGEST_EXPONENT:
                raise NotReal("a number that is too large,", whole)
            return getattr(context, name)(value)
        if name == "Abs":
            return abs(value)
        if name == "atan2":
            # by the arc tangent of a quotient that stays finite
            (x,) = others
            if x.a > 0:
                return self._monotone("atan", value / x, whole)
            if value.a > 0 or value.b < 0:
                quarter = context.pi / 2 if value.a > 0 else -context.pi / 2
                return quarter - self._monotone("atan", x / value, whole)
            raise NotReal("no direction is known of", sp.Tuple(*whole.args[::-1]))
        return self._monotone(name, value, whole)

    def _monotone(self, name: str, value: Any, whole: sp.Expr, *more: int) -> Any:
        """A monotone function, by its values at both ends."""
        digits = self.context.dps
        # The image of [a, b] under a monotone function lies between f(a) and f(b). mpmath's
        # floating-point functions do not bound their errors; ten more digits and the slack below
        # leave room for these.
        own = context(digits + 10)
        ends = [getattr(own, name)(own.mpf(end), *more) for end in (value.a, value.b)]
        if any(isinstance(end, own.mpc) or not own.isfinite(end) for end in ends):
            raise NotReal("a value that is not real,", whole)
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
        self.context = self.intervals.context
        self._values: dict[sp.Expr, Any] = {}
        for atom, value in point.items():
            is_exact = isinstance(value, sp.Expr)
            self._values[atom] = self(value) if is_exact else self.context.mpf(value)

    def set(self, atom: sp.Expr, value: Any) -> None:
        """Give an atom its value, before anything that holds it is asked for."""
        self._values[atom] = value

    def __call__(self, expression: sp.Expr) -> Any:
        """The bounds; raises NotReal if there is no value, Unknown if none is known."""
        return evaluate(expression, self.intervals, self._values)


class Floats:
    """Floats, one or an array of them, by a module of functions: NumPy, or math."""

    _NAMES: Mapping[str, tuple[str, ...]] = {  # in SymPy: in the modules
        **{name: (name,) for name in ("sin", "cos", "tan", "sinh", "cosh", "tanh", "exp", "log")},
        **{f"a{name}": (f"a{name}", f"arc{name}") for name in ("sin", "cos", "tan", "tan2")},
        "Abs": ("fabs",),
        "erf": ("erf",),
    }

    def __init__(self, module: Any) -> None:
        self._module = module
        self.by_name = {
            name: getattr(module, own)
            for name, names in self._NAMES.items()
            for own in names
            if hasattr(module, own)
        }
        self.functions = frozenset(self.by_name)

    def number(self, numerator: int, denominator: int) -> float:
        return numerator / denominator

    def constant(self, name: str) -> float:
        return float(getattr(self._module, name))

    def power(self, base: Any, exponent: sp.Rational, whole: sp.Expr) -> Any:  # noqa: ARG002
        # a float, since NumPy takes no whole number to a negative whole power
        return (base + 0.0) ** (int(exponent) if exponent.is_Integer else float(exponent))

    def apply(self, name: str, whole: sp.Expr, *values: Any) -> Any:  # noqa: ARG002
        return self.by_name[name](*values)


_IN_FLOATS: dict[str, Callable[..., float]] = {
    "Add": lambda *parts: sum(parts),
    "Mul": lambda *parts: math.prod(parts),
    "Pow": pow,
    **Floats(math).by_name,
}


def function_of(
    expression: sp.Expr, symbols: Sequence[sp.Expr]
) -> Callable[[Sequence[float]], float]:
    """The value of an expression in floats, for values of the symbols in their order."""
    if expression in symbols:
        return itemgetter(symbols.index(expression))
    if expression.is_number:
        number = float(expression)
        return lambda _: number
    name = expression.func.__name__
    if name in _REWRITTEN and name not in _IN_FLOATS:
        return function_of(_REWRITTEN[name](*expression.args), symbols)
    if name not in _IN_FLOATS:
        raise Unknown(expression)
    function = _IN_FLOATS[name]
    parts = [function_of(part, symbols) for part in expression.args]
    if len(parts) > 1:
        return lambda values: function(*[part(values) for part in parts])
    (part,) = parts
    return lambda values: function(part(values))


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
