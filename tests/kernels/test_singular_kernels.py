"""Kernels at poles, near them and where a singularity is removable, against 50 digits."""

from __future__ import annotations

from functools import cache
from itertools import chain

import numpy as np
import pytest
import sympy as sp
from numpy.testing import assert_array_equal

from helpers.motions import derived
from helpers.target_modules import INVERSES, exact, worst_error
from helpers.witness import mp
from rigidsym.algebra.stable_forms import series_of
from rigidsym.models.library import rotation_from
from rigidsym.motion import derive

DTYPES = [np.float64, np.float32]
OMEGA = (0.7, -1.1, 0.4)


@cache
def kernels(name: str):
    return derive(rotation_from(name)).kernels().load()


def arguments_of(name: str, q, dtype) -> list[np.ndarray]:
    given = [np.asarray(q, dtype)]
    return given + ([np.array(OMEGA, dtype)] if name.startswith("rates") else [])


def both(functions, name: str, arguments: list[np.ndarray]) -> list[np.ndarray]:
    """The values of one orientation by arrays and, in double precision, by the twin."""
    found = [getattr(functions, name)(*(np.stack([a, a]) for a in arguments))[1]]
    assert found[0].dtype == arguments[0].dtype
    if arguments[0].dtype == np.float64:
        twin = getattr(functions, f"{name}_scalar")(*chain(*(a.tolist() for a in arguments)))
        found.append(np.array(twin))
    return found


def test_divisors_are_summed_in_one_thread():
    # from 10,001 values on, OpenBLAS takes several, which wait for one another
    functions, sizes = derive("ZXZ").kernels().load(), []

    class Counted(np.ndarray):
        def dot(self, other):
            sizes.append(self.size)
            return super().dot(other)

    usual = functions._or_nan
    functions._or_nan = lambda value, *others: usual(value.view(Counted), *others)
    for rows in (10_000, 30_000):
        q = np.full((rows, 3), 0.7)
        assert np.isfinite(functions.rates_from_angular_velocity_body(q, q)).all()
        functions.rates_from_angular_velocity_body(q, q, threads=2)
    assert max(sizes) == 10_000


def poles(sequence: str, dtype) -> list[float]:
    """Middle angles that round to a pole, computed in several ways."""
    is_proper = sequence[0] == sequence[2]
    turns = (0, 1, -1, 2, 7) if is_proper else (0.5, -0.5, 1.5, 2.5, -3.5)
    return [dtype(turn) * dtype(np.pi) for turn in turns]


def divides(entry: sp.Expr) -> bool:
    return bool(entry.atoms(sp.tan, sp.cot)) or sp.denom(sp.together(entry)).has(sp.sin, sp.cos)


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize("name", INVERSES)
def test_at_a_pole_what_is_divided_is_nan_and_nothing_else(sequence, name, dtype):
    expected = np.array([divides(entry) for entry in derived(sequence).step(name).expression])
    for pole in poles(sequence, dtype):
        for found in both(kernels(sequence), name, arguments_of(name, [0.3, pole, -0.7], dtype)):
            assert_array_equal(np.isnan(found.ravel()), expected)
            assert np.isfinite(found.ravel()[~expected]).all()


DISTANCES = [sign * 10.0**-power for power in range(1, 16, 2) for sign in (1, -1)]


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize("name", INVERSES)
def test_near_a_pole_the_error_is_a_few_eps_or_the_result_is_nan(sequence, name, dtype):
    """NaN exactly where the sine or cosine is within eps times the angle."""
    eps = float(np.finfo(dtype).eps)
    motion = derived(sequence)
    divisor = mp.sin if sequence[0] == sequence[2] else mp.cos
    for pole in poles(sequence, dtype)[:3]:
        for distance in DISTANCES:
            middle = dtype(pole + distance)
            arguments = arguments_of(name, [0.3, middle, -0.7], dtype)
            near = abs(divisor(mp.mpf(float(middle)))) / abs(mp.mpf(float(middle)))
            for found in both(kernels(sequence), name, arguments):
                if abs(near / eps - 1) > 1e-6:
                    assert np.isnan(found).any() == (near <= eps)
                if near > eps:
                    truth = exact(motion, name, [a[None] for a in arguments])
                    assert worst_error(found.astype(dtype), truth) <= 64, middle


def scale_of(name: str, rate, second, norm_of_inverse: float) -> float:
    """What errors are relative to: the sizes of what is multiplied, of order one where R is."""
    if "acceleration" in name:
        return float(np.linalg.norm(rate) ** 2 + np.linalg.norm(second))
    inverse = norm_of_inverse if name.startswith(("inverse", "rates")) else 1.0
    return inverse * (1.0 if "matrix" in name else float(np.linalg.norm(rate)))


SWITCHES = [float(series_of(order).switch) ** 0.5 for order in (3, 4, 5)]
SIDES = [switch * side for switch in SWITCHES for side in (1 - 1e-6, 1 + 1e-6)]
LENGTHS = [0, 1e-30, 1e-8, 1e-2, 1, *SIDES, np.pi, 6.28, 6.29, 9, 20]


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize("length", LENGTHS)
def test_the_rotation_vector_is_accurate_at_every_length(length, dtype):
    """Within 40 eps up to one radian (4 were measured); from there eps n, the rounding of n."""
    functions, motion = kernels("rotation_vector"), derive(rotation_from("rotation_vector"))
    random = np.random.default_rng(int(1000 * length))
    axes = [random.normal(size=3)] + [np.array([0, 1.0, 0])] * (length in (0, 1))
    for axis in axes:
        v = (length * axis / np.linalg.norm(axis)).astype(dtype)
        rate, second = random.normal(size=(2, 3)).astype(dtype)
        near = v if length else 1e-40 * axis  # the expressions are 0/0 at no turn at all
        given = {"q_dot": rate, "omega_space": rate, "omega_body": rate, "q_ddot": second}
        truths = {}
        with mp.workdps(200):
            for step in motion.steps:
                points = [a[None] for a in (near, *(given[n] for n in step.quantity.inputs[1:]))]
                truths[step.quantity.name] = exact(motion, step.quantity.name, points)
        norm = float(max(map(abs, truths["inverse_rate_matrix_space"][0])))
        for step in motion.steps:
            name, inputs = step.quantity.name, [v, *(given[n] for n in step.quantity.inputs[1:])]
            spread = max(1, length)
            if name.startswith(("inverse", "rates")) and length > 1:
                spread = length / abs(np.sin(length / 2))
            for found in both(functions, name, inputs):
                scale = scale_of(name, rate, second, norm)
                error = worst_error(found.astype(dtype), truths[name], [scale])
                assert error <= 40 * spread, (name, error, spread)


@pytest.mark.parametrize("angle", [0.0, 2 * np.pi, 1e-12, 1e-3, 1.0, 6.283])
def test_the_axis_is_undetermined_without_a_turn_and_accurate_beside_it(angle):
    """½ cot(φ/2) has the digits that sin φ/(1 − cos φ) loses."""
    functions, motion = kernels("axis_angle"), derive(rotation_from("axis_angle"))
    for name in INVERSES:
        given = arguments_of(name, [0.6, 0.0, 0.8, angle], float)
        for found in both(functions, name, given):
            if angle % (2 * np.pi) == 0:
                assert np.isnan(found).any()
                assert np.isfinite(found[3]).all()  # the rate of the angle is Ω along the axis
            else:
                assert worst_error(found, exact(motion, name, [a[None] for a in given])) <= 64


@pytest.mark.parametrize(
    ("dtype", "sizes"), [(np.float64, (0.0, 1e-200, 1e-150)), (np.float32, (0.0, 1e-30, 1e-17))]
)
def test_a_quaternion_that_is_zero_or_underflows_is_no_rotation(dtype, sizes):
    for size in sizes:
        q = (size * np.array([0.5, 0.5, -0.5, 0.5])).astype(dtype)
        for found in both(kernels("quaternion"), "rotation_matrix", [q]):
            assert np.isnan(found).all()
