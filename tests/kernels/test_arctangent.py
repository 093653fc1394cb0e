"""The angle of a point in the targets that print their own: against 50 digits, in every octant."""

from __future__ import annotations

import ctypes
import shutil
import subprocess

import numpy as np
import pytest

import rigidsym as rs
from helpers.target_modules import STRICT
from helpers.witness import mp
from rigidsym.kernels.lowering.trigonometry import arctangent

DIGITS = {"double": 53, "float": 24}
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
    y, x = random.normal(size=(2, 3000)) * 10.0 ** random.uniform(-15, 15, size=(2, 3000))
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
