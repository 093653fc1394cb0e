"""Time, the skew matrix of a vector, and the turns about the coordinate axes."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import sympy as sp
from sympy.core.function import AppliedUndef

from rigidsym.algebra.generators import TIME, in_names
from rigidsym.errors import ExpressionError, ModelError
from rigidsym.text.names import check_name

__all__ = ["AXES", "TIME", "elementary", "hat", "rodrigues", "symbolic", "time_function"]
__all__ += ["as_typed", "depends_on_time", "time_functions"]

AXES = ("x", "y", "z")


def time_function(name: str) -> sp.Expr:
    """The function of time `name`(t), the same object that dynamicsymbols(name) gives."""
    return sp.Function(name)(TIME)


def time_functions(names: Sequence[str], count: int, expected: str) -> tuple[sp.Expr, ...]:
    """The functions of time of plain names; raises ModelError unless `count` different ones."""
    try:
        plain = [check_name(name) for name in names] if isinstance(names, Sequence) else []
    except ExpressionError as error:
        raise ModelError(str(error)) from error
    if len(plain) != count or len(set(plain)) != count:
        raise ModelError(f"{expected}, got {', '.join(plain) or repr(names)}")
    return tuple(map(time_function, plain))


def depends_on_time(value: sp.Basic) -> bool:
    """Whether t occurs in it by itself, not only as the argument of a coordinate."""
    moving = value.atoms(sp.Derivative, AppliedUndef)
    return bool(value.xreplace({function: sp.Dummy() for function in moving}).has(TIME))


def as_typed(value: sp.Basic) -> str:
    """The expression as in a derivation file: theta, and theta_dot for its rate."""
    return str(in_names(value))


def symbolic(value: object, what: str) -> sp.Expr:
    """A SymPy expression or a number from a caller. Raises ModelError for anything else."""
    try:
        return sp.sympify(value, strict=True)
    except sp.SympifyError:
        raise ModelError(f"{what}: expected a SymPy expression, got {value!r}") from None


def hat(vector: sp.MatrixBase) -> sp.ImmutableMatrix:
    """C(u), shape (3, 3), with C(u) v = u × v (lecture, section 3.2)."""
    x, y, z = vector
    return sp.ImmutableMatrix([[0, -z, y], [z, 0, -x], [-y, x, 0]])


def rotation_of(parts: Sequence[sp.Expr]) -> sp.Matrix:
    """(w² − v·v) 1 + 2 v vᵀ + 2 w C(v): the matrix of a quaternion (w, v), times its square."""
    w, *vector = parts
    v = sp.Matrix(vector)
    return (w**2 - v.dot(v)) * sp.eye(3) + 2 * v * v.T + 2 * w * hat(v)


@lru_cache(maxsize=256)
def elementary(axis: str, angle: sp.Expr) -> sp.ImmutableMatrix:
    """Right-handed active turn by `angle` (radians) about the coordinate axis x, y or z.

    For z and x it is the R_z(β) and R_x(β) printed in the lecture, section 3.2.
    """
    first = AXES.index(axis)
    second, third = (first + 1) % 3, (first + 2) % 3
    cosine, sine = sp.cos(angle), sp.sin(angle)
    entries = {(first, first): 1, (second, second): cosine, (third, third): cosine}
    entries |= {(second, third): -sine, (third, second): sine}
    return sp.ImmutableMatrix(3, 3, lambda row, column: entries.get((row, column), 0))


@lru_cache(maxsize=256)
def rodrigues(axis: tuple[sp.Expr, ...], angle: sp.Expr) -> sp.ImmutableMatrix:
    """Right-handed active turn by `angle` (radians) about a unit axis (3,), Rodrigues' formula.

    1 + sin β C(e) + (1 − cos β) C(e)², which is a rotation where e·e = 1 and not otherwise.
    """
    skew = hat(axis)
    sine, rest = sp.sin(angle), 1 - sp.cos(angle)
    parts = zip(sp.eye(3), skew, skew * skew, strict=True)
    return sp.ImmutableMatrix(
        3, 3, [sp.Add(e, sine * s, *(rest * t for t in sp.Add.make_args(q))) for e, s, q in parts]
    )
