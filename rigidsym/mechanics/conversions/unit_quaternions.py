"""Quaternions p = (w, x, y, z), scalar first: their products, and their matrices, and back."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeVar

import sympy as sp
from sympy.polys.rings import PolyElement

from rigidsym.mechanics.conversions.function import NamedValues, Vector, Where
from rigidsym.models.rotation import Citation

Part = TypeVar("Part", sp.Expr, PolyElement)

QUATERNION = ("w", "x", "y", "z")
SHEPPERD = Citation(
    text="S. Shepperd, Quaternion from Rotation Matrix, Journal of Guidance and Control 1 (1978)"
)


def product(first: Sequence[Part], second: Sequence[Part]) -> tuple[Part, ...]:
    """The product of two quaternions, as it comes."""
    (w, x, y, z), (a, b, c, d) = first, second
    return (
        w * a - x * b - y * c - z * d,
        w * b + x * a + y * d - z * c,
        w * c - x * d + y * a + z * b,
        w * d + x * c - y * b + z * a,
    )


def half_turn(direction: Sequence[sp.Expr], angle: sp.Expr) -> Vector:
    """cos(β/2) + sin(β/2) e, the unit quaternion of the turn by β about the unit axis e."""
    return (sp.cos(angle / 2), *(sp.sin(angle / 2) * part for part in direction))


def in_halves(
    whole: Vector, first: Sequence[sp.Expr], last: Sequence[sp.Expr]
) -> tuple[Vector, Vector]:
    """x₊ = (x − e₁ x e₃)/2 and x₋ = (x + e₁ x e₃)/2 for the axes e₁ and e₃."""
    zero = sp.S.Zero
    across = product(product((zero, *first), whole), (zero, *last))
    pairs = tuple(zip(whole, across, strict=True))
    return tuple((a - b) / 2 for a, b in pairs), tuple((a + b) / 2 for a, b in pairs)


def outer_product(matrix: sp.MatrixBase) -> sp.Matrix:
    """K(R) = 4 p pᵀ, (4, 4), of a rotation matrix (Shepperd, 1978)."""
    r, trace = sp.Matrix(matrix), matrix.trace()
    vector = [r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1]]
    block = r + r.T + (1 - trace) * sp.eye(3)
    return sp.Matrix([[1 + trace, *vector], *([v, *block[k, :]] for k, v in enumerate(vector))])


def shepperd(values: NamedValues, matrix: sp.Matrix) -> Vector:
    """The column of 4 p pᵀ with the largest diagonal entry, so that nothing cancels.

    Its scalar is not negative where the first column is taken.
    """
    outer = outer_product(matrix)
    names = [[f"k{a}{b}" for b in QUATERNION] for a in QUATERNION]
    w, x, y, z = (
        values.each(names[k], [outer[min(j, k), max(j, k)] for j in range(4)]) for k in range(4)
    )
    by_x, by_z = x[1] > w[0], z[3] > y[2]
    upper = values.let("upper", Where(by_x, x[1], w[0]))
    lower = values.let("lower", Where(by_z, z[3], y[2]))
    return values.each(
        QUATERNION,
        [Where(lower > upper, Where(by_z, z[k], y[k]), Where(by_x, x[k], w[k])) for k in range(4)],
    )


def scalar_last(quaternion: Vector) -> Vector:
    """(x, y, z, w) from (w, x, y, z)."""
    return (*quaternion[1:], quaternion[0])


def scaled(values: NamedValues, quaternion: Sequence[sp.Expr]) -> Vector:
    """The quaternion over the sum of its parts' sizes: any length will do, and zero gives NaN."""
    quarters = [values.let("quarter", sp.Abs(part) / 4) for part in quaternion]  # no overflow
    size = values.let("size", sp.Add(*quarters))
    return values.each(QUATERNION, [part / size for part in quaternion])


def unit(values: NamedValues, quaternion: Vector) -> Vector:
    """The quaternion over its length."""
    length = values.length("length", quaternion)
    return tuple(part / length for part in quaternion)


def short_way(values: NamedValues, quaternion: Sequence[sp.Expr]) -> Vector:
    """The same rotation by the quaternion whose scalar is not negative."""
    w, *vector = quaternion
    flipped = [Where(w < 0, -part, part) for part in vector]
    return values.each(QUATERNION, [sp.Abs(w), *flipped])
