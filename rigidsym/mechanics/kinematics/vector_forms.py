"""Vectors and matrices of a vector v: Ω = f v̇ + g v × v̇ + ..., R = 1 + a C(v) + b C(v)².

The coefficients are read off for v along the first axis. The form with these coefficients, as it is
printed, is then proved equal to all entries for every v.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import reduce
from operator import add

import sympy as sp
from sympy.polys.rings import PolyElement

from rigidsym.algebra.matrix import RingMatrix, hat
from rigidsym.algebra.present import presenter_for
from rigidsym.algebra.ring import Quotient
from rigidsym.formula.reader import formula
from rigidsym.formula.tree import NOTHING, Formula
from rigidsym.mechanics.derivation import VectorForm, VectorTerm
from rigidsym.mechanics.prove import Prover
from rigidsym.models.rotation import TIME

LENGTH = sp.Symbol("n", positive=True)  # |v|

V = formula(r"\v")
V_DOT = formula(r"\dot\v")
CROSS = formula(r"\v\times\dot\v")
TWICE = formula(r"\v\times(\v\times\dot\v)")
ALONG = formula(r"(\v\cdot\dot\v)\,\v")

_ONE = formula(r"\1")
_SKEW = formula(r"\C(\v)")
_SQUARE = formula(r"\C(\v)^{2}")
_OUTER = formula(r"\v\,\v^T")
_APPLIED = {  # to a vector w
    _ONE: "#1",
    _SKEW: r"\v\times #1",
    _SQUARE: r"\v\times(\v\times #1)",
    _OUTER: r"(\v\cdot #1)\,\v",
}
_ROW = formula(r"\v^T")
_TERMS_OF = r"#1\text{ in terms of }\v"

Weighted = list[tuple[PolyElement, Formula, RingMatrix]]  # coefficient, its vector, over the ring


def vector_form(
    prove: Prover, vector: Sequence[sp.Expr], omega: RingMatrix, symbol: Formula
) -> VectorForm | None:
    """Ω or Ω′ in terms of v, v̇, v × v̇ and v × (v × v̇); None if there is no such form."""
    work = Vectors(vector, prove)
    claim = formula(_TERMS_OF + r", \dot\v", symbol)
    return work.shortest(work.forms(omega), omega, prove.codec.ring.one, claim)


def matrix_form(
    prove: Prover,
    vector: Sequence[sp.Expr],
    matrix: RingMatrix,
    below: PolyElement,
    symbol: Formula,
    *,
    to: tuple[Formula, RingMatrix] | None = None,
) -> VectorForm | None:
    """A matrix (3, 3) over `below` as a 1 + b C(v) + c v vᵀ, or with C(v)²; None if it is not.

    Applied `to` a vector w, (3, 1), it is a w + b v × w + ... Of a unit vector, there may be a
    fourth row, f vᵀ.
    """
    work = Vectors(vector, prove)
    rows = 4 if work.is_unit and len(matrix.rows) == 4 else 3
    if matrix.shape != (rows, 3):
        return None
    name, w = to or (NOTHING, RingMatrix.identity(work.ring, 3))
    claim = formula(_TERMS_OF + (", #2" if to else ""), symbol, name)
    whole = RingMatrix(work.ring, matrix.rows[:3])
    forms = [
        [(c, formula(_APPLIED[basis], name) if to else basis, part @ w) for c, basis, part in form]
        for form in work.matrix_forms(whole)
    ]
    if rows == 3:
        return work.shortest(forms, whole @ w, below, claim)
    row = RingMatrix(work.ring, matrix.rows[3:])
    last = work.row_form(row, formula(r"\v\cdot #1", name) if to else _ROW)
    if not last:
        return None
    (term,) = work.terms(last, below)
    residual = work.residual([term], [last[0][2] @ w], row @ w, below)
    found = work.shortest(forms, whole @ w, below, claim, residual)
    return found and found._replace(last=term)


def _one_fraction(coefficient: sp.Expr) -> sp.Expr:
    """A coefficient over one denominator if that is shorter: (n − sin n)/n³."""
    together = sp.together(coefficient)
    # fractions within fractions are worth an operation or two
    return together if sp.count_ops(together) <= sp.count_ops(coefficient) + 2 else coefficient


class Vectors:
    """The vector of one model over its ring, and the point at which v = (|v|, 0, 0)."""

    def __init__(self, vector: Sequence[sp.Expr], prove: Prover) -> None:
        self.vector = tuple(vector)
        self.prove = prove
        self.codec = codec = prove.codec
        self.ring = codec.ring
        self.v = [codec.encode(part) for part in vector]
        self.v_dot = [codec.encode(sp.diff(part, TIME)) for part in vector]
        self.square = self.ring.dot([(part, part) for part in self.v])
        self._places = [self.ring.index[part] for part in vector]
        self._root = self.ring.index.get(sp.sqrt(sum(part**2 for part in vector)))
        self.is_unit = self.ring.reduce(self.square - self.ring.one) == self.ring.zero

    def forms(self, omega: RingMatrix) -> list[Weighted]:
        """The candidates: with (v·v̇) v, and with v × (v × v̇) in its place."""
        first, second, _ = (self.special(entry) for entry in omega.entries)
        rates = [self.special(rate) for rate in self.v_dot]
        straight = second.diff(rates[1])
        across = self.by_length(-second.diff(rates[2]))
        rest = self.by_length(first - straight * rates[0])
        along = None if rest is None else self.by_length(rest.diff(rates[0]))
        if across is None or rest is None or along is None:
            return []
        scalar = rest - rest.diff(rates[0]) * rates[0]
        twice = straight + along * self.special(self.square)
        v_dot, v = self.column(self.v_dot), self.column(self.v)
        once = v.cross(v_dot)
        dotted = v.scale(self.ring.dot(zip(self.v, self.v_dot, strict=True)))
        around, ahead = (across, CROSS, once), (scalar, V, v)
        return [
            self.lifted([(straight, V_DOT, v_dot), around, (along, ALONG, dotted), ahead]),
            self.lifted([(twice, V_DOT, v_dot), around, (along, TWICE, v.cross(once)), ahead]),
        ]

    def matrix_forms(self, matrix: RingMatrix) -> list[Weighted]:
        """The candidates: with v vᵀ, and with C(v)² in its place."""
        entries = (matrix.rows[i][j] for i, j in ((0, 0), (1, 1), (2, 1)))
        along, across, turned = map(self.special, entries)
        once = self.by_length(turned)
        half = self.by_length(along - across)
        outer = None if half is None else self.by_length(half)
        if once is None or outer is None:
            return []
        v = self.column(self.v)
        one, skew, dyad = RingMatrix.identity(self.ring, 3), hat(v), v @ v.T
        return [
            self.lifted([(across, _ONE, one), (once, _SKEW, skew), (outer, _OUTER, dyad)]),
            self.lifted([(along, _ONE, one), (once, _SKEW, skew), (outer, _SQUARE, skew @ skew)]),
        ]

    def row_form(self, row: RingMatrix, name: Formula) -> Weighted:
        """A row (1, 3) as f vᵀ; empty if it is not."""
        coefficient = self.by_length(self.special(row[0, 0]))
        form = [(coefficient, name, self.column(self.v).T)] if coefficient is not None else []
        return form if self._is_equal(form, row) else []

    def shortest(
        self,
        forms: Iterable[Weighted],
        whole: RingMatrix,
        below: PolyElement,
        claim: Formula,
        more: Sequence[Quotient] = (),
    ) -> VectorForm | None:
        """The shortest of the forms that equal whole/below, proved as it is printed.

        The proof is that `more` vanishes, too.
        """
        equal = [form for form in forms if self._is_equal(form, whole)]
        if not equal:
            return None
        terms, form = min(
            ((self.terms(form, below), form) for form in equal),
            key=lambda pair: sum(int(sp.count_ops(term.coefficient)) + 1 for term in pair[0]),
        )
        vectors = [vector for coefficient, _, vector in form if coefficient]
        return VectorForm(
            terms=terms,
            components=self.vector,
            length=LENGTH,
            proof=self.prove.cancel([*self.residual(terms, vectors, whole, below), *more], claim),
        )

    def _is_equal(self, form: Weighted, whole: RingMatrix) -> bool:
        """Whether the sum of the terms is the whole at every v: decided in the ring."""
        total = reduce(add, (vector.scale(c) for c, _, vector in form), whole.scale(-self.ring.one))
        return bool(form) and total.is_zero()

    def terms(self, form: Weighted, below: PolyElement) -> tuple[VectorTerm, ...]:
        """What is printed: the coefficients over `below` as functions of the length."""
        present = presenter_for(self.codec)
        along_axis = dict(zip(self.vector, (LENGTH, 0, 0), strict=True))
        return tuple(
            VectorTerm(_one_fraction(present.quotient(quotient).subs(along_axis)), name)
            for coefficient, name, _ in form
            for quotient in (Quotient(self.ring, self.ring.reduce(coefficient), below),)
            if coefficient
        )

    def residual(
        self,
        terms: Sequence[VectorTerm],
        vectors: Sequence[RingMatrix],
        whole: RingMatrix,
        below: PolyElement,
    ) -> list[Quotient]:
        """The printed terms less whole/below, entry by entry, with |v| = √(v·v)."""
        ring, length = self.ring, sp.sqrt(sum(part**2 for part in self.vector))
        coefficients = [
            self.codec.encode_quotient(term.coefficient.xreplace({LENGTH: length}))
            for term in terms
        ]
        total = [Quotient(ring, -entry, below) for entry in whole.entries]
        for coefficient, vector in zip(coefficients, vectors, strict=True):
            for place, entry in enumerate(vector.entries):
                total[place] += coefficient * Quotient.whole(ring, entry)
        return total

    def special(self, element: PolyElement) -> PolyElement:
        """The element at v = (|v|, 0, 0); |v| is the root, if the ring has it."""
        first, *others = self._places
        result = self.ring.zero
        for monomial, coefficient in element.items():
            if any(monomial[place] for place in others):
                continue
            powers = list(monomial)
            if self.is_unit:
                powers[first] %= 2
            elif self._root is not None:
                powers[self._root] += powers[first]
                powers[first] = 0
            result += self.ring.polynomials.term_new(tuple(powers), coefficient)
        return self.ring.reduce(result) if self._root is not None else result

    def by_length(self, element: PolyElement) -> PolyElement | None:
        """The element at the special point, divided by |v|; None if |v| does not divide it."""
        if self._root is not None:
            root = self.ring.generators[self._root].expression
            return self.ring.reduce(element * self.codec.encode(1 / root))
        gen = self.ring.generator(self._places[0])
        if self.is_unit:
            return self.special(element * gen)
        whole, inverse = self._without_inverses(element)
        if any(monomial[self._places[0]] == 0 for monomial in whole):
            return None
        return self.special(self.ring.reduce(whole.exquo(gen) * inverse)) if whole else whole

    def _without_inverses(self, element: PolyElement) -> tuple[PolyElement, PolyElement]:
        """p and i with element = p i, where p holds no 1/d: a power of |v| in it is then seen."""
        inverse = self.ring.one
        for place, gen in enumerate(self.ring.generators):
            power = max((monomial[place] for monomial in element), default=0)
            if power and gen.expression.is_Pow and gen.expression.exp.is_negative:
                below = self.codec.encode(1 / gen.expression)
                element = self.special(self.ring.reduce(element * below**power))
                inverse *= self.ring.generator(place) ** power
        return element, inverse

    def lifted(self, form: Weighted) -> Weighted:
        """The coefficients as functions of v·v again; empty if one is odd in |v|."""
        if self._root is not None:  # they hold |v| itself
            return form
        first = self._places[0]
        if any(monomial[first] % 2 for coefficient, _, _ in form for monomial in coefficient):
            return []
        return [(self._lift(coefficient), name, vector) for coefficient, name, vector in form]

    def _lift(self, coefficient: PolyElement) -> PolyElement:
        first = self._places[0]
        total = self.ring.zero
        for monomial, number in coefficient.items():
            rest = (*monomial[:first], 0, *monomial[first + 1 :])
            term = self.ring.polynomials.term_new(rest, number)
            total += term * self.square ** (monomial[first] // 2)
        return self.ring.reduce(total)

    def column(self, parts: Sequence[PolyElement]) -> RingMatrix:
        return RingMatrix.column(self.ring, parts)
