"""Arguments of sine and cosine as rational combinations of atoms, over a common fraction.

sin(2φ − ψ/2) needs the generators of φ and ψ/2 alone: every sine and cosine is expanded over the
smallest fraction of each atom that occurs, so that cos 2θ and cos θ meet in one ring.
"""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction
from functools import lru_cache
from math import gcd, lcm

import sympy as sp

from rigidsym.errors import AlgebraError

Combination = dict[sp.Expr, sp.Rational]


@lru_cache(maxsize=1024)
def combination(argument: sp.Expr) -> Combination:
    """{atom: rational coefficient} of an angle; the atom π carries a constant part."""
    terms = sp.expand(argument).as_coefficients_dict()
    for coefficient in terms.values():
        if not coefficient.is_Rational:
            raise not_exact(coefficient)
    return {atom: coefficient for atom, coefficient in terms.items() if coefficient}


def not_exact(number: sp.Float) -> AlgebraError:
    """The error for a floating-point number, with the fraction to write for it."""
    fraction = Fraction(str(number)).limit_denominator(10**12)
    return AlgebraError(
        f"{number} is a floating-point number; exact work needs a fraction such as {fraction}"
    )


def cosine_sine_of_pi(turns: sp.Rational) -> tuple[sp.Expr, sp.Expr]:
    """cos(turns·π) and sin(turns·π) by square roots; raises AlgebraError where there are none."""
    values = sp.cos(turns * sp.pi), sp.sin(turns * sp.pi)
    if any(value.has(sp.sin, sp.cos) for value in values):
        raise AlgebraError(
            f"cos and sin of {turns * sp.pi} are not square roots of numbers; "
            "give the angle a name instead"
        )
    return values


def common_fractions(combinations: Iterable[Combination]) -> Combination:
    """For each atom, the largest fraction of which every coefficient is a whole multiple."""
    fractions: Combination = {}
    for terms in combinations:
        for atom, coefficient in terms.items():
            fractions[atom] = _common(fractions.get(atom, sp.Integer(0)), abs(coefficient))
    return {atom: fraction for atom, fraction in fractions.items() if atom is not sp.pi}


def _common(a: sp.Rational, b: sp.Rational) -> sp.Rational:
    return sp.Rational(gcd(int(a.p), int(b.p)), lcm(int(a.q), int(b.q)))
