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
from rigidsym.models.library import rotation_from

pytestmark = pytest.mark.usefixtures("double")

CONSTANTS = "z(gamma) x(phi) y(alpha0) z(beta)"  # only its quaternion
TEXTS = ("ZXZ", "rotation_vector", "modified_rodrigues", CONSTANTS)
C = ("ZXZ", "axis_angle", "rotation_vector", "modified_rodrigues", "direction_cosines", CONSTANTS)
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
    return motion(text).kernels(target, conversions=True).load()


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
        "shadow_set": [q],
        "shorter_set": [q],
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


def assert_as_in_numpy(text: str, target: str) -> None:
    for name, arrays in given(text).items():
        expected = getattr(module(text, "numpy"), name)(*arrays)
        function = getattr(module(text, target), name)
        found = function(*arrays)
        np.testing.assert_allclose(found, expected, rtol=1e-13, atol=1e-13, err_msg=name)


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
        known = getattr(module(text, "numpy"), name)
        vectors = [np.atleast_2d(a.reshape(len(a), -1) if a.ndim > 1 else a) for a in arrays]
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


SANITIZED = """
#include <math.h>
#include <stdlib.h>
#include "%s"
static double value(int k)
{
    const double odd[] = {0.0, -0.0, NAN, INFINITY, 1e300, -1e-310, 0.3, 3.14159, -2.0, 1.0, 0.5};
    return odd[(k * 7 + k / 11) %% 11];
}
int main(void)
{
    for (int rows = 0; rows < 70; rows += rows < 5 ? 1 : 13) {
        for (int stride = 1; stride < 3; stride++) {
%s
        }
    }
    return 0;
}
"""


def _sanitized_call(name: str, sizes: list[int]) -> str:
    """A call of the array function, with arrays on the heap of just the size that it may touch."""
    real, array = ("float", "_arrayf") if name.endswith("f") else ("double", "_array")
    lines, given = [], []
    for k, size in enumerate(sizes):
        row = f"({size} * stride + 1)"
        length = f"(rows ? (size_t)((rows - 1) * {row} + ({size} - 1) * stride + 1) : 0)"
        lines.append(f"{real} *a{k} = malloc({length} * sizeof({real}) + 1);")
        lines.append(
            f"for (size_t n = 0; n < {length}; n++) a{k}[n] = ({real})value((int)n + rows);"
        )
        given += [f"a{k}", row, "stride"]
    function = name.removesuffix("f") if real == "float" else name
    lines.append(f"{function}{array}((size_t)rows, {', '.join(given)});")
    lines += [f"free(a{k});" for k in range(len(sizes))]
    return "{" + " ".join(lines) + "}"


@pytest.mark.campaign
@pytest.mark.skipif(not shutil.which("gcc"), reason="no gcc")
@pytest.mark.parametrize("text", ["ZXZ", "axis_angle"])
def test_sanitizers_find_nothing_in_conversions(text, tmp_path):
    """Odd sizes, offsets, steps and strides, with zeros, NaN and infinities among the inputs."""
    source = motion(text).kernels("c", conversions=True).write(tmp_path).with_suffix(".h")
    declared = re.findall(r"^void (\w+)\(([^;]*\[\d+\])\s*\);", source.read_text(), re.MULTILINE)
    calls = [
        _sanitized_call(name, [int(size) for size in re.findall(r"\[(\d+)\]", given)])
        for name, given in declared
        if "_from_" in name or "_quaternion" in name
    ]
    assert len(calls) == 6  # three functions in two types
    main = tmp_path / "main.c"
    main.write_text(SANITIZED % (source.name, "\n".join(calls)), encoding="utf-8")
    flags = ("-std=c99", "-g", "-O1", "-fsanitize=address,undefined,float-cast-overflow")
    made = tmp_path / "main"
    files = (source.with_suffix(".c"), main)
    command = ("gcc", *flags, "-fno-sanitize-recover=all", *files, "-o", made, "-lm")
    subprocess.run(command, check=True)
    subprocess.run([made], check=True)


@pytest.mark.campaign
@pytest.mark.parametrize("target", ["numpy", "c", "numba"])
@pytest.mark.parametrize("text", ["ZXZ", "rotation_vector"])
def test_out_and_threads_change_no_bit(text, target):
    if TARGETS[target].missing:
        pytest.skip(f"{target} needs {TARGETS[target].missing}")
    functions, random = module(text, target), np.random.default_rng(1)
    q = random.uniform(-3, 3, size=(50_001, 3))
    p = functions.quaternion(q)
    matrix = functions.rotation_matrix(q)
    for name, array in (
        ("from_quaternion", p),
        ("from_rotation_matrix", matrix),
        ("quaternion", q),
    ):
        function = getattr(functions, name)
        expected = function(array)
        out = np.full(expected.shape[::-1], np.nan).T  # columns side by side
        assert function(array, out=out, threads=2) is out
        np.testing.assert_array_equal(out, expected)
        strided = np.concatenate([array, array], axis=-1)[..., : array.shape[-1]]
        np.testing.assert_array_equal(function(strided[::-1])[::-1], expected)
