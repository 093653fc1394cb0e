"""Vectors shown as vectors: Ω = f v̇ + g v × v̇ + ..., where three coordinates form a vector v.

The coefficients are read off where v points along its first axis, and the form that they make is
then proved equal to all components at every v. No coefficient is assumed.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import reduce
from operator import add

import sympy as sp
from sympy.polys.rings import PolyElement

from rigidsym.algebra.codec import Codec
from rigidsym.algebra.matrix import RingMatrix, cross
from rigidsym.algebra.present import presenter_for
from rigidsym.mechanics.derivation import Markup, Proof, VectorForm, VectorTerm
from rigidsym.models.rotation import RotationModel
from rigidsym.models.so3 import TIME

LENGTH = sp.Symbol("n", positive=True)  # |v|

V = Markup(r"\mathbf{v}", "v")
V_DOT = Markup(r"\dot{\mathbf{v}}", "v̇")
CROSS = Markup(r"\mathbf{v}\times\dot{\mathbf{v}}", "v × v̇")
TWICE = Markup(r"\mathbf{v}\times(\mathbf{v}\times\dot{\mathbf{v}})", "v × (v × v̇)")
ALONG = Markup(r"(\mathbf{v}\cdot\dot{\mathbf{v}})\,\mathbf{v}", "(v·v̇) v")

Weighted = list[tuple[PolyElement, Markup, RingMatrix]]  # coefficient, its vector, over the ring


def vector_form(
    model: RotationModel, omega: RingMatrix, codec: Codec, symbol: Markup
) -> VectorForm | None:
    """Ω or Ω′ in terms of v, v̇, v × v̇ and v × (v × v̇); None where there is no such form."""
    if not model.vector:
        return None
    work = Vectors(model.vector, codec)
    forms = [form for form in work.forms(omega) if work.is_equal(form, omega)]
    if not forms:
        return None
    terms = min((work.terms(form) for form in forms), key=length_of_form)
    claim = Markup(
        rf"{symbol.latex}\text{{ in terms of }}\mathbf{{v}}, \dot{{\mathbf{{v}}}}",
        f"{symbol.text} in terms of v, v̇",
    )
    return VectorForm(
        terms=terms,
        components=model.vector,
        length=LENGTH,
        proof=Proof(claim=claim, status="exact"),
    )


def length_of_form(terms: Sequence[VectorTerm]) -> int:
    return sum(int(sp.count_ops(term.coefficient)) + 1 for term in terms)


def one_fraction(coefficient: sp.Expr) -> sp.Expr:
    """A coefficient over one denominator where that is shorter: (n − sin n)/n³."""
    together = sp.together(coefficient)
    # fractions within fractions are worth an operation or two
    return together if sp.count_ops(together) <= sp.count_ops(coefficient) + 2 else coefficient


class Vectors:
    """The vector of one model over its ring, and the point where it lies along its first axis."""

    def __init__(self, vector: Sequence[sp.Expr], codec: Codec) -> None:
        self.vector = vector
        self.codec = codec
        self.ring = codec.ring
        self.v = [codec.encode(part) for part in vector]
        self.v_dot = [codec.encode(sp.diff(part, TIME)) for part in vector]
        self.square = self.ring.dot([(part, part) for part in self.v])
        self._places = [self.ring.index[part] for part in vector]
        self._root = self.ring.index.get(sp.sqrt(sum(part**2 for part in vector)))

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
        once = self._crossed(self.v_dot)
        dotted = v.scale(self.ring.dot(zip(self.v, self.v_dot, strict=True)))
        around, ahead = (across, CROSS, once), (scalar, V, v)
        crossed_twice = self._crossed(once.entries)
        return [
            self.lifted([(straight, V_DOT, v_dot), around, (along, ALONG, dotted), ahead]),
            self.lifted([(twice, V_DOT, v_dot), around, (along, TWICE, crossed_twice), ahead]),
        ]

    def is_equal(self, form: Weighted, omega: RingMatrix) -> bool:
        """Whether the sum of the terms is Ω at every v: decided in the ring."""
        total = reduce(add, (vector.scale(coefficient) for coefficient, _, vector in form))
        return bool(form) and (total - omega).is_zero()

    def terms(self, form: Weighted) -> tuple[VectorTerm, ...]:
        """What is printed: the coefficients as functions of the length."""
        present = presenter_for(self.codec)
        along_axis = dict(zip(self.vector, (LENGTH, 0, 0), strict=True))
        return tuple(
            VectorTerm(one_fraction(present.element(coefficient).subs(along_axis)), vector)
            for coefficient, vector, _ in form
            if coefficient
        )

    def special(self, element: PolyElement) -> PolyElement:
        """The element where v = (|v|, 0, 0); |v| is the root, where the ring has it."""
        first, *others = self._places
        result = self.ring.zero
        for monomial, coefficient in element.items():
            if any(monomial[place] for place in others):
                continue
            powers = list(monomial)
            if self._root is not None:
                powers[self._root] += powers[first]
                powers[first] = 0
            result += self.ring.polynomials.term_new(tuple(powers), coefficient)
        return self.ring.reduce(result) if self._root is not None else result

    def by_length(self, element: PolyElement) -> PolyElement | None:
        """The element at the special point, divided by |v|; None where that does not divide."""
        if self._root is not None:
            root = self.ring.generators[self._root].expression
            return self.ring.reduce(element * self.codec.encode(1 / root))
        gen = self.ring.generator(self._places[0])
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
        """The coefficients as functions of v·v again; empty where one is odd in |v|."""
        if self._root is not None:  # |v| itself stands in them
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

    def _crossed(self, parts: Sequence[PolyElement]) -> RingMatrix:
        return self.column(cross(self.ring, tuple(self.v), tuple(parts)))
