"""C for firmware: one type, one plain function a quantity, <math.h>."""

from __future__ import annotations

import ctypes
import subprocess

import numpy as np
import pytest

import rigidsym as rs
from helpers.command import call
from helpers.target_modules import STRICT

SOME = ("rotation_matrix", "angular_velocity_body", "inverse_rate_matrix_body")


@pytest.mark.campaign
@pytest.mark.parametrize("dtype", [np.float64, np.float32])
@pytest.mark.parametrize("rotation", ["ZYX", "rotation_vector", "z(a) [1,2,3](b) y(c) x(d)"])
def test_compilers_are_silent_and_results_are_those_of_numpy(tmp_path, rotation, dtype):
    motion, real = (
        rs.derive(rotation, only=SOME),
        {np.float64: "double", np.float32: "float"}[dtype],
    )
    asked = {"conversions": len(rotation) < 4, "derivatives": ["angular_velocity_body by q"]}
    kernels, functions = motion.kernels("c", lean=real, **asked), motion.kernels(**asked).load()
    source, made = kernels.write(tmp_path), tmp_path / "made.so"
    flags = ("-O2", "-shared", "-fPIC", source, "-o", made, "-lm")
    for compiler in ("clang", "gcc"):
        subprocess.run([compiler, *STRICT, *flags], check=True)
    library, random = ctypes.CDLL(str(made)), np.random.default_rng(7)
    for name in (*SOME, "angular_velocity_body_jacobian_q"):
        inputs = motion.step(name.removesuffix("_jacobian_q")).quantity.inputs
        sizes = [len(motion.argument(n).names) for n in inputs]
        given = [random.uniform(0.2, 1.2, size).astype(dtype) for size in sizes]
        found = getattr(functions, name)(*given)
        parts = found if isinstance(found, tuple) else (found,)
        expected = np.hstack([part.ravel() for part in parts])
        out = np.empty(expected.shape, dtype)
        function = getattr(library, f"{kernels.name}_{name}{'f' if real == 'float' else ''}")
        function(*(ctypes.c_void_p(array.ctypes.data) for array in (*given, out)))
        largest = max(1.0, np.abs(expected).max())
        most = 500 * np.finfo(dtype).eps * largest
        np.testing.assert_allclose(out, expected, rtol=0, atol=most, err_msg=name)


FILE = """\
[rotation]
sequence = "ZYX"
[output]
quantities = ["rotation_matrix"]
kernels = ["c"]
note = []
[output.c]
lean = "double"
"""


def test_a_file_and_the_command_line_ask_for_it(tmp_path):
    (tmp_path / "euler_zyx_intrinsic.toml").write_text(FILE)
    call("run", "euler_zyx_intrinsic.toml", "--out", "a", cwd=tmp_path)
    call("derive", "ZYX", "--only", "rotation_matrix", "--lean", "--out", "b", cwd=tmp_path)
    for ending in (".c", ".h"):
        name = f"euler_zyx_intrinsic/euler_zyx_intrinsic{ending}"
        assert len({(tmp_path / out / name).read_text() for out in "ab"}) == 1
    assert "changed" not in call("check", "a", cwd=tmp_path).stdout
    source = "a/euler_zyx_intrinsic/euler_zyx_intrinsic.c"
    refused = call("build", source, cwd=tmp_path, status=2)
    assert "derive --target c writes it, without --lean" in refused.stderr
