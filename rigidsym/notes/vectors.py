"""A vector quantity as a sum of vectors."""

from __future__ import annotations

import sympy as sp

from rigidsym.formula.letters import Letters, VectorLength, is_negative
from rigidsym.formula.scalars import formula_of
from rigidsym.formula.tree import MINUS, PLUS, Formula, Matrix, bracketed, row
from rigidsym.mechanics.derivation import VectorForm


def sum_of_vectors(form: VectorForm, letters: Letters) -> Formula:
    """The terms with their coefficients: v̇ + (1 − cos n)/n² v × v̇ + ..."""
    form = in_notation(form, letters.length) if letters.length else form
    parts: list[Formula] = []
    for term in form.terms:
        minus, coefficient = sign_outside(by_half_angle(term.coefficient))
        if minus or parts:
            parts.append(MINUS if minus else PLUS)
        parts += [*_factor(coefficient, letters), term.vector]
    if form.last is None:
        return row(*parts)
    last = row(*_factor(form.last.coefficient, letters), form.last.vector)
    return Matrix(((row(*parts),), (last,)))


def _factor(coefficient: sp.Expr, letters: Letters) -> list[Formula]:
    """A coefficient before a vector; 1 is not written, and a sum is in brackets."""
    return [bracketed(formula_of(coefficient, letters))] if coefficient != 1 else []


def in_notation(form: VectorForm, length: VectorLength) -> VectorForm:
    """The form in the length that the notation has; |v|² is n² − w² where n is |q|."""
    if length.components == form.components:
        return form
    others = [part**2 for part in length.components if part not in form.components]
    own = sp.sqrt(length.symbol**2 - sp.Add(*others))
    terms = (t._replace(coefficient=t.coefficient.subs(form.length, own)) for t in form.terms)
    return form._replace(terms=tuple(terms), components=length.components, length=length.symbol)


def by_half_angle(coefficient: sp.Expr) -> sp.Expr:
    """With cot(n/2) for sin n/(1 − cos n): (1 − ½ n cot(n/2))/n², where 1 − cos n cancels."""
    above, below = sp.fraction(coefficient)
    for factor in sp.Mul.make_args(below):
        cosine = 1 - factor
        if cosine.func is not sp.cos:
            continue
        sine, rest = sp.sin(*cosine.args), sp.Symbol("rest")
        # The numerator is `over` (1 − cos n) + `times` sin n, and sin n/(1 − cos n) = cot(n/2).
        over, left = sp.div(sp.expand(above).xreplace({sine: rest}), factor, cosine)
        times, none = sp.div(left, rest, rest)
        if none == 0 and not over.has(rest) and not times.has(rest, cosine):
            scale = (below / factor).as_coeff_Mul()[0]
            whole = sp.Add(over / scale, times / scale * sp.cot(cosine.args[0] / 2))
            return whole * scale * factor / below
    number, rest = coefficient.as_content_primitive()  # 2 − 2 cos n is 2 (1 − cos n)
    return coefficient if number == 1 else number * by_half_angle(rest)


def sign_outside(coefficient: sp.Expr) -> tuple[bool, sp.Expr]:
    """Whether a minus sign goes before, and what is behind: cos n − 1 is −(1 − cos n)."""
    if is_negative(coefficient):
        return True, -coefficient
    for factor in sp.Mul.make_args(sp.fraction(coefficient)[0]):
        if factor.is_Add and factor.as_coeff_Add()[0].is_negative:
            return True, coefficient / factor * sp.Add(*(-term for term in factor.args))
    return False, coefficient
