"""The angle of a point for targets that print their own: one quotient and a polynomial, derived.

With a ≥ b ≥ 0 the sizes of the coordinates, the angle from the nearer axis is atan b/a, or
π/4 + atan (b − a)/(b + a) if b/a > tan π/8. There atan t = t + t z A(z) with z = t², where A
interpolates (atan √z/√z − 1)/z in Chebyshev's points, in rational numbers. Multiples of π/4 are
added in two parts, of which the first is exact.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from functools import cache

from rigidsym.kernels.lowering.sincos import interpolated, quarter_of_pi

_TERMS = 40  # of the power series that is interpolated: the next is below 1e-32
_TOP = Fraction(17158, 100000)  # over tan² π/8
_EDGE = Fraction(41421, 100000)  # under tan π/8, where both quotients have this size


@dataclass(frozen=True, kw_only=True, slots=True)
class Arctangent:
    """The numbers of one precision."""

    edge: float  # up to this quotient it is taken itself
    coefficients: tuple[Fraction, ...]  # A, from the lowest power up
    eighth: tuple[float, float]  # π/4 in two parts; up to four times the first is exact
    error: Fraction  # bound on what the polynomial leaves out, relative to the arctangent


@cache
def arctangent(digits: int) -> Arctangent:
    """The numbers for 53 bits (double) or 24 (float)."""
    terms = {53: 12, 24: 5}[digits]
    scale = 2 ** (digits - 3)
    first = Fraction(int(quarter_of_pi() * scale), scale)
    return Arctangent(
        edge=float(_EDGE),
        coefficients=interpolated(_series, terms, _TOP),
        eighth=(float(first), float(quarter_of_pi() - first)),
        error=_TOP * Fraction(2, 2 * terms + 3) * (_TOP / 4) ** terms,
    )


def _series(z: Fraction) -> Fraction:
    """(atan √z/√z − 1)/z."""
    return sum((-((-z) ** k) / (2 * k + 3) for k in range(_TERMS)), Fraction(0))
