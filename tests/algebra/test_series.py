"""The entire functions c_k of n²: coefficients, switches and bounds, and forms that hold them."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
import sympy as sp

from helpers.witness import mp
from rigidsym.algebra.codec import codec_for
from rigidsym.algebra.stable_forms import FIRST_SERIES, Stumpff, halved, rewriter_for, series_of
from rigidsym.models.library import rotation_from
from rigidsym.models.rotation import time_function
from rigidsym.motion import derive

ORDERS = range(FIRST_SERIES, 8)
X, Y, Z = map(time_function, "xyz")
NORM = sp.sqrt(X**2 + Y**2 + Z**2)


def exact(order: int, x) -> mp.mpf:
    """c_k by its integral over (1 − t)^{k−1}/(k−1)! cos nt, which the package does not use."""
    n = mp.sqrt(x)
    if order == 0:
        return mp.cos(n)
    weight = mp.factorial(order - 1)
    return mp.quad(lambda t: (1 - t) ** (order - 1) * mp.cos(n * t), [0, 1]) / weight


@pytest.mark.parametrize("order", ORDERS)
def test_what_the_series_leaves_out_is_within_its_bound(order):
    series = series_of(order)
    for part in (0, 0.1, 0.5, 0.9, 1):
        x = mp.mpf(series.switch.numerator) / series.switch.denominator * part
        terms = (mp.mpf(c.numerator) / c.denominator for c in series.coefficients)
        value = mp.fsum(term * x**j for j, term in enumerate(terms))
        truth = exact(order, x)
        bound = mp.mpf(series.remainder.numerator) / series.remainder.denominator
        assert abs(value - truth) <= bound * truth
        assert bound <= mp.mpf(2) ** -56


@cache
def module():
    return derive(rotation_from("rotation_vector")).kernels().load()


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
@pytest.mark.parametrize("order", range(6))
def test_arrays_and_floats_keep_the_bound_on_both_sides_of_the_switch(order, dtype):
    """Of c₀ to c₂ the bound is one of the largest value, 1/k!."""
    eps = float(np.finfo(dtype).eps)
    switch = float(series_of(max(order, FIRST_SERIES)).switch)
    sides = np.concatenate([np.linspace(0.97, 1, 12), np.linspace(1, 1.03, 12)]) * switch
    far = np.geomspace(1e-30, 200, 24)
    x = np.concatenate([[0.0], sides, far]).astype(dtype)
    bound = float(series_of(order).error) if order >= FIRST_SERIES else 4.0
    with np.errstate(all="ignore"):
        arrays = module()._entire(x, order)[0]
    assert arrays.dtype == dtype
    for square, value in zip(x.tolist(), arrays.tolist(), strict=True):
        truth = exact(order, mp.mpf(square))
        scale = truth if order >= FIRST_SERIES else 1 / mp.factorial(order)
        spread = 1 if order >= FIRST_SERIES else max(1, float(mp.sqrt(square)))
        assert abs(value - truth) <= bound * spread * eps * scale, square
        if dtype is np.float64:
            twin = module()._entire_scalar(square, order)[0]
            assert abs(twin - truth) <= bound * spread * eps * scale, square


def rewritten(expression: sp.Expr) -> sp.Expr | None:
    rewriter = rewriter_for(codec_for([sp.sin(NORM) / NORM, X]))
    assert rewriter is not None
    return rewriter.rewritten(expression)


@pytest.mark.parametrize(
    ("expression", "form"),
    [
        (sp.sin(NORM) / NORM, Stumpff(1, NORM**2)),
        ((1 - sp.cos(NORM)) / NORM**2, Stumpff(2, NORM**2)),
        ((NORM - sp.sin(NORM)) / NORM**3, Stumpff(3, NORM**2)),
        (X + sp.cos(NORM), X + Stumpff(0, NORM**2)),
        ((sp.sin(NORM) - NORM * sp.cos(NORM)) / NORM**3, Stumpff(2, NORM**2) - Stumpff(3, NORM**2)),
        (NORM * sp.sin(NORM) / (1 - sp.cos(NORM)), Stumpff(1, NORM**2) / Stumpff(2, NORM**2)),
    ],
    ids=str,
)
def test_removable_singularities_are_written_in_entire_functions(expression, form):
    assert rewritten(expression) == form


def test_a_divisor_of_one_minus_a_cosine_goes_over_to_half_the_angle():
    entries = [sp.sin(X) / (1 - sp.cos(X)), Y + 1, (1 - sp.cos(X)) * Y / (2 - 2 * sp.cos(X))]
    assert halved(entries, [sp.sin(X), Y]) == [sp.cot(X / 2), Y + 1, Y / 2]
    assert halved([sp.sin(X) / (1 + sp.cos(X))], [sp.sin(X)]) == [sp.tan(X / 2)]
    assert halved([1 / (2 + sp.cos(X))], [sp.sin(X)]) == [1 / (2 + sp.cos(X))]
    codec = codec_for([sp.sin(X / 2)])
    assert codec.encode_quotient(entries[0]).equals(codec.encode_quotient(sp.cot(X / 2)))
