"""A point at which all relations of a record hold, modulo a prime: they contradict nothing."""

from __future__ import annotations

import math
from collections.abc import Mapping
from fractions import Fraction
from random import Random

from rigidsym.errors import CheckError
from rigidsym.tools.certificate.checker import (
    ONE,
    PRIME,
    UNITS,
    Array,
    Language,
    Poly,
)

_TRIES = 99


def point_of(known: Language) -> dict[str, int]:
    """A value for each name in the relations; raises CheckError if none is found."""
    draw = Random(18)  # the same file every time
    starts = [_orthogonal(known), {}] if len(known.groups["q"]) == 9 else [{}]
    for start in starts * _TRIES:
        at = dict(start)
        if all(_satisfied(relation, known, at, draw) for relation in known.relations.values()):
            return at
    raise CheckError("no point was found at which all relations hold")


def _satisfied(relation: Poly, known: Language, at: dict[str, int], draw: Random) -> bool:
    """Choose values for names that have none, so that the relation holds; whether some exist."""
    order = list(known.flow)
    free = [name for name in relation.names if name not in at]
    if not free:
        return residue(relation, at) == 0
    *letters, last = sorted(free, key=lambda n: (order.index(n) if n in order else -1, n))
    for _ in range(_TRIES if letters else 1):
        at |= {name: draw.randrange(PRIME) for name in letters}
        root = _solved(relation, last, at)
        if root is not None:
            at[last] = root
            return True
    return False


def _orthogonal(known: Language) -> dict[str, int]:
    """Nine entries of a rotation, and of dR/dt = R C(Ω′) and its derivative."""
    v, omega, alpha = (
        Array([ONE * k] for k in entries).hat() for entries in ((1, 2, 3), (2, 3, 5), (7, 1, 4))
    )
    R = UNITS + (v + v * v) * Fraction(2, 15)  # of the quaternion 1 + (1, 2, 3)
    return {
        name: residue(entry, {})
        for group, matrix in (
            ("q", R),
            ("q_dot", R * omega),
            ("q_ddot", R * (omega * omega + alpha)),
        )
        for name, entry in zip(known.groups[group], matrix.entries, strict=True)
    }


def _solved(relation: Poly, name: str, at: Mapping[str, int]) -> int | None:
    """The value of a name that comes up to the second power, if there is one."""
    slope = relation.derivative(name)
    zero = {**at, name: 0}
    a = residue(slope.derivative(name), at) * pow(2, -1, PRIME) % PRIME
    b, c = residue(slope, zero), residue(relation, zero)
    if a == 0:
        return -c * pow(b, -1, PRIME) % PRIME if b else None
    square = (b * b - 4 * a * c) % PRIME
    root = pow(square, (PRIME + 1) // 4, PRIME)  # the prime is 3 modulo 4
    return (root - b) * pow(2 * a, -1, PRIME) % PRIME if root * root % PRIME == square else None


def residue(poly: Poly, at: Mapping[str, int]) -> int:
    """The value at a point, modulo the prime."""
    terms = ((c.numerator * pow(c.denominator, -1, PRIME), m) for m, c in poly.terms.items())
    return sum(math.prod((at[n] for n in m), start=c) for c, m in terms) % PRIME
