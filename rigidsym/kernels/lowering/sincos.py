"""Sine and cosine for targets that print their own: a reduction and two polynomials, derived.

An angle x is n quarter turns and a rest r, |r| ≤ π/4. There sin r = r + r z S(z) and
cos r = 1 + z (−1/2 + z C(z)) with z = r². S and C interpolate their power series in Chebyshev's
points, in rational numbers. π/2 is cut in parts so short that n times each is exact.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from functools import cache, partial
from math import cos, factorial, pi

_TERMS = 16  # of the power series that is interpolated: the next is below 1e-35
_MARGIN = Fraction(51, 50)  # on |r| ≤ π/4: n is rounded from a rounded x
_WORD = 32
_ZEROS = 2  # words before the point, so that every angle finds its bits behind some
_WORDS = 40  # enough for the largest double


@dataclass(frozen=True, kw_only=True, slots=True)
class Reduction:
    """The numbers of one precision."""

    digits: int  # bits of the significand
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
    eighth = quarter_of_pi() * _MARGIN
    top = eighth * eighth
    sine, cosine = (interpolated(partial(_series, first), terms, top) for first in (3, 4))
    return Reduction(
        digits=digits,
        turns=turns,
        parts=_parts(digits - turns, parts, digits),
        sine=sine,
        cosine=cosine,
        error=top * _left_out(3, terms, top),  # that of the cosine is smaller
    )


@cache
def two_over_pi() -> tuple[int, ...]:
    """2/π in words of 32 bits, after two words of zeros."""
    bits = _WORD * (_WORDS - _ZEROS)
    number = (1 << (2 * bits + 65)) // _pi_times_two_to(bits + 64)
    return tuple(
        (number >> (_WORD * (_WORDS - 1 - k))) & (2**_WORD - 1) if k >= _ZEROS else 0
        for k in range(_WORDS)
    )


@cache
def _pi_times_two_to(bits: int) -> int:
    """π 2**bits, cut off, by Machin's formula π = 16 atan(1/5) − 4 atan(1/239)."""
    one = 1 << (bits + 16)
    return (16 * _arctangent(5, one) - 4 * _arctangent(239, one)) >> 16


def _arctangent(inverse: int, one: int) -> int:
    """one · atan(1/inverse) by its power series."""
    power, total, place = one // inverse, 0, 1
    while power:
        total += power // place if place % 4 == 1 else -(power // place)
        power //= inverse * inverse
        place += 2
    return total


def quarter_of_pi() -> Fraction:
    return Fraction(_pi_times_two_to(200), 4 << 200)


def _parts(short: int, count: int, digits: int) -> tuple[Fraction, ...]:
    """π/2 as `count` parts of `short` bits and one of `digits`."""
    rest = Fraction(_pi_times_two_to(300), 2 << 300)
    found = []
    for bits in (*[short] * count, digits):
        part = _cut(rest, bits)
        found.append(part)
        rest -= part
    return tuple(found)


def _cut(value: Fraction, bits: int) -> Fraction:
    """The first bits of a positive number."""
    scale = Fraction(2) ** (bits - (value.numerator.bit_length() - value.denominator.bit_length()))
    while value * scale >= 2**bits:
        scale /= 2
    while value * scale < 2 ** (bits - 1):
        scale *= 2
    return Fraction(int(value * scale)) / scale


def interpolated(
    function: Callable[[Fraction], Fraction], terms: int, top: Fraction
) -> tuple[Fraction, ...]:
    """The polynomial through a function in Chebyshev's points of (0, top), lowest power first."""
    points = [top * (1 + Fraction(cos(pi * (2 * k + 1) / (2 * terms)))) / 2 for k in range(terms)]
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


def _series(first: int, z: Fraction) -> Fraction:
    """(sin r − r)/r³ for first = 3, (cos r − 1 + r²/2)/r⁴ for 4, of z = r²."""
    sign = -1 if first == 3 else 1
    terms = (sign * (-z) ** k / factorial(2 * k + first) for k in range(_TERMS))
    return sum(terms, Fraction(0))


def _left_out(first: int, terms: int, top: Fraction) -> Fraction:
    """Bound on the error of interpolation: the next derivative over (terms)!, times the points."""
    return Fraction(2, factorial(2 * terms + first)) * (top / 4) ** terms
