"""Sine, cosine and the angle of a point in targets that print their own: numbers, and 50 digits."""

from __future__ import annotations

import numpy as np
import pytest

import rigidsym as rs
from helpers.witness import mp
from rigidsym.kernels.targets.precision import DOUBLE, SINGLE, numbers, two_over_pi

# bits of the significand and of n quarter turns, and short parts of π/2
KNOWN = [(DOUBLE, 53, 21, 2), (SINGLE, 24, 13, 3)]
EIGHTH = mp.pi / 4


def polynomial(literals, z):
    """The value of a printed polynomial, its highest power first."""
    return mp.polyval([mp.mpf(literal.rstrip("f")) for literal in literals], z)


@pytest.mark.parametrize(("precision", "digits", "turns", "short"), KNOWN)
def test_numbers_are_as_exact_as_the_type_and_parts_are_multiplied_exactly(
    precision, digits, turns, short
):
    known = numbers(precision)
    assert len(known["parts"]) == short + 1
    assert known["reach"] == f"{float(2**turns * mp.pi / 2):.0f}"
    rest = +mp.pi / 2
    for k, part in enumerate(known["parts"]):
        bits = digits - turns if k < short else digits
        last_bit = mp.mpf(2) ** (mp.floor(mp.log(rest, 2)) + 1 - bits)
        assert part == mp.floor(rest / last_bit) * last_bit  # cut, not rounded
        rest -= part
    sines, cosines = zip(known["first"], *known["rest"], strict=True)
    most = mp.mpf(2) ** (-digits - 1)
    for k in range(1, 60):
        r, t = EIGHTH * k / 59, (mp.sqrt(2) - 1) * k / 59
        z = r * r
        assert abs((1 + z * polynomial(sines, z)) * r / mp.sin(r) - 1) < most
        assert abs((1 - z / 2 + z * z * polynomial(cosines, z)) / mp.cos(r) - 1) < most
        near = 1 + t * t * polynomial(known["arctangent"], t * t)
        assert abs(near * t / mp.atan(t) - 1) < most
    high, low = (float(literal.rstrip("f")) for literal in known["eighth"])
    scale = mp.mpf(2) ** (digits - 3)
    assert high == mp.floor(EIGHTH * scale) / scale  # three bits are free for k
    assert low == float(EIGHTH - high)


def test_two_over_pi_is_right_to_the_last_bit():
    assert two_over_pi()[:2] == [0, 0]  # before the point
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
    edge = float(numbers(DOUBLE)["edge"]) * (1 + np.linspace(-1e-7, 1e-7, 41))
    for near in np.concatenate([np.linspace(0, 1, 200), edge]):
        points = np.append(points, [[near, 1], [1, near], [-near, -1]], axis=0)
    for y, x in points.tolist():
        exact = mp.atan2(mp.mpf(y), mp.mpf(x))
        assert abs(mp.mpf(angle_of(y, x)) - exact) <= 1.5 * 2.0**-52 * abs(exact)
