"""Sine, cosine and the angle of a point for targets that print their own: polynomials, derived.

An angle x is n quarter turns and a rest r, |r| ≤ π/4. There sin r = r + r z S(z) and
cos r = 1 + z (−1/2 + z C(z)) with z = r². π/2 is cut in parts so short that n times each is exact.

With a ≥ b ≥ 0 the sizes of a point's coordinates, its angle from the nearer axis is atan b/a, or
π/4 + atan (b − a)/(b + a) if b/a > tan π/8. There atan t = t + t z A(z) with z = t². Multiples of
π/4 are added in two parts, of which the first is exact.

S, C and A interpolate their power series in Chebyshev's points, in rational numbers.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from functools import cache, partial
from math import cos, factorial, pi

from mpmath.libmp import pi_fixed

_TERMS = 16  # of the power series of sine and cosine: the next is below 1e-35
_MARGIN = Fraction(51, 50)  # on |r| ≤ π/4: n is rounded from a rounded x
_RATIO = Fraction(28, 25)  # over r/sin r there
_WORD = 32
_ZEROS = 2  # words before the point, so that every angle finds its bits behind some
_WORDS = 40  # enough for the largest double

_ARCTANGENT_TERMS = 40  # of its power series: the next is below 1e-32
_TOP = Fraction(17158, 100000)  # over tan² π/8
_ARCTANGENT_RATIO = Fraction(53, 50)  # over tan π/8 / (π/8)
_EDGE = Fraction(41421, 100000)  # under tan π/8, where both quotients have this size

_QUARTER_OF_PI = Fraction(pi_fixed(200), 4 << 200)


@dataclass(frozen=True, kw_only=True, slots=True)
class Reduction:
    """The numbers of sine and cosine in one precision."""

    turns: int  # |n| < 2**turns, else the angle is far
    parts: tuple[Fraction, ...]  # of π/2, each but the last of digits - turns bits
    sine: tuple[Fraction, ...]  # S, from the lowest power up
    cosine: tuple[Fraction, ...]  # C
    error: Fraction  # bound on what the polynomials leave out, relative to sine and cosine

    @property
    def reach(self) -> float:
        """The largest angle that the parts reduce, in radians."""
        return 2**self.turns * pi / 2


@cache
def reduction(digits: int) -> Reduction:
    """The reduction for 53 bits (double) or 24 (float)."""
    turns, parts, terms = {53: (21, 2, 6), 24: (13, 3, 3)}[digits]
    top = (_QUARTER_OF_PI * _MARGIN) ** 2
    sine, cosine = (_interpolated(partial(_turn_series, first), terms, top) for first in (3, 4))
    return Reduction(
        turns=turns,
        parts=_parts(digits - turns, parts, digits),
        sine=sine,
        cosine=cosine,
        # more than the cosine's
        error=_RATIO * top * Fraction(2, factorial(2 * terms + 3)) * (top / 4) ** terms,
    )


@dataclass(frozen=True, kw_only=True, slots=True)
class Arctangent:
    """The numbers of the angle of a point in one precision."""

    edge: float  # up to this quotient it is taken itself
    coefficients: tuple[Fraction, ...]  # A, from the lowest power up
    eighth: tuple[float, float]  # π/4 in two parts; up to four times the first is exact
    error: Fraction  # bound on what the polynomial leaves out, relative to the arctangent


@cache
def arctangent(digits: int) -> Arctangent:
    """The numbers for 53 bits (double) or 24 (float)."""
    terms = {53: 12, 24: 5}[digits]
    scale = 2 ** (digits - 3)
    first = Fraction(int(_QUARTER_OF_PI * scale), scale)
    return Arctangent(
        edge=float(_EDGE),
        coefficients=_interpolated(_arctangent_series, terms, _TOP),
        eighth=(float(first), float(_QUARTER_OF_PI - first)),
        error=_ARCTANGENT_RATIO * _TOP * Fraction(2, 2 * terms + 3) * (_TOP / 4) ** terms,
    )


@cache
def two_over_pi() -> tuple[int, ...]:
    """2/π in words of 32 bits, after two words of zeros."""
    bits = _WORD * (_WORDS - _ZEROS)
    number = (1 << (2 * bits + 65)) // pi_fixed(bits + 64)
    places = range(_WORDS - 1 - _ZEROS, -1, -1)
    return (*[0] * _ZEROS, *((number >> (_WORD * k)) & (2**_WORD - 1) for k in places))


def _parts(short: int, count: int, digits: int) -> tuple[Fraction, ...]:
    """π/2 as `count` parts of `short` bits and one of `digits`."""
    rest = Fraction(pi_fixed(300), 2 << 300)
    found = []
    for bits in (*[short] * count, digits):
        # rest is a binary fraction: 2**size is its highest bit
        size = rest.numerator.bit_length() - rest.denominator.bit_length()
        scale = Fraction(2) ** (bits - 1 - size)
        found.append(Fraction(int(rest * scale)) / scale)
        rest -= found[-1]
    return tuple(found)


def _interpolated(
    function: Callable[[Fraction], Fraction], terms: int, top: Fraction
) -> tuple[Fraction, ...]:
    """The polynomial through a function in Chebyshev's points of (0, top), lowest power first."""
    angles = (pi * (2 * k + 1) / (2 * terms) for k in range(terms))
    points = [top * (1 + Fraction(cos(angle))) / 2 for angle in angles]
    table = list(map(function, points))
    for width in range(1, terms):  # Newton's divided differences
        for k in range(terms - 1, width - 1, -1):
            table[k] = (table[k] - table[k - 1]) / (points[k] - points[k - width])
    result = [Fraction(0)] * terms
    for k in range(terms - 1, -1, -1):  # Horner: result · (z − points[k]) + table[k]
        shifted = [Fraction(0), *result[:-1]]
        result = [a - points[k] * b for a, b in zip(shifted, result, strict=True)]
        result[0] += table[k]
    return tuple(result)


def _turn_series(first: int, z: Fraction) -> Fraction:
    """(sin r − r)/r³ for first = 3, (cos r − 1 + r²/2)/r⁴ for 4, of z = r²."""
    sign = -1 if first == 3 else 1
    terms = (sign * (-z) ** k / factorial(2 * k + first) for k in range(_TERMS))
    return sum(terms, Fraction(0))


def _arctangent_series(z: Fraction) -> Fraction:
    """(atan √z/√z − 1)/z."""
    return sum((-((-z) ** k) / (2 * k + 3) for k in range(_ARCTANGENT_TERMS)), Fraction(0))
