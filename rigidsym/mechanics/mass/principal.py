"""Principal moments and axes in symbols, where the characteristic polynomial factors."""

from __future__ import annotations

from dataclasses import dataclass, replace

import sympy as sp

from rigidsym.algebra.present import Rationals
from rigidsym.mechanics.derivation import sentence_of

_LAMBDA = sp.Symbol("lambda")
_MOST_OPERATIONS = 200  # of a tensor whose characteristic polynomial is tried
_MOST_OF_AXES = 1000  # operations of axes: longer ones fill pages, and take minutes to prove
_LETTERS = ("x", "y", "z")


@dataclass(frozen=True, kw_only=True, slots=True)
class Principal:
    """Principal moments (3, 1) and axes (3, 3), and how they follow."""

    moments: sp.ImmutableMatrix
    axes: sp.ImmutableMatrix | None  # None if no direction has a closed form
    reasons: tuple[str, ...]  # keys of templates/notes/en/reasons.toml
    axis: str = ""  # of the description, which these name

    @property
    def because(self) -> str:
        return " ".join(sentence_of(reason).format(axis=self.axis) for reason in self.reasons)


def principal_of(inertia: sp.ImmutableMatrix) -> Principal | None:
    """The principal moments and axes; None if the characteristic polynomial does not factor.

    There are no axes where they would be too long for use.
    """
    principal = _closed_form(inertia)
    if principal is None or principal.axes is None or sp.count_ops(principal.axes) <= _MOST_OF_AXES:
        return principal
    return replace(principal, axes=None, reasons=(*principal.reasons, "axes_too_long"))


def _closed_form(inertia: sp.ImmutableMatrix) -> Principal | None:
    if inertia.is_diagonal():
        moments = list(inertia.diagonal())
        single = [k for k in range(3) if moments.count(moments[k]) == 1]
        reason = {0: "diagonal_sphere", 1: "diagonal_symmetric", 3: "diagonal"}[len(single)]
        return Principal(
            moments=sp.ImmutableMatrix(moments),
            axes=sp.ImmutableMatrix(sp.eye(3)),
            reasons=(reason,),
            axis=_LETTERS[single[0]] if single else "",
        )
    for alone in (2, 1, 0):
        if not any(inertia[alone, k] for k in range(3) if k != alone):
            principal = _one_axis_apart(inertia, alone)
            if principal is not None:
                return principal
    return _factored(inertia)


def _square_root(expression: sp.Expr) -> sp.Expr:
    """The root, with the squares among the factors taken out of it."""
    above, below = sp.fraction(sp.together(expression))
    return _root_of_polynomial(above) / _root_of_polynomial(below)


def _root_of_polynomial(expression: sp.Expr) -> sp.Expr:
    number, factors = sp.factor_list(expression)
    inside, outside = number, sp.S.One
    for factor, times in factors:
        outside *= factor ** (times // 2)
        inside *= factor ** (times % 2)
    return outside * sp.sqrt(inside)


def _one_axis_apart(inertia: sp.ImmutableMatrix, alone: int) -> Principal | None:
    """One coordinate axis is principal; the other two are turned about it.

    None if the root of (p − q)² + 4 r², for the two moments across the axis, is rational. Its sign
    does not matter: the other one swaps the two moments with their axes.
    """
    i, j = (alone + 1) % 3, (alone + 2) % 3
    p, q, r = inertia[i, i], inertia[j, j], inertia[i, j]
    square = (p - q) ** 2 + 4 * r**2
    root = sp.sqrt(square) if all(e.is_Symbol for e in (p, q, r)) else _square_root(square)
    if not _has_root(root):
        return None
    field = Rationals.of([p, q])
    half = field.write(field.read((p + q) / 2))
    apart = field.write(field.read(p - q))
    basis = sp.eye(3)
    moments, axes = [inertia[alone, alone]] * 3, sp.eye(3)
    moments[i], moments[j] = half + root / 2, half - root / 2
    axes[:, i], axes[:, j] = _across(basis[:, i], basis[:, j], apart, r, root)
    return Principal(
        moments=sp.ImmutableMatrix(moments),
        axes=sp.ImmutableMatrix(axes),
        reasons=("one_axis_apart",),
        axis=_LETTERS[alone],
    )


def _across(
    first: sp.Matrix, second: sp.Matrix, apart: sp.Expr, product: sp.Expr, root: sp.Expr
) -> tuple[sp.Matrix, sp.Matrix]:
    """The principal axes in the plane of two unit vectors.

    The moments about them are `apart`, their product of inertia is `product`, and `root` is
    √(apart² + 4 product²).
    """
    cosine = sp.sqrt(sp.Rational(1, 2) + apart / (2 * root))
    sine = product / (root * cosine)
    return cosine * first + sine * second, cosine * second - sine * first


def _factored(inertia: sp.ImmutableMatrix) -> Principal | None:
    """From the factors of the characteristic polynomial over the rational functions."""
    if sp.count_ops(inertia) > _MOST_OPERATIONS or _is_irreducible(inertia):
        return None
    matrix = sp.Matrix(inertia - _LAMBDA * sp.eye(3))
    polynomial = sp.expand(matrix.det(method="berkowitz"))
    factors = sp.factor_list(sp.together(polynomial), _LAMBDA)[1]
    roots: list[sp.Expr] = []
    for factor, times in factors:
        degree = sp.degree(factor, _LAMBDA)
        if degree == 1:
            roots += [-factor.coeff(_LAMBDA, 0) / factor.coeff(_LAMBDA, 1)] * times
        elif degree == 2:
            a, b, c = (factor.coeff(_LAMBDA, k) for k in (2, 1, 0))
            root = sp.sqrt(sp.expand(b**2 - 4 * a * c))
            roots += [(-b + root) / (2 * a), (-b - root) / (2 * a)]
        elif degree == 3:
            return None
    apart = [root for root in roots if not _has_root(root)]
    if len(apart) == 1:
        return _about_one_axis(inertia, apart[0])
    shares = {root: sp.cancel(root / sum(roots)) for root in roots}
    is_ordered = all(share.is_Rational for share in shares.values())
    roots = sorted(
        roots,  # a single one last, the others by their size if it is known
        key=lambda root: (roots.count(root) == 1, shares[root] if is_ordered else 0, str(root)),
    )
    axes = _axes(inertia, roots)
    moments = sp.ImmutableMatrix([sp.factor(root) for root in roots])
    reason = "factored_symmetric" if len(set(roots)) < 3 else "factored"
    return Principal(moments=moments, axes=axes, reasons=(reason,))


def _is_irreducible(inertia: sp.ImmutableMatrix) -> bool:
    """Whether the characteristic polynomial was seen not to factor, at one point.

    It is monic, so that its factors at a point would be those in symbols, at this point.
    """
    symbols = sorted(inertia.free_symbols, key=str)
    point = {symbol: sp.prime(k) for k, symbol in enumerate(symbols, 5)}
    there = inertia.xreplace(point)
    if not all(entry.is_Rational for entry in there):
        return False
    return bool(there.charpoly(_LAMBDA).is_irreducible)


def _about_one_axis(inertia: sp.ImmutableMatrix, moment: sp.Expr) -> Principal | None:
    """One moment is rational, and so is the direction of its axis; the others lie across it."""
    axis = _null_vector(inertia, moment)
    if axis is None:
        return None
    across = (axis.cross(sp.eye(3)[:, k]) for k in range(3))
    first = min((vector for vector in across if any(vector)), key=sp.count_ops)
    second = axis.cross(first).applyfunc(sp.cancel)
    lengths = [sp.sqrt(sp.factor(sp.cancel(v.dot(v)))) for v in (first, axis)]
    frame = [first / lengths[0], second / (lengths[0] * lengths[1]), axis / lengths[1]]
    squares = (first.dot(first), second.dot(second))
    p, q = (
        sp.cancel(v.dot(inertia * v) / square)
        for v, square in zip((first, second), squares, strict=True)
    )
    product = first.dot(inertia * second)
    root = _square_root((p - q) ** 2 + 4 * sp.cancel(product**2 / (squares[0] * squares[1])))
    scaled = product / (lengths[0] ** 2 * lengths[1])
    axes = [*_across(frame[0], frame[1], p - q, scaled, root), frame[2]]
    half = sp.cancel((p + q) / 2)
    return Principal(
        moments=sp.ImmutableMatrix([half + root / 2, half - root / 2, moment]),
        axes=sp.ImmutableMatrix(sp.Matrix.hstack(*axes)),
        reasons=("linear_factor",),
    )


def _has_root(expression: sp.Expr) -> bool:
    return any(not power.exp.is_Integer for power in expression.atoms(sp.Pow))


def _axes(inertia: sp.ImmutableMatrix, roots: list[sp.Expr]) -> sp.ImmutableMatrix | None:
    """Unit vectors; the last root is single."""
    last = _null_vector(inertia, roots[2])
    if last is None:
        return None
    first = None if roots[0] == roots[1] else _null_vector(inertia, roots[0])
    if first is None:
        crossed = (last.cross(sp.eye(3)[:, k]).applyfunc(sp.cancel) for k in range(3))
        first = next(vector for vector in crossed if any(vector))
    first, last = _unit(first), _unit(last)
    return sp.ImmutableMatrix(sp.Matrix.hstack(first, last.cross(first), last))


def _null_vector(inertia: sp.ImmutableMatrix, root: sp.Expr) -> sp.Matrix | None:
    """A column of the adjugate of I − λ 1, free of common factors; None if all vanish."""
    adjugate = (inertia - root * sp.eye(3)).adjugate().applyfunc(sp.cancel)
    for k in range(3):
        column = sp.Matrix(adjugate[:, k])
        if any(column):
            lead = next(entry for entry in column if entry != 0)
            plain = (column / lead).applyfunc(sp.cancel)
            divisor = sp.lcm_list([sp.fraction(entry)[1] for entry in plain])
            return sp.Matrix((plain * divisor).applyfunc(sp.cancel))
    return None


def _unit(vector: sp.Matrix) -> sp.Matrix:
    return vector / sp.sqrt(sp.factor(sp.cancel(vector.dot(vector))))
