"""Formulas of what is proved beside the steps."""

from __future__ import annotations

from rigidsym.formula.reader import formula
from rigidsym.formula.tree import Formula, Rate, row, transpose_of


def spin_of(matrix: Formula) -> Formula:
    return row(Rate(matrix), transpose_of(matrix))


def orthogonal(matrix: Formula) -> Formula:
    return inverse_of(matrix, transpose_of(matrix))


def proper(matrix: Formula) -> Formula:
    return formula(r"\det #1 = 1", matrix)


def stays_orthogonal(matrix: Formula) -> Formula:
    """The derivative of the statement that the matrix is orthogonal."""
    return formula(
        r"#1#2 + #3#4 = \mathbf{0}",
        Rate(matrix),
        transpose_of(matrix),
        matrix,
        Rate(transpose_of(matrix)),
    )


def skew(spin: Formula) -> Formula:
    return formula(r"#1 + \left(#1\right)^{\mathsf T} = \mathbf{0}", spin)


def is_operator(vector: Formula, matrix: Formula, sign: str = "") -> Formula:
    """The matrix is the skew operator of plus or minus the vector."""
    return formula(rf"#2 = {sign}\mathbf{{C}}(#1)", vector, matrix)


def rotates(rotation: Formula, body: Formula, space: Formula) -> Formula:
    return formula(r"#3 = #1\,#2", rotation, body, space)


def inverse_of(matrix: Formula, inverse: Formula) -> Formula:
    return formula(r"#1#2 = \mathbf{1}", matrix, inverse)


def solves(matrix: Formula, inverse: Formula, omega: Formula) -> Formula:
    return formula(r"#1\,(#2#3) = #3", matrix, inverse, omega)
