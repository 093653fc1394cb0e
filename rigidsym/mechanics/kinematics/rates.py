"""Rates of the coordinates from a given angular velocity: a right inverse of the rate matrix.

With as many coordinates as dimensions it is the inverse. With more, the rates of least norm are
taken, W⁺ = Wᵀ (W Wᵀ)⁻¹; where constraints bind the coordinates the rates must keep to them.
"""

from __future__ import annotations

from collections.abc import Sequence

import sympy as sp
from sympy.polys.rings import PolyElement

from rigidsym.algebra.codec import Codec
from rigidsym.algebra.matrix import RingMatrix

Inverse = tuple[RingMatrix, PolyElement]  # G and d, for G/d


def right_inverse(matrix: RingMatrix, bound: RingMatrix | None) -> Inverse | None:
    """G (n, 3) and d with W G = d 1, for a rate matrix W (3, n); None if there is none.

    `bound` is the matrix J of the constraints on the rates, J q̇ = 0; then J G = 0 as well.
    """
    count = matrix.shape[1]
    if count < 3:
        return None
    if count == 3 and bound is None:
        return _if_regular(matrix.adjugate(), matrix.det())
    gram = matrix.gram()
    least = _if_regular(matrix.T @ gram.adjugate(), gram.det())
    if least is None or bound is None or (bound @ least[0]).is_zero():
        return least
    square = RingMatrix(matrix.ring, (*matrix.rows, *bound.rows))
    if square.shape[0] != count:
        return None
    columns = square.adjugate().T.rows[:3]
    return _if_regular(RingMatrix(matrix.ring, columns).T, square.det())


def bound_on_rates(
    constraints: Sequence[sp.Expr], coordinates: Sequence[sp.Expr], codec: Codec
) -> RingMatrix | None:
    """J = ∂(constraints)/∂q, (m, n); None if no constraint binds a coordinate."""
    rows = [[sp.diff(c, q) for q in coordinates] for c in constraints if c.has(*coordinates)]
    if not rows:
        return None
    return RingMatrix.of(codec.ring, [[codec.encode(entry) for entry in row] for row in rows])


def _if_regular(inverse: RingMatrix, determinant: PolyElement) -> Inverse | None:
    return (inverse, determinant) if determinant else None
