"""The shortest of the polynomials that are equal modulo the relations.

A normal form is for deciding. For reading, 1 − c² is better written s², and w² + x² + y² + z²
better written 1: from the normal form, a walk over neighbours that differ by a multiple of one
relation, never to a longer one.
"""

from __future__ import annotations

from collections.abc import Iterator
from operator import sub

from sympy.polys.rings import PolyElement

from rigidsym.algebra.ring import Ring

_MOST_STEPS = 60


def shortest(ring: Ring, element: PolyElement) -> PolyElement:
    """A shortest polynomial found that equals `element` in the ring."""
    if element.is_ground:
        return element
    best = current = element
    seen = {current}
    for _ in range(_MOST_STEPS):
        fresh = [other for other in _neighbours(ring, current) if other not in seen]
        if not fresh:
            break
        fewest = min(map(len, fresh))  # degrees are added up of these alone
        candidate = min((other for other in fresh if len(other) == fewest), key=_length)
        if _length(candidate) > _length(current):
            break
        seen.add(candidate)
        current = candidate
        if _length(current) < _length(best):
            best = current
    return best


def _length(element: PolyElement) -> tuple[int, int]:
    """Terms first, then the degrees: what a reader counts."""
    return len(element), sum(sum(monomial) for monomial in element)


def _neighbours(ring: Ring, element: PolyElement) -> Iterator[PolyElement]:
    """Each polynomial in which one term was replaced by means of one relation."""
    domain = ring.polynomials.domain
    highest = tuple(map(max, zip(*element, strict=True)))
    for part, needed, factor, relation in ring.relation_terms:
        if any(highest[k] < power for k, power in needed):
            continue
        for monomial, coefficient in element.items():
            if any(monomial[k] < power for k, power in needed):
                continue
            times, left = domain.div(coefficient, factor)
            if not left:  # in Z a coefficient may not be divisible
                rest = tuple(map(sub, monomial, part))
                yield element - relation.mul_term((rest, times))
