"""The conversions of every target give the numbers of the NumPy module's."""

from __future__ import annotations

import ctypes
import re
import shutil
import subprocess
from functools import cache
from types import ModuleType

import jax
import numpy as np
import pytest

import rigidsym as rs
from helpers.target_modules import STRICT
from rigidsym.kernels.targets import TARGETS
from rigidsym.models.library import PARAMETRISATIONS, PRESETS
from rigidsym.models.rotation_text import rotation_from

pytestmark = pytest.mark.usefixtures("double")

CHAIN = "z(phi) x(alpha) [0,3,4](beta)"
CONSTANTS = "z(gamma) x(phi) y(alpha0) z(beta)"
MIRRORED = "z(phi) [1,1,1](theta) z(-phi)"
TEXTS = (
    *("ZXZ", *PARAMETRISATIONS, CHAIN, CONSTANTS, "z(phi) x(b) [0,-1,0](c)"),
    *("z(a) x(b) z(c) y(d)", "davenport", "z(phi) [sets,k,rows](theta) z(psi)"),
    *("z(phi + psi) x(theta)", "z(phi) x(theta) z(-phi)", MIRRORED),
)
C = (
    *("ZXZ", "axis_angle", "rotation_vector", "modified_rodrigues", "direction_cosines"),
    *(CHAIN, CONSTANTS, "z(a) x(b) z(c) y(d)", MIRRORED),
)
JAX = ("ZXZ", "rotation_vector", "modified_rodrigues", CONSTANTS, MIRRORED)


CATALOGUE = (*rs.EULER_SEQUENCES[::12], *PARAMETRISATIONS, *PRESETS, CHAIN, CONSTANTS)
WITHOUT_UNWRAP = ("c", "javascript", "jax")  # of C, only the Python module has it
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
        assert lacking <= ({"unwrap"} if target in WITHOUT_UNWRAP else set()), text
        assert not lacking or "unwrap is only in" in words, text


def assert_as_in_numpy(text: str, target: str) -> None:
    for name, arrays in given(text).items():
        if name == "unwrap" and target in WITHOUT_UNWRAP:
            continue
        expected = getattr(module(text, "numpy"), name)(*arrays)
        function = getattr(module(text, target), name)
        found = function(*arrays)
        np.testing.assert_allclose(found, expected, rtol=1e-13, atol=1e-13, err_msg=name)


@pytest.mark.parametrize("text", JAX)
def test_jax(text):
    assert_as_in_numpy(text, "jax")


@pytest.mark.skipif(bool(TARGETS["javascript"].missing), reason="node is not installed")
@pytest.mark.parametrize("text", TEXTS)
def test_javascript(text):
    assert_as_in_numpy(text, "javascript")


@pytest.mark.skipif(not shutil.which("gcc"), reason="no gcc")
@pytest.mark.parametrize("text", C)
def test_c(text, tmp_path):
    """In C itself, without a Python module: strictly compiled, in both types, one and many."""
    source = motion(text).kernels("c", conversions=True).write(tmp_path)
    built = tmp_path / "functions.so"
    flags = (*STRICT, "-fPIC", "-shared")
    subprocess.run(["gcc", *flags, source, "-o", built, "-lm"], check=True)
    library = ctypes.CDLL(str(built))
    for name, arrays in given(text).items():
        if name == "unwrap":
            continue
        known = getattr(module(text, "numpy"), name)
        vectors = [np.atleast_2d(a.reshape(len(a), -1) if a.ndim > 1 else a) for a in arrays]
        if known.signature.count("),(") >= len(vectors):
            vectors.append(np.zeros((1, 1)))  # what the rotation does not determine
        expected = known(*arrays)
        for suffix, dtype, limit in (("", np.float64, 1e-13), ("f", np.float32, 1e-3)):
            given_ = [np.ascontiguousarray(v, dtype) for v in vectors]
            out = np.empty(expected.shape, dtype)
            places = [
                x
                for v in (*given_, out)
                for x in (
                    ctypes.c_void_p(v.ctypes.data),
                    ctypes.c_ssize_t(0 if len(v) == 1 else v.shape[1]),
                    ctypes.c_ssize_t(1),
                )
            ]
            function = getattr(library, f"{motion(text).name}_{name}_array{suffix}")
            function(ctypes.c_size_t(len(out)), *places)
            if suffix:  # poles and half turns part ways in single precision
                out, expected = out[5:], expected[5:]
            np.testing.assert_allclose(out, expected, rtol=limit, atol=limit, err_msg=name)


@pytest.mark.skipif(bool(TARGETS["javascript"].missing), reason="node is not installed")
def test_a_quaternion_read_off_from_the_transpose_of_r():
    motion = rs.derive(rotation_from("direction_cosines", passive=True), ["rotation_matrix"])
    q = [0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0]  # R, which turns y to x; A turns x to y
    found = motion.kernels("javascript", conversions=True).load().quaternion(q)
    expected = motion.kernels(conversions=True).load().quaternion(q)
    np.testing.assert_allclose(found, expected, atol=1e-6)
    np.testing.assert_allclose(expected, [0.5, -0.5, -0.5, -0.5])


@pytest.mark.parametrize("angle", [0.0, 0.7])
def test_derivatives_of_conversions(angle):
    """There and back is the identity, and so is its derivative: at no turn at all, too."""
    functions = module("rotation_vector", "jax")
    back = jax.jacobian(lambda v: functions.from_quaternion(functions.quaternion(v)))
    np.testing.assert_allclose(back(angle * np.array([0.6, 0.0, 0.8])), np.eye(3), atol=1e-14)
