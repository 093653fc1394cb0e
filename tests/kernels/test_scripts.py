"""The targets JavaScript, run by node, and JAX: their manners."""

from __future__ import annotations

import json
import re
import subprocess
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

import rigidsym as rs
from helpers.motions import derived
from helpers.node import load
from helpers.target_modules import inputs, module
from rigidsym.errors import KernelError

NAME = "euler_zxz_intrinsic"


pytestmark = [pytest.mark.usefixtures("node"), pytest.mark.usefixtures("double")]


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
  said(() => turned(q, new Float64Array(9))),
  said(() => velocity(q, q.slice(0, 6))),
  said(() => kernels.quaternion(["1", "2", "3"])),
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
        "RangeError: out: expected 1000 rows of 9 numbers, got 9 numbers",
        "RangeError: q_dot: expected 1000 rows or one, got 2",
        "TypeError: q: expected numbers, got string at 0",  # + would join them
        "TypeError: matrix: expected numbers, got null at 8",
        "TypeError: q: expected numbers, got undefined at 4",
    ]


def test_text_in_a_title_stays_in_its_comment():
    names = ("await", "Math", "of")
    motion = rs.derive(rs.EulerAngles("ZXZ", angles=names), only=["rotation_matrix"])
    odd = rs.Motion(**{**vars(motion), "title": "*/ throw 1; /* </script>"})
    kernels = odd.kernels("javascript")
    assert "*/ throw" not in kernels.source
    q = [0.1, 0.2, 0.3]
    found = load(kernels).rotation_matrix(q)
    assert np.allclose(found, motion.kernels().load().rotation_matrix(q), atol=1e-14)


def test_every_function_is_declared_for_typescript(tmp_path: Path):
    asked = {"angular_velocity_body": "q"}
    kernels = derived("ZXZ").kernels("javascript", conversions=True, derivatives=asked)
    functions = r"^export function (\w+)\("
    written, declared = (
        re.findall(functions, kernels.files[f"{NAME}.{ending}"], re.M)
        for ending in ("mjs", "d.mts")
    )
    assert declared == written
    assert kernels.write(tmp_path / "mine.mjs") == tmp_path / "mine.mjs"
    with pytest.raises(
        KernelError, match=f"{NAME}.mjs runs in browsers and in Node, not in Python"
    ):
        kernels.load()


@cache
def functions(name: str = "ZXZ"):
    return rs.derive(name).kernels("jax").load()


@pytest.mark.campaign
@pytest.mark.parametrize("size", [1e-3, 0.0])
def test_the_tangent_of_the_matrix_is_its_rate(size):
    """At a rotation vector of zero, too, where its formulas are 0/0."""
    import jax

    kernels = functions("rotation_vector")
    q, q_dot = np.random.default_rng(2).normal(size=(2, 3)) * [[size], [1.0]]
    _, tangent = jax.jvp(kernels.rotation_matrix, (q,), (q_dot,))
    assert_allclose(tangent, kernels.rotation_rate(q, q_dot), atol=1e-14)
    second = jax.jacrev(jax.jacfwd(kernels.angular_velocity_space))(q, q_dot)
    assert np.isfinite(second).all()


def test_types_are_those_of_jax():
    import jax

    q = inputs("ZXZ", "rotation_matrix")[0].astype(np.float32)
    matrix = functions().rotation_matrix
    assert matrix(q).dtype == np.float32
    assert functions().spin_matrix(q, q.astype(float)).dtype == np.float64
    jax.config.update("jax_enable_x64", False)
    assert matrix([0, 1, 2]).dtype == np.float32
    assert_allclose(matrix(q), module().rotation_matrix(q), atol=1e-5)


JAX_REFUSES = [
    (np.zeros(4), r"q: got shape \(4,\); expected \(\.\.\., 3\), the last axis phi, theta, psi"),
    (np.zeros(3, complex), "q: got dtype complex128; expected floats"),
    ("abc", "q: JAX takes no array of str"),
    (np.ma.masked_all(3), "q: JAX takes no masked array"),
]


@pytest.mark.parametrize(("q", "message"), JAX_REFUSES)
def test_arguments_that_are_refused(q, message):
    with pytest.raises((TypeError, ValueError), match=f"^{message}$"):
        functions().rotation_matrix(q)
