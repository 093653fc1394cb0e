"""Generated functions for JAX: the same numbers, under jit, vmap and grad."""

from __future__ import annotations

import inspect
import subprocess
import sys
from functools import cache

import jax
import numpy as np
import pytest
import sympy as sp
from numpy.testing import assert_allclose, assert_array_equal

import rigidsym as rs
from helpers.errors_of_kernels import angles_of_all_sizes, exactly, worst_error
from helpers.kernel_modules import EPS, QUANTITIES, inputs, module
from helpers.motions import derived
from rigidsym.errors import MissingExtra


@cache
def functions(name: str = "ZXZ"):
    return rs.derive(name).kernels("jax").load()


pytestmark = pytest.mark.usefixtures("double")


@pytest.mark.parametrize("sequence", ["ZXZ", "zyx"])
def test_every_function_gives_the_numbers_of_numpy(sequence):
    for name, (arguments, shape) in QUANTITIES.items():
        function = getattr(functions(sequence), name)
        assert list(inspect.signature(function).parameters) == list(arguments)
        arrays = inputs(name, (4, 1, 2))
        found, expected = function(*arrays), getattr(module(sequence), name)(*arrays)
        assert (found.shape, found.dtype) == ((4, 1, 2, *shape), np.float64)
        assert_allclose(found, expected, rtol=1e-13, atol=1e-13)


def test_jit_vmap_and_grad_apply():
    q, q_dot = inputs("angular_velocity_body", (5,))
    function = functions().angular_velocity_body
    expected = function(q, q_dot)
    assert_allclose(jax.jit(function)(q, q_dot), expected, atol=1e-15)
    assert_allclose(jax.vmap(function)(q, q_dot), expected, atol=1e-15)
    energy = jax.grad(lambda rates: 0.5 * (function(q[0], rates) ** 2).sum())(q_dot[0])
    rates = functions().rate_matrix_body(q[0])
    assert_allclose(energy, rates.T @ expected[0], atol=1e-14)


@pytest.mark.parametrize("name", ["ZXZ", "rotation_vector", "unit_quaternion"])
@pytest.mark.parametrize("size", [1e-3, 0.0])
def test_the_tangent_of_the_matrix_is_its_rate(name, size):
    """At a rotation vector of zero, too, where its formulas are 0/0."""
    kernels = functions(name)
    rng = np.random.default_rng(2)
    count = len(derived("ZXZ").argument("q").names) + (name == "unit_quaternion")
    q, q_dot = size * rng.normal(size=count), rng.normal(size=count)
    if name == "unit_quaternion":
        q = np.array([1.0, 0.0, 0.0, 0.0])
    _, tangent = jax.jvp(kernels.rotation_matrix, (q,), (q_dot,))
    assert_allclose(tangent, kernels.rotation_rate(q, q_dot), atol=1e-14)
    if size:
        return
    second = jax.jacrev(jax.jacfwd(kernels.angular_velocity_space))(q, q_dot)
    assert np.isfinite(second).all()


@pytest.mark.parametrize("name", ["rotation_matrix", "angular_velocity_body"])
def test_errors_are_within_4_eps(name):
    q = angles_of_all_sizes()
    arrays = [q, np.random.default_rng(5).uniform(-3, 3, q.shape)][: len(QUANTITIES[name][0])]
    exact = exactly("ZXZ", name, arrays)
    scales = np.abs(arrays[-1]).max(axis=1) if len(arrays) > 1 else None
    found = np.asarray(getattr(functions(), name)(*arrays))
    assert worst_error(found, exact, scales) <= 4


def test_types_are_those_of_jax():
    q = inputs("rotation_matrix")[0].astype(np.float32)
    matrix = functions().rotation_matrix
    assert matrix(q).dtype == np.float32
    assert functions().spin_matrix(q, q).dtype == np.float32
    assert functions().spin_matrix(q, q.astype(float)).dtype == np.float64
    assert matrix([0, 1, 2]).dtype == np.float64
    jax.config.update("jax_enable_x64", False)
    assert matrix([0, 1, 2]).dtype == np.float32
    assert_allclose(matrix(q), module().rotation_matrix(q), atol=4 * EPS * 2**29)


@pytest.mark.parametrize("leading", [(), (0,), (7,)])
def test_every_shape_and_stride_is_taken(leading):
    (q,) = inputs("rotation_matrix", leading)
    found = functions().rotation_matrix(q)
    assert found.shape == (*leading, 3, 3)
    assert_allclose(found, module().rotation_matrix(q), atol=4 * EPS)
    wide = np.zeros((*leading, 7))
    wide[..., 5::-2] = q
    apart = wide[..., 5::-2]
    apart.flags.writeable = False
    assert_array_equal(functions().rotation_matrix(apart), found)
    assert functions().angular_velocity_body.signature == "(3),(3)->(3)"


def test_poles_and_what_is_not_finite_give_nan():
    found = functions().rates_from_angular_velocity_body(np.zeros(3), np.ones(3))
    assert_array_equal(np.isnan(found), [True, False, True])  # the rate of theta has no pole
    for bad in (np.nan, np.inf):
        found = functions().rotation_matrix(np.array([0.1, bad, 0.2]))
        expected = module().rotation_matrix(np.array([0.1, bad, 0.2]))
        assert_array_equal(np.isnan(found), np.isnan(expected))


def test_arguments_that_are_refused():
    message = r"^q: got shape \(4,\); expected \(\.\.\., 3\), the last axis phi, theta, psi$"
    with pytest.raises(ValueError, match=message):
        functions().rotation_matrix(np.zeros(4))
    with pytest.raises(TypeError, match=r"^q: got dtype complex128; expected floats$"):
        functions().rotation_matrix(np.zeros(3, complex))
    foreign = np.dtype(float).newbyteorder()
    with pytest.raises(TypeError, match=f"^q: JAX takes no array of {foreign}"):
        functions().rotation_matrix(np.zeros(3, foreign))
    with pytest.raises(TypeError, match=r"^q: JAX takes no array of str$"):
        functions().rotation_matrix("abc")
    with pytest.raises(TypeError, match=r"^q: JAX takes no masked array$"):
        functions().rotation_matrix(np.ma.masked_all(3))


def test_ruff_would_leave_the_modules_as_they_are(tmp_path):
    for name in ("ZXZ", "rotation_vector", "z(phi) x(theta)", "z(phi) [a,b,c](beta)", "y(phi)"):
        rs.derive(name).kernels("jax", conversions=True).write(tmp_path)
    for name in ("direction_cosines", "modified_rodrigues", "z(phi) x(b) [0,3,4](c)"):
        few = rs.derive(name, only=["rotation_matrix"])
        few.kernels("jax", conversions=True).write(tmp_path)
    for command in (("format", "--check"), ("check",)):
        done = subprocess.run(
            [sys.executable, "-m", "ruff", *command, "--isolated", "--no-cache", str(tmp_path)],
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == 0, done.stdout + done.stderr


def test_conversions_stand_beside_quantities_that_are_no_functions():
    radius, height = sp.symbols("r h")
    body = rs.solid("cylinder", radius=radius, height=height, mass=1)
    motion = rs.derive("axis_angle", only="principal_axes", body=body)
    source = motion.kernels("jax", conversions=True).source
    assert "def from_quaternion(" in source
    assert "def principal_axes(" not in source


def test_a_missing_jax_is_named(monkeypatch):
    monkeypatch.setattr("rigidsym.kernels.targets.find_spec", lambda _: None)
    with pytest.raises(MissingExtra, match=r"pip install '.\[jax\]'"):
        derived("ZXZ").kernels("jax").load()
