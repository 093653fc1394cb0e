"""The targets JavaScript, run by node, and JAX: their manners."""

from __future__ import annotations

import json
import re
import subprocess
from functools import cache
from pathlib import Path

import jax
import numpy as np
import pytest
from numpy.testing import assert_allclose

import rigidsym as rs
from helpers import node
from helpers.motions import derived
from helpers.node import load
from helpers.target_modules import inputs as inputs_of, module, turned_by
from rigidsym.errors import KernelError
from rigidsym.kernels.ir import Kernel, KernelArgument, Name, Negative
from rigidsym.kernels.targets import javascript
from rigidsym.motion import derive

NAME = "euler_zxz_intrinsic"


pytestmark = [pytest.mark.usefixtures("node"), pytest.mark.usefixtures("double")]


@cache
def motion_of(rotation: str) -> rs.Motion:
    return derive(rotation)


def given(motion: rs.Motion, inputs: tuple[str, ...], count: int = 2) -> list[np.ndarray]:
    rng = np.random.default_rng(7)
    return [rng.uniform(-3, 3, (count, len(motion.argument(name).symbols))) for name in inputs]


def test_functions_of_the_length_pass_through_zero_and_over_the_switch():
    motion = motion_of("rotation_vector")
    kernels, known = load(motion.kernels("javascript")), motion.kernels().load()
    lengths = np.array([0.0, 1e-12, 1e-3, 1.0, 1.93, 1.94, 2.78, 2.79, 3.99, 4.01, 6.0])
    q = lengths[:, None] * np.array([2.0, -1.0, 2.0]) / 3
    rates = [0.3, -0.5, 0.7]
    for name in ("angular_velocity_body", "angular_acceleration_space"):
        arrays = [q, rates, rates][: 2 + name.startswith("angular_acc")]
        found, expected = getattr(kernels, name)(*arrays), getattr(known, name)(*arrays)
        np.testing.assert_allclose(found, expected, rtol=0, atol=20 * 2.0**-52)


BATCHES = """
import * as kernels from "./euler_zxz_intrinsic.mjs";

const { rotation_matrix_batch: turned, angular_velocity_body_batch: velocity } = kernels;
const q = Float64Array.from({ length: 3 * 1000 }, (_, k) => Math.sin(k) * 3);
const single = Array.from({ length: 1000 }, (_, i) =>
  kernels.rotation_matrix(q.subarray(3 * i, 3 * i + 3)));
const same = (a, b) => a.length === b.length && a.every((value, k) => value === b[k]);
const said = (action) => {
  try { return action(); } catch (error) { return `${error.name}: ${error.message}`; }
};
const out = new Float64Array(9000);
const single32 = new Float32Array(9);
console.log(JSON.stringify([
  same(turned(q), single.flat(2)),
  turned(q) instanceof Float64Array,
  turned(q, out) === out && same(out, single.flat(2)),
  turned(new Float64Array(0)).length,
  turned([0, 0, 0], single32) === single32 && single32[8] === 1,
  same(velocity(q, [1, 2, 3]).slice(3, 6), kernels.angular_velocity_body(q.slice(3, 6), [1, 2, 3])),
  velocity(new Float64Array(0), [1, 2, 3]).length,
  said(() => turned(new Float64Array(7))),
  said(() => turned(undefined)),
  said(() => turned(q, new Float64Array(9))),
  said(() => velocity(q, q.slice(0, 6))),
  said(() => kernels.quaternion(["1", "2", "3"])),
  said(() => kernels.quaternion("123")),
  said(() => kernels.from_rotation_matrix([[1, 0, 0], [0, 1, 0], [0, 0, null]])),
  said(() => turned([0, 0, 0, 0, undefined, 0])),
]));
"""


def test_many_orientations_are_flat_arrays(tmp_path: Path):
    derived("ZXZ").kernels("javascript", conversions=True).write(tmp_path)
    (tmp_path / "main.mjs").write_text(BATCHES, encoding="utf-8")
    done = subprocess.run(
        ["node", "main.mjs"], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout) == [
        *(True, True, True, 0, True, True, 0),
        "RangeError: q: expected rows of 3 numbers, got 7 numbers",
        "RangeError: q: expected rows of 3 numbers, got undefined numbers",
        "RangeError: out: expected 1000 rows of 9 numbers, got 9 numbers",
        "RangeError: q_dot: expected 1000 rows or one, got 2",
        "TypeError: q: expected numbers, got string at 0",  # + would join them
        "TypeError: q: expected numbers, got string at 0",
        "TypeError: matrix: expected numbers, got null at 8",
        "TypeError: q: expected numbers, got undefined at 4",
    ]


def test_text_in_a_title_stays_in_its_comment():
    motion = turned_by("turns", "await", "Math", "of")
    odd = rs.Motion(**{**vars(motion), "title": "*/ throw 1; /* </script>"})
    kernels = odd.kernels("javascript")
    assert "*/ throw" not in kernels.source
    q = [0.1, 0.2, 0.3]
    found = load(kernels).rotation_matrix(q)
    assert np.allclose(found, motion.kernels().load().rotation_matrix(q), atol=1e-14)


def test_a_component_may_be_called_as_its_vector_is():
    vector = KernelArgument(name="q", components=("q",), units=("rad",), about="")
    kernel = Kernel(
        name="minus", arguments=(vector,), assignments=(), outputs=(Negative(Name("q")),), shape=()
    )
    made = node.module("made", javascript.bare([kernel]))
    assert made.minus([2.0]) == -2.0


def test_every_function_is_declared_for_typescript(tmp_path: Path):
    asked = {"angular_velocity_body": "q"}
    kernels = derived("ZXZ").kernels("javascript", conversions=True, derivatives=asked)
    module, types = (kernels.files[f"{NAME}.{ending}"] for ending in ("mjs", "d.mts"))
    functions = r"^export function (\w+)\((.*?)\)[ :]"
    written = {name: given.count(",") for name, given in re.findall(functions, module, re.M)}
    declared = {name: given.count(",") for name, given in re.findall(functions, types, re.M)}
    assert declared == written
    assert "export function rotation_matrix(q: Vector): number[][];" in types
    assert kernels.write(tmp_path / "mine.mjs") == tmp_path / "mine.mjs"


def test_python_does_not_load_it():
    with pytest.raises(
        KernelError, match=f"{NAME}.mjs runs in browsers and in Node, not in Python"
    ):
        derived("ZXZ").kernels("javascript").load()


@cache
def functions(name: str = "ZXZ"):
    return rs.derive(name).kernels("jax").load()


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
