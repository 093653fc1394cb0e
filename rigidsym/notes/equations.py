"""The equation of a step, for notes and for the terminal."""

from __future__ import annotations

from collections.abc import Iterable

import sympy as sp

from rigidsym.formula.display import Equation
from rigidsym.formula.letters import Letters, is_negative
from rigidsym.formula.reader import formula
from rigidsym.formula.scalars import formula_of
from rigidsym.formula.tree import MINUS, NOTHING, Formula, Matrix, bracketed, row
from rigidsym.mechanics.conversions.function import outer_product
from rigidsym.mechanics.derivation import Argument, Proof, Statement, Step
from rigidsym.mechanics.particles import MASS
from rigidsym.notes.letters import entries_of

_SUM = formula(r"\sum_i m_i")


def claims_of(proofs: Iterable[Proof]) -> tuple[tuple[Formula, ...], tuple[Formula, ...]]:
    """The proved claims, and the unproved ones."""
    proofs = list(proofs)
    return (
        tuple([proof.claim for proof in proofs if proof.is_exact]),
        tuple([proof.claim for proof in proofs if not proof.is_exact]),
    )


def equation_of(step: Step, arguments: Iterable[Argument]) -> Equation:
    """The numbered equation of a step."""
    quantity = step.quantity
    proved, unproved = claims_of(step.proofs)
    is_scalar = quantity.shape == "scalar"
    is_matrix = not (is_scalar or step.recursion)
    definition = step.recursion or quantity.definition
    return Equation(
        sides=(quantity.symbol, *([] if definition == NOTHING else [definition])),
        matrix=step.expression if is_matrix else None,
        scalar=step.expression[0] if is_scalar else None,
        entries=entries_of(step, arguments) if is_matrix else (),
        number=step.number,
        label=quantity.name,
        proved=proved,
        unproved=unproved,
    )


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


def columns_of_matrix() -> sp.ImmutableMatrix:
    """K(R), (4, 4), in the entries of R; each column is a multiple of the quaternion."""
    entries = sp.Matrix(3, 3, lambda i, j: sp.Symbol(f"R_{i + 1}{j + 1}"))
    return sp.ImmutableMatrix(outer_product(entries))
