"""Shorter forms of polynomials: by the relations, by sums of angles, by common factors.

1. `shortest`: a normal form is for deciding. For reading, 1 − c² is better written s², and
   w² + x² + y² + z² better written 1: from the normal form, a walk over neighbours that differ by
   a multiple of one relation, never to a longer one.
2. `folded`: cos α cos β − sin α sin β is written cos(α + β). Terms come in over the generators of a
   ring and leave over more places: after the generators stand, for every two angles, the cosine and
   sine of their sum and of their difference.
3. `collect`: common factors are taken out, in the order of what they save. Terms are Laurent
   monomials (a negative power divides); the result is a sum of products, each of which may hold a
   sum in turn.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from fractions import Fraction
from functools import reduce
from itertools import combinations
from math import gcd, lcm
from operator import add, itemgetter, sub
from typing import NamedTuple

import sympy as sp
from sympy.polys.rings import PolyElement

from rigidsym.algebra.generators import is_sum_of
from rigidsym.algebra.ring import Monomial, Ring

_MOST_STEPS = 60


def shortest(ring: Ring, element: PolyElement) -> PolyElement:
    """A shortest polynomial found that equals `element` in the ring."""
    if element.is_ground:
        return element
    best = current = element
    least = length = _length(element)
    seen = {current}
    for _ in range(_MOST_STEPS):
        shorter = [n for n in _neighbours(ring, current, length) if n.length <= length]
        shorter.sort(key=itemgetter(0))
        found = ((n.length, current - n.relation.mul_term(n.term)) for n in shorter)
        fresh = next((neighbour for neighbour in found if neighbour[1] not in seen), None)
        if fresh is None:
            break
        length, current = fresh
        seen.add(current)
        if length < least:
            least, best = fresh
    return best


def _length(element: PolyElement) -> tuple[int, int]:
    """The number of terms, then the sum of the degrees."""
    return len(element), sum(map(sum, element))


class Neighbour(NamedTuple):
    """What is left when a multiple of a relation is subtracted; made only where it is short."""

    length: tuple[int, int]
    relation: PolyElement
    term: tuple[Monomial, object]  # which multiplies the relation


def _neighbours(ring: Ring, element: PolyElement, length: tuple[int, int]) -> Iterator[Neighbour]:
    """Each polynomial in which one term was replaced by means of one relation."""
    domain = ring.polynomials.domain
    highest = tuple(map(max, zip(*element, strict=True)))
    for part, needed, factor, relation in ring.relation_terms:
        if any(highest[k] < power for k, power in needed):
            continue
        is_one = factor == domain.one
        for monomial, coefficient in element.items():
            if any(monomial[k] < power for k, power in needed):
                continue
            times, left = (coefficient, None) if is_one else domain.div(coefficient, factor)
            if left:  # in Z a coefficient may not be divisible
                continue
            rest = tuple(map(sub, monomial, part))
            count, degrees = length
            for own, number in relation.items():
                changed = tuple(map(add, own, rest))
                before = element.get(changed)
                if before is None:
                    count, degrees = count + 1, degrees + sum(changed)
                elif before == number * times:
                    count, degrees = count - 1, degrees - sum(changed)
            yield Neighbour((count, degrees), relation, (rest, times))


Angle = tuple[int, int]  # places of sine and cosine
Number = int | Fraction
FoldedTerms = dict[Monomial, Number]


class Rule(NamedTuple):
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


def folded(terms: Mapping[Monomial, Number], found: Iterable[Rule]) -> FoldedTerms:
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


def _fold_at(terms: FoldedTerms, monomial: Monomial, rule: Rule, place: int) -> None:
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
        terms[target] = terms.get(target, 0) + value


def _times(monomial: Monomial, places: Iterable[int], power: int) -> Monomial:
    changed = list(monomial)
    for place in places:
        changed[place] += power
    return tuple(changed)


Weights = Mapping[int, int]  # place of a generator -> operations that one use of it costs


class FactoredTerm(NamedTuple):
    """coefficient · generators^powers · (sum of the factors in `bracket`, where there is one)."""

    coefficient: Number
    powers: Monomial
    bracket: tuple[FactoredTerm, ...] = ()


def collect(terms: Mapping[Monomial, Number], weights: Weights) -> tuple[FactoredTerm, ...]:
    """The terms as a sum of products with common factors taken out."""
    factor = _best_factor(terms, weights) if len(terms) > 1 else None
    if factor is None:
        return tuple(FactoredTerm(coefficient, powers) for powers, coefficient in terms.items())
    place, sign = factor
    inside = {m: c for m, c in terms.items() if m[place] * sign > 0}
    outside = {m: c for m, c in terms.items() if m[place] * sign <= 0}
    return (_take_out(inside, weights), *(collect(outside, weights) if outside else ()))


def _best_factor(terms: Mapping[Monomial, Number], weights: Weights) -> tuple[int, int] | None:
    """(generator, sign of its power) that saves most, of those that occur in several terms.

    A term saves the factor where its lowest power takes all of it; what is taken out is written
    once. Ties go to the generator that comes first.
    """
    powers: dict[tuple[int, int], list[int]] = {}
    for monomial in terms:
        for place, power in enumerate(monomial):
            if power:
                powers.setdefault((place, 1 if power > 0 else -1), []).append(abs(power))
    savings = {
        key: (found.count(min(found)) - 1) * (weights[key[0]] + 1) for key, found in powers.items()
    }
    best = max(savings, key=lambda key: (savings[key], -key[0]), default=None)
    return best if best and savings[best] else None


def _take_out(terms: Mapping[Monomial, Number], weights: Weights) -> FactoredTerm:
    """All that the terms have in common, times what is left of them."""
    common = reduce(_common_powers, terms)
    number = _content(terms.values())
    rest = {
        tuple(map(sub, monomial, common)): coefficient if number == 1 else coefficient / number
        for monomial, coefficient in terms.items()
    }
    return FactoredTerm(number, common, collect(rest, weights))


def _common_powers(first: Monomial, second: Monomial) -> Monomial:
    """Powers that both hold, of one sign: numerators with numerators."""
    return tuple(
        (min(a, b) if a > 0 else max(a, b)) if a * b > 0 else 0
        for a, b in zip(first, second, strict=True)
    )


def _content(coefficients: Iterable[Number]) -> Fraction:
    """The common factor of the coefficients, negative where that leaves fewer minus signs."""
    values = list(coefficients)
    size = Fraction(
        gcd(*(abs(value.numerator) for value in values)),
        lcm(*(value.denominator for value in values)),
    )
    minuses = sum(value < 0 for value in values)
    return -size if minuses == len(values) else size
