"""A vector quantity as a sum of vectors."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import sympy as sp

from rigidsym.formula.letters import Letters, VectorLength, is_negative, power_of
from rigidsym.formula.scalars import formula_of
from rigidsym.formula.tree import MINUS, PLUS, Bracket, Formula, Matrix, bracketed, row
from rigidsym.mechanics.derivation import VectorForm


def sum_of_vectors(form: VectorForm, letters: Letters) -> Formula:
    """The terms with their coefficients: v̇ + (1 − cos n)/n² v × v̇ + ...

    A fraction that several terms share is written once: 2/n² (w v̇ + v × v̇ − ẇ v).
    """
    form = in_notation(form, letters.length) if letters.length else form
    groups: dict[tuple[_Shared, int], list[tuple[bool, sp.Expr, Formula]]] = {}
    for place, term in enumerate(form.terms):
        minus, coefficient = sign_outside(by_half_angle(term.coefficient))
        own, shared = _parted(coefficient)
        key = (shared, place if shared == _Shared() else -1)
        groups.setdefault(key, []).append((minus, own, term.vector))
    parts: list[Formula] = []
    for (shared, _), terms in groups.items():
        minus, own, vector = terms[0]
        common = sp.gcd_list([own for _, own, _ in terms]) if len(terms) > 1 else own
        if minus or parts:
            parts.append(MINUS if minus else PLUS)
        parts += _factor(common, shared, letters)
        parts.append(_bracket(terms, common, letters) if len(terms) > 1 else vector)
    if form.last is None:
        return row(*parts)
    below = _factor(form.last.coefficient, _Shared(), letters)
    return Matrix(((row(*parts),), (row(*below, form.last.vector),)))


class _Shared(NamedTuple):
    """What terms may share of their coefficients: sums/(number × divisor)."""

    sums: sp.Expr = sp.S.One
    number: sp.Integer = sp.S.One
    divisor: sp.Expr = sp.S.One


def _parted(coefficient: sp.Expr) -> tuple[sp.Expr, _Shared]:
    """A coefficient that has no sign: a product of an integer and names, and the rest."""
    content, primitive = coefficient.as_content_primitive()
    above, below = sp.fraction(primitive)
    sums = [factor for factor in sp.Mul.make_args(above) if power_of(factor)[0].is_Add]
    names = [factor for factor in sp.Mul.make_args(above) if factor not in sums]
    return sp.Mul(content.p, *names), _Shared(sp.Mul(*sums), sp.Integer(content.q), below)


def _factor(own: sp.Expr, shared: _Shared, letters: Letters) -> list[Formula]:
    """A coefficient before a vector; 1 is not written, and a sum is in brackets."""
    if shared.divisor == 1:  # apart, or SymPy would multiply the number into the sum
        factors = [own / shared.number, shared.sums]
    else:
        factors = [sp.Mul(own, shared.sums, 1 / shared.number, 1 / shared.divisor)]
    return [bracketed(formula_of(factor, letters)) for factor in factors if factor != 1]


def _bracket(
    terms: Sequence[tuple[bool, sp.Expr, Formula]], common: sp.Expr, letters: Letters
) -> Formula:
    """The terms over what is common to them, and to the sign of the first."""
    inside: list[Formula] = []
    for minus, own, vector in terms:
        if inside:
            inside.append(PLUS if minus == terms[0][0] else MINUS)
        inside += [*_factor(own / common, _Shared(), letters), vector]
    return Bracket(row(*inside))


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
