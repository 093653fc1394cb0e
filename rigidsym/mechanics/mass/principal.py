"""Principal moments and axes in symbols.

If all moments are rational functions of the entries, the axes solve linear equations. If one axis
of the description is principal, the other two moments are the roots of a quadratic equation. Other
tensors have no closed form that anyone would read.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import sympy as sp

from rigidsym.algebra.present import Rationals
from rigidsym.mechanics.derivation import sentence_of

_LAMBDA = sp.Symbol("lambda")
_MOST_OPERATIONS = 200  # of a tensor whose characteristic polynomial is tried
_MOST_OF_AXES = 1000  # operations of axes: longer ones fill pages, and take minutes to prove
_LETTERS, _BASIS = ("x", "y", "z"), [sp.eye(3).col(k) for k in range(3)]


@dataclass(frozen=True, kw_only=True, slots=True)
class Principal:
    """Principal moments (3, 1) and axes (3, 3), and how they follow."""

    moments: sp.ImmutableMatrix
    axes: sp.ImmutableMatrix | None  # None if they are too long
    reasons: tuple[str, ...]  # keys of templates/notes/en/reasons.toml
    axis: str = ""  # of the description, which these name

    @property
    def because(self) -> str:
        return " ".join(sentence_of(reason).format(axis=self.axis) for reason in self.reasons)


def principal_of(inertia: sp.ImmutableMatrix) -> Principal | None:
    """The principal moments and axes; None if there is no short closed form.

    There are no axes where they would be too long for use.
    """
    if inertia.is_diagonal():
        diagonal = list(inertia.diagonal())
        single = [k for k in range(3) if diagonal.count(diagonal[k]) == 1]
        return Principal(
            moments=sp.ImmutableMatrix(diagonal),
            axes=sp.ImmutableMatrix(sp.eye(3)),
            reasons=({0: "diagonal_sphere", 1: "diagonal_symmetric", 3: "diagonal"}[len(single)],),
            axis=_LETTERS[single[0]] if single else "",
        )
    moments = _rational_moments(inertia)
    apart = [k for k, unit in enumerate(_BASIS) if inertia * unit == inertia[k, k] * unit]
    if len(moments) == 3:
        principal = _factored(inertia, moments)
    elif apart:
        principal = _about(inertia, apart[0])
    else:
        return None
    if sp.count_ops(principal.axes) <= _MOST_OF_AXES:
        return principal
    return replace(principal, axes=None, reasons=(*principal.reasons, "axes_too_long"))


def _rational_moments(inertia: sp.ImmutableMatrix) -> list[sp.Expr]:
    """The roots of the characteristic polynomial in its linear factors."""
    # The polynomial is monic, so that its factors at a point would be those in symbols, there.
    symbols = sorted(inertia.free_symbols, key=str)
    there = inertia.xreplace({symbol: sp.prime(k) for k, symbol in enumerate(symbols, 5)})
    is_known = all(entry.is_Rational for entry in there)
    if sp.count_ops(inertia) > _MOST_OPERATIONS or (
        is_known and there.charpoly(_LAMBDA).is_irreducible
    ):
        return []
    # det(I − λ 1) = 0. Only linear factors give a moment without roots.
    matrix = sp.Matrix(inertia - _LAMBDA * sp.eye(3))
    polynomial = sp.together(sp.expand(matrix.det(method="berkowitz")))
    return [
        -factor.coeff(_LAMBDA, 0) / factor.coeff(_LAMBDA, 1)
        for factor, times in sp.factor_list(polynomial, _LAMBDA)[1]
        for _ in range(times if sp.degree(factor, _LAMBDA) == 1 else 0)
    ]


def _about(inertia: sp.ImmutableMatrix, k: int) -> Principal:
    """The k-th coordinate axis is principal; the other two are turned about it."""
    i, j = (k + 1) % 3, (k + 2) % 3
    # The block (p r; r q) has the eigenvalues (p + q)/2 ± w/2 with w² = (p − q)² + 4 r². Its first
    # axis is at the angle α with tan 2α = 2 r/(p − q), so that
    # cos² α = ½ + (p − q)/(2 w) and sin α cos α = r/w.
    p, q, r = inertia[i, i], inertia[j, j], inertia[i, j]
    field = Rationals.of([p, q, r])  # which knows that sin² + cos² = 1
    half, apart, product = map(field.read, ((p + q) / 2, p - q, 2 * r))
    under, root = field.write(apart * apart + product * product), sp.S.One
    # squares among the factors are taken out of the root; its sign only swaps the two moments
    for part, sign in zip(sp.fraction(sp.together(under)), (1, -1), strict=True):
        number, factors = sp.factor_list(part)
        inside = sp.Mul(number, *(factor ** (times % 2) for factor, times in factors))
        outside = sp.Mul(*(factor ** (times // 2) for factor, times in factors))
        root *= (outside * sp.sqrt(inside)) ** sign
    root = min(root, sp.sqrt((p - q) ** 2 + 4 * r**2), key=sp.count_ops)
    cosine = sp.sqrt(sp.Rational(1, 2) + field.write(apart) / (2 * root))
    sine, mean = r / (root * cosine), field.write(half)
    x, y = _BASIS[i], _BASIS[j]
    axes = [cosine * x + sine * y, cosine * y - sine * x, _BASIS[k]]
    return Principal(
        moments=sp.ImmutableMatrix([mean + root / 2, mean - root / 2, inertia[k, k]]),
        axes=sp.ImmutableMatrix(sp.Matrix.hstack(*axes)),
        reasons=("one_axis_apart",),
        axis=_LETTERS[k],
    )


def _factored(inertia: sp.ImmutableMatrix, moments: list[sp.Expr]) -> Principal:
    """All moments are rational, and so are the directions of the axes."""
    moments = [sp.factor(moment) for moment in moments]
    shares = {moment: sp.cancel(moment / sum(moments)) for moment in moments}
    is_ordered = all(share.is_Rational for share in shares.values())
    moments = sorted(
        moments,  # a single one last, the others by their size if it is known
        key=lambda m: (moments.count(m) == 1, shares[m] if is_ordered else 0, str(m)),
    )
    # With two equal moments every direction across the third axis is principal; one is chosen.
    is_symmetric = moments[0] == moments[1]
    last = _null_vector(inertia, moments[2])
    across = (last.cross(unit).applyfunc(sp.cancel) for unit in _BASIS)
    first = next(filter(any, across)) if is_symmetric else _null_vector(inertia, moments[0])
    x, z = (vector / sp.sqrt(sp.factor(sp.cancel(vector.dot(vector)))) for vector in (first, last))
    return Principal(
        moments=sp.ImmutableMatrix(moments),
        axes=sp.ImmutableMatrix(sp.Matrix.hstack(x, z.cross(x), z)),
        reasons=("factored_symmetric" if is_symmetric else "factored",),
    )


def _null_vector(inertia: sp.ImmutableMatrix, moment: sp.Expr) -> sp.Matrix:
    """The axis of a single moment λ, a column of the adjugate of I − λ 1, in lowest terms."""
    # (I − λ 1) adj(I − λ 1) = det(I − λ 1) 1 = 0, so each column of the adjugate is an eigenvector
    # or 0. For a single eigenvalue the rank of I − λ 1 is two, and some column is not 0.
    adjugate = (inertia - moment * sp.eye(3)).adjugate().applyfunc(sp.cancel)
    column = next(column for k in range(3) if any(column := sp.Matrix(adjugate[:, k])))
    lead = next(entry for entry in column if entry != 0)
    plain = (column / lead).applyfunc(sp.cancel)
    divisor = sp.lcm_list([sp.fraction(entry)[1] for entry in plain])
    return sp.Matrix((plain * divisor).applyfunc(sp.cancel))
