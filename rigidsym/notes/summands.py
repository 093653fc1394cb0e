"""A matrix of sums over particles, from the matrix of the generic one."""

from __future__ import annotations

import sympy as sp

from rigidsym.formula.letters import Letters, is_negative
from rigidsym.formula.reader import formula
from rigidsym.formula.scalars import formula_of
from rigidsym.formula.tree import MINUS, Formula, Matrix, bracketed, row
from rigidsym.mechanics.derivation import Statement
from rigidsym.mechanics.particles import MASS

_SUM = formula(r"\sum_i m_i")


def sums(statement: Statement, letters: Letters) -> Matrix | None:
    """The matrix of sums; None where the statement has no summands."""
    if statement.summands is None:
        return None
    rows = statement.summands.tolist()
    return Matrix(tuple(tuple(_sum(entry, letters) for entry in line) for line in rows))


def _sum(summand: sp.Expr, letters: Letters) -> Formula:
    """Σ mᵢ (b² + c²): the mass first."""
    minus = is_negative(summand)
    rest = (-summand if minus else summand) / MASS
    whole = row(_SUM, bracketed(formula_of(rest, letters)))
    return row(MINUS, whole) if minus else whole
