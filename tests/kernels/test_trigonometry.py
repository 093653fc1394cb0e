"""Sine, cosine and the angle of a point in targets that print their own: numbers, and 50 digits."""

from __future__ import annotations

import ctypes
import shutil
import subprocess
from fractions import Fraction

import numpy as np
import pytest

import rigidsym as rs
from helpers.target_modules import STRICT
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


WRAPPER = """
#include "euler_zxz_intrinsic.c"
void every_double(int n, const double *y, const double *x, double *out);
void every_float(int n, const float *y, const float *x, float *out);
void every_double(int n, const double *y, const double *x, double *out)
{
    for (int k = 0; k < n; k++) out[k] = angle_of(y[k], x[k]);
}
void every_float(int n, const float *y, const float *x, float *out)
{
    for (int k = 0; k < n; k++) out[k] = angle_of_FLOAT(y[k], x[k]);
}
""".replace("angle_of_FLOAT", "angle_off")


def points(dtype: type) -> tuple[np.ndarray, np.ndarray]:
    """Points of all octants and sizes, on the axes and diagonals, and where the formula changes."""
    random = np.random.default_rng(3)
    y, x = random.normal(size=(2, 1000)) * 10.0 ** random.uniform(-15, 15, size=(2, 1000))
    edge = float(arctangent(53).edge) * (1 + np.linspace(-1e-7, 1e-7, 41))
    near = np.concatenate([np.linspace(0, 1, 200), edge])
    y = np.concatenate([y, near, np.ones_like(near), -near])
    x = np.concatenate([x, np.ones_like(near), near, -np.ones_like(near)])
    return y.astype(dtype), x.astype(dtype)


def error(found: np.ndarray, y: np.ndarray, x: np.ndarray) -> float:
    """The largest relative error, in eps of the type."""
    exact = [mp.atan2(mp.mpf(float(a)), mp.mpf(float(b))) for a, b in zip(y, x, strict=True)]
    misses = [abs(mp.mpf(float(f)) - e) / abs(e) for f, e in zip(found, exact, strict=True) if e]
    return float(max(misses) / mp.mpf(float(np.finfo(found.dtype).eps)))


@pytest.mark.campaign
@pytest.mark.skipif(not shutil.which("gcc"), reason="no gcc")
@pytest.mark.parametrize("optimised", ["-O0", "-O3"])
@pytest.mark.parametrize("name", ["double", "float"])
def test_c_within_one_and_a_half_eps(tmp_path, name, optimised):
    rs.derive("ZXZ").kernels("c", conversions=True).write(tmp_path)
    (tmp_path / "wrapped.c").write_text(WRAPPER, encoding="utf-8")
    flags = (*STRICT, "-Wno-unused-function", optimised, "-fPIC", "-shared")
    built = tmp_path / "wrapped.so"
    subprocess.run(["gcc", *flags, tmp_path / "wrapped.c", "-o", built, "-lm"], check=True)
    dtype = {"double": np.float64, "float": np.float32}[name]
    y, x = points(dtype)
    found = np.empty_like(y)
    pointers = [ctypes.c_void_p(array.ctypes.data) for array in (y, x, found)]
    getattr(ctypes.CDLL(str(built)), f"every_{name}")(len(y), *pointers)
    assert error(found, y, x) < 1.5
    assert found[(y == 0) & (x > 0)].max() == 0


def test_numba_within_one_and_a_half_eps():
    pytest.importorskip("numba")
    module = rs.derive("ZXZ").kernels("numba", conversions=True).load()
    y, x = points(np.float64)
    found = np.array([module._angle_of(a, b) for a, b in zip(y.tolist(), x.tolist(), strict=True)])
    assert error(found, y, x) < 1.5
