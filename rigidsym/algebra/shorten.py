"""The shortest of the polynomials that are equal modulo the relations.

A normal form is for deciding. For reading, 1 − c² is better written s², and w² + x² + y² + z²
better written 1: from the normal form, a walk over neighbours that differ by a multiple of one
relation, never to a longer one.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
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
        candidate = _shortest_outside(seen, list(_neighbours(ring, current)))
        if candidate is None or _length(candidate) > _length(current):
            break
        seen.add(candidate)
        current = candidate
        if _length(current) < _length(best):
            best = current
    return best


def _shortest_outside(seen: set[PolyElement], found: Sequence[PolyElement]) -> PolyElement | None:
    """The first of the shortest that are not in the set; only these are looked up and added up."""
    for count in sorted(set(map(len, found))):
        short = sorted((element for element in found if len(element) == count), key=_length)
        fresh = next((element for element in short if element not in seen), None)
        if fresh is not None:
            return fresh
    return None


def _length(element: PolyElement) -> tuple[int, int]:
    """The number of terms, then the sum of the degrees."""
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
