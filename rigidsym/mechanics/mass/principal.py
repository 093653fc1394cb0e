"""Principal moments and axes in symbols.

If one axis of the description is principal, the other two moments are the roots of a quadratic
equation. Other tensors have no closed form that anyone would read.
"""

from __future__ import annotations

import sympy as sp

from rigidsym.algebra.codec import codec_for
from rigidsym.algebra.present import presenter_for
from rigidsym.mechanics.derivation import sentence_of
from rigidsym.system.records import Record

_MOST_OF_AXES = 1000  # operations of axes: longer ones fill pages, and take minutes to prove
_LETTERS, _BASIS = ("x", "y", "z"), [sp.eye(3).col(k) for k in range(3)]


class Principal(Record, kw_only=True):
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
    k = next((k for k, unit in enumerate(_BASIS) if inertia * unit == inertia[k, k] * unit), None)
    return None if k is None else _about(inertia, k)


def _about(inertia: sp.ImmutableMatrix, k: int) -> Principal:
    """The k-th coordinate axis is principal; the other two are turned about it."""
    i, j = (k + 1) % 3, (k + 2) % 3
    # The block (p r; r q) has the eigenvalues (p + q)/2 ± w/2 with w² = (p − q)² + 4 r². Its first
    # axis is at the angle α with tan 2α = 2 r/(p − q), so that
    # cos² α = ½ + (p − q)/(2 w) and sin α cos α = r/w.
    p, q, r = inertia[i, i], inertia[j, j], inertia[i, j]
    codec = codec_for([p, q, r], order=None)  # which knows that sin² + cos² = 1
    written = presenter_for(codec).quotient
    half, apart, product = map(codec.encode_quotient, ((p + q) / 2, p - q, 2 * r))
    under, root = written(apart * apart + product * product), sp.S.One
    # squares among the factors are taken out of the root; its sign only swaps the two moments
    for part, sign in zip(sp.fraction(sp.together(under)), (1, -1), strict=True):
        number, factors = sp.factor_list(part)
        inside = sp.Mul(number, *(factor ** (times % 2) for factor, times in factors))
        outside = sp.Mul(*(factor ** (times // 2) for factor, times in factors))
        root *= (outside * sp.sqrt(inside)) ** sign
    root = min(root, sp.sqrt((p - q) ** 2 + 4 * r**2), key=sp.count_ops)
    cosine = sp.sqrt(sp.Rational(1, 2) + written(apart) / (2 * root))
    sine, mean = r / (root * cosine), written(half)
    x, y = _BASIS[i], _BASIS[j]
    axes = sp.ImmutableMatrix.hstack(cosine * x + sine * y, cosine * y - sine * x, _BASIS[k])
    is_long = sp.count_ops(axes) > _MOST_OF_AXES
    return Principal(
        moments=sp.ImmutableMatrix([mean + root / 2, mean - root / 2, inertia[k, k]]),
        axes=None if is_long else sp.ImmutableMatrix(axes),
        reasons=("one_axis_apart", *(["axes_too_long"] if is_long else [])),
        axis=_LETTERS[k],
    )
