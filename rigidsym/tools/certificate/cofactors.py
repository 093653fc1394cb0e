"""The cofactors of a claim: how a polynomial that vanishes is a sum of multiples of relations."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import combinations

import sympy as sp
from sympy.polys.orderings import ProductOrder, grevlex
from sympy.polys.rings import PolyElement, PolyRing

from rigidsym.errors import CheckError
from rigidsym.tools.certificate.checker import Poly

Cofactors = dict[int, PolyElement]  # by the place of the relation
_KINDS = ("1/(", "sqrt(", "cos(", "sin(")  # the order of names; others come last
_MOST_PAIRS = 40  # of a Gröbner basis


class UnfinishedError(CheckError):
    """The search for cofactors was given up."""


class Division:
    """Division by the relations of one record, with its quotients.

    An inverse i of f is cleared first: P(i) = iᵏ N + C (i f − 1). Then N is divided by a Gröbner
    basis of the other relations, whose elements remember how they follow from these.
    """

    def __init__(self, relations: Sequence[Poly], polynomials: Iterable[Poly]) -> None:
        """`polynomials` are all that will be divided, for their names."""
        found = set().union(*(poly.names for poly in (*relations, *polynomials)))
        names = sorted(found, key=lambda name: (_kind(name), -len(name), name))
        self._place = {name: place for place, name in enumerate(names)}
        symbols = [f"x{place}" for place in range(len(names))]
        self._inverses: list[tuple[int, int, Poly]] = []
        roots = sum(_kind(name) < 2 for name in names)
        blocks = (grevlex, lambda powers: powers[:roots]), (grevlex, lambda powers: powers[roots:])
        order = ProductOrder(*blocks) if roots else grevlex
        self.ring = PolyRing(symbols, sp.QQ, order)
        self.names = names
        basis: list[tuple[PolyElement, Cofactors]] = []
        for place, relation in enumerate(relations):
            inverse = next(
                (n for n in relation.names if n == f"1/({relation.derivative(n)})"), None
            )
            if inverse is None:
                basis.append((self.element(relation), {place: self.ring.one}))
            else:
                self._inverses.append((self._place[inverse], place, relation.derivative(inverse)))
        self._inverses.sort(key=lambda found: found[0])
        self._basis = basis
        self._is_complete = False

    def element(self, poly: Poly) -> PolyElement:
        terms: dict[tuple[int, ...], sp.Rational] = {}
        for names, coefficient in poly.terms.items():
            powers = [0] * len(self.names)
            for name in names:
                powers[self._place[name]] += 1
            terms[tuple(powers)] = sp.QQ(coefficient.numerator, coefficient.denominator)
        return self.ring.from_dict(terms)

    def cofactors(self, poly: Poly) -> Cofactors:
        """Raises CheckError for a polynomial that is no sum of multiples of the relations."""
        rest, found, factor = self.element(poly), dict[int, PolyElement](), self.ring.one
        while rest:  # a root may hold an inverse, and bring it back
            before = rest
            for place, relation, divisor in self._inverses:
                power, rest, cofactor = self._cleared(rest, place, self.element(divisor))
                _add(found, factor, {relation: cofactor})
                factor = factor * self.ring.gens[place] ** power
            quotients, rest = self._divided(rest)
            for quotient, (_, combination) in zip(quotients, self._basis, strict=True):
                _add(found, factor * quotient, combination)
            if rest == before:
                if self._is_complete:
                    raise CheckError(f"no cofactors were found; {len(rest)} terms are left")
                self._basis, self._is_complete = _completed(self._basis), True
        return {place: cofactor for place, cofactor in sorted(found.items()) if cofactor}

    def _divided(self, element: PolyElement) -> tuple[list[PolyElement], PolyElement]:
        divisors = [divisor for divisor, _ in self._basis]
        return element.div(divisors) if element else ([element] * len(divisors), element)

    def _cleared(
        self, element: PolyElement, place: int, divisor: PolyElement
    ) -> tuple[int, PolyElement, PolyElement]:
        """(k, N, C) with P = iᵏ N + C (i f − 1) and no i in N."""
        parts: dict[int, PolyElement] = {}
        for powers, coefficient in element.items():
            rest = (*powers[:place], 0, *powers[place + 1 :])
            parts.setdefault(powers[place], self.ring.zero)[rest] = coefficient
        most, inverse = max(parts, default=0), self.ring.gens[place]
        cleared, cofactor = self.ring.zero, self.ring.zero
        for power, part in parts.items():
            cleared += part * divisor ** (most - power)
            for extra in range(most - power):
                cofactor -= part * inverse ** (power + extra) * divisor**extra
        return most, cleared, cofactor

    def terms(self, element: PolyElement) -> list[list[str | int]]:
        """Each term as its coefficient and the places of its names, as often as they occur."""
        return [
            [str(coefficient), *(place for place, n in enumerate(powers) for _ in range(n))]
            for powers, coefficient in sorted(element.items(), reverse=True)
        ]


def _kind(name: str) -> int:
    return next((k for k, start in enumerate(_KINDS) if name.startswith(start)), len(_KINDS))


def _completed(
    basis: list[tuple[PolyElement, Cofactors]],
) -> list[tuple[PolyElement, Cofactors]]:
    """The Gröbner basis, by Buchberger's algorithm."""
    pairs, count = list(combinations(range(len(basis)), 2)), 0
    while pairs:
        first, second = pairs.pop(0)
        (one, of_one), (two, of_two) = basis[first], basis[second]
        ring = one.ring
        lead, other = one.leading_expv(), two.leading_expv()
        common = ring.monomial_lcm(lead, other)
        if common == ring.monomial_mul(lead, other):
            continue
        count += 1
        if count > _MOST_PAIRS:
            raise UnfinishedError("there are too many conditions on the coordinates")
        up = ring.term_new(ring.monomial_div(common, lead), 1 / one.LC)
        down = ring.term_new(ring.monomial_div(common, other), -1 / two.LC)
        quotients, rest = (up * one + down * two).div([element for element, _ in basis])
        if not rest:
            continue
        found: Cofactors = {}
        _add(found, up, of_one)
        _add(found, down, of_two)
        for quotient, (_, combination) in zip(quotients, basis, strict=True):
            _add(found, -quotient, combination)
        pairs += [(place, len(basis)) for place in range(len(basis))]
        basis.append((rest, found))
    return basis


def _add(total: Cofactors, factor: PolyElement, combination: Cofactors) -> None:
    if factor:
        for place, cofactor in combination.items():
            total[place] = total.get(place, factor.ring.zero) + factor * cofactor
