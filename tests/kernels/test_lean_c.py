"""C for firmware: one type, one orientation a call, <math.h>."""

from __future__ import annotations

import ctypes
import re
import shutil
import subprocess
from itertools import product

import numpy as np
import pytest

import rigidsym as rs
from helpers.command import call
from helpers.target_modules import STRICT

pytestmark = pytest.mark.campaign

LEAN = {"precision": "double", "arrays": False, "libm": True}
SOME = ("rotation_matrix", "angular_velocity_body", "angular_acceleration_space")
ROTATIONS = {"ZYX": (), "rotation_vector": SOME, "z(a) [1,2,3](b) y(c) x(d)": SOME}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("lean")


@pytest.fixture(scope="module", params=ROTATIONS)
def module(request, folder):
    motion = rs.derive(request.param, only=ROTATIONS[request.param])
    asked = {"conversions": "v" not in request.param, "derivatives": ["angular_velocity_body by q"]}
    kernels = motion.kernels("c", **asked, **LEAN)
    kernels.write(folder)
    return motion, kernels, motion.kernels(**asked).load()


def run(*command: str, cwd) -> str:
    done = subprocess.run(command, cwd=cwd, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.mark.parametrize("compiler", ["gcc", "clang"])
def test_compilers_are_silent_and_the_generated_test_passes(module, folder, compiler):
    _, kernels, _ = module
    made = f"{kernels.name}_{compiler}"
    sources = (kernels.main, f"{kernels.name}_test.c")
    run(compiler, *STRICT, "-O1", *sources, "-o", made, "-lm", cwd=folder)
    assert run(f"./{made}", cwd=folder) == ""


MISRA = ("10.4", "12.1", "12.3", "17.7", "18.4", "19.2")  # of MISRA C:2012, which pilots ask for
_ARMS = re.compile(
    r" \? \(.*\) : \(?[\w. +/]+\)?;$"
)  # cppcheck takes off the parentheses of an arm


def test_the_rules_of_flight_are_kept(module, folder):
    _, kernels, _ = module
    if shutil.which("cppcheck") is None:
        pytest.skip("cppcheck is not installed")
    sources = [kernels.main, f"{kernels.name}_test.c"]
    done = subprocess.run(
        ["cppcheck", "--addon=misra", "--std=c99", *sources],
        cwd=folder,
        capture_output=True,
        text=True,
        check=True,
    )
    found = re.findall(r"\[misra-c2012-([\d.]+)\]\n(.*)", done.stderr)
    assert {rule for rule, _ in found}  # such as 15.5: it did look
    assert [line for rule, line in found if rule in MISRA and not _ARMS.search(line)] == []


def test_the_generated_test_finds_a_wrong_function(module, folder):
    _, kernels, _ = module
    wrong = re.sub(r"out\[0\] = (.*);", r"out[0] = 1e-9 + (\1);", kernels.source)
    (folder / "wrong.c").write_text(wrong, encoding="utf-8")
    run("gcc", "wrong.c", f"{kernels.name}_test.c", "-o", "wrong", "-lm", cwd=folder)
    done = subprocess.run(["./wrong"], cwd=folder, capture_output=True, text=True, check=False)
    tested = kernels.files[f"{kernels.name}_test.c"].count("failures += differs(")
    assert done.returncode == done.stdout.count("entry 0 is") == tested


def test_results_are_those_of_the_numpy_module(module, folder):
    motion, kernels, functions = module
    flags = ("-std=c99", "-O2", "-shared", "-fPIC")
    run("gcc", *flags, kernels.main, "-o", f"{kernels.name}.so", "-lm", cwd=folder)
    library = ctypes.CDLL(str(folder / f"{kernels.name}.so"))
    random = np.random.default_rng(7)
    names = [step.quantity.name for step in motion.steps if hasattr(functions, step.quantity.name)]
    assert len(names) == 13 or set(names) == set(SOME)
    for name in names:
        inputs = motion.step(name).quantity.inputs
        given = [random.uniform(0.2, 1.2, len(motion.argument(n).names)) for n in inputs]
        expected = getattr(functions, name)(*given)
        out = np.empty_like(expected)
        arrays = [ctypes.c_void_p(array.ctypes.data) for array in (*given, out)]
        getattr(library, f"{kernels.name}_{name}")(*arrays)
        largest = max(1.0, np.abs(expected).max())
        np.testing.assert_allclose(out, expected, rtol=0, atol=1e-13 * largest, err_msg=name)


def test_options_may_be_chosen_one_by_one(folder):
    motion = rs.derive("rotation_vector", only="angular_velocity_body")
    for precision, arrays, libm in product(("float", "both"), (True, False), (True, False)):
        kernels = motion.kernels("c", precision=precision, arrays=arrays, libm=libm)
        source = kernels.write(folder).name
        run("clang", *STRICT, "-fsyntax-only", source, cwd=folder)
        assert ("sin(" in kernels.source or "sinf(" in kernels.source) is libm
        assert ("_array" in kernels.source) is arrays
        assert ("double q[" in kernels.files[f"{kernels.name}.h"]) is (precision == "both")
        if (test := f"{kernels.name}_test.c") in kernels.files:
            run("gcc", *STRICT, source, test, "-o", "alone", "-lm", cwd=folder)
            assert run("./alone", cwd=folder) == ""


FILE = """\
[rotation]
sequence = "ZYX"
[output]
quantities = ["rotation_matrix"]
kernels = ["c"]
note = []
[output.c]
precision = "double"
arrays = false
libm = true
"""


def test_a_file_and_the_command_line_ask_for_it(tmp_path):
    (tmp_path / "euler_zyx_intrinsic.toml").write_text(FILE)
    call("run", "euler_zyx_intrinsic.toml", "--out", "a", cwd=tmp_path)
    call("derive", "ZYX", "--only", "rotation_matrix", "--lean", "--out", "b", cwd=tmp_path)
    name = "euler_zyx_intrinsic/euler_zyx_intrinsic"
    for ending in (".c", ".h", "_test.c"):
        texts = {(tmp_path / out / f"{name}{ending}").read_text() for out in "ab"}
        assert len(texts) == 1
    assert "changed" not in call("check", "a", cwd=tmp_path).stdout
    refused = call("build", f"a/{name}.c", cwd=tmp_path, status=2)
    assert "with arrays and both precisions" in refused.stderr
