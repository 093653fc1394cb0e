"""Expressions that are quotients, over the ring of their numerators and denominators.

The ring then needs no generator for the inverse of a sum, so that common factors of numerator and
denominator are seen and cancel.
"""

from __future__ import annotations

from collections.abc import Iterable

import sympy as sp

from rigidsym.algebra.codec import Codec, codec_for
from rigidsym.algebra.present import presenter_for
from rigidsym.algebra.quotient import Quotient


class Rationals:
    """Quotients over one ring: in (`read`), and out in textbook form (`write`)."""

    def __init__(self, expressions: Iterable[sp.Expr], constraints: Iterable[sp.Expr] = ()) -> None:
        parts = (part for e in expressions for part in sp.sympify(e, strict=True).as_numer_denom())
        self._take(codec_for(parts, constraints=constraints))

    @classmethod
    def over(cls, codec: Codec) -> Rationals:
        """The quotients over a ring that is there already."""
        made = cls.__new__(cls)
        made._take(codec)
        return made

    def _take(self, codec: Codec) -> None:
        self.codec, self.ring = codec, codec.ring

    def read(self, expression: sp.Expr) -> Quotient:
        """Raises AlgebraError for an expression that the ring was not built for."""
        above, below = sp.sympify(expression, strict=True).as_numer_denom()
        return self.codec.encode_quotient(above) * self.codec.encode_quotient(below).inverse()

    def read_matrix(self, matrix: sp.MatrixBase) -> list[list[Quotient]]:
        return [[self.read(entry) for entry in row] for row in matrix.tolist()]

    def write(self, value: Quotient) -> sp.Expr:
        return presenter_for(self.codec).quotient(value)

    def total(self, parts: Iterable[Quotient]) -> Quotient:
        return Quotient.sum(self.ring, parts)

    def negative(self, value: Quotient) -> Quotient:
        return Quotient(self.ring, -value.numerator, value.denominator)
