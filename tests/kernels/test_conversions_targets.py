"""The conversions of every target give the numbers of the NumPy module's."""

from __future__ import annotations

import re
from functools import cache
from types import ModuleType

import jax
import numpy as np
import pytest

import rigidsym as rs
from helpers.node import load
from helpers.target_modules import EVERY
from rigidsym.kernels.targets import TARGETS
from rigidsym.models.library import rotation_from

pytestmark = pytest.mark.usefixtures("double")

CONSTANTS = "z(gamma) x(phi) y(alpha0) z(beta)"  # only its quaternion
TEXTS = ("ZXZ", "rotation_vector", "modified_rodrigues", CONSTANTS)
CATALOGUE = (*TEXTS, "quaternion", "goldstein")
WITHOUT_TWINS = ("c", "javascript", "jax")  # of C, the functions of one orientation are those
EXPORTED = {
    "c": re.compile(r"^void (\w+)_array\(", re.MULTILINE),
    "javascript": re.compile(r"^export function (\w+)\(", re.MULTILINE),
}
PYTHON = re.compile(r"^    \"(\w+)\",$", re.MULTILINE)  # lines of __all__


@cache
def motion(text: str) -> rs.Motion:
    return rs.derive(rotation_from(text), ["rotation_matrix"])


@cache
def module(text: str, target: str) -> ModuleType:
    return load(motion(text).kernels(target, conversions=True))


def given(text: str) -> dict[str, list[np.ndarray]]:
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


@cache
def offered(text: str, target: str) -> tuple[set[str], str]:
    """The functions of a target's file, and the words on it."""
    files = motion(text).kernels(target, conversions=True).files
    texts = "\n".join(t for name, t in files.items() if not name.endswith(("_c.py", "_module.c")))
    names = EXPORTED.get(target, PYTHON).findall(texts)
    if target == "c":
        names = [name.removeprefix(f"{motion(text).name}_") for name in names]
    words = " ".join(re.sub(r"^ \* ?", "", line) for line in texts.split("\n"))
    return set(names), " ".join(words.split())


@pytest.mark.parametrize("target", [name for name in TARGETS if name != "numpy"])
def test_every_function_is_in_every_target_or_named_as_missing(target):
    for text in CATALOGUE:
        known, _ = offered(text, "numpy")
        names, words = offered(text, target)
        lacking = known - names
        if target in WITHOUT_TWINS:
            lacking = {name for name in lacking if not name.endswith("_scalar")}
        assert lacking <= {"unwrap"}, text
        assert not lacking or "Only the NumPy module has unwrap." in words, text


@pytest.mark.parametrize("target", [each for each in EVERY if each.values != ("numpy",)])
@pytest.mark.parametrize("text", ["modified_rodrigues", CONSTANTS])
def test_every_target_has_the_numbers_of_numpy(text, target):
    for name, arrays in given(text).items():
        expected = getattr(module(text, "numpy"), name)(*arrays)
        found = getattr(module(text, target), name)(*arrays)
        np.testing.assert_allclose(found, expected, rtol=1e-13, atol=1e-13, err_msg=name)


@pytest.mark.usefixtures("node")
def test_a_quaternion_read_off_from_the_transpose_of_r():
    motion = rs.derive(rotation_from("direction_cosines", passive=True), ["rotation_matrix"])
    q = [0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0]  # R, which turns y to x; A turns x to y
    found = load(motion.kernels("javascript", conversions=True)).quaternion(q)
    expected = motion.kernels(conversions=True).load().quaternion(q)
    np.testing.assert_allclose(found, expected, atol=1e-6)
    np.testing.assert_allclose(expected, [0.5, -0.5, -0.5, -0.5])


@pytest.mark.parametrize("angle", [0.0, 0.7])
def test_derivatives_of_conversions(angle):
    """There and back is the identity, and so is its derivative: at no turn at all, too."""
    functions = module("rotation_vector", "jax")
    back = jax.jacobian(lambda v: functions.from_quaternion(functions.quaternion(v)))
    np.testing.assert_allclose(back(angle * np.array([0.6, 0.0, 0.8])), np.eye(3), atol=1e-14)
