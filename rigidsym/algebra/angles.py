"""Arguments of sine and cosine as rational combinations of atoms, over a common fraction.

Every sine and cosine is expanded over the smallest fraction of each angle that occurs, so that
cos 2θ and cos θ meet in one ring. Independent sums of coordinates are angles by themselves:
beside sin θ, sin(2φ − ψ/2) needs one pair of generators; beside sin φ, those of φ and ψ/2.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable
from fractions import Fraction
from functools import lru_cache, reduce
from math import gcd, lcm

import sympy as sp
from sympy.core.function import AppliedUndef

from rigidsym.errors import AlgebraError

Combination = dict[sp.Expr, sp.Rational]
_NEARLY_ZERO = 1e-20  # beyond which a number is not zero, and its polynomial need not be found


@lru_cache(maxsize=1024)
def combination(argument: sp.Expr) -> Combination:
    """{atom: rational coefficient} of an angle; the atom π carries a constant part.

    Quotients that cancel and numbers that are zero in disguise are gone from it.
    """
    terms = sp.expand(argument).as_coefficients_dict()
    if any(map(_is_quotient, terms)):
        terms = _cancelled(terms)
    for coefficient in terms.values():
        if not coefficient.is_Rational:
            raise not_exact(coefficient)
    found = {atom: coefficient for atom, coefficient in terms.items() if coefficient}
    return _without_zeros(found) if any(map(_has_root, found)) else found


def reduced(angle: sp.Expr) -> sp.Expr:
    """An angle without quotients that cancel and numbers that are zero; else as it is written."""
    terms = sp.expand(angle).as_coefficients_dict()
    if not any(_is_quotient(term) or _has_root(term) for term in terms):
        return angle
    found = combination(angle)
    if found == {term: c for term, c in terms.items() if c}:
        return angle
    return sp.Add(*(coefficient * term for term, coefficient in found.items()))


def is_sum_of(angle: sp.Expr, *parts: sp.Expr) -> bool:
    """Whether an angle is made of the atoms of its parts."""
    return set(combination(angle)) <= set().union(*map(combination, parts))


def _is_quotient(term: sp.Expr) -> bool:
    """Whether a term is divided by anything but a number."""
    powers = (factor for factor in sp.Mul.make_args(term) if factor.is_Pow)
    return any(p.exp.could_extract_minus_sign() and not p.base.is_number for p in powers)


def _cancelled(terms: Combination) -> Combination:
    """The terms with their quotients over one denominator, if that leaves fewer quotients."""
    quotients = {term: c for term, c in terms.items() if _is_quotient(term)}
    whole = sp.cancel(sp.Add(*(c * term for term, c in quotients.items())))
    above, below = sp.fraction(whole)
    again = sp.Add(*(term / below for term in sp.Add.make_args(sp.expand(above))))
    fewer = again.as_coefficients_dict()
    if sum(map(_is_quotient, fewer)) >= len(quotients):
        return terms
    rest = sp.Add(*(c * term for term, c in terms.items() if term not in quotients))
    return sp.Add(rest, again).as_coefficients_dict()


def _has_root(term: sp.Expr) -> bool:
    return any(f.is_number and not f.is_Rational and f is not sp.pi for f in sp.Mul.make_args(term))


def _without_zeros(terms: Combination) -> Combination:
    """The terms without multiples of one thing by numbers that add up to zero."""
    groups: dict[sp.Expr, Combination] = {}
    for term, coefficient in terms.items():
        number, rest = term.as_independent(*term.free_symbols, as_Add=False)
        groups.setdefault(rest if term.free_symbols else sp.S.One, {})[term] = coefficient * (
            number if term.free_symbols else term
        )
    kept = [group for group in groups.values() if not is_identically_zero(sp.Add(*group.values()))]
    return {term: terms[term] for group in kept for term in group}


def is_identically_zero(expression: sp.Expr) -> bool:
    """Whether an expression vanishes by expansion or, of algebraic numbers, by its polynomial."""
    if sp.expand(expression) == 0:
        return True
    if expression.has(sp.Function) and sp.expand(expression.rewrite(sp.exp)) == 0:
        return True
    if not expression.is_number or not expression.is_algebraic:
        return False
    return bool(
        abs(sp.N(expression, 30)) < _NEARLY_ZERO and sp.minimal_polynomial(expression).is_Symbol
    )


def angle_of(sine: sp.Expr, cosine: sp.Expr) -> sp.Expr:
    """The angle with a given sine and cosine; atan2 only if they name no angle themselves."""
    for sign_of_sine in (1, -1):
        for sign_of_cosine in (1, -1):
            first, second = sign_of_sine * sine, sign_of_cosine * cosine
            if first.func is sp.sin and second == sp.cos(first.args[0]):
                angle = sign_of_sine * sign_of_cosine * first.args[0]
                return angle if sign_of_cosine > 0 else angle + sp.pi
    return sp.atan2(sine, cosine)


def not_exact(number: sp.Float) -> AlgebraError:
    """The error for a floating-point number, with the fraction to write for it."""
    fraction = Fraction(str(number)).limit_denominator(10**12)
    return AlgebraError(
        f"{number} is a floating-point number; exact work needs a fraction such as {fraction}"
    )


def cosine_sine_of_pi(turns: sp.Rational) -> tuple[sp.Expr, sp.Expr]:
    """cos(turns·π) and sin(turns·π) by square roots; raises AlgebraError if there are none."""
    values = sp.cos(turns * sp.pi), sp.sin(turns * sp.pi)
    if any(value.has(sp.sin, sp.cos) for value in values):
        raise AlgebraError(
            f"cos and sin of {turns * sp.pi} are not square roots of numbers; "
            "give the angle a name instead"
        )
    return values


def common_fractions(combinations: Iterable[Combination]) -> Combination:
    """{angle: fraction}: each combination is a sum of whole multiples of fraction·angle.

    The angles are the combinations themselves if these are independent, or else their atoms.
    """
    given = [{a: c for a, c in terms.items() if a is not sp.pi} for terms in combinations]
    if any(len(terms) > 1 for terms in given):
        multiples = [_multiple(terms) for terms in given if terms]
        if _are_independent(set().union(*multiples)):
            given = multiples
    fractions: Combination = {}
    for terms in given:
        for angle, coefficient in terms.items():
            fractions[angle] = _common(fractions.get(angle, sp.Integer(0)), abs(coefficient))
    return fractions


def _multiple(terms: Combination) -> Combination:
    """{angle: coefficient}: the combination as a multiple of one sum of whole multiples."""
    unit = reduce(_common, map(abs, terms.values()), sp.Integer(0))
    angle = sp.Add(*(c / unit * atom for atom, c in terms.items()))
    return {-angle: -unit} if angle.could_extract_minus_sign() else {angle: unit}


def _are_independent(angles: Collection[sp.Expr]) -> bool:
    """Whether no rational combination of the angles vanishes and each sum is of coordinates."""
    atoms = {atom for angle in angles for atom in combination(angle)}
    sums = (atom for angle in angles if angle.is_Add for atom in combination(angle))
    if len(angles) > len(atoms) or not all(isinstance(atom, AppliedUndef) for atom in sums):
        return False
    return bool(coefficients(angles, atoms).rank() == len(angles))


def coefficients(angles: Iterable[sp.Expr], atoms: Collection[sp.Expr]) -> sp.Matrix:
    """A row for each angle: its coefficients, atom by atom."""
    return sp.Matrix([[combination(angle).get(atom, 0) for atom in atoms] for angle in angles])


def _common(a: sp.Rational, b: sp.Rational) -> sp.Rational:
    return sp.Rational(gcd(int(a.p), int(b.p)), lcm(int(a.q), int(b.q)))
