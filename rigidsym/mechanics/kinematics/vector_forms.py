"""R, Ω and the rates by the vector v of the coordinates: R = 1 + a C(v) + b C(v)², Ω = f v̇ + ...

The coefficients are those of textbooks, as functions of n = |v| and of the coordinate that is not
in v. Each form is proved equal to all entries for every v, as it is printed.
"""

from __future__ import annotations

from functools import cache
from typing import Any, NamedTuple

import sympy as sp

from rigidsym.algebra.matrix import hat
from rigidsym.algebra.ring import Quotient
from rigidsym.formula.reader import formula
from rigidsym.mechanics.derivation import Quantity, VectorForm, VectorTerm
from rigidsym.models.rotation import TIME

LENGTH = sp.Symbol("n", positive=True)  # |v|
V, V_DOT = formula(r"\v"), formula(r"\dot\v")
_BASES = tuple(map(formula, (r"\1", r"\C(\v)", r"\C(\v)^{2}", r"\v\,\v^T", r"\v^T")))
_APPLIED = ("#1", r"\v\times #1", r"\v\times(\v\times #1)", r"(\v\cdot #1)\,\v", r"\v\cdot #1")
CROSS, TWICE = (formula(text, V_DOT) for text in _APPLIED[1:3])

_OTHER = sp.Symbol("w")  # the coordinate that is not in v
_HALF = sp.Rational(1, 2)
Coefficients = tuple[sp.Expr | int, ...]


class Form(NamedTuple):
    """Coefficients of 1, C(v), C(v)² and v vᵀ; in Ω of v̇, v × v̇ and v × (v × v̇)."""

    rotation: Coefficients
    along: sp.Expr | int = 0  # of v in Ω, times the rate of the other coordinate
    inverse: Coefficients = ()  # W⁻¹, if it has three columns of v
    last: int = 0  # of vᵀ, in the row of the other coordinate
    velocity: Coefficients = ()  # if it is not that of C(v) and of C(v)² in R


@cache
def forms() -> dict[tuple[str, int], Form]:
    """By the kind of definition and the number of coordinates."""
    n, w = LENGTH, _OTHER
    sine, rest = sp.sin(n), 1 - sp.cos(n)
    square, gibbs = n**2 + w**2, 2 / (n**2 + 1)
    bracket = (-n * sine - 2 * sp.cos(n) + 2) / (2 * n**2 * rest)
    quarter = sp.Mul(sp.Rational(1, 4), 1 - n**2, evaluate=False)
    modified = 8 / (n**2 + 1) ** 2
    outer = -_HALF * (sp.sin(w) / (1 - sp.cos(w)))
    half_and_outer = (_HALF, -_HALF, 0, _HALF)
    return {
        ("unit_quaternion", 4): Form((1, 2 * w, 2), -2),
        ("quaternion", 4): Form((1, 2 * w / square, 2 / square), -2 / square),
        ("quaternion", 3): Form((1, gibbs, gibbs), inverse=half_and_outer),
        ("axis_angle", 4): Form((1, sp.sin(w), 1 - sp.cos(w)), 1, (0, -_HALF, outer), last=1),
        ("axis_angle", 3): Form(
            (1, sine / n, rest / n**2),
            inverse=(1, -_HALF, bracket),
            velocity=(1, rest / n**2, (n - sine) / n**3),
        ),
        ("modified_rodrigues", 3): Form(
            (1, 4 * ((1 - n**2) / (n**2 + 1) ** 2), modified),
            inverse=(quarter, *half_and_outer[1:]),
            velocity=(4 / (n**2 + 1), modified, modified),
        ),
    }


def vector_form(k: Any, quantity: Quantity, value: Any) -> VectorForm | None:
    """The quantity in terms of the vector of the coordinates; None if there is no such form.

    `k` is the workspace of the quantity (`kinematics.workspace`).
    """
    model, kind, symbol = k.model, quantity.vectors, quantity.symbol
    head = model.definition.partition("(")[0]
    form = forms().get((head, len(model.coordinates))) if model.vector else None
    others = [q for q in model.coordinates if q not in model.vector]
    if form is None or not kind or (kind == "rate_matrix" and others):
        return None
    v = k.codec.column(model.vector)
    names, bases = list(_BASES), [k.one, hat(v), hat(v) @ hat(v), v @ v.T, v.T]
    by_kind = {"rotation": form.rotation, "inverse": form.inverse, "rates": form.inverse}
    coefficients = by_kind.get(kind, form.velocity or (*form.rotation[1:], 0))
    text = r"#1\text{ in terms of }\v"
    factor = V_DOT  # that the matrices are applied to
    if kind in ("velocity", "rates"):
        if kind == "velocity":
            coefficients = (*coefficients, *(form.along * sp.diff(q, TIME) for q in others))
            u = k.codec.column([sp.diff(x, TIME) for x in model.vector])
        else:
            assert quantity.frame is not None
            factor, u = quantity.frame.omega, k.argument(f"omega_{quantity.frame.name}")
        bases = [basis @ u for basis in bases]
        names, text = [formula(each, factor) for each in _APPLIED], text + ", #2"
    if kind == "velocity":
        names[3], bases[3] = V, v
    # C(v) changes its sign with the direction of the turn
    is_backwards = model.passive if quantity.frame is None else quantity.frame.prime != ""
    terms, vectors = [], []
    for place, coefficient in enumerate(map(sp.sympify, coefficients)):
        if coefficient:
            own = coefficient.xreplace(dict(zip([_OTHER], others, strict=False)))
            above, below = sp.fraction(own)
            own = -above / below if place == 1 and is_backwards else own
            terms.append(VectorTerm(own, names[place]))
            vectors.append(bases[place])
    if not terms:
        return None
    matrix, divisor = value if isinstance(value, tuple) else (value, k.codec.ring.one)
    blocks, last = [(terms, vectors, matrix.rows[:3])], None
    if form.last and len(matrix.rows) > 3:
        last = VectorTerm(sp.Integer(form.last), names[4])
        blocks.append(([last], bases[4:], matrix.rows[3:]))
    # The printed terms less the entries over their divisor, with |v| = √(v·v).
    ring, length = k.codec.ring, sp.sqrt(sum(part**2 for part in model.vector))
    residual: list[Quotient] = []
    for own_terms, own_vectors, rows in blocks:
        entries = [Quotient(ring, -entry, divisor) for row in rows for entry in row]
        for term, vector in zip(own_terms, own_vectors, strict=True):
            scale = k.codec.encode_quotient(term.coefficient.xreplace({LENGTH: length}))
            for place, entry in enumerate(vector.entries):
                entries[place] += scale * Quotient.whole(ring, entry)
        residual += entries
    return VectorForm(
        terms=tuple(terms),
        components=model.vector,
        length=LENGTH,
        proof=k.prove.cancel(residual, formula(text, symbol, factor)),
        last=last,
    )
