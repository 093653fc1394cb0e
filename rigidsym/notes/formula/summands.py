"""A matrix of sums over particles, from the matrix of the generic one."""

from __future__ import annotations

import sympy as sp

from rigidsym.mechanics.derivation import Markup, Statement
from rigidsym.mechanics.particles import MASS
from rigidsym.notes.formula.formula import markup
from rigidsym.notes.formula.notation import Notation
from rigidsym.notes.formula.order import is_negative

Rows = list[list[Markup]]


def sums(statement: Statement, notation: Notation) -> Rows:
    """The entries, row by row; none where the statement has no summands."""
    if statement.summands is None:
        return []
    return [[_sum(entry, notation) for entry in row] for row in statement.summands.tolist()]


def in_brackets(rows: Rows) -> Markup:
    """The matrix as one formula."""
    inside = r" \\[5pt]".join(" & ".join(entry.latex for entry in row) for row in rows)
    text = "; ".join(", ".join(entry.text for entry in row) for row in rows)
    return Markup(rf"\begin{{pmatrix}} {inside} \end{{pmatrix}}", f"({text})")


def _sum(summand: sp.Expr, notation: Notation) -> Markup:
    """Σ mᵢ (b² + c²): the mass first, and no blanks at which a line could break."""
    minus = is_negative(summand)
    rest = (-summand if minus else summand) / MASS
    written = markup(rest, notation)
    latex = f"({written.latex})" if rest.is_Add else rf"\,{written.latex}"
    text = f"({written.text})" if rest.is_Add else written.text
    sign = ("-", "−") if minus else ("", "")
    return Markup(rf"{sign[0]}\sum_i m_i{latex.replace(' + ', '+')}", f"{sign[1]}Σ mᵢ {text}")
