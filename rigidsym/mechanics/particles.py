"""Sums over the particles of a body, by rule and not by number.

Σᵢ is linear, and factors common to all particles are taken out of it. A summand is a polynomial in
the mass m and the components of one particle; its sum follows from the sums of its monomials. Some
of these are known, such as Σ m = M and Σ m x = 0; any other is equal only to itself. So two sums
that agree for the generic summand agree for every body, of however many particles.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import sympy as sp
from sympy.polys.rings import PolyElement

from rigidsym.algebra.codec import Codec
from rigidsym.algebra.matrix import RingMatrix
from rigidsym.algebra.ring import Monomial
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
            self._part(monomial): codec.encode(value)
            for summand, value in known.items()
            for monomial in codec.encode(summand)
        }

    def _part(self, monomial: Monomial) -> Monomial:
        """The powers in a monomial that belong to the particle."""
        return tuple(monomial[place] for place in self._own)

    def of(self, summand: PolyElement) -> PolyElement:
        """The sum of a summand, in normal form; raises AlgebraError where m is no factor of it."""
        result = self.ring.zero
        for monomial, coefficient in self.ring.reduce(summand).items():
            if monomial[self._mass] != 1:
                raise AlgebraError("a summand without the mass of the particle has no sum here")
            known = self._known.get(self._part(monomial))
            if known is None:
                result += self.ring.polynomials.term_new(monomial, coefficient)
                continue
            rest = list(monomial)
            for place in self._own:
                rest[place] = 0
            result += known.mul_term((tuple(rest), coefficient))
        return self.ring.reduce(result)

    def of_matrix(self, summands: RingMatrix) -> RingMatrix:
        """The sums of the entries."""
        return summands.map(self.of)


def sums_of_body(codec: Codec, mass: sp.Expr, inertia: sp.ImmutableMatrix) -> ParticleSums:
    """The sums of a body's particles about its centre of mass, in body components.

    Σ m = M, Σ m x′ = 0, and Σ m x′ x′ᵀ = ½ tr(I′) 1 − I′, which is what I′ says of the body.
    """
    second = inertia.trace() / 2 * sp.eye(3) - inertia
    known: dict[sp.Expr, sp.Expr] = {MASS: mass, **{MASS * part: sp.S.Zero for part in IN_BODY}}
    for j, first in enumerate(IN_BODY):
        known |= {MASS * first * IN_BODY[k]: second[j, k] for k in range(j, 3)}
    return ParticleSums(codec, SYMBOLS, known)
