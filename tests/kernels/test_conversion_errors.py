"""Errors of conversions in every target, as angles between rotations, and the numbers of NumPy."""

from __future__ import annotations

from functools import cache
from types import ModuleType

import jax
import numpy as np
import pytest

import rigidsym as rs
from helpers.conversion_modules import module as numpy_module
from helpers.node import load
from helpers.target_modules import EVERY, row_by_row
from helpers.witness import distance, hat, mp, rotation as exact_rotation
from rigidsym.models.library import rotation_from

BACK = ("from_quaternion", "from_rotation_matrix")
MOST_OF_EULER = 160  # eps in R, near poles too; ten times what was measured
MOST_OF_OTHERS = 40


@cache
def motion(text: str) -> rs.Motion:
    return rs.derive(rotation_from(text), ["rotation_matrix"])


# the witness: quaternions and coordinates as rotations, by textbook formulas at 50 digits


def of_quaternion(w, x, y, z):
    """The rotation, times the square of the length."""
    v = mp.matrix([x, y, z])
    square = x * x + y * y + z * z
    return (w * w - square) * mp.eye(3) + 2 * v * v.T + 2 * w * hat(v)


def of_unit(*parts):
    return of_quaternion(*parts) / mp.fsum(part * part for part in parts)


def of_axis(x, y, z, angle):
    skew = hat([x, y, z])
    return mp.eye(3) + mp.sin(angle) * skew + (1 - mp.cos(angle)) * skew * skew


def of_vector(x, y, z):
    length = mp.sqrt(x * x + y * y + z * z)
    return of_axis(x / length, y / length, z / length, length)


def of_shadows(x, y, z):
    square = x * x + y * y + z * z
    return of_unit((1 - square) / 2, x, y, z)


FORMS = {
    "quaternion": of_unit,
    "unit_quaternion": of_quaternion,
    "axis_angle": of_axis,
    "rotation_vector": of_vector,
    "gibbs_vector": lambda x, y, z: of_unit(mp.one, x, y, z),
    "modified_rodrigues": of_shadows,
    "cayley_klein": lambda a, b, c, d: of_quaternion(a, d, c, b),
    "direction_cosines": lambda *entries: mp.matrix([entries[k : k + 3] for k in (0, 3, 6)]),
}


def turned(text: str, q) -> mp.matrix:
    exact = [mp.mpf(float(part)) for part in q]
    return FORMS[text](*exact) if text in FORMS else exact_rotation(text, exact)


def given(text: str, count: int, seed: int) -> np.ndarray:
    """Quaternions (count, 4), of Euler angles that come near to poles too."""
    source = np.random.default_rng(seed)
    found = source.normal(size=(count, 4))
    if text in FORMS:
        return found
    away = source.choice([-1, 1], count) * 10.0 ** -source.uniform(1, 17, count)
    pole = source.choice([0, np.pi] if text[0] == text[2] else [-np.pi / 2, np.pi / 2], count)
    turns = [source.uniform(-np.pi, np.pi, count), pole + away, source.uniform(-3, 3, count)]
    axes = [np.eye(3)["xyz".index(axis)][:, np.newaxis] for axis in text.lower()]
    parts = [
        np.stack([np.cos(angle / 2), *(np.sin(angle / 2) * axis)])
        for axis, angle in zip(axes, turns, strict=True)
    ]
    parts = parts if text.isupper() else parts[::-1]
    near = multiplied(multiplied(parts[0], parts[1]), parts[2]).T
    return np.where(np.arange(count)[:, None] % 2, near, found)


def multiplied(p: np.ndarray, q: np.ndarray) -> np.ndarray:
    """The product of quaternions (4, count)."""
    vector = p[0] * q[1:] + q[0] * p[1:] + np.cross(p[1:], q[1:], axis=0)
    return np.concatenate([[p[0] * q[0] - (p[1:] * q[1:]).sum(axis=0)], vector])


def worst(text: str, module: ModuleType, p: np.ndarray, target="numpy") -> dict[str, float]:
    """The largest errors of both ways back, in eps of the quaternions' type."""
    exact = [of_unit(*map(mp.mpf, row)) for row in p.astype(float).tolist()]
    matrices = np.array([np.array(R.tolist(), float) for R in exact]).astype(p.dtype)
    read = [mp.matrix(matrix.astype(float).tolist()) for matrix in matrices]
    found = {}
    for name, values, truths in zip(BACK, (p, matrices), (exact, read), strict=True):
        q = row_by_row(target, getattr(module, name))(values)
        errors = [
            distance(turned(text, row), R) / max(map(abs, R))
            for row, R in zip(q, truths, strict=True)
        ]
        found[name] = float(max(errors)) / np.finfo(p.dtype).eps
    return found


def most(text: str) -> float:
    return MOST_OF_OTHERS if text in FORMS else MOST_OF_EULER


@pytest.mark.parametrize("text", ["ZXZ", "zyx", *FORMS])
def test_inverse_conversions_are_accurate_near_poles_too(text):
    for dtype in (np.float64, np.float32):
        p = given(text, 24, 7).astype(dtype)
        for name, error in worst(text, numpy_module(text), p).items():
            assert error <= most(text), name


@pytest.mark.parametrize("target", [e for e in EVERY if e.values != ("numpy",)])
@pytest.mark.parametrize("text", ["zyx", "rotation_vector"])
def test_they_are_so_in_every_target(text, target):
    module = load(motion(text).kernels(target, conversions=True))
    for name, error in worst(text, module, given(text, 20, 8), target).items():
        assert error <= most(text), name


# unwrap


pytestmark = pytest.mark.usefixtures("double")

CONSTANTS = "z(gamma) x(phi) y(alpha0) z(beta)"  # only its quaternion
TEXTS = ("ZXZ", "rotation_vector", "modified_rodrigues", CONSTANTS)


@cache
def module(text: str, target: str) -> ModuleType:
    return load(motion(text).kernels(target, conversions=True))


def arguments(text: str) -> dict[str, list[np.ndarray]]:
    """Arguments of each conversion of the NumPy module: the poles, half turns and no turn too."""
    known, random = module(text, "numpy"), np.random.default_rng(4)
    if motion(text).model.constants:
        return {"quaternion": [random.normal(size=(40, 3)), np.full(1, 0.4)]}
    p = np.concatenate([np.eye(4), -np.eye(4)[:1], random.normal(size=(40, 4))])
    q = known.from_quaternion(p)
    arguments = {
        "from_quaternion": [p],
        "from_rotation_matrix": [known.rotation_matrix(q)],
        "quaternion": [q],
    }
    return {name: arrays for name, arrays in arguments.items() if hasattr(known, name)}


@pytest.mark.parametrize("target", [each for each in EVERY if each.values != ("numpy",)])
@pytest.mark.parametrize("text", ["modified_rodrigues", CONSTANTS])
def test_every_target_has_the_numbers_of_numpy(text, target):
    for name, arrays in arguments(text).items():
        expected = getattr(module(text, "numpy"), name)(*arrays)
        found = getattr(module(text, target), name)(*arrays)
        np.testing.assert_allclose(found, expected, rtol=1e-13, atol=1e-13, err_msg=name)


@pytest.mark.parametrize("angle", [0.0, 0.7])
def test_derivatives_of_conversions(angle):
    """There and back is the identity, and so is its derivative: at no turn at all, too."""
    functions = module("rotation_vector", "jax")
    back = jax.jacobian(lambda v: functions.from_quaternion(functions.quaternion(v)))
    np.testing.assert_allclose(back(angle * np.array([0.6, 0.0, 0.8])), np.eye(3), atol=1e-14)
