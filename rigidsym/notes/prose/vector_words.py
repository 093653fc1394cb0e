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
        coefficient = by_half_angle(_in_notation(term.coefficient, form, letters))
        minus, coefficient = sign_outside(coefficient)
        if minus or parts:
            parts.append(MINUS if minus else PLUS)
        parts += _factor(coefficient, letters)
        parts.append(term.vector)
    return row(*parts)


def _in_notation(coefficient: sp.Expr, form: VectorForm, letters: Letters) -> sp.Expr:
    """A coefficient in the length that the notation has; |v|² is n² − w² where n is |q|."""
    length = letters.length
    if length is None or length.components == form.components:
        return coefficient
    others = [part**2 for part in length.components if part not in form.components]
    return coefficient.subs(form.length, sp.sqrt(length.symbol**2 - sp.Add(*others)))


def by_half_angle(coefficient: sp.Expr) -> sp.Expr:
    """With cot(n/2) for sin n/(1 − cos n): (1 − ½ n cot(n/2))/n², where 1 − cos n cancels."""
    above, below = sp.fraction(coefficient)
    for factor in sp.Mul.make_args(below):
        cosine = 1 - factor
        if cosine.func is not sp.cos:
            continue
        sine, rest = sp.sin(*cosine.args), sp.Symbol("rest")
        over, left = sp.div(sp.expand(above).xreplace({sine: rest}), factor, cosine)
        times, none = sp.div(left, rest, rest)
        if none == 0 and not over.has(rest) and not times.has(rest, cosine):
            scale = (below / factor).as_coeff_Mul()[0]
            whole = sp.Add(over / scale, times / scale * sp.cot(cosine.args[0] / 2))
            return whole * scale * factor / below
    return coefficient


def sign_outside(coefficient: sp.Expr) -> tuple[bool, sp.Expr]:
    """Whether a minus sign goes before, and what is behind: cos n − 1 is −(1 − cos n)."""
    if is_negative(coefficient):
        return True, -coefficient
    for factor in sp.Mul.make_args(sp.fraction(coefficient)[0]):
        if factor.is_Add and factor.as_coeff_Add()[0].is_negative:
            return True, coefficient / factor * sp.Add(*(-term for term in factor.args))
    return False, coefficient


def _factor(coefficient: sp.Expr, letters: Letters) -> list[Formula]:
    """A coefficient before a vector; 1 is not written, and a sum is in brackets."""
    return [] if coefficient == 1 else [bracketed(formula_of(coefficient, letters))]
