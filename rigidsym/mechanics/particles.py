"""Sums over the particles of a body, by rule and not by number.

Σᵢ is linear, and factors common to all particles are taken out of it. A summand is a polynomial in
the mass m and the components of one particle; its sum follows from the sums of its monomials. Some
of these are known, such as Σ m = M and Σ m x = 0; any other is equal only to itself. So two sums
that agree for the generic summand agree for every body, of however many particles.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import lru_cache
from math import prod

import sympy as sp
from sympy.polys.rings import PolyElement

from rigidsym.algebra.codec import Codec
from rigidsym.algebra.matrix import RingMatrix
from rigidsym.algebra.ring import split
from rigidsym.errors import AlgebraError

MASS = sp.Symbol("m_i")
IN_BODY = sp.symbols("a_i b_i c_i")  # components of x′ᵢ, at rest in the body
SYMBOLS = (MASS, *IN_BODY)


class ParticleSums:
    """Σᵢ over one ring: the sums that are `known`, by their summands."""

    def __init__(
        self, codec: Codec, own: Iterable[sp.Expr], known: Mapping[sp.Expr, sp.Expr]
    ) -> None:
        self.ring = codec.ring
        self._own = [self.ring.index[expression] for expression in own]
        self._mass = self.ring.index[MASS]
        self._known = {
            powers: codec.encode(value)
            for summand, value in known.items()
            for powers in split(codec.encode(summand), self._own)
        }

    def of(self, summand: PolyElement) -> PolyElement:
        """The sum of a summand, in normal form; raises AlgebraError where m is no factor of it."""
        result = self.ring.zero
        for powers, part in split(self.ring.reduce(summand), self._own).items():
            own = dict(zip(self._own, powers, strict=True))
            if own[self._mass] != 1:
                raise AlgebraError("a summand without the mass of the particle has no sum here")
            total = self._known.get(powers)
            if total is None:
                total = prod(self.ring.generator(place) ** power for place, power in own.items())
            result += total * part
        return self.ring.reduce(result)

    def of_matrix(self, summands: RingMatrix) -> RingMatrix:
        """The sums of the entries."""
        return RingMatrix.of(self.ring, [map(self.of, row) for row in summands.rows])


@lru_cache(maxsize=32)
def sums_of_body(codec: Codec, mass: sp.Expr, inertia: sp.ImmutableMatrix) -> ParticleSums:
    """The sums of a body's particles about its centre of mass, in body components.

    Σ m = M, Σ m x′ = 0, and Σ m x′ x′ᵀ = ½ tr(I′) 1 − I′, which is what I′ says of the body.
    """
    second = inertia.trace() / 2 * sp.eye(3) - inertia
    known: dict[sp.Expr, sp.Expr] = {MASS: mass, **{MASS * part: sp.S.Zero for part in IN_BODY}}
    for j, first in enumerate(IN_BODY):
        known |= {MASS * first * IN_BODY[k]: second[j, k] for k in range(j, 3)}
    return ParticleSums(codec, SYMBOLS, known)
