"""The time derivative of a vector form, term by term, by the product rule."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

import sympy as sp

from rigidsym.formula.reader import formula
from rigidsym.formula.tree import Formula
from rigidsym.mechanics.derivation import VectorForm, VectorTerm
from rigidsym.mechanics.kinematics.vector_forms import ALONG, CROSS, TWICE, V_DOT, V
from rigidsym.models.rotation import TIME

_V_DDOT = formula(r"\ddot{\mathbf{v}}")
_RATES: Mapping[Formula, tuple[Formula, ...]] = {  # of each vector, as a sum
    V: (V_DOT,),
    V_DOT: (_V_DDOT,),
    CROSS: (formula(r"\mathbf{v}\times\ddot{\mathbf{v}}"),),
    TWICE: (
        formula(r"\mathbf{v}\times(\mathbf{v}\times\ddot{\mathbf{v}})"),
        formula(r"\dot{\mathbf{v}}\times(\mathbf{v}\times\dot{\mathbf{v}})"),
    ),
    ALONG: (
        formula(r"(\mathbf{v}\cdot\ddot{\mathbf{v}})\,\mathbf{v}"),
        formula(r"(\dot{\mathbf{v}}\cdot\dot{\mathbf{v}})\,\mathbf{v}"),
        formula(r"(\mathbf{v}\cdot\dot{\mathbf{v}})\,\dot{\mathbf{v}}"),
    ),
}


def rates_of_form(form: VectorForm, rate_of_length: sp.Symbol) -> Iterator[VectorForm]:
    """The derivative of f v̇ + g v × v̇ + ..., with the symbol for ṅ in its coefficients.

    Each vector once, and each as often as its coefficients have denominators.
    """
    whole: dict[Formula, sp.Expr] = {}
    apart: dict[tuple[Formula, sp.Expr], sp.Expr] = {}
    for coefficient, vector in _terms(form, rate_of_length):
        whole[vector] = whole.get(vector, 0) + coefficient
        for part in sp.Add.make_args(coefficient):
            kind = (vector, sp.fraction(part)[1])
            apart[kind] = apart.get(kind, 0) + part
    yield _form(form, whole.items())
    yield _form(form, ((vector, c) for (vector, _), c in apart.items()))


def _form(form: VectorForm, terms: Iterable[tuple[Formula, sp.Expr]]) -> VectorForm:
    return form._replace(terms=tuple(VectorTerm(_collected(c), v) for v, c in terms if c != 0))


def _collected(coefficient: sp.Expr) -> sp.Expr:
    """As one fraction, with equal terms above its line added up: −3n + n (1 − cos n)."""
    above, below = sp.fraction(sp.together(coefficient))
    return sp.factor_terms(sp.expand(above)) / below


def _terms(form: VectorForm, rate_of_length: sp.Symbol) -> Iterator[tuple[sp.Expr, Formula]]:
    """First those with second derivatives."""
    for term in form.terms:
        yield from ((term.coefficient, vector) for vector in _RATES[term.vector])
    for term in form.terms:
        by_length = sp.diff(term.coefficient, form.length) * rate_of_length
        yield sp.diff(term.coefficient, TIME) + by_length, term.vector
