"""Angular velocity of a product of turns, without multiplying the product out.

For R = F G with rotations F and G, dR/dt Rᵀ = Ḟ Fᵀ + F (Ġ Gᵀ) Fᵀ, and F C(w) Fᵀ = C(F w), so that
Ω(F G) = Ω(F) + F Ω(G). Both statements are proved turn by turn, for a w that is free; by induction
they hold for the product, which for many turns is far too long to be worth expanding.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import reduce

from rigidsym.algebra.matrix import RingMatrix


@dataclass(frozen=True, slots=True, eq=False)
class Factor:
    """One turn over the ring: its matrix F and the angular velocity ω of Ḟ Fᵀ = C(ω)."""

    matrix: RingMatrix  # (3, 3)
    omega: RingMatrix  # (3, 1)


def product(factors: Sequence[Factor]) -> RingMatrix:
    """R, multiplied from left to right."""
    return reduce(lambda a, b: a @ b, (factor.matrix for factor in factors))


def omega_space(factors: Sequence[Factor]) -> RingMatrix:
    """Ω = ω₁ + F₁ (ω₂ + F₂ (ω₃ + ...)), space components."""
    *first, last = factors
    return reduce(lambda w, factor: factor.omega + factor.matrix @ w, reversed(first), last.omega)


def omega_body(factors: Sequence[Factor]) -> RingMatrix:
    """Ω′, body components: each turn adds its own axis, which it does not move."""
    first, *others = factors
    return reduce(lambda w, factor: factor.omega + factor.matrix.T @ w, others, first.omega)


def orthogonality(factors: Sequence[Factor]) -> RingMatrix:
    """F Fᵀ − 1 of every turn, one below the other."""
    one = RingMatrix.identity(factors[0].matrix.ring, 3)
    return _stacked([factor.matrix.gram() - one for factor in factors])


def determinants(factors: Sequence[Factor]) -> RingMatrix:
    """det F − 1 of every turn, one below the other."""
    ring = factors[0].matrix.ring
    return RingMatrix.column(ring, [factor.matrix.det() - 1 for factor in factors])


def operators(factors: Sequence[Factor], free: RingMatrix) -> RingMatrix:
    """Ḟ Fᵀ − C(ω) and F C(w) Fᵀ − C(F w) of every turn, for a free vector w, (3, 1)."""
    residuals = []
    for factor in factors:
        turn = factor.matrix
        residuals.append(turn.dt() @ turn.T - hat(factor.omega))
        residuals.append(turn @ hat(free) @ turn.T - hat(turn @ free))
    return _stacked(residuals)


def unhat(skew: RingMatrix) -> RingMatrix:
    """C⁻¹: the vector of a skew matrix, from its entries below the diagonal (lecture, 3.2)."""
    return RingMatrix.column(skew.ring, [skew[2, 1], skew[0, 2], skew[1, 0]])


def hat(vector: RingMatrix) -> RingMatrix:
    """C(u), the matrix of u ×, over the ring (lecture, section 3.2)."""
    x, y, z = vector.entries
    zero = vector.ring.zero
    return RingMatrix.of(vector.ring, [[zero, -z, y], [z, zero, -x], [-y, x, zero]])


def _stacked(matrices: Sequence[RingMatrix]) -> RingMatrix:
    return RingMatrix(matrices[0].ring, tuple(row for matrix in matrices for row in matrix.rows))
