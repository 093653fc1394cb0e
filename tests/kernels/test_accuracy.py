"""Errors of sines and of large angles, and what NaN and infinity give, in every target."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
import sympy as sp

import rigidsym as rs
from helpers.target_modules import EVERY, plain, row_by_row
from helpers.witness import evaluate, mp
from rigidsym.kernels.lowering.rounding import SINE
from rigidsym.kernels.targets import TARGETS

EPS = 2.0**-52
FEW = ("rotation_matrix", "angular_velocity_body", "rates_from_angular_velocity_space")


@cache
def few(*names: str) -> rs.Motion:
    return rs.derive("ZXZ", only=names or FEW)


@cache
def functions(target: str):
    """Name: the function on arrays, its results row by row."""
    module = few().kernels(target).load()
    return {name: row_by_row(target, getattr(module, name)) for name in FEW}


def inputs(name: str, count: int, size: float) -> list[np.ndarray]:
    source = np.random.default_rng(11)
    vectors = [few().argument(vector) for vector in few().step(name).quantity.inputs]
    sizes = [size, *[1.0] * (len(vectors) - 1)]
    return [source.uniform(-s, s, (count, 3)) for s in sizes]


# what the bounds rest on, and what a reader is told of large angles, NaN and infinity


@pytest.mark.parametrize("target", EVERY)
def test_sines_are_within_what_the_bounds_rest_on(target):
    turned = rs.derive("x(phi)", only=["rotation_matrix"]).kernels(target).load().rotation_matrix
    source = np.random.default_rng(12)
    angles = np.concatenate([source.uniform(-s, s, 400) for s in (4.0, 1e4, 1e15)])
    for dtype in (np.float64, np.float32)[: 1 + TARGETS[target].has_single]:
        given = angles.astype(dtype)
        found = row_by_row(target, turned)(given[:, np.newaxis])[:, [4, 7]]
        for angle, row in zip(given.tolist(), found.tolist(), strict=True):
            exact = mp.cos_sin(mp.mpf(angle))
            worst = max(abs(mp.mpf(x) - y) for x, y in zip(row, exact, strict=True))
            assert worst <= SINE * np.finfo(dtype).eps, angle


@pytest.mark.parametrize("size", [1e6, 1e15])
@pytest.mark.parametrize("target", EVERY)
def test_large_angles_are_right_or_refused(target, size):
    """Refused: where a sine that divides is at most eps times its angle, as the module says."""
    for name in FEW:
        step, arrays = few().step(name), inputs(name, 12, size)
        symbols = [s for vector in step.quantity.inputs for s in few().argument(vector).symbols]
        for row, *point in zip(functions(target)[name](*arrays), *arrays, strict=True):
            values = dict(zip(symbols, map(mp.mpf, np.concatenate(point).tolist()), strict=True))
            truth = list(evaluate(few().spelled(step.expression), values))
            if np.isnan(row).any():
                theta = mp.mpf(float(point[0][1]))
                assert abs(mp.sin(theta)) <= EPS * abs(theta)
                assert name.startswith("rates")
                continue
            worst = max(abs(mp.mpf(float(x)) - y) for x, y in zip(row, truth, strict=True))
            assert worst <= 20 * EPS * max(map(abs, truth)), name


@pytest.mark.parametrize("target", EVERY)
def test_what_depends_on_nan_or_an_infinite_angle_is_nan(target):
    for name in FEW:
        step, vectors = few().step(name), few().step(name).quantity.inputs
        cases = [
            (vector, place, bad)
            for vector in vectors
            for place in range(3)
            for bad in ((np.nan, np.inf, -np.inf) if vector == "q" else (np.nan,))
        ]
        arrays = [np.repeat(array, len(cases), axis=0) for array in inputs(name, 1, 1.0)]
        for row, (vector, place, bad) in enumerate(cases):
            arrays[vectors.index(vector)][row, place] = bad
        for found, (vector, place, bad) in zip(
            functions(target)[name](*arrays), cases, strict=True
        ):
            symbol = few().argument(vector).symbols[place]
            depends = [holds(entry, symbol) for entry in step.expression]
            assert np.isnan(found[depends]).all(), (name, symbol, bad)


def holds(entry: sp.Expr, symbol: sp.Expr) -> bool:
    """Whether an input stands in an expression; a coordinate does not stand in its rate."""
    plain = {rate: sp.Dummy() for rate in entry.atoms(sp.Derivative) - {symbol}}
    return entry.xreplace(plain).has(symbol)


@pytest.mark.parametrize("target", TARGETS)
def test_every_file_says_which_angles_are_accurate_and_what_nan_gives(target):
    angles = " ".join(few().kernels(target).files.values())
    sums = " ".join(rs.derive("z(2*phi-psi) x(theta)").kernels(target).files.values())
    none = " ".join(rs.derive("unit_quaternion").kernels(target).files.values())
    for text in (angles, sums, none):
        assert "makes every entry that depends on it NaN" in plain(text)
    assert "accurate for angles of any magnitude." in plain(angles)
    assert "If angles are added or multiplied before a sine is taken" in plain(sums)
    assert "angles of any magnitude" not in plain(none)
