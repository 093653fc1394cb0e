"""Bounds on the rounding error of kernels, from their own operations: static forward analysis.

Every value of a kernel gets a bound on its size and one on its error in units of eps, for inputs
that are exact as given: angles, of which only sines and cosines are taken, of any size, and other
inputs of at most one. An operation rounds by half a unit in the last place of what it gives, which
is 2^p eps/4 for results of at most 2^p, and passes on the errors of what it takes (Higham, Accuracy
and Stability of Numerical Algorithms, chapters 2 and 3); terms in eps² are covered by rounding the
result up. Sines and cosines are taken to be at most one, and within `SINE`. Where a kernel divides,
there is no such bound. `benchmarks/bounds.py` has the same bounds proved by Gappa.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache, reduce
from math import ceil, factorial, frexp
from typing import NamedTuple

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
_HALF = 0.5  # the mantissa of a power of two
_SLACK = 1 + 2.0**-15  # for terms in eps², of single precision too, and for rounding here


@dataclass(frozen=True, slots=True)
class Bounded:
    """Bounds on a value."""

    size: float
    error: float  # in eps
    is_scale: bool = False  # a power of two, by which products and quotients are exact

    @classmethod
    def rounded(cls, size: float, error: float = 0.0) -> Bounded:
        """The float nearest to a number that is at most `size` and has an error already."""
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

    def __str__(self) -> str:
        ranges = []
        if self.of_any_size:
            ranges.append(f"angles {' and '.join(self.of_any_size)} of any size")
        if self.up_to_one:
            ranges.append(f"components of {' and '.join(self.up_to_one)} up to 1")
        return f"Bound on rounding: {self.error:g} eps in any entry, for {'; '.join(ranges)}."


@lru_cache(maxsize=256)  # each language tells the bound, and the module that there is one
def rounding(kernel: Kernel) -> Rounding | None:
    """The bound of a kernel; None for one that divides, takes roots, or is given degrees."""
    if any(unit.startswith("deg") for a in kernel.arguments for unit in a.units):
        return None
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
    kernel: Kernel, inputs: Mapping[str, Bounded], exact: Collection[str] = ()
) -> float:
    """In eps, of the outputs; names in `exact`, and inputs without bounds, are exact angles.

    Raises NoBoundError where the kernel divides, or takes roots.
    """
    values = dict(inputs)
    for assignment in kernel.assignments:
        if assignment.name not in exact:
            values[assignment.name] = _bounded(assignment.value, values)
    return max(_bounded(output, values).error for output in kernel.outputs)


def numbers_and_angles(kernel: Kernel) -> tuple[set[str], set[str]]:
    """The inputs that more is taken of than a sine or a cosine, of them or of a half of them, and
    the names of halves as exact as the angle itself.

    That a guard compares with an angle does not count.
    """
    halves = _halves(kernel)
    others = [a.value for a in kernel.assignments if a.name not in halves]
    values = [v for v in (*others, *kernel.outputs) if not (_is_sine(v) or isinstance(v, Guarded))]
    plain = {name for value in values for name in names_in(value)}
    for name, source in reversed(halves.items()):
        if name in plain:
            plain.add(source)
    return plain.intersection(kernel.components), halves.keys() - plain


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


def _bounded(expression: Expression, values: Mapping[str, Bounded]) -> Bounded:
    """From left to right, as the targets compute."""
    match expression:
        case Name(text):
            return values[text]
        case Number(value):
            size, is_scale = abs(float(value)), _is_power_of_two(value)
            if is_scale or (isinstance(value, Fraction) and Fraction(float(value)) == value):
                return Bounded(size, 0.0, is_scale)
            return Bounded.rounded(size)
        case Negative(operand):
            return _bounded(operand, values)
        case Sum(terms):
            return reduce(_sum, (_bounded(term, values) for term in terms))
        case Product(factors, divisors) if all(isinstance(d, Number) for d in divisors):
            above, below = (
                reduce(_product, (_bounded(part, values) for part in side), _ONE)
                for side in (factors, divisors)
            )
            inverse = Bounded(1 / below.size, below.error / below.size**2, below.is_scale)
            return _product(above, inverse)
        case Call("sin" | "cos", argument):
            angle = values.get(argument.text, Bounded(0.0, 0.0))  # an input is exact as given
            return Bounded(1.0, SINE + angle.error)
        case Call("abs", argument):
            return values[argument.text]
        case Call(_, argument) if expression.order is not None:
            return _entire(expression.order, values[argument.text])
    raise NoBoundError


def _sum(a: Bounded, b: Bounded) -> Bounded:
    return Bounded.rounded(a.size + b.size, a.error + b.error)


def _product(a: Bounded, b: Bounded) -> Bounded:
    size, error = a.size * b.size, a.error * b.size + b.error * a.size
    if a.is_scale or b.is_scale:
        return Bounded(size, error, a.is_scale and b.is_scale)
    return Bounded.rounded(size, error)


_ONE = Bounded(1.0, 0.0, is_scale=True)


def _entire(order: int, square: Bounded) -> Bounded:
    size, slope, own = entire_bounds(order)
    return Bounded(size, own * size + slope * (square.error + square.size))


def entire_bounds(order: int) -> tuple[float, float, float]:
    """Of c_k of n²: its size, at most 1/k!; its slope, (k c_(k+2) - c_(k+1))/2; its own error in
    eps of its size. Beside that n is off by half an eps, and n² by one."""
    slope = 0.5 * (order / factorial(order + 2) + 1 / factorial(order + 1))
    own = float(series_of(order).error) if order >= FIRST_SERIES else _ENTIRE
    return Bounded.rounded(1 / factorial(order)).size, slope, own
