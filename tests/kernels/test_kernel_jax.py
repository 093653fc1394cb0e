"""Generated functions for JAX: jit, vmap and grad, types, and what is refused."""

from __future__ import annotations

from functools import cache

import jax
import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import rigidsym as rs
from helpers.motions import derived
from helpers.target_modules import inputs as inputs_of, module


@cache
def functions(name: str = "ZXZ"):
    return rs.derive(name).kernels("jax").load()


pytestmark = pytest.mark.usefixtures("double")
FEW_EPS = 64 * 2.0**-52  # 4 eps were measured


def inputs(name: str, leading: tuple[int, ...] = (7,)) -> list[np.ndarray]:
    return inputs_of("ZXZ", name, leading)


@pytest.mark.campaign
def test_jit_vmap_and_grad_apply():
    q, q_dot = inputs("angular_velocity_body", (5,))
    function = functions().angular_velocity_body
    expected = function(q, q_dot)
    assert_allclose(jax.jit(function)(q, q_dot), expected, atol=1e-14)
    assert_allclose(jax.vmap(function)(q, q_dot), expected, atol=1e-14)
    energy = jax.grad(lambda rates: 0.5 * (function(q[0], rates) ** 2).sum())(q_dot[0])
    rates = functions().rate_matrix_body(q[0])
    assert_allclose(energy, rates.T @ expected[0], atol=1e-14)


@pytest.mark.campaign
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


def test_types_are_those_of_jax():
    q = inputs("rotation_matrix")[0].astype(np.float32)
    matrix = functions().rotation_matrix
    assert matrix(q).dtype == np.float32
    assert functions().spin_matrix(q, q).dtype == np.float32
    assert functions().spin_matrix(q, q.astype(float)).dtype == np.float64
    assert matrix([0, 1, 2]).dtype == np.float64
    jax.config.update("jax_enable_x64", False)
    assert matrix([0, 1, 2]).dtype == np.float32
    assert_allclose(matrix(q), module().rotation_matrix(q), atol=FEW_EPS * 2**29)


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


@pytest.mark.parametrize("leading", [(), (0,), (7,)])
def test_every_shape_and_stride_is_taken(leading):
    (q,) = inputs("rotation_matrix", leading)
    found = functions().rotation_matrix(q)
    assert found.shape == (*leading, 3, 3)
    assert_allclose(found, module().rotation_matrix(q), atol=FEW_EPS)
    wide = np.zeros((*leading, 7))
    wide[..., 5::-2] = q
    apart = wide[..., 5::-2]
    apart.flags.writeable = False
    assert_array_equal(functions().rotation_matrix(apart), found)
    assert functions().angular_velocity_body.signature == "(3),(3)->(3)"
