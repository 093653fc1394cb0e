"""Is this formula right? The entry to this folder."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import sympy as sp
from sympy.core.function import AppliedUndef

from rigidsym.errors import ExpressionError
from rigidsym.motion import Motion
from rigidsym.tools.compare.language import spelled_out
from rigidsym.tools.compare.matching import Comparison, against, identified, in_words
from rigidsym.tools.compare.program import formula_matrix
from rigidsym.tools.compare.quantities import SHAPES, KnownQuantity, of_motion, target


def compare(
    formula: str | sp.MatrixBase | Sequence[Any],
    rotation: str | Motion | None = None,
    quantity: str | None = None,
) -> Comparison:
    """Compare a formula with a quantity of a rotation, or with all known quantities.

    `formula` is a text in Python, SymPy, C, MATLAB or LaTeX, a matrix, or rows of texts. Without
    `rotation` the conventions of the catalogue are tried. Raises ExpressionError for a text that is
    not a formula, and for a function: `rigidsym compare FILE` reads it in its file.
    """
    if callable(formula):
        raise ExpressionError(
            "expected a formula, not a function; `rigidsym compare FILE` reads functions in a file"
        )
    matrix = spelled_out(as_matrix(formula))
    if matrix.rows == 1:
        matrix = matrix.T
    if rotation is None and quantity is None:
        return identified(_checked(matrix))
    return against(matrix, _goal(rotation, quantity))


def _checked(formula: sp.ImmutableMatrix) -> sp.ImmutableMatrix:
    """Raises ExpressionError if the formula cannot be a quantity of the catalogue."""
    shape = in_words(formula.shape)
    if formula.shape not in SHAPES:
        read = f"{formula[0]} is {shape}" if len(formula) == 1 else f"the formula is {shape}"
        raise ExpressionError(
            f"{read}; expected a matrix of 3x3, 3x4, 4x3 or 4x4, or a vector of 3 or 4 entries, as "
            "in [c -s 0; s c 0; 0 0 1]"
        )
    if not formula.free_symbols:
        raise ExpressionError(f"{shape} of numbers only; expected a formula with names of angles")
    return formula


def as_matrix(formula: Any) -> sp.ImmutableMatrix:
    """The matrix that a formula stands for."""
    if isinstance(formula, str):
        return formula_matrix(formula)
    if isinstance(formula, sp.MatrixBase):
        return _in_symbols(formula)
    rows = [row if isinstance(row, list | tuple) else [row] for row in formula]
    return sp.ImmutableMatrix([[as_matrix(entry)[0] for entry in row] for row in rows])


def _in_symbols(matrix: sp.MatrixBase) -> sp.ImmutableMatrix:
    """The matrix with symbols for functions of time and their rates, and exact numbers."""
    plain: dict[sp.Expr, sp.Expr] = {f: sp.Rational(str(f)) for f in matrix.atoms(sp.Float)}
    for function in matrix.atoms(sp.Derivative, AppliedUndef):
        order = function.derivative_count if isinstance(function, sp.Derivative) else 0
        name = function.expr.func.__name__ if order else function.func.__name__
        suffix = f"_{'d' * order}ot" if order else ""
        plain[function] = sp.Symbol(name + suffix, real=True)
    return sp.ImmutableMatrix(matrix.xreplace(plain))


def _goal(rotation: str | Motion | None, quantity: str | None) -> KnownQuantity:
    if rotation is None or quantity is None:
        raise ExpressionError(
            "expected a rotation and a quantity, such as 'ZYX', 'rotation_matrix'"
        )
    if quantity == "coriolis_matrix":
        raise ExpressionError("a Coriolis matrix is not unique; compare the bias vector C(q, q̇) q̇")
    if isinstance(rotation, Motion):
        return of_motion(rotation, quantity, rotation.name)
    return target(rotation, quantity)
