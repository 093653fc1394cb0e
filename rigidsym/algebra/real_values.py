"""Real values of expressions, as intervals that are proved to enclose them.

Roots of negative numbers, quotients by zero and logarithms of zero or negative numbers have no real
value. A value is returned only if it exists at every point of the intervals, so that statements
about it are proved.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import mpmath
import sympy as sp
from sympy.core.function import AppliedUndef

from rigidsym.algebra.generators import TIME

DIGITS = 50
MORE_DIGITS = 400  # if fewer do not decide
GUARD = 20  # digits that evaluations may lose
SCALES = ("1", "1", "1", "-1", "-1", "1/10", "10", "-10", "1/100", "100")  # of random points
_ATOMS = (sp.Symbol, sp.Derivative, AppliedUndef)
Numbers = dict[sp.Expr, Any]
Point = Mapping[sp.Expr, Any]  # of functions of time, their derivatives and symbols
_MONOTONE = {"atan", "asin", "acos", "sinh", "tanh", "asinh", "acosh", "atanh", "erf"}
_LARGEST_EXPONENT = 10**5
_REWRITTEN: dict[type, Callable[..., sp.Expr]] = {
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
def arithmetic(digits: int, *, of_intervals: bool = False) -> Any:
    """Numbers or intervals of so many digits; mpmath takes milliseconds to make an arithmetic."""
    context = mpmath.iv.__class__() if of_intervals else mpmath.mp.__class__()
    context.dps = digits
    return context


class RealValues:
    """Bounds on the values of expressions at one point, each worked out once.

    `radii` bound the distances of the true values from those of the point.
    """

    def __init__(self, point: Point, digits: int, radii: Point | None = None) -> None:
        self.numbers = arithmetic(digits)
        self.context = arithmetic(digits, of_intervals=True)
        self._known: dict[sp.Expr, Any] = {}
        for atom, value in point.items():
            middle = self(value) if isinstance(value, sp.Expr) else self.context.mpf(value)
            radius = (radii or {}).get(atom, 0)
            self._known[atom] = self.around(middle, radius) if radius else middle

    def around(self, middle: Any, radius: Any) -> Any:
        """The interval of a radius about a number."""
        return middle + self.context.mpf(radius) * self.context.mpf([-1, 1])

    def set(self, atom: sp.Expr, value: Any) -> None:
        """Give an atom its value, before anything that holds it is asked for."""
        self._known[atom] = value

    def middle(self, expression: sp.Expr) -> Any:
        """The number in the middle of the bounds."""
        return self.numbers.mpf(self(expression).mid)

    def __call__(self, expression: sp.Expr) -> Any:
        """The bounds; raises NotReal if there is no value, Unknown if none is known."""
        if expression not in self._known:
            self._known[expression] = self._value(expression)
        return self._known[expression]

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
        if isinstance(e, sp.exp | sp.sin | sp.cos):
            return getattr(context, e.func.__name__)(self._moderate(self(e.args[0]), e))
        if isinstance(e, sp.log):
            return context.log(self._positive(e.args[0], "the logarithm of"))
        if isinstance(e, sp.Abs):
            return abs(self(e.args[0]))
        if type(e) in _REWRITTEN:
            return self(_REWRITTEN[type(e)](*e.args))
        if isinstance(e, sp.atan2):
            return self(self._quarter(*e.args))
        return self._function(e)

    def _quarter(self, y: sp.Expr, x: sp.Expr) -> sp.Expr:
        """atan2 by the arc tangent of a quotient that stays finite."""
        if self(x).a > 0:
            return sp.atan(y / x)
        if self(y).a > 0:
            return sp.pi / 2 - sp.atan(x / y)
        if self(y).b < 0:
            return -sp.pi / 2 - sp.atan(x / y)
        raise NotReal("no direction is known of", sp.Tuple(x, y))

    def _moderate(self, exponent: Any, whole: sp.Expr) -> Any:
        if not abs(exponent) < _LARGEST_EXPONENT:
            raise NotReal("a number that is too large,", whole)
        return exponent

    def _power(self, base: sp.Expr, exponent: sp.Expr) -> Any:
        if not exponent.is_Rational:
            return self.context.exp(
                self(exponent) * self.context.log(self._positive(base, "a power of"))
            )
        value = self(base)
        if exponent.q != 1 and value.a < 0:
            raise NotReal("a root of a negative number,", base)
        if exponent < 0 and 0 in value:
            raise NotReal("division by", base)
        return self._root(value, int(exponent.q)) ** int(exponent.p)

    def _root(self, value: Any, degree: int) -> Any:
        if degree < 3:
            return value if degree == 1 else self.context.sqrt(value)
        if 0 in value:
            above = self.context.mpf(value.b) ** (self.context.mpf(1) / degree)
            return self.context.mpf([0, above.b]) if value.b > 0 else self.context.mpf(0)
        return self.context.exp(self.context.log(value) / degree)

    def _positive(self, part: sp.Expr, reason: str) -> Any:
        if not self(part).a > 0:
            raise NotReal(f"{reason} a number that is not positive,", part)
        return self(part)

    def _function(self, e: sp.Expr) -> Any:
        """A monotone function, by its values at both ends."""
        name = e.func.__name__
        if isinstance(e, AppliedUndef) or name not in _MONOTONE:
            raise Unknown(e)
        value, digits = self(e.args[0]), self.context.dps
        own = arithmetic(digits + 10)
        found = [getattr(own, name)(own.mpf(end)) for end in (value.a, value.b)]
        if any(isinstance(f, own.mpc) or not own.isfinite(f) for f in found):
            raise NotReal("a value that is not real,", e)
        slack = own.mpf(10) ** -digits * (1 + max(map(abs, found)))
        return self.context.mpf([min(found) - slack, max(found) + slack])


@dataclass(frozen=True, eq=False)
class Configuration:
    """Real values of coordinates, rates and constants; unbound ones follow from the seed."""

    values: Mapping[sp.Expr, Any]  # of what the conditions hold: exact, or with many digits
    radii: Mapping[sp.Expr, Any]  # bounds on the distance of the true values, if not exact
    digits: int
    seed: int

    def numbers(self, expressions: Sequence[sp.Expr]) -> RealValues:
        """The values of expressions to so many digits."""
        return RealValues(self._point(expressions), self.digits + GUARD)

    def intervals(self, expressions: Sequence[sp.Expr]) -> RealValues:
        """Proved bounds on the values of expressions."""
        return RealValues(self._point(expressions), self.digits + GUARD, self.radii)

    def _point(self, expressions: Sequence[sp.Expr]) -> Numbers:
        return {**random_point(atoms_of(expressions), self.seed), **self.values}


def atoms_of(expressions: Sequence[sp.Expr]) -> list[sp.Expr]:
    """Symbols, functions of time and their derivatives, in alphabetical order."""
    found = set().union(*(e.atoms(*_ATOMS) for e in expressions)) - {TIME}
    return sorted(found, key=str)


def random_point(atoms: Sequence[sp.Expr], seed: int) -> Numbers:
    """A rational number for each atom, the same for its name and the seed wherever it occurs."""
    scale = sp.Rational(SCALES[seed % len(SCALES)])
    drawn = (random.Random(f"{seed} {atom}").randint(101, 999) for atom in atoms)
    numbers = (scale * sp.Rational(number, 1000) for number in drawn)
    return {TIME: sp.Rational(1, 3), **dict(zip(atoms, numbers, strict=True))}


def values_of_parts(work: RealValues, parts: Sequence[sp.Expr]) -> list[Any]:
    """The values of expressions; a function of which none is known has one at random.

    Raises NotReal for an expression that is not real.
    """
    values = []
    for part in parts:
        while True:
            try:
                values.append(work(part))
                break
            except Unknown as error:
                work.set(error.part, work(random_point([error.part], 0)[error.part]))
    return values
