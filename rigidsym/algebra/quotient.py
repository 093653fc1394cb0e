"""Quotients of ring elements as pairs; equal when the cross products are.

Denominators are not zero, so that a/b = c/d where a·d − c·b reduces to zero. Where the ring knows
all relations it is an integral domain, and only there.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import reduce
from operator import add, mul

from sympy.polys.rings import PolyElement

from rigidsym.algebra.ring import Ring
from rigidsym.errors import AlgebraError


@dataclass(frozen=True, slots=True, eq=False)
class Quotient:
    """numerator / denominator, both in normal form; the denominator is not zero."""

    ring: Ring
    numerator: PolyElement
    denominator: PolyElement

    def __post_init__(self) -> None:
        if not self.denominator:
            raise AlgebraError("division by an expression that is zero in the ring")

    @classmethod
    def whole(cls, ring: Ring, element: PolyElement) -> Quotient:
        return cls(ring, element, ring.one)

    @classmethod
    def sum(cls, ring: Ring, parts: Iterable[Quotient]) -> Quotient:
        """The sum, over one denominator where the parts share it."""
        terms = list(parts)
        if all(term.denominator == ring.one for term in terms):
            return cls.whole(ring, ring.total(term.numerator for term in terms))
        return reduce(add, terms)

    @classmethod
    def product(cls, ring: Ring, parts: Iterable[Quotient]) -> Quotient:
        factors = list(parts)
        return reduce(mul, factors) if factors else cls.whole(ring, ring.one)

    def __add__(self, other: Quotient) -> Quotient:
        if self.denominator == other.denominator:
            return Quotient(self.ring, self.numerator + other.numerator, self.denominator)
        a, b = (self.numerator, self.denominator), (other.numerator, other.denominator)
        dot = self.ring.dot
        return Quotient(self.ring, dot(((a[0], b[1]), (b[0], a[1]))), dot(((a[1], b[1]),)))

    def __mul__(self, other: Quotient) -> Quotient:
        dot = self.ring.dot
        below, other_below = self.denominator, other.denominator
        if other_below != self.ring.one:
            below = dot(((below, other_below),))
        return Quotient(self.ring, dot(((self.numerator, other.numerator),)), below)

    def __pow__(self, exponent: int) -> Quotient:
        base = self if exponent >= 0 else self.inverse()
        return Quotient.product(self.ring, [base] * abs(exponent))

    def inverse(self) -> Quotient:
        return Quotient(self.ring, self.denominator, self.numerator)

    def equals(self, other: Quotient) -> bool:
        """Whether both are the same function: the cross products agree in the ring."""
        if self.denominator == other.denominator:
            return bool(self.numerator == other.numerator)  # normal forms
        return self.ring.is_zero(
            self.numerator * other.denominator - other.numerator * self.denominator
        )
