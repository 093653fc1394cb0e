"""The conversions of every target give the numbers of the NumPy module's."""

from __future__ import annotations

from functools import cache
from types import ModuleType

import numpy as np
import pytest
from test_kernel_jax import double  # noqa: F401  (a fixture)

import rigidsym as rs
from rigidsym.rotations import rotation_from

CHAIN = "z(phi) x(alpha) [0,3,4](beta)"
CONSTANTS = "z(gamma) x(phi) y(alpha0) z(beta)"
JAX = ("ZXZ", "rotation_vector", "modified_rodrigues", CONSTANTS)


@cache
def motion(text: str) -> rs.Motion:
    return rs.derive(rotation_from(text), ["rotation_matrix"])


@cache
def module(text: str, target: str) -> ModuleType:
    return motion(text).kernels(target, conversions=True).load()


def given(text: str) -> dict[str, list[np.ndarray]]:
    """Arguments of each conversion of the NumPy module: the poles, half turns and no turn too."""
    known, random = module(text, "numpy"), np.random.default_rng(4)
    more = [np.full(len(motion(text).model.constants), 0.4)] if motion(text).model.constants else []
    p = np.concatenate([np.eye(4), -np.eye(4)[:1], random.normal(size=(40, 4))])
    q = known.from_quaternion(p, *more)
    walk = np.cumsum(random.normal(size=(300, q.shape[-1])) / 5, axis=0)
    walk[7] = np.nan
    found = {
        "from_quaternion": [p, *more],
        "from_rotation_matrix": [known.rotation_matrix(q, *more), *more],
        "quaternion": [q, *more],
        "unwrap": [(walk + np.pi) % (2 * np.pi) - np.pi, *more],
        "shadow_set": [q],
        "shorter_set": [q],
    }
    return {name: arrays for name, arrays in found.items() if hasattr(known, name)}


def assert_as_in_numpy(text: str, target: str) -> None:
    for name, arrays in given(text).items():
        expected = getattr(module(text, "numpy"), name)(*arrays)
        found = getattr(module(text, target), name)(*arrays)
        np.testing.assert_allclose(found, expected, rtol=1e-13, atol=1e-13, err_msg=name)


@pytest.mark.parametrize("text", JAX)
def test_jax(text):
    assert_as_in_numpy(text, "jax")


@pytest.mark.parametrize("angle", [0.0, 0.7])
def test_derivatives_of_conversions(angle):
    """There and back is the identity, and so is its derivative: at no turn at all, too."""
    import jax

    functions = module("rotation_vector", "jax")
    back = jax.jacobian(lambda v: functions.from_quaternion(functions.quaternion(v)))
    np.testing.assert_allclose(back(angle * np.array([0.6, 0.0, 0.8])), np.eye(3), atol=1e-14)
