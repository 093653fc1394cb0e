"""Sine, cosine and the angle of a point in targets that print their own: numbers, and 50 digits."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

import rigidsym as rs
from helpers.witness import mp
from rigidsym.kernels.lowering.trigonometry import arctangent, reduction, two_over_pi

# digits: bits of n quarter turns, short parts of π/2, coefficients of sine and cosine, of atan
KNOWN = {53: (21, 2, 6, 12), 24: (13, 3, 3, 5)}
EIGHTH = mp.pi / 4


def value(number: Fraction) -> mp.mpf:
    return mp.mpf(number.numerator) / number.denominator


def polynomial(coefficients: tuple[Fraction, ...], z: mp.mpf) -> mp.mpf:
    return mp.fsum(value(c) * z**k for k, c in enumerate(coefficients))


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
def test_polynomials_are_as_near_as_they_say(digits):
    turn, half = reduction(digits), arctangent(digits)
    for k in range(1, 60):
        r, t = EIGHTH * k / 59, (mp.sqrt(2) - 1) * k / 59
        z, bound = r * r, value(turn.error)
        assert abs((1 + z * polynomial(turn.sine, z)) * r / mp.sin(r) - 1) < bound
        assert abs((1 - z / 2 + z * z * polynomial(turn.cosine, z)) / mp.cos(r) - 1) < bound
        near = 1 + t * t * polynomial(half.coefficients, t * t)
        assert abs(near - mp.atan(t) / t) <= value(half.error) * mp.atan(t) / t
    assert float(half.error) < 2.0 ** (-digits - 2)
    high, low = half.eighth
    scale = mp.mpf(2) ** (digits - 3)
    assert mp.mpf(high) == mp.floor(EIGHTH * scale) / scale  # three bits are free for k
    assert low == float(EIGHTH - mp.mpf(high))


def test_two_over_pi_is_right_to_the_last_bit():
    assert two_over_pi()[:2] == (0, 0)  # before the point
    assert len(two_over_pi()) == 40
    with mp.workdps(420):
        number = sum(mp.mpf(2) ** (32 * (1 - k)) * word for k, word in enumerate(two_over_pi()))
        assert 0 <= 2 / mp.pi - number < mp.mpf(2) ** (-32 * 38)


def test_the_angle_of_a_point_is_within_one_and_a_half_eps():
    """In all octants and sizes, on the axes and diagonals, and where the formula changes."""
    pytest.importorskip("numba")
    angle_of = rs.derive("ZXZ").kernels("numba", conversions=True).load()._angle_of
    random = np.random.default_rng(3)
    points = random.normal(size=(1000, 2)) * 10.0 ** random.uniform(-15, 15, size=(1000, 2))
    edge = float(arctangent(53).edge) * (1 + np.linspace(-1e-7, 1e-7, 41))
    for near in np.concatenate([np.linspace(0, 1, 200), edge]):
        points = np.append(points, [[near, 1], [1, near], [-near, -1]], axis=0)
    for y, x in points.tolist():
        exact = mp.atan2(mp.mpf(y), mp.mpf(x))
        assert abs(mp.mpf(angle_of(y, x)) - exact) <= 1.5 * 2.0**-52 * abs(exact)
