"""Polynomials in generators modulo relations, with d/dt as a derivation.

A generator stands for a SymPy expression: cos θ, sin θ, θ̇, a mass, √(v·v), 1/(1 + ρ·ρ).
The relations between the generators (c² + s² = 1, w² + x² + y² + z² = 1, n·i = 1, ...) become a
Gröbner basis, and every element is in normal form. An element of the ideal always reduces to zero,
so a zero is a proof. If `complete` is true, there are no further relations, and any other normal
form is not zero.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache, reduce
from operator import add, itemgetter, mul, sub
from typing import Any

import sympy as sp
from sympy.polys.domains.rationalfield import RationalField
from sympy.polys.groebnertools import groebner
from sympy.polys.orderings import grevlex
from sympy.polys.rings import PolyElement, PolyRing

from rigidsym.errors import AlgebraError
from rigidsym.system.records import NamedTuple

Monomial = tuple[int, ...]
Terms = dict[Monomial, Any]  # coefficients in Q
Pair = tuple[PolyElement, PolyElement]
Rule = tuple[Monomial, list[tuple[int, int]], Terms]  # leading monomial, its powers, the rest


class _Rationals(RationalField):
    """Q, with whole numbers as Python's: products of fractions take SymPy five times as long."""

    zero, one, tp = 0, 1, (int, sp.QQ.tp)

    def quo(self, a: Any, b: Any) -> Any:
        """a/b, exactly; Python's a / b of whole numbers would be rounded."""
        return a if b == 1 else super().quo(a, b)

    exquo = quo


NUMBERS = _Rationals()


class Generator(NamedTuple):
    """One indeterminate of the ring and the SymPy expression it stands for."""

    expression: sp.Expr
    opaque: bool = False  # whether relations of it may be missing from the ring


class Ring:
    """Q[generators] modulo relations; elements are `PolyElement`s in normal form.

    `relations` are polynomials that vanish, `relation_terms` their terms one by one. `derivatives`
    holds d/dt of the generators that have one in this ring: the highest derivatives of the
    coordinates have none.
    """

    def __init__(self, generators: Sequence[Generator]) -> None:
        self.generators = tuple(generators)
        names = [f"g{index}" for index in range(len(self.generators))]
        self.polynomials = PolyRing(names, NUMBERS, grevlex)
        self.zero: PolyElement = self.polynomials.zero
        self.one: PolyElement = self.polynomials.one
        self.index = {gen.expression: place for place, gen in enumerate(self.generators)}
        self.relations: tuple[PolyElement, ...] = ()
        self.derivatives: Mapping[int, PolyElement] = {}
        self.relation_terms: list[tuple[Monomial, list[tuple[int, int]], Any, PolyElement]] = []
        self._normal_forms = _NormalForms([])
        self._monomial_rates: dict[Monomial, PolyElement] = {}

    @property
    def complete(self) -> bool:
        """Whether every relation between the generators is known, so that non-zero is decided."""
        return not any(gen.opaque for gen in self.generators)

    def generator(self, place: int) -> PolyElement:
        return self.polynomials.gens[place]

    def set_relations(self, relations: Iterable[PolyElement]) -> None:
        """Take the relations and their Gröbner basis; normal forms from now on obey them."""
        self.relations = tuple(relation for relation in relations if relation)
        # With a Gröbner basis, the remainder of a division does not depend on the order of its
        # steps, and it is zero exactly for the members of the ideal.
        basis = groebner(list(self.relations), self.polynomials) if self.relations else []
        if any(element.is_ground for element in basis):
            raise AlgebraError("the relations contradict one another: they imply 1 = 0")
        rules: list[Rule] = []
        # c·m + rest = 0 becomes the rule m → −rest/c: s² + c² − 1 = 0 becomes s² → 1 − c².
        for element in basis:  # read as: leading monomial -> minus the rest
            leading, divide = element.leading_expv(), NUMBERS.quo
            tail = {m: divide(-c, element[leading]) for m, c in element.items() if m != leading}
            rules.append((leading, _powers(leading), tail))
        self._normal_forms = _NormalForms(rules)
        self.relation_terms = [
            (term, _powers(term), coefficient, relation)
            for relation in self.relations
            for term, coefficient in relation.items()
            if any(term)
        ]
        self._monomial_rates = {}

    def reduce(self, element: PolyElement) -> PolyElement:
        """The normal form of a polynomial: zero exactly for members of the ideal."""
        if self._normal_forms.standard.issuperset(element):
            return element
        return self._settled(element)

    def dot(self, pairs: Iterable[Pair], minus: Iterable[Pair] = ()) -> PolyElement:
        """The sum of the products, less those of `minus`, in normal form."""
        # Σ pᵢ qᵢ is reduced once, after all products are added; products that cancel are never
        # reduced.
        times = self.polynomials.monomial_mul
        total: Terms = {}
        known = total.get
        for sign, group in ((1, pairs), (-1, minus)) if minus else ((1, pairs),):
            for first, second in group:
                if not (first and second):
                    continue
                terms = second.items()
                for monomial, coefficient in first.items():
                    weight = sign * coefficient
                    for other, factor in terms:
                        product = times(monomial, other)
                        total[product] = known(product, 0) + weight * factor
        return self._settled(total) if total else self.zero

    def difference(self, first: PolyElement, second: PolyElement) -> PolyElement:
        """The difference of two elements in normal form, which is one."""
        # Both sides of nearly every claim are equal; SymPy would compare their rings first.
        return self.zero if dict.__eq__(first, second) else first - second

    def _settled(self, terms: Terms) -> PolyElement:
        """The polynomial of these terms, in normal form."""
        # Reduction is linear: the normal form of Σ c m is Σ c NF(m) over the monomials m.
        forms = self._normal_forms
        result = terms
        if not forms.standard.issuperset(terms):
            result = {}
            for monomial, coefficient in terms.items():
                form = forms[monomial]
                if form is None:
                    result[monomial] = result.get(monomial, 0) + coefficient
                elif coefficient:
                    _add(result, coefficient, form)
        if not all(result.values()):
            result = {m: c for m, c in result.items() if c}
        return PolyElement(self.polynomials, result) if result else self.zero

    def is_zero(self, element: PolyElement) -> bool:
        return not element or not self.reduce(element)

    def is_one(self, element: PolyElement) -> bool:
        return element is self.one or dict.__eq__(element, self.one)

    def can_derive(self, element: PolyElement) -> bool:
        """Whether every generator in the element has a time derivative in this ring."""
        used = (place for monomial in element for place, power in enumerate(monomial) if power)
        return all(place in self.derivatives for place in used)

    def dt(self, element: PolyElement) -> PolyElement:
        """Time derivative: the sum over the generators of ∂/∂g · dg/dt, in normal form.

        Raises AlgebraError where a generator has no derivative in this ring.
        """
        # d/dt (Σ c m) = Σ c ṁ, since the coefficients are constant. The result needs no reduction:
        # a sum of normal forms is a normal form.
        result: Terms = {}
        for monomial, coefficient in element.items():
            if monomial not in self._monomial_rates:
                self._monomial_rates[monomial] = self._monomial_rate(monomial)
            _add(result, coefficient, self._monomial_rates[monomial])
        return PolyElement(self.polynomials, {m: c for m, c in result.items() if c})

    def _monomial_rate(self, monomial: Monomial) -> PolyElement:
        """d/dt of one monomial, by the product rule; `dt` remembers it."""
        total = self.zero
        for place, power in enumerate(monomial):
            if power and place not in self.derivatives:
                raise AlgebraError(
                    f"the ring was built without the time derivative of "
                    f"{self.generators[place].expression}; build it with a higher order"
                )
            if power:
                # ∂/∂g of gⁿ·rest, times ġ: n gⁿ⁻¹ ġ·rest.
                rest = (*monomial[:place], power - 1, *monomial[place + 1 :])
                total += self.derivatives[place].mul_term((rest, power))
        return self.reduce(total)


@dataclass(frozen=True, slots=True, eq=False)
class Quotient:
    """numerator / denominator, both in normal form; the denominator is not zero.

    a/b = c/d where a·d − c·b reduces to zero. Where the ring knows all relations it is an integral
    domain, and only there.
    """

    ring: Ring
    numerator: PolyElement
    denominator: PolyElement

    def __post_init__(self) -> None:
        if not self.denominator:
            raise AlgebraError("division by an expression that is zero in the ring")

    @classmethod
    def whole(cls, ring: Ring, element: PolyElement) -> Quotient:
        return cls(ring, element, ring.one)

    @classmethod
    def sum(cls, ring: Ring, parts: Iterable[Quotient]) -> Quotient:
        """The sum, over one denominator where the parts share it."""
        terms = list(parts)
        if all(ring.is_one(term.denominator) for term in terms):
            return cls.whole(ring, ring.dot((term.numerator, ring.one) for term in terms))
        return reduce(add, terms)

    @classmethod
    def product(cls, ring: Ring, parts: Iterable[Quotient]) -> Quotient:
        factors = list(parts)
        return reduce(mul, factors) if factors else cls.whole(ring, ring.one)

    def __add__(self, other: Quotient) -> Quotient:
        # Without common denominators a/b + c/d is (a d + c b)/(b d), and its terms multiply.
        if self.denominator == other.denominator:
            return Quotient(self.ring, self.numerator + other.numerator, self.denominator)
        a, b = (self.numerator, self.denominator), (other.numerator, other.denominator)
        dot = self.ring.dot
        return Quotient(self.ring, dot(((a[0], b[1]), (b[0], a[1]))), dot(((a[1], b[1]),)))

    def __neg__(self) -> Quotient:
        return Quotient(self.ring, -self.numerator, self.denominator)

    def __sub__(self, other: Quotient) -> Quotient:
        return self + -other

    def __mul__(self, other: Quotient) -> Quotient:
        dot = self.ring.dot
        below, other_below = self.denominator, other.denominator
        if not self.ring.is_one(other_below):
            below = dot(((below, other_below),))
        return Quotient(self.ring, dot(((self.numerator, other.numerator),)), below)

    def __pow__(self, exponent: int) -> Quotient:
        base = self if exponent >= 0 else self.inverse()
        return Quotient.product(self.ring, [base] * abs(exponent))

    def inverse(self) -> Quotient:
        return Quotient(self.ring, self.denominator, self.numerator)

    def equals(self, other: Quotient) -> bool:
        """Whether both are the same function: the cross products agree in the ring."""
        if dict.__eq__(self.denominator, other.denominator):
            return dict.__eq__(self.numerator, other.numerator)  # normal forms
        # a/b = c/d exactly if a d − c b = 0. Neither quotient has to be in lowest terms.
        crossed = (self.numerator, other.denominator), (other.numerator, self.denominator)
        return not self.ring.dot(crossed[:1], minus=crossed[1:])


class _NormalForms(dict[Monomial, Terms | None]):
    """Normal forms of monomials, each worked out once, since reduction is linear in them.

    None where the monomial is its own normal form; `standard` are those met so far.
    """

    def __init__(self, rules: Sequence[Rule]) -> None:
        self.standard: set[Monomial] = set()
        self._rules = rules

    def __missing__(self, monomial: Monomial) -> Terms | None:
        # m = rest·leading becomes rest·tail. Each monomial of the tail comes before the leading one
        # in the monomial order, so the recursion ends. Any rule that divides m will do, by the
        # Gröbner property.
        for leading, needed, tail in self._rules:
            if all(monomial[place] >= power for place, power in needed):
                rest = tuple(map(sub, monomial, leading))
                result: Terms = {}
                for term, coefficient in tail.items():
                    product = tuple(map(add, rest, term))
                    form = self[product]
                    _add(result, coefficient, {product: 1} if form is None else form)
                self[monomial] = {m: c for m, c in result.items() if c}
                return self[monomial]
        self[monomial] = None
        self.standard.add(monomial)
        return None


def split(element: PolyElement, places: Sequence[int]) -> dict[Monomial, PolyElement]:
    """{powers of the generators at some places: what these powers multiply in the element}."""
    parts: dict[Monomial, Terms] = {}
    for monomial, coefficient in element.items():
        rest = list(monomial)
        for place in places:
            rest[place] = 0
        parts.setdefault(tuple(monomial[k] for k in places), {})[tuple(rest)] = coefficient
    return {powers: element.new(terms) for powers, terms in parts.items()}


def _powers(monomial: Monomial) -> list[tuple[int, int]]:
    """(place, power) of the generators that occur."""
    return [(place, power) for place, power in enumerate(monomial) if power]


def _add(total: Terms, coefficient: Any, terms: Terms) -> None:
    """Add a multiple of some terms to a total, in place."""
    for monomial, factor in terms.items():
        total[monomial] = total.get(monomial, 0) + coefficient * factor


_MOST_STEPS = 60  # of the walk to a shorter form, each of which tries every relation at every term
# longer sums become 2 to 5 % shorter, which takes seconds for each and helps nobody to read them
_MOST_TERMS = 300


@lru_cache(maxsize=4096)  # entries of one rotation return in its rates, and in other rotations
def shortest(ring: Ring, element: PolyElement) -> PolyElement:
    """A shortest polynomial found that equals `element` in the ring."""
    if element.is_ground or len(element) > _MOST_TERMS:
        return element
    # A walk in the residue class of the element: each step subtracts a multiple of a relation.
    # Steps to polynomials of equal length are allowed, since the way to a shorter one often leads
    # over them; `seen` keeps the walk from turning in circles.
    best = current = element
    least = length = (len(element), sum(map(sum, element)))  # the terms, then their degrees
    seen = {current}
    for _ in range(_MOST_STEPS):
        shorter = [n for n in _neighbours(ring, current, length) if n[0] <= length]
        shorter.sort(key=itemgetter(0))
        reduced = ((length, current - relation.mul_term(by)) for length, relation, by in shorter)
        fresh = next((neighbour for neighbour in reduced if neighbour[1] not in seen), None)
        if fresh is None:
            break
        length, current = fresh
        seen.add(current)
        if length < least:
            least, best = fresh
    return best


# the terms of a sum with their degrees, a relation, and the term that multiplies the relation
Neighbour = tuple[tuple[int, int], PolyElement, tuple[Monomial, object]]


def _neighbours(ring: Ring, element: PolyElement, length: tuple[int, int]) -> Iterator[Neighbour]:
    """Each polynomial in which one term was replaced by means of one relation, before it is made:
    its length, and the multiple of the relation that is to be subtracted.
    """
    # The multiple t·r of a relation r is chosen so that one of its terms cancels one of the
    # element.
    highest = tuple(map(max, zip(*element, strict=True)))
    for part, needed, factor, relation in ring.relation_terms:
        if any(highest[k] < power for k, power in needed):
            continue
        for monomial, coefficient in element.items():
            if any(monomial[k] < power for k, power in needed):
                continue
            times, rest = NUMBERS.quo(coefficient, factor), tuple(map(sub, monomial, part))
            count, degrees = length
            # The length of the difference is counted without building it, as only one neighbour is
            # used.
            for own, number in relation.items():
                changed = tuple(map(add, own, rest))
                before = element.get(changed)
                if before is None:
                    count, degrees = count + 1, degrees + sum(changed)
                elif before == number * times:
                    count, degrees = count - 1, degrees - sum(changed)
            yield (count, degrees), relation, (rest, times)
