"""Quotients of ring elements as pairs; equal when the cross products are.

The rings are integral domains, so that a/b = c/d exactly where a·d − c·b reduces to zero.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

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
        total = cls.whole(ring, ring.zero)
        for part in parts:
            total = total + part
        return total

    @classmethod
    def product(cls, ring: Ring, parts: Iterable[Quotient]) -> Quotient:
        total = cls.whole(ring, ring.one)
        for part in parts:
            total = total * part
        return total

    def __add__(self, other: Quotient) -> Quotient:
        if self.denominator == other.denominator:
            return Quotient(self.ring, self.numerator + other.numerator, self.denominator)
        reduce = self.ring.reduce
        return Quotient(
            self.ring,
            reduce(self.numerator * other.denominator + other.numerator * self.denominator),
            reduce(self.denominator * other.denominator),
        )

    def __mul__(self, other: Quotient) -> Quotient:
        reduce = self.ring.reduce
        return Quotient(
            self.ring,
            reduce(self.numerator * other.numerator),
            reduce(self.denominator * other.denominator),
        )

    def __pow__(self, exponent: int) -> Quotient:
        base = self if exponent >= 0 else self.inverse()
        return Quotient.product(self.ring, [base] * abs(exponent))

    def inverse(self) -> Quotient:
        return Quotient(self.ring, self.denominator, self.numerator)

    def equals(self, other: Quotient) -> bool:
        """Whether both are the same function: the cross products agree in the ring."""
        return self.ring.is_zero(
            self.numerator * other.denominator - other.numerator * self.denominator
        )
