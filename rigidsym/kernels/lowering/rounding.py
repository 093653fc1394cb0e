"""Bounds on the rounding error of kernels, from their own operations: static forward analysis.

Every value of a kernel gets a bound on its size and one on its error in units of eps, for inputs
that are exact as given: angles, of which only sines and cosines are taken, of any size, and other
inputs of at most one. An operation rounds by half an eps of what it gives and passes on the errors
of what it takes (Higham, Accuracy and Stability of Numerical Algorithms, chapter 3); terms in eps²
are covered by rounding the result up. Where a kernel divides, there is no such bound.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import reduce
from math import ceil, factorial, frexp

from rigidsym.algebra.series import FIRST_SERIES, series_of
from rigidsym.kernels.ir import (
    Call,
    Expression,
    Guarded,
    Kernel,
    Name,
    Negative,
    Number,
    Product,
    Sum,
    names_in,
)

SINE = 1.1  # eps: of a sine or a cosine, what every target keeps; tests measure it
_ENTIRE = 3.0  # eps of its size: of c0, c1 and c2
_SLACK = 1 + 2.0**-15  # for terms in eps², of single precision too, and for rounding here


@dataclass(frozen=True, slots=True)
class _Bounded:
    """Bounds on a value."""

    size: float
    error: float  # in eps


class _NoBound(Exception):
    """The error of a value is not bounded, or not by this analysis."""


@dataclass(frozen=True, slots=True)
class Rounding:
    """A bound on the error of every entry of a kernel."""

    error: float  # in eps of the type, rounded up to a tenth
    of_any_size: tuple[str, ...]  # arguments whose components are angles alone
    up_to_one: tuple[str, ...]  # arguments with components that it holds for up to one

    def __str__(self) -> str:
        ranges = []
        if self.of_any_size:
            ranges.append(f"angles {' and '.join(self.of_any_size)} of any size")
        if self.up_to_one:
            ranges.append(f"components of {' and '.join(self.up_to_one)} up to 1")
        return f"Bound on rounding: {self.error:g} eps in any entry, for {'; '.join(ranges)}."


def rounding(kernel: Kernel) -> Rounding | None:
    """The bound of a kernel; None where there is none: it divides, or takes roots."""
    halves = _halves(kernel)
    plain = _used_plainly(kernel, halves)
    values = {name: _Bounded(1.0, 0.0) for name in plain.intersection(kernel.components)}
    try:
        for assignment in kernel.assignments:
            if assignment.name in halves and assignment.name not in plain:
                continue  # as exact as the angle that it is a half of
            values[assignment.name] = _bounded(assignment.value, values)
        error = max(_bounded(output, values).error for output in kernel.outputs)
    except _NoBound:
        return None
    used = [a for a in kernel.arguments if not kernel.used.isdisjoint(a.components)]
    return Rounding(
        error=ceil(10 * _SLACK * error) / 10,
        of_any_size=tuple(a.name for a in used if plain.isdisjoint(a.components)),
        up_to_one=tuple(a.name for a in used if not plain.isdisjoint(a.components)),
    )


def _used_plainly(kernel: Kernel, halves: dict[str, str]) -> set[str]:
    """The inputs that more is taken of than a sine or a cosine, of them or of a half of them.

    That a guard compares with an angle does not count.
    """
    others = [a.value for a in kernel.assignments if a.name not in halves]
    values = [v for v in (*others, *kernel.outputs) if not (_is_sine(v) or isinstance(v, Guarded))]
    plain = {name for value in values for name in names_in(value)}
    for name, source in reversed(halves.items()):
        if name in plain:
            plain.add(source)
    return plain.intersection((*kernel.components, *halves))


def adds_angles(kernel: Kernel) -> bool:
    """Whether a sine or a cosine is taken of what was rounded: a sum or a multiple of angles."""
    exact = {*kernel.components, *_halves(kernel)}
    return any(angle.text not in exact for angle in kernel.sines)


def _halves(kernel: Kernel) -> dict[str, str]:
    """name: what it is a half of, or another power of two times, and so exact."""
    found = {}
    for assignment in kernel.assignments:
        match assignment.value:
            case Product((Name(source),), (Number(value),)) | Product(
                (Number(value), Name(source)), ()
            ) if _is_power_of_two(value):
                found[assignment.name] = source
    return found


def _is_power_of_two(value: Fraction | float) -> bool:
    return frexp(float(value))[0] in (0.5, -0.5)


def _is_sine(value: Expression) -> bool:
    return isinstance(value, Call) and value.function in ("sin", "cos")


def _bounded(expression: Expression, values: Mapping[str, _Bounded]) -> _Bounded:
    """From left to right, as the targets compute."""
    match expression:
        case Name(text):
            return values[text]
        case Number(value):
            size = abs(float(value))
            is_exact = isinstance(value, Fraction) and Fraction(float(value)) == value
            return _Bounded(size, 0.0 if is_exact else 0.5 * size)
        case Negative(operand):
            return _bounded(operand, values)
        case Sum(terms):
            return reduce(_sum, (_bounded(term, values) for term in terms))
        case Product(factors, divisors) if all(isinstance(d, Number) for d in divisors):
            ones = (_inverse(divisor) for divisor in divisors if isinstance(divisor, Number))
            return reduce(_product, (*(_bounded(f, values) for f in factors), *ones))
        case Call("sin" | "cos", argument):
            angle = values.get(argument.text, _Bounded(0.0, 0.0))  # an input is exact as given
            return _Bounded(1.0, SINE + angle.error)
        case Call("abs", argument):
            return values[argument.text]
        case Call(_, argument) if expression.order is not None:
            return _entire(expression.order, values[argument.text])
    raise _NoBound


def _sum(a: _Bounded, b: _Bounded) -> _Bounded:
    size = a.size + b.size
    return _Bounded(size, a.error + b.error + 0.5 * size)


def _product(a: _Bounded, b: _Bounded) -> _Bounded:
    size = a.size * b.size
    return _Bounded(size, a.error * b.size + b.error * a.size + 0.5 * size)


def _inverse(divisor: Number) -> _Bounded:
    """What a number divides by, as a factor; one half eps for its own rounding."""
    size = 1 / abs(float(divisor.value))
    return _Bounded(size, 0.5 * size)


def _entire(order: int, square: _Bounded) -> _Bounded:
    """c_k of n², at most 1/k! and of the slope (k c_(k+2) - c_(k+1))/2; n is off by half an eps."""
    size = 1 / factorial(order)
    slope = 0.5 * (order / factorial(order + 2) + 1 / factorial(order + 1))
    own = float(series_of(order).error) if order >= FIRST_SERIES else _ENTIRE
    return _Bounded(size, own * size + slope * (square.error + square.size))
