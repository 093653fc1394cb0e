"""Cofactors: how a polynomial that vanishes under conditions is a sum of multiples of them."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

import sympy as sp
from sympy.polys.orderings import grevlex
from sympy.polys.rings import PolyElement, PolyRing

from rigidsym.errors import CheckError
from rigidsym.tools.certificate.checker import Poly

Cofactors = dict[int, PolyElement]  # by the position of the condition
_MOST_PAIRS = 40  # of a Gröbner basis


class UnfinishedError(CheckError):
    """The search for cofactors was given up."""


class Division:
    """Division by the conditions of one record, with its quotients.

    Cosines and roots are names too; their squares join the conditions. The elements of the Gröbner
    basis remember how they follow from these.
    """

    def __init__(self, conditions: Sequence[Poly], residuals: Sequence[Poly]) -> None:
        self._squares = (*conditions, *residuals)[0].ring.squares
        one = residuals[0].number(1)
        relations = [
            one.new(name) * one + square * one.number(-1) for name, square in self._squares.items()
        ]
        names = set().union(*(poly.names for poly in (*conditions, *residuals, *relations)))
        self._names = sorted(names, key=lambda name: ("(" not in name, -len(name), name))
        place = {name: k for k, name in enumerate(self._names)}
        self._place = place
        self._ring = PolyRing([f"x{k}" for k in range(len(place))], sp.QQ, grevlex)
        self._count = len(conditions)
        squares = [
            self._ring.gens[place[name]] ** 2 - self._element(square)
            for name, square in self._squares.items()
        ]
        elements = [*map(self._element, conditions), *squares]
        self._basis = [
            (element, {k: self._ring.one}) for k, element in enumerate(elements) if element
        ]
        self._is_complete = False

    def cofactors(self, residual: Poly) -> dict[str, str]:
        """Texts by the positions of conditions; their sum is *minus* the residual.

        Raises CheckError for a residual that does not vanish under the conditions.
        """
        rest = self._element(residual)
        quotients, remainder = self._divided(rest)
        if remainder and not self._is_complete:
            self._basis, self._is_complete = _completed(self._basis), True
            quotients, remainder = self._divided(rest)
        if remainder:
            raise CheckError(f"no cofactors were found; {len(remainder)} terms are left")
        sums: Cofactors = {}
        for quotient, (_, combination) in zip(quotients, self._basis, strict=True):
            _add(sums, -quotient, combination)
        return {str(k): self._text(sums[k]) for k in sorted(sums) if k < self._count and sums[k]}

    def _divided(self, element: PolyElement) -> tuple[list[PolyElement], PolyElement]:
        divisors = [divisor for divisor, _ in self._basis]
        return element.div(divisors) if element else ([element] * len(divisors), element)

    def _element(self, poly: Poly) -> PolyElement:
        terms: dict[tuple[int, ...], sp.Rational] = {}
        for names, coefficient in poly.terms.items():
            powers = [0] * len(self._names)
            for name in names:
                powers[self._place[name]] += 1
            terms[tuple(powers)] = sp.QQ(coefficient.numerator, coefficient.denominator)
        return self._ring.from_dict(terms)

    def _text(self, element: PolyElement) -> str:
        return " + ".join(
            "*".join(
                [f"({c})", *(f"{n}**{k}" for n, k in zip(self._names, powers, strict=True) if k)]
            )
            for powers, c in sorted(element.items(), reverse=True)
        )


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
        combination: Cofactors = {}
        _add(combination, up, of_one)
        _add(combination, down, of_two)
        for quotient, (_, of_divisor) in zip(quotients, basis, strict=True):
            _add(combination, -quotient, of_divisor)
        pairs += [(place, len(basis)) for place in range(len(basis))]
        basis.append((rest, combination))
    return basis


def _add(total: Cofactors, factor: PolyElement, combination: Cofactors) -> None:
    if factor:
        for place, cofactor in combination.items():
            total[place] = total.get(place, factor.ring.zero) + factor * cofactor
