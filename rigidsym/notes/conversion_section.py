"""What a note says of the way back from a matrix or a quaternion to the coordinates."""

from __future__ import annotations

from typing import Any

import sympy as sp

from rigidsym.formula.reader import formula
from rigidsym.mechanics.conversions.conversions import Conversions
from rigidsym.mechanics.conversions.function import SHEPPERD, outer_product
from rigidsym.notes.document import (
    Cited,
    Equation,
    EquationRow,
)

COLUMNS = formula(r"\mathbf{K}")


def conversion_facts(found: Conversions) -> dict[str, Any]:
    """How the quaternion follows from the matrix, and the coordinates from both."""
    matrix = columns_of_matrix()
    sides = (formula(rf"4\,p_{name}\,\mathbf{{p}}") for name in "0123")
    columns = (Equation(sides=(side,), matrix=matrix[:, k]) for k, side in enumerate(sides))
    return {
        "quaternion": None,
        "columns_of": found.from_matrix.claim,
        "source": Cited(SHEPPERD),
        "columns": EquationRow(tuple(columns)),
        "inverse": found.inverse,
        "without": found.without,
        "are_proved": found.is_proved,
    }


def columns_of_matrix() -> sp.ImmutableMatrix:
    """K(R), (4, 4), in the entries of R."""
    entries = sp.Matrix(3, 3, lambda i, j: sp.Symbol(f"R_{i + 1}{j + 1}"))
    return sp.ImmutableMatrix(outer_product(entries))
