"""Common factors are taken out, in the order of what they save.

Terms are Laurent monomials over the generators (a negative power divides), with coefficients.
The result is a sum of products, each of which may hold a sum in turn.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import reduce
from math import gcd, lcm

from rigidsym.algebra.ring import Monomial

Terms = Mapping[Monomial, Fraction]
Weights = Mapping[int, int]  # place of a generator -> operations that one use of it costs


@dataclass(frozen=True, slots=True)
class FactoredTerm:
    """coefficient · generators^powers · (sum of the factors in `bracket`, where there is one)."""

    coefficient: Fraction
    powers: Monomial
    bracket: tuple[FactoredTerm, ...] = ()


def collect(terms: Terms, weights: Weights) -> tuple[FactoredTerm, ...]:
    """The terms as a sum of products with common factors taken out."""
    factor = _best_factor(terms, weights) if len(terms) > 1 else None
    if factor is None:
        return tuple(FactoredTerm(coefficient, powers) for powers, coefficient in terms.items())
    place, sign = factor
    inside = {m: c for m, c in terms.items() if m[place] * sign > 0}
    outside = {m: c for m, c in terms.items() if m[place] * sign <= 0}
    return (_take_out(inside, weights), *(collect(outside, weights) if outside else ()))


def _best_factor(terms: Terms, weights: Weights) -> tuple[int, int] | None:
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


def _take_out(terms: Terms, weights: Weights) -> FactoredTerm:
    """All that the terms have in common, times what is left of them."""
    common = reduce(_common_powers, terms)
    number = _content(terms.values())
    rest = {
        tuple(a - b for a, b in zip(monomial, common, strict=True)): coefficient / number
        for monomial, coefficient in terms.items()
    }
    return FactoredTerm(number, common, collect(rest, weights))


def _common_powers(first: Monomial, second: Monomial) -> Monomial:
    """Powers that both hold, of one sign: numerators with numerators."""
    return tuple(
        (min(a, b) if a > 0 else max(a, b)) if a * b > 0 else 0
        for a, b in zip(first, second, strict=True)
    )


def _content(coefficients: Iterable[Fraction]) -> Fraction:
    """The common factor of the coefficients, negative where that leaves fewer minus signs."""
    values = list(coefficients)
    size = Fraction(
        gcd(*(abs(value.numerator) for value in values)),
        lcm(*(value.denominator for value in values)),
    )
    minuses = sum(value < 0 for value in values)
    return -size if minuses == len(values) else size
