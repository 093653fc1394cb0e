"""Matrices of a vector: a 1 + b C(v) + c v vᵀ, or with C(v)², with coefficients of |v| alone.

As for vectors, the coefficients are read off where v points along its first axis, and what they
make is then proved equal to all entries at every v.
"""

from __future__ import annotations

from dataclasses import replace

from sympy.polys.rings import PolyElement

from rigidsym.algebra.codec import Codec
from rigidsym.algebra.matrix import RingMatrix
from rigidsym.algebra.present import presenter_for
from rigidsym.algebra.quotient import Quotient
from rigidsym.mechanics.claims import fill
from rigidsym.mechanics.derivation import Markup, Proof, VectorForm, VectorTerm
from rigidsym.mechanics.kinematics.composition import hat
from rigidsym.mechanics.kinematics.vectors import (
    LENGTH,
    Vectors,
    Weighted,
    length_of_form,
    one_fraction,
)
from rigidsym.models.rotation import RotationModel

_ONE = Markup(r"\mathbf{1}", "1")
_CROSS = Markup(r"\mathbf{C}(\mathbf{v})", "C(v)")
_TWICE = Markup(r"\mathbf{C}(\mathbf{v})^{2}", "C(v)²")
_OUTER = Markup(r"\mathbf{v}\,\mathbf{v}^{\mathsf T}", "v vᵀ")


_APPLIED = {  # to a vector w
    _ONE: ("{0}", "{0}"),
    _CROSS: (r"\mathbf{{v}}\times{0}", "v × {0}"),
    _TWICE: (r"\mathbf{{v}}\times(\mathbf{{v}}\times{0})", "v × (v × {0})"),
    _OUTER: (r"(\mathbf{{v}}\cdot{0})\,\mathbf{{v}}", "(v·{0}) v"),
}


def applied(form: VectorForm, symbol: Markup, vector: Markup) -> VectorForm:
    """The form of M w for that of a matrix M: a w + b v × w + ..."""
    terms = tuple(
        VectorTerm(term.coefficient, fill(*_APPLIED[term.vector], vector)) for term in form.terms
    )
    claim = fill(
        r"{0}\text{{ in terms of }}\mathbf{{v}}, {1}", "{0} in terms of v, {1}", symbol, vector
    )
    return replace(form, terms=terms, proof=Proof(claim=claim, status="exact"))


def matrix_form(
    model: RotationModel, matrix: RingMatrix, codec: Codec, symbol: Markup, below: PolyElement
) -> VectorForm | None:
    """A matrix (3, 3) over `below` as a function of the vector v; None where it is no such one."""
    if not model.vector or matrix.shape != (3, 3):
        return None
    work = Vectors(model.vector, codec)
    forms = [form for form in _forms(work, matrix) if form and work.is_equal(form, matrix)]
    if not forms:
        return None
    terms = min((_terms(work, form, below) for form in forms), key=length_of_form)
    claim = Markup(
        rf"{symbol.latex}\text{{ in terms of }}\mathbf{{v}}", f"{symbol.text} in terms of v"
    )
    proof = Proof(claim=claim, status="exact")
    return VectorForm(terms=terms, components=model.vector, length=LENGTH, proof=proof)


def _forms(work: Vectors, matrix: RingMatrix) -> list[Weighted]:
    """The candidates: with v vᵀ, and with C(v)² in its place."""
    along, across, turned = (work.special(matrix.rows[i][j]) for i, j in ((0, 0), (1, 1), (2, 1)))
    once = work.by_length(turned)
    half = work.by_length(along - across)
    outer = None if half is None else work.by_length(half)
    if once is None or outer is None:
        return []
    one, skew = RingMatrix.identity(work.ring, 3), hat(work.column(work.v))
    dyad = work.column(work.v) @ work.column(work.v).T
    return [
        work.lifted([(across, _ONE, one), (once, _CROSS, skew), (outer, _OUTER, dyad)]),
        work.lifted([(along, _ONE, one), (once, _CROSS, skew), (outer, _TWICE, skew @ skew)]),
    ]


def _terms(work: Vectors, form: Weighted, below: PolyElement) -> tuple[VectorTerm, ...]:
    present = presenter_for(work.codec)
    along_axis = dict(zip(work.vector, (LENGTH, 0, 0), strict=True))
    return tuple(
        VectorTerm(one_fraction(present.quotient(quotient).subs(along_axis)), name)
        for coefficient, name, _ in form
        for quotient in (Quotient(work.ring, coefficient, below),)
        if coefficient
    )
