"""The numbers of sine, cosine and the angle of a point: series, remainders and bits."""

from __future__ import annotations

from fractions import Fraction
from math import factorial

import pytest

from helpers.witness import mp
from rigidsym.kernels.lowering.trigonometry import arctangent, reduction, two_over_pi

# digits: bits of n quarter turns, short parts of π/2, coefficients of sine and cosine, of atan
KNOWN = {53: (21, 2, 6, 12), 24: (13, 3, 3, 5)}
EIGHTH = mp.pi / 4
NEAR = 1e-22  # the points are rounded to doubles


def value(number: Fraction) -> mp.mpf:
    return mp.mpf(number.numerator) / number.denominator


def polynomial(coefficients: tuple[Fraction, ...], z: mp.mpf) -> mp.mpf:
    return mp.fsum(value(c) * z**k for k, c in enumerate(coefficients))


def chebyshev_points(count: int, top: mp.mpf) -> list[mp.mpf]:
    """The zeros of the polynomial T_count, moved from (−1, 1) to (0, top)."""
    return [top * (1 + mp.cos(mp.pi * (2 * k - 1) / (2 * count))) / 2 for k in range(1, count + 1)]


@pytest.mark.parametrize("digits", KNOWN)
def test_pi_over_two_is_cut_into_parts_that_n_quarter_turns_multiply_exactly(digits):
    turns, short, _, _ = KNOWN[digits]
    found = reduction(digits)
    assert (found.turns, len(found.parts)) == (turns, short + 1)
    assert found.reach == float(2**turns * mp.pi / 2)
    rest = +mp.pi / 2
    for k, part in enumerate(found.parts):
        bits = digits - turns if k < short else digits
        last_bit = mp.mpf(2) ** (mp.floor(mp.log(rest, 2)) + 1 - bits)
        assert value(part) == mp.floor(rest / last_bit) * last_bit  # cut, not rounded
        rest -= value(part)


@pytest.mark.parametrize("digits", KNOWN)
def test_sine_and_cosine_agree_with_their_polynomials_in_chebyshevs_points(digits):
    _, _, terms, _ = KNOWN[digits]
    found, top = reduction(digits), (EIGHTH * 51 / 50) ** 2
    assert len(found.sine) == len(found.cosine) == terms
    for z in chebyshev_points(terms, top):
        r = mp.sqrt(z)
        assert mp.almosteq(polynomial(found.sine, z), (mp.sin(r) - r) / r**3, NEAR)
        assert mp.almosteq(polynomial(found.cosine, z), (mp.cos(r) - 1 + z / 2) / z**2, NEAR)


@pytest.mark.parametrize("digits", KNOWN)
def test_the_arctangent_agrees_with_its_polynomial_in_chebyshevs_points(digits):
    terms, found = KNOWN[digits][3], arctangent(digits)
    assert len(found.coefficients) == terms
    for z in chebyshev_points(terms, mp.mpf(17158) / 100000):
        t = mp.sqrt(z)
        assert mp.almosteq(polynomial(found.coefficients, z), (mp.atan(t) / t - 1) / z, NEAR)


@pytest.mark.parametrize("digits", KNOWN)
def test_the_errors_are_chebyshevs_remainder(digits):
    """Of n terms on (0, h): 2 (h/4)ⁿ times the first coefficient left out.

    z S and z A are h times as large at most; a sine is at least 25/28 of its angle, and an
    arctangent 50/53 of its quotient.
    """
    _, _, terms, more = KNOWN[digits]
    top = (EIGHTH * 51 / 50) ** 2
    remainder = top * 2 * (top / 4) ** terms / factorial(2 * terms + 3) * 28 / 25
    assert mp.almosteq(value(reduction(digits).error), remainder, 1e-30)
    top = mp.mpf(17158) / 100000
    remainder = top * 2 * (top / 4) ** more / (2 * more + 3) * 53 / 50
    assert mp.almosteq(value(arctangent(digits).error), remainder, 1e-30)


@pytest.mark.parametrize("digits", KNOWN)
def test_sine_and_cosine_are_as_near_as_they_say(digits):
    found = reduction(digits)
    for k in range(1, 60):
        r = EIGHTH * k / 59
        z, bound = r * r, value(found.error)
        assert abs((1 + z * polynomial(found.sine, z)) * r / mp.sin(r) - 1) < bound
        assert abs((1 - z / 2 + z * z * polynomial(found.cosine, z)) / mp.cos(r) - 1) < bound


@pytest.mark.parametrize("digits", KNOWN)
def test_the_arctangent_is_as_near_as_it_says(digits):
    found = arctangent(digits)
    for k in range(1, 60):
        t = (mp.sqrt(2) - 1) * k / 59
        near = 1 + t * t * polynomial(found.coefficients, t * t)
        assert abs(near - mp.atan(t) / t) <= value(found.error) * mp.atan(t) / t
    assert float(found.error) < 2.0 ** (-digits - 2)


@pytest.mark.parametrize("digits", KNOWN)
def test_an_eighth_of_a_turn_has_two_parts_and_four_of_the_first_are_exact(digits):
    high, low = arctangent(digits).eighth
    scale = mp.mpf(2) ** (digits - 3)
    assert mp.mpf(high) == mp.floor(EIGHTH * scale) / scale  # three bits are left for k
    assert low == float(EIGHTH - mp.mpf(high))


def test_two_over_pi_is_right_to_the_last_bit():
    assert two_over_pi()[:2] == (0, 0)  # before the point
    assert len(two_over_pi()) == 40
    with mp.workdps(420):
        number = sum(mp.mpf(2) ** (32 * (1 - k)) * word for k, word in enumerate(two_over_pi()))
        assert 0 <= 2 / mp.pi - number < mp.mpf(2) ** (-32 * 38)
