"""Arguments of sine and cosine as rational combinations of atoms, over a common fraction.

sin(2φ − ψ/2) needs the generators of φ and ψ/2 alone: every sine and cosine is expanded over the
smallest fraction of each atom that occurs, so that cos 2θ and cos θ meet in one ring.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import lru_cache
from math import gcd, lcm

import sympy as sp

Combination = dict[sp.Expr, sp.Rational]


@lru_cache(maxsize=1024)
def combination(argument: sp.Expr) -> Combination:
    """{atom: rational coefficient} of an angle; the atom π carries a constant part."""
    terms = sp.expand(argument).as_coefficients_dict()
    return {atom: coefficient for atom, coefficient in terms.items() if coefficient}


def common_fractions(combinations: Iterable[Combination]) -> Combination:
    """For each atom, the largest fraction of which every coefficient is a whole multiple."""
    fractions: Combination = {}
    for terms in combinations:
        for atom, coefficient in terms.items():
            fractions[atom] = _common(fractions.get(atom, sp.Integer(0)), abs(coefficient))
    return {atom: fraction for atom, fraction in fractions.items() if atom is not sp.pi}


def _common(a: sp.Rational, b: sp.Rational) -> sp.Rational:
    return sp.Rational(gcd(int(a.p), int(b.p)), lcm(int(a.q), int(b.q)))
