"""A vector quantity as a sum of vectors, for the note and the terminal."""

from __future__ import annotations

import sympy as sp

from rigidsym.formula.letters import Letters, is_negative
from rigidsym.formula.scalars import formula_of
from rigidsym.formula.tree import MINUS, PLUS, Formula, bracketed, row
from rigidsym.mechanics.derivation import VectorForm


def sum_of_vectors(form: VectorForm, letters: Letters) -> Formula:
    """The terms with their coefficients: v̇ + (1 − cos n)/n² v × v̇ + ..."""
    parts: list[Formula] = []
    for term in form.terms:
        coefficient = _in_notation(term.coefficient, form, letters)
        minus = is_negative(coefficient)
        if minus or parts:
            parts.append(MINUS if minus else PLUS)
        parts += _factor(-coefficient if minus else coefficient, letters)
        parts.append(term.vector)
    return row(*parts)


def _in_notation(coefficient: sp.Expr, form: VectorForm, letters: Letters) -> sp.Expr:
    """A coefficient in the length that the notation has; |v|² is n² − w² where n is |q|."""
    length = letters.length
    if length is None or length.components == form.components:
        return coefficient
    others = [part**2 for part in length.components if part not in form.components]
    return coefficient.subs(form.length, sp.sqrt(length.symbol**2 - sp.Add(*others)))


def _factor(coefficient: sp.Expr, letters: Letters) -> list[Formula]:
    """A coefficient before a vector; 1 is not written, and a sum is in brackets."""
    return [] if coefficient == 1 else [bracketed(formula_of(coefficient, letters))]
