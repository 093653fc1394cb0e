"""Bounds on the rounding error of kernels, and guards of divisors that vanish.

Bounds come from the operations of a kernel: static forward analysis. Every value gets a bound on
its size and one on its error in units of eps, for inputs that are exact as given: angles, of which
only sines and cosines are taken, of any size, and other inputs of at most one. An operation rounds
by half a unit in the last place of its result, which is 2^p eps/4 for results of at most 2^p, and
passes on the errors of its operands (Higham, Accuracy and Stability of Numerical Algorithms,
chapters 2 and 3); terms in eps² are covered by rounding the result up. Sines and cosines are taken
to be at most one, and within `SINE`. If a kernel divides, there is no such bound.
`benchmarks/bounds.py` has the same bounds proved by Gappa.

At a pole, a kernel returns NaN instead of a number of pure rounding error. A sine or cosine cannot
be distinguished from zero if it is at most eps times its angle, the size of the rounding error of
the angle. The functions c_k of n² have errors of up to 4 eps of n, a sum of up to 4 eps of the
sizes of its terms; a sum of squares loses its digits if it underflows, or if its terms are smaller
than the rounding errors of their angles.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import replace
from fractions import Fraction
from functools import lru_cache, reduce
from math import ceil, factorial, frexp
from typing import TypeGuard

from rigidsym.algebra.stable_forms import FIRST_SERIES, series_of
from rigidsym.kernels import ir
from rigidsym.kernels.lowering.naming import Names
from rigidsym.system.records import NamedTuple, Record

SINE = 1.1  # eps: of a sine or a cosine, what every target keeps; tests measure it
_ENTIRE = 3.0  # eps of its size: of c0, c1 and c2
_HALF = 0.5  # the mantissa of a power of two
_SLACK = 1 + 2.0**-15  # for terms in eps², of single precision too, and for rounding here


class Bounded(Record):
    """Bounds on a value."""

    size: float
    error: float  # in eps
    is_scale: bool = False  # a power of two, by which products and quotients are exact

    @classmethod
    def rounded(cls, size: float, error: float = 0.0) -> Bounded:
        """The float nearest to a number that is at most `size` and has an error already."""
        # 2^(e−1) ≤ size < 2^e. The least power of two that is not below the size is 2^e, or 2^(e−1)
        # if the size is this power itself.
        mantissa, exponent = frexp(size)
        power = 2.0 ** (exponent - (mantissa == _HALF))
        is_float = (mantissa * 2**24).is_integer()  # in single precision too
        return cls(size if is_float else min(power, size * _SLACK), error + power / 4)


class NoBoundError(Exception):
    """The error of a value is not bounded, or not by this analysis."""


class Rounding(NamedTuple):
    """A bound on the error of every entry of a kernel."""

    error: float  # in eps of the type, rounded up to a tenth
    of_any_size: tuple[str, ...]  # arguments whose components are angles alone
    up_to_one: tuple[str, ...]  # arguments with components that it holds for up to one


@lru_cache(maxsize=256)  # each language tells the bound, and the module that there is one
def rounding(kernel: ir.Kernel) -> Rounding | None:
    """The bound of a kernel; None for one that divides or takes roots."""
    plain, exact = numbers_and_angles(kernel)
    try:
        error = largest_error(kernel, dict.fromkeys(plain, Bounded(1.0, 0.0)), exact)
    except NoBoundError:
        return None
    used = [a for a in kernel.arguments if not kernel.used.isdisjoint(a.components)]
    return Rounding(
        error=ceil(10 * _SLACK * error) / 10,
        of_any_size=tuple(a.name for a in used if plain.isdisjoint(a.components)),
        up_to_one=tuple(a.name for a in used if not plain.isdisjoint(a.components)),
    )


def largest_error(
    kernel: ir.Kernel, inputs: Mapping[str, Bounded], exact: Collection[str] = ()
) -> float:
    """In eps, of the outputs; names in `exact`, and inputs without bounds, are exact angles.

    Raises NoBoundError where the kernel divides, or takes roots.
    """
    values = dict(inputs)
    for assignment in kernel.assignments:
        if assignment.name not in exact:
            values[assignment.name] = _bounded(assignment.value, values)
    return max(_bounded(output, values).error for output in kernel.outputs)


class _Ones(dict[str, Bounded]):
    """Bounds of what has none: exact, and at most one; so are divisors."""

    def __missing__(self, name: str) -> Bounded:
        return Bounded(1.0, 0.0)


def error_of_form(assignments: Iterable[ir.Assignment], outputs: Iterable[ir.Expression]) -> float:
    """A measure of the rounding in a form, with which others of the same function compare.

    It is the error in eps if inputs, divisors, roots and choices were exact and at most one.
    """
    values = _Ones()
    for name, value in assignments:
        with suppress(NoBoundError):
            values[name] = _bounded(value, values)
    return max(_bounded(output, values).error for output in outputs)


def numbers_and_angles(kernel: ir.Kernel) -> tuple[set[str], set[str]]:
    """The inputs that more is taken of than a sine or a cosine, of them or of a half of them, and
    the names of halves as exact as the angle itself.

    That a guard compares with an angle does not count.
    """
    halves = _halves(kernel)
    others = [a.value for a in kernel.assignments if a.name not in halves]
    plain = {
        name
        for value in (*others, *kernel.outputs)
        if not (isinstance(value, ir.Guarded) or _is_sine(value))
        for name in ir.names_in(value)
    }
    # From the last one to the first, since a half may be taken of a half.
    for name, source in reversed(halves.items()):
        if name in plain:
            plain.add(source)
    return plain.intersection(kernel.components), halves.keys() - plain


def adds_angles(kernel: ir.Kernel) -> bool:
    """Whether a sine or a cosine is taken of what was rounded: a sum or a multiple of angles."""
    exact = {*kernel.components, *_halves(kernel)}
    return any(angle.text not in exact for angle in kernel.sines)


def _halves(kernel: ir.Kernel) -> dict[str, str]:
    """name: what it is a half of, or another power of two times, and so exact."""
    halves = {}
    for name, product in kernel.assignments:
        match product:
            case ir.Product((ir.Number(value), ir.Name(source)), ()) if _is_power_of_two(value):
                halves[name] = source
    return halves


def _is_power_of_two(value: Fraction | float) -> bool:
    return frexp(float(value))[0] in (0.5, -0.5)


def _is_sine(value: ir.Expression) -> TypeGuard[ir.Call]:
    return isinstance(value, ir.Call) and value.function in ("sin", "cos")


def _bounded(expression: ir.Expression, values: Mapping[str, Bounded]) -> Bounded:
    """From left to right, as the targets compute."""
    match expression:
        case ir.Name(text):
            return values[text]
        case ir.Number(value):
            size, is_scale = abs(float(value)), _is_power_of_two(value)
            if is_scale or (isinstance(value, Fraction) and Fraction(float(value)) == value):
                return Bounded(size, 0.0, is_scale)
            return Bounded.rounded(size)
        case ir.Negative(operand):
            return _bounded(operand, values)
        case ir.Sum(terms):
            bounds = (_bounded(term, values) for term in terms)
            return reduce(lambda a, b: Bounded.rounded(a.size + b.size, a.error + b.error), bounds)
        case ir.Product(factors, divisors):
            numbers = tuple(d for d in divisors if isinstance(d, ir.Number))
            if numbers != divisors and not isinstance(values, _Ones):
                raise NoBoundError
            above, below = (
                reduce(_product, (_bounded(part, values) for part in side), _ONE)
                for side in (factors, numbers)
            )
            # The error of 1/b is that of b over b². The error of the quotient is rounded once, in
            # the product.
            inverse = Bounded(1 / below.size, below.error / below.size**2, below.is_scale)
            return _product(above, inverse)
        case ir.Call("sin" | "cos", argument):
            # The slope of sine and cosine is at most 1 in size, so that they pass the error of the
            # angle on.
            angle = values.get(argument.text, Bounded(0.0, 0.0))  # an input is exact as given
            return Bounded(1.0, SINE + angle.error)
        case ir.Call("abs", argument):
            return values[argument.text]
        case ir.Call(_, argument) if expression.order is not None:
            # c_k takes n²: its error, and one eps of its size for the rounding of n, pass on with
            # the slope.
            size, slope, own = entire_bounds(expression.order)
            square = values[argument.text]
            return Bounded(size, own * size + slope * (square.error + square.size))
    raise NoBoundError


def _product(a: Bounded, b: Bounded) -> Bounded:
    # |â b̂ − a b| ≤ δa |b| + |a| δb + δa δb; the last term is of the order eps².
    size, error = a.size * b.size, a.error * b.size + b.error * a.size
    if a.is_scale or b.is_scale:
        return Bounded(size, error, a.is_scale and b.is_scale)
    return Bounded.rounded(size, error)


_ONE = Bounded(1.0, 0.0, is_scale=True)


def entire_bounds(order: int) -> tuple[float, float, float]:
    """Of c_k of n²: its size, at most 1/k!; its slope, (k c_(k+2) - c_(k+1))/2; its own error in
    eps of its size. Beside that n is off by half an eps, and n² by one."""
    slope = 0.5 * (order / factorial(order + 2) + 1 / factorial(order + 1))
    own = float(series_of(order).error) if order >= FIRST_SERIES else _ENTIRE
    return Bounded.rounded(1 / factorial(order)).size, slope, own


_ROUNDINGS = ir.Number(Fraction(4))
_DOUBLE_ZERO = ir.Number(Fraction(8))  # c₂ near a zero is half the square of the error of n over n


def guarded(kernel: ir.Kernel, names: Names) -> ir.Kernel:
    """The same kernel with its divisors guarded, as far as they can vanish.

    `names` gives out the names that are new.
    """
    if not kernel.divisors:
        return kernel
    guard = _Guard(names)
    for assignment in kernel.assignments:
        guard.assign(assignment.name, guard.expression(assignment.value))
    outputs = tuple(map(guard.expression, kernel.outputs))
    return replace(kernel, assignments=tuple(guard.assignments), outputs=outputs)


class _Guard:
    def __init__(self, names: Names) -> None:
        self.assignments: list[ir.Assignment] = []
        self._names = names
        self._values: dict[str, ir.Expression] = {}
        self._known: dict[ir.Expression, ir.Expression] = {}  # divisors
        self._made: dict[ir.Expression, ir.Name] = {}  # sizes and limits

    def assign(self, name: str, value: ir.Expression) -> ir.Name:
        self.assignments.append(ir.Assignment(name, value))
        self._values[name] = value
        return ir.Name(name)

    def expression(self, whole: ir.Expression) -> ir.Expression:
        """The expression with its divisors guarded; what that takes is assigned before it."""
        match whole:
            case ir.Product(factors, divisors):
                divided = tuple(map(self._divisor, divisors))
                return ir.Product(tuple(map(self.expression, factors)), divided)
            case ir.Sum(terms):
                return ir.Sum(tuple(map(self.expression, terms)))
            case ir.Negative(operand):
                return ir.Negative(self.expression(operand))
        return whole

    def _divisor(self, divisor: ir.Expression) -> ir.Expression:
        if divisor not in self._known:
            whole = self.expression(divisor)
            limit = self._limit(whole)
            if limit is not None:
                value = self._named(whole)
                name = self._names.fresh(f"{value.text}_or_nan")
                whole = self.assign(name, ir.Guarded(value, *limit))
            self._known[divisor] = whole
        return self._known[divisor]

    def _limit(self, divisor: ir.Expression) -> tuple[ir.Name | ir.Number | None, int] | None:
        """The scale of a guard and its power of eps; none if the divisor cannot vanish."""
        value = self._value(divisor)
        match value:
            case ir.Call("sin" | "cos", angle):
                return angle, 1
            case ir.Call("c0", square):
                # c₀ = cos n has the slope ±1 at its zeros and is off by 4 eps n there.
                root = self._new(ir.Call("sqrt", square))
                return self._new(ir.Product((_ROUNDINGS, root))), 1
            case ir.Call("c1"):
                # c₁ = sin n/n: an error of 4 eps n in the sine is one of 4 eps.
                return _ROUNDINGS, 1
            case ir.Call("c2"):
                return _DOUBLE_ZERO, 2
            case ir.Sum():
                terms = list(self._flat(value, ir.Sum))
                is_positive = all(map(self._is_positive, terms))
                if is_positive and any(isinstance(term, ir.Number) for term in terms):
                    return None
                self._named(divisor)
                factors = (factor for term in terms for factor in self._flat(term, ir.Product))
                if not is_positive:
                    return self._sizes(value), 1
                if any(isinstance(f, ir.Name) and f.text in self._values for f in factors):
                    return self._reach(), 2
                return None, 1  # squares of inputs hold no rounding, but may underflow
        return None

    def _reach(self) -> ir.Name:
        """The square of how far rounding reaches where sines and cosines are squared, over eps²."""
        # Near its zeros, a sine or a cosine of a may be wrong by 4 eps (1 + |a|), rounding of a
        # included.
        called = {v.argument: None for v in self._values.values() if _is_sine(v)}
        sizes = [self._new(ir.Call("abs", angle)) for angle in called]
        reach = self._new(ir.Product((_ROUNDINGS, ir.Sum((ir.Number(Fraction(1)), *sizes)))))
        return self._new(ir.Product((reach, reach)))

    def _value(self, expression: ir.Expression) -> ir.Expression:
        """What is behind a name, if it is not an input."""
        if isinstance(expression, ir.Name):
            return self._values.get(expression.text, expression)
        return expression

    def _flat(self, whole: ir.Expression, kind: type) -> Iterator[ir.Expression]:
        """The terms of a sum and of the sums among them, or the factors of a product likewise."""
        value = self._value(whole)
        if isinstance(value, kind) and not (isinstance(value, ir.Product) and value.divisors):
            for part in ir.parts(value):
                yield from self._flat(part, kind)
        else:
            yield whole

    def _is_positive(self, part: ir.Expression) -> bool:
        """Whether it is a positive number, or a number times squares."""
        # An even number of equal factors is a square.
        factors = list(self._flat(part, ir.Product))
        return all(
            factor.value > 0 if isinstance(factor, ir.Number) else factors.count(factor) % 2 == 0
            for factor in factors
        )

    def _sizes(self, total: ir.Sum) -> ir.Name:
        """The sum of the sizes of the terms, times the roundings that each may bring."""
        sizes = []
        for term in total.terms:
            part = term.operand if isinstance(term, ir.Negative) else term
            is_size = self._is_positive(part)
            sizes.append(part if is_size else self._new(ir.Call("abs", self._named(part))))
        return self._new(ir.Product((_ROUNDINGS, ir.Sum(tuple(sizes)))))

    def _named(self, expression: ir.Expression) -> ir.Name:
        return expression if isinstance(expression, ir.Name) else self._new(expression)

    def _new(self, value: ir.Expression) -> ir.Name:
        if value not in self._made:
            self._made[value] = self.assign(self._names.numbered("x"), value)
        return self._made[value]
