"""Generated NumPy functions are true: SciPy, numerical derivatives and 50 digits say so."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from scipy.spatial.transform import Rotation

import rigidsym as rs
from helpers.errors_of_kernels import angles_of_all_sizes, exactly, worst_error
from helpers.kernel_modules import EPS, QUANTITIES, inputs, module, one_by_one
from helpers.motions import derived
from helpers.witness import derivative, paths, rotation, unhat
from rigidsym.kernels.module import generate


def as_array(matrix) -> np.ndarray:
    array = np.array(matrix.tolist(), dtype=float)
    return array[:, 0] if array.shape[1] == 1 else array


def test_rotation_matrix_is_scipys(sequence):
    q = inputs("rotation_matrix", (50,))[0]
    assert_allclose(
        module(sequence).rotation_matrix(q),
        Rotation.from_euler(sequence, q).as_matrix(),
        atol=4 * EPS,
    )


def test_passive_rotation_matrix_is_the_transpose(sequence):
    passive = generate(derived(sequence, passive=True)).load()
    q = inputs("rotation_matrix")[0]
    expected = Rotation.from_euler(sequence, q).inv().as_matrix()
    assert_allclose(passive.rotation_matrix(q), expected, atol=4 * EPS)


def test_velocities_and_accelerations_are_those_of_the_numerical_derivative(sequence):
    (path,) = paths(1, seed=7)
    turned, rate, second = (
        derivative(lambda t: rotation(sequence, path.at(t)), order) for order in range(3)
    )
    spin = rate * turned.T
    omega = unhat(spin)
    alpha = unhat(second * turned.T + rate * rate.T)
    expected = {
        "rotation_rate": rate,
        "spin_matrix": spin,
        "angular_velocity_space": omega,
        "angular_velocity_body": turned.T * omega,
        "angular_acceleration_space": alpha,
        "angular_acceleration_body": turned.T * alpha,
    }
    q, q_dot, q_ddot = (np.array(c, float) for c in (path.q, path.q_dot, path.q_ddot))
    for name, value in expected.items():
        arguments = (q, q_dot, q_ddot)[: len(QUANTITIES[name][0])]
        found = getattr(module(sequence), name)(*arguments)
        assert_allclose(found, as_array(value), rtol=0, atol=1e-14, err_msg=name)


def test_rates_come_back_from_the_velocity(sequence):
    q, q_dot = inputs("angular_velocity_space", (50,))
    functions = module(sequence)
    for frame in ("space", "body"):
        omega = getattr(functions, f"angular_velocity_{frame}")(q, q_dot)
        rates = getattr(functions, f"rates_from_angular_velocity_{frame}")(q, omega)
        assert_allclose(rates, q_dot, rtol=1e-10, atol=1e-10)
        matrix = getattr(functions, f"rate_matrix_{frame}")(q)
        inverse = getattr(functions, f"inverse_rate_matrix_{frame}")(q)
        assert_allclose(np.einsum("nij,nj->ni", matrix, q_dot), omega, atol=1e-14)
        assert_allclose(matrix @ inverse, np.broadcast_to(np.eye(3), (50, 3, 3)), atol=1e-10)


def test_rotation_matrix_is_within_4_eps(sequence):
    q = angles_of_all_sizes()
    exact = exactly(sequence, "rotation_matrix", [q])
    assert worst_error(module(sequence).rotation_matrix(q), exact) <= 4
    assert worst_error(one_by_one("rotation_matrix", [q], sequence), exact) <= 4


@pytest.mark.parametrize("name", ["angular_velocity_space", "angular_velocity_body"])
def test_velocities_are_within_4_eps_of_the_largest_rate(sequence, name):
    """Rates that cancel each other leave a small Ω; what was lost then is a rate's own digits."""
    q = angles_of_all_sizes()
    q_dot = np.random.default_rng(5).uniform(-3, 3, q.shape)
    exact = exactly(sequence, name, [q, q_dot])
    scales = np.abs(q_dot).max(axis=1)
    assert worst_error(getattr(module(sequence), name)(q, q_dot), exact, scales) <= 4
    assert worst_error(one_by_one(name, [q, q_dot], sequence), exact, scales) <= 4


@pytest.mark.parametrize("name", QUANTITIES)
def test_agrees_with_the_derivation_at_50_digits(sequence, name):
    arrays = inputs(name, (6,))
    found = getattr(module(sequence), name)(*arrays)
    assert worst_error(found, exactly(sequence, name, arrays)) <= 60  # 1/sin θ is up to 20 here


@pytest.mark.parametrize("sequence", ["ZXZ", "zyx"])
def test_near_a_pole_only_the_input_limits_the_accuracy(sequence):
    pole = 0.0 if sequence == "ZXZ" else np.pi / 2
    q = np.array([[0.3, pole + distance, -0.7] for distance in (1e-3, -1e-6, 1e-9, 1e-12)])
    omega = np.ones_like(q)
    found = module(sequence).rates_from_angular_velocity_body(q, omega)
    exact = exactly(sequence, "rates_from_angular_velocity_body", [q, omega])
    assert worst_error(found, exact) <= 8


def test_large_angles_are_right():
    rng = np.random.default_rng(11)
    q = np.concatenate([rng.uniform(-s, s, (30, 3)) for s in (1e6, 1e15, 1e300)])
    assert worst_error(module().rotation_matrix(q), exactly("ZXZ", "rotation_matrix", [q])) <= 4


def test_single_precision_is_as_good_as_single_precision_can_be(sequence):
    q = angles_of_all_sizes().astype(np.float32)
    found = module(sequence).rotation_matrix(q)
    assert found.dtype == np.float32
    expected = module(sequence).rotation_matrix(q.astype(np.float64))
    assert np.abs(found - expected).max() <= 5 * np.finfo(np.float32).eps


@pytest.fixture(scope="module")
def twenty_turns():
    return rs.derive(" ".join(f"{'zxy'[k % 3]}({'abcdefghijklmnopqrst'[k]}1)" for k in range(20)))


@pytest.fixture(scope="module")
def long_chain(twenty_turns):
    """The module of twenty turns, whose twins share functions of arrays, and its text."""
    kernels = twenty_turns.kernels()
    return kernels.load(), kernels.source


def test_long_twins_share_the_functions_of_arrays(long_chain):
    functions, text = long_chain
    q, q_dot = np.random.default_rng(5).uniform(-3, 3, (2, 3, 20))
    found, shared = functions.rotation_rate(q, q_dot), functions.rotation_rate_scalar
    twins = [shared(*map(float, [*a, *b])) for a, b in zip(q, q_dot, strict=True)]
    assert_allclose(twins, found, rtol=1e-13, atol=1e-13)
    assert isinstance(twins[0][2][2], float)
    assert shared(*[1] * 40) == shared(*[1.0] * 40)
    assert "return _of_floats(_rotation_rate, (3, 3)" in " ".join(text.split()).replace("( ", "(")


@pytest.mark.filterwarnings("error")
def test_long_twins_give_nan_where_arrays_do(long_chain):
    functions, _ = long_chain
    straight = [0.0, *[0.5 * np.pi, 0.0, 0.0] * 6, 0.0]
    for q in ([np.inf] * 20, straight, [np.nan, *[1.0] * 19]):
        vectors = np.array(q), np.array([1.0, 2.0, 3.0])
        rates = functions.rates_from_angular_velocity_body(*vectors)
        twin = functions.rates_from_angular_velocity_body_scalar(*map(float, [*q, 1.0, 2.0, 3.0]))
        assert_array_equal(np.isnan(twin), np.isnan(rates))
    margin = functions.singularity_margin(np.ones((300, 20)))
    assert_allclose(margin, functions.singularity_margin_scalar(*[1.0] * 20), rtol=1e-13)


@pytest.mark.parametrize("target", ["numpy", "c", "numba"])
def test_the_text_of_a_long_chain_takes_less_than_eight_kilobytes_a_turn(twenty_turns, target):
    assert len(twenty_turns.kernels(target).source.encode()) < 20 * 8000
