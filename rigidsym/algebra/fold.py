"""Angle sums folded: cos α cos β − sin α sin β is written cos(α + β).

Terms come in over the generators of a ring and leave over more places: after the generators stand,
for every two angles, the cosine and sine of their sum and of their difference.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import combinations

import sympy as sp

from rigidsym.algebra.angles import is_sum_of
from rigidsym.algebra.ring import Monomial

Angle = tuple[int, int]  # places of sine and cosine
Terms = dict[Monomial, Fraction]


@dataclass(frozen=True, slots=True)
class Rule:
    """first + sign · second = function(alpha ± beta), for products of two generators."""

    first: tuple[int, int]
    second: tuple[int, int]
    sign: int
    function: type[sp.sin] | type[sp.cos]
    angles: tuple[sp.Expr, sp.Expr]  # α and ±β

    @property
    def folded(self) -> sp.Expr:
        """The function of the sum; SymPy takes long to make one, and few are ever needed."""
        return self.function(sp.Add(*self.angles))


def rules(angles: Sequence[Angle], expressions: Sequence[sp.Expr]) -> tuple[Rule, ...]:
    """The addition theorems of every two angles."""
    return tuple(rule for a, b in combinations(angles, 2) for rule in _of_two(a, b, expressions))


def _of_two(a: Angle, b: Angle, expressions: Sequence[sp.Expr]) -> Iterator[Rule]:
    alpha, beta = expressions[a[0]].args[0], expressions[b[0]].args[0]
    if not is_sum_of(alpha + beta, alpha, beta):
        return  # the angles cancel in part, and the ring has other generators for their sum
    (s, c), (sine, cosine) = a, b
    plus, minus = (alpha, beta), (alpha, -beta)
    yield Rule((c, cosine), (s, sine), -1, sp.cos, plus)
    yield Rule((c, cosine), (s, sine), 1, sp.cos, minus)
    yield Rule((s, cosine), (c, sine), 1, sp.sin, plus)
    yield Rule((s, cosine), (c, sine), -1, sp.sin, minus)


def folded(terms: Mapping[Monomial, Fraction], found: Iterable[Rule]) -> Terms:
    """The terms with each pair of an addition theorem made one.

    Places for all rules are added, unless no rule can apply.
    """
    if len(terms) < 2:
        return dict(terms)
    found = tuple(found)
    highest = tuple(map(max, zip(*terms, strict=True)))
    present = {place for place, power in enumerate(highest) if power > 0}
    may = [
        (place, rule)
        for place, rule in enumerate(found, start=len(highest))
        if present.issuperset(rule.first) and present.issuperset(rule.second)
    ]
    if not may:
        return dict(terms)
    result = {(*monomial, *[0] * len(found)): value for monomial, value in terms.items()}
    for place, rule in may:
        for monomial in list(result):
            _fold_at(result, monomial, rule, place)
    return result


def _fold_at(terms: Terms, monomial: Monomial, rule: Rule, place: int) -> None:
    """Fold the pair that this monomial begins, if its other half is there."""
    a, b = rule.first
    if monomial not in terms or monomial[a] < 1 or monomial[b] < 1:
        return
    rest = _times(monomial, rule.first, -1)
    other = _times(rest, rule.second, 1)
    if terms.get(other) == rule.sign * terms[monomial]:
        value = terms.pop(monomial)
        del terms[other]
        target = _times(rest, (place,), 1)
        terms[target] = terms.get(target, Fraction(0)) + value


def _times(monomial: Monomial, places: Iterable[int], power: int) -> Monomial:
    changed = list(monomial)
    for place in places:
        changed[place] += power
    return tuple(changed)
