"""The Stumpff functions c_k of n², on which rotation vectors rest, and their derived series.

c₀ = cos n, c₁ = sin n/n, c₂ = (1 − cos n)/n², c₃ = (n − sin n)/n³, and on by
c_{k+2} = (c_k(0) − c_k)/n². Their closed forms are 0/0 at n = 0 and lose digits near it; from
c₃ on, a Taylor polynomial in x = n² takes over below a switch. Its coefficients follow from
SymPy's series of sine and cosine over Q, its length from the first term left out (the terms
alternate and fall), and the switch from the rounding of the closed form, in rational numbers.
"""

from __future__ import annotations

from fractions import Fraction
from functools import cache
from typing import NamedTuple

import sympy as sp
from sympy.polys.ring_series import rs_cos, rs_sin

_EPS = Fraction(1, 2**52)  # of float64; a shorter type needs no more terms
_LEFT_OUT = _EPS / 16  # of the value: the most that the first term left out may be
_CLOSED = Fraction(4)  # eps: the largest rounding error of a closed form above its switch
_ELEMENTARY = Fraction(3)  # eps: of c₁ and c₂ by t = tan(n/2) within 1 eps, see `_closed_error`
_STEP = Fraction(1, 4)
_FURTHEST = 16  # x = n²: switches beyond gain nothing, and Horner's rule would lose
_DEGREE = 40  # of the Taylor polynomials of sine and cosine in n
FIRST_SERIES = 3  # c₀, c₁ and c₂ need none


class Series(NamedTuple):
    """c_k below its switch: Σ coefficients[j] x^j, x = n² < switch."""

    order: int  # k
    coefficients: tuple[Fraction, ...]
    switch: Fraction  # in x
    remainder: Fraction  # bound on what the series leaves out, relative to c_k
    error: Fraction  # bound on the relative error on both sides of the switch, in eps


@cache
def series_of(order: int) -> Series:
    """The series of c_k, k ≥ 3, with its switch and its bounds, derived."""
    switch, closed = _switch(order)
    value = _enclosed(order, switch)[0]
    terms = taylor(order)
    left_out = (abs(term) * switch**place / value for place, term in enumerate(terms))
    length = next(place for place, size in enumerate(left_out) if size <= _LEFT_OUT)
    remainder = abs(terms[length]) * switch**length / value
    horner = _horner(terms[:length], switch) / value
    return Series(
        order=order,
        coefficients=terms[:length],
        switch=switch,
        remainder=remainder,
        error=max(closed, horner + remainder / _EPS),
    )


@cache
def taylor(order: int) -> tuple[Fraction, ...]:
    """The Taylor coefficients of c_k in x = n², exact, from those of sine and cosine."""
    ring, n = sp.ring("n", sp.QQ)
    whole = (rs_sin if order % 2 else rs_cos)(n, n, _DEGREE)
    powers = range(order % 2, _DEGREE, 2)
    terms = [whole.coeff(n**power if power else ring.one) for power in powers]
    sign = -1 if (order // 2) % 2 else 1  # each step to c_{k+2} drops a term and turns the signs
    return tuple(
        sign * Fraction(int(term.numerator), int(term.denominator)) for term in terms[order // 2 :]
    )


def closed_form(order: int, angle: sp.Expr) -> sp.Expr:
    """c_k of an angle n in sines and cosines."""
    if order < 2:
        return sp.sin(angle) / angle if order else sp.cos(angle)
    first = taylor(order - 2)[0]
    start = sp.Rational(first.numerator, first.denominator)
    return (start - closed_form(order - 2, angle)) / angle**2


@cache
def _switch(order: int) -> tuple[Fraction, Fraction]:
    """The least x from which on the closed form keeps its bound, and its error there in eps."""
    x = _STEP
    while x < _FURTHEST:
        error = _closed_error(order, x)
        if error <= _CLOSED:
            return x, error
        x += _STEP
    return x, _closed_error(order, x)


def _closed_error(order: int, x: Fraction) -> Fraction:
    """Bound on the relative rounding error of (c_k(0) − c_k)/x from x on, in eps.

    c_k comes with an error of its own, which counts by its share of the difference; to the right
    of x that share is smaller still, since c_k is. c₁ = 2t/(1 + t²)/n has four roundings of half an
    eps and an error of t that is multiplied by (1 − t²)/(1 + t²); c₂ = 2t²/(1 + t²)/n² one more,
    and the error of t times 2/(1 + t²), at most one where c₂ has a share, n > π/2.
    """
    before, above = taylor(order - 2)[0], _enclosed(order - 2, x)[1]
    inherited = series_of(order - 2).error if order - 2 >= FIRST_SERIES else _ELEMENTARY
    return inherited * above / (before - above) + 1  # the difference and the quotient


def _enclosed(order: int, x: Fraction) -> tuple[Fraction, Fraction]:
    """Bounds on c_k(x): neighbouring partial sums of an alternating series."""
    total = Fraction(0)
    sums = [total := total + term * x**place for place, term in enumerate(taylor(order))]
    return min(sums[-2:]), max(sums[-2:])


def _horner(terms: tuple[Fraction, ...], x: Fraction) -> Fraction:
    """Bound on the rounding error of Horner's rule, in eps: each term by its own roundings."""
    roundings = (2 * place + 2 for place in range(len(terms)))
    sizes = (abs(term) * x**place for place, term in enumerate(terms))
    return sum((n * size for n, size in zip(roundings, sizes, strict=True)), Fraction(0)) / 2
