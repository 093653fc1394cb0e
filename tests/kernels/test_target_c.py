"""The C source by itself: what compilers and sanitizers say, what it needs, how it is built."""

from __future__ import annotations

import ctypes
import json
import re
import shutil
import subprocess
import sys
import sysconfig
from itertools import product
from pathlib import Path

import numpy as np
import pytest
import sympy as sp

import rigidsym as rs
from helpers.command import call
from helpers.target_modules import loading, required
from helpers.witness import mp
from rigidsym.kernels.targets import compiling as c_build

REQUIRED = required("COMPILERS")
COMPILERS = [
    pytest.param(
        name, marks=pytest.mark.skipif(not (REQUIRED or shutil.which(name)), reason=f"no {name}")
    )
    for name in ("gcc", "clang")
]
CPU = Path("/proc/cpuinfo").read_text("utf-8") if Path("/proc/cpuinfo").is_file() else ""
STREAMS = ("-mavx2", "-DSTREAMED=1") if "avx2" in CPU else ()  # past the caches from one row up
SHUFFLES = "#define SHUFFLE __builtin_shufflevector\n"
STRICT = ("-std=c99", "-pedantic", "-Wall", "-Wextra", "-Werror", "-Wshadow", "-Wconversion")
STRICT += ("-Wdouble-promotion",)
SOME = ("rotation_matrix", "angular_velocity_body", "inverse_rate_matrix_body")
NAME = "euler_zxz_intrinsic"

MAIN = """
#include <stdio.h>
#include "euler_zxz_intrinsic.h"

#define N 131
static double q[3 * N], q_dot[3 * N], matrix[9 * N], body[3 * N];
static float qf[3 * N], matrixf[9 * N];

int main(void)
{
    const double sizes[] = {1.0, 1e4, 1e6, 1e15, 1e22, 1e300, 1e-300, 0.0};
    for (int i = 0; i < N; i++) {
        for (int k = 0; k < 3; k++) {
            q[3 * i + k] = (0.37 * i - 20.0 + k) * sizes[i % 8];
            q_dot[3 * i + k] = 0.1 * i - k;
            qf[3 * i + k] = (float)((0.37 * i - 20.0 + k) * (i % 8 == 5 ? 1e30 : sizes[i % 8]));
        }
    }
    volatile double zero = 0.0;
    q[27] = 1.0 / zero;
    q[32] = zero / zero;
    for (size_t count = 0; count <= N; count += 1 + count / 3) {
        euler_zxz_intrinsic_rotation_matrix_array(count, q, 3, 1, matrix, 9, 1);
        euler_zxz_intrinsic_rotation_matrix_arrayf(count, qf, 3, 1, matrixf, 9, 1);
        euler_zxz_intrinsic_angular_velocity_body_array(
            count, q + 3 * (N - 1), -3, 1, q_dot, 0, 1, body, 3, 1);
        euler_zxz_intrinsic_from_rotation_matrix_array(count, matrix, 9, 1, body, 3, 1);
        euler_zxz_intrinsic_from_quaternion_array(count, q, 2, 1, body, 3, 1);
        euler_zxz_intrinsic_from_quaternion_arrayf(count, qf, 2, 1, matrixf, 3, 1);
    }
    euler_zxz_intrinsic_rotation_matrix_arrayf(N, qf, 3, 1, matrixf, 9, 1);
    euler_zxz_intrinsic_rotation_matrix(q + 12, matrix + 36);
    euler_zxz_intrinsic_rates_from_angular_velocity_space(q, q_dot + 3, body + 3);
    printf("%.17g %.17g %.9g\\n", matrix[0], matrix[53], (double)matrixf[35]);
    printf("%.17g %.17g %.17g\\n", q[1], q[16], (double)qf[10]);
    return 0;
}
"""


@pytest.fixture(scope="module")
def sources(tmp_path_factory):
    folder = tmp_path_factory.mktemp("c")
    rs.derive("ZXZ", only=SOME).kernels("c").write(folder)
    return folder


@pytest.fixture(scope="module")
def zxz():
    motion = rs.derive("ZXZ", only=["rotation_matrix"])
    return motion.kernels("c").load(), motion.kernels().load()


def run(*command: str, cwd) -> str:
    done = subprocess.run(command, cwd=cwd, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.mark.campaign
@pytest.mark.parametrize("compiler", COMPILERS)
def test_sanitizers_find_nothing_at_any_size(tmp_path, compiler):
    called = (*SOME[:2], "rates_from_angular_velocity_space")
    rs.derive("ZXZ", only=called).kernels("c", conversions=True).write(tmp_path)
    (tmp_path / "main.c").write_text(MAIN, encoding="utf-8")
    sanitizers = "-fsanitize=address,undefined,float-cast-overflow"
    flags = ("-std=c99", "-g", "-O0", sanitizers, "-DCACHED=1", *STREAMS)
    made = f"main_{compiler}"
    (tmp_path / "empty.c").write_text("int main(void) { return 0; }\n", encoding="utf-8")
    linked = subprocess.run(
        [compiler, sanitizers, "empty.c", "-o", "empty"], cwd=tmp_path, capture_output=True
    )
    if linked.returncode and not REQUIRED:
        pytest.skip(f"{compiler} has no sanitizers; Debian has clang's in libclang-rt-dev")
    run(
        *(compiler, *flags, "-fno-sanitize-recover=all", f"{NAME}.c", "main.c"),
        *("-o", made, "-lm"),
        cwd=tmp_path,
    )
    values, angles = (
        [float(x) for x in line.split()]
        for line in run(str(tmp_path / made), cwd=tmp_path).splitlines()
    )
    with mp.workdps(400):
        assert abs(values[1] - mp.cos(mp.mpf(angles[1]))) < 1e-15
        assert abs(values[2] - mp.cos(mp.mpf(angles[2]))) < 3e-7


@loading("c")
@pytest.mark.campaign
@pytest.mark.parametrize("compiler", COMPILERS)
@pytest.mark.parametrize("way", ["shuffled", "plain", *(["streamed"] if STREAMS else [])])
def test_rows_stand_where_they_belong(sources, zxz, compiler, way):
    """Any count, from any place in a line of the cache, into rows side by side and apart."""
    text = (sources / f"{NAME}.c").read_text(encoding="utf-8")
    assert text.count(SHUFFLES) == 1
    name = f"rows_{compiler}_{way}"
    kept = text.replace(SHUFFLES, "") if way == "plain" else text
    (sources / f"{name}.c").write_text(kept, encoding="utf-8")
    flags = ["-std=c99", "-O2", "-fPIC", "-shared", "-ffp-contract=off"]
    flags += STREAMS if way == "streamed" else ()
    run(compiler, *flags, f"{name}.c", "-o", f"{name}.so", "-lm", cwd=sources)
    library = ctypes.CDLL(str(sources / f"{name}.so"))
    for dtype, suffix in ((np.float64, ""), (np.float32, "f")):
        many = getattr(library, f"{NAME}_rotation_matrix_array{suffix}")
        q = np.random.default_rng(0).uniform(-3, 3, (120, 3)).astype(dtype)
        expected = zxz[0].rotation_matrix(q).reshape(120, 9)
        for start, count, width in product(range(9), (0, 1, 31, 32, 33, 64, 95, 111), (9, 11)):
            found = np.full((count + 1, width), 7.0, dtype)
            given, filled = (ctypes.c_void_p(a.ctypes.data) for a in (q[start:], found))
            steps, across = (map(ctypes.c_ssize_t, (n, 1)) for n in (3, width))
            many(ctypes.c_size_t(count), given, *steps, filled, *across)
            wide = np.full_like(found, 7.0)
            wide[:count, :9] = expected[start : start + count]
            # fused or not, an entry is within 2 eps of the exact one
            np.testing.assert_allclose(found, wide, rtol=0, atol=4 * np.finfo(dtype).eps)


@loading("c")
def test_build_compiles_what_derive_wrote_and_says_what_is_missing(tmp_path, monkeypatch):
    command = ("derive", "z(phi)", "--only", "rotation_matrix", "--target", "c", "--out", ".")
    call(*command, cwd=tmp_path)
    source = "chain_z/chain_z.c"
    assert call("build", source, cwd=tmp_path).stdout == "chain_z/chain_z_c.py\n"
    code = "import chain_z_c as m; print(m.rotation_matrix([0.0]).tolist())"
    folder = tmp_path / "chain_z"
    assert json.loads(run(sys.executable, "-c", code, cwd=folder)) == np.eye(3).tolist()
    bare = call("build", source, cwd=tmp_path, status=4, PATH="/nowhere", CC="")
    assert "needs a C compiler (cc, gcc, clang), which is not installed" in bare.stderr
    monkeypatch.setattr(sysconfig, "get_paths", lambda: {"include": "/nowhere"})
    bare = call("build", source, cwd=tmp_path, status=4)
    assert "needs Python's header /nowhere/Python.h, which is not installed" in bare.stderr
    (folder / "chain_z.h").unlink()
    wrong = call("build", source, cwd=tmp_path, status=2).stderr
    assert wrong.startswith("rigidsym: chain_z/chain_z.h: not found;")


@pytest.mark.parametrize("compiler", COMPILERS)
def test_modes_that_change_values_are_refused(tmp_path, compiler):
    source = rs.derive("ZXZ", only=["rotation_matrix"]).kernels("c").write(tmp_path)
    for flag in ("-ffast-math", "-Ofast", "-ffinite-math-only"):
        command = (compiler, "-O2", flag, "-c", source.name, "-o", "refused.o")
        done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
        assert done.returncode != 0, flag
        assert "compile without -ffast-math" in done.stderr, flag


@loading("c")
def test_one_time_and_one_row_of_constants_serve_many_tops():
    a, c = sp.symbols("A C")
    body = rs.principal_moments(a, a, c)
    motion = rs.derive("ZXZ", ["state_derivative"], body=body, potential="m*g*l*cos(theta)")
    memory = np.random.default_rng(6).uniform(0.3, 3, 70 * 6 + 4)
    y, constants = memory[:-4].reshape(-1, 6), np.linspace(1, 2, 6)
    for target in ("numpy", "c"):
        derivative = motion.kernels(target).load().state_derivative
        expected = derivative(np.full(70, 0.5), y, np.tile(constants, (70, 1)))
        for time in (0.5, np.array(0.5), np.full(70, 0.5)):
            for threads in (1, 2):
                assert np.array_equal(derivative(time, y, constants, threads=threads), expected)
        out = memory.copy()[4:].reshape(y.shape)  # three results are components of y
        rows = out.base[:-4].reshape(y.shape)
        assert np.array_equal(derivative(0.5, rows, constants, out=out), expected)
    single = derivative(0.5, y.astype(np.float32), constants.astype(np.float32))
    assert single.dtype == np.float64  # a plain number is one


@loading("c")
def test_the_memory_of_a_large_result_is_used_again_when_nobody_refers_to_it(zxz):
    compiled, plain = zxz
    q = np.random.default_rng(5).uniform(-3, 3, (480_000, 3))  # 35 MB of matrices
    first, second = compiled.rotation_matrix(q), compiled.rotation_matrix(-q)
    some, place = first[1000:1005], first.ctypes.data
    del first
    third = compiled.rotation_matrix(q[::-1])
    assert not np.shares_memory(some, third)
    np.testing.assert_allclose(some, plain.rotation_matrix(q[1000:1005]), atol=1e-14)
    np.testing.assert_allclose(second[-3:], plain.rotation_matrix(-q[-3:]), atol=1e-14)
    del some
    again = compiled.rotation_matrix(q, threads=2)
    assert again.ctypes.data == place or not sys.platform.startswith("linux")
    np.testing.assert_array_equal(again[::-1][:50], third[:50])


@loading("c")
def test_a_source_is_compiled_once_with_a_cache_and_without_one(tmp_path, monkeypatch):
    (tmp_path / "file").write_text("", encoding="utf-8")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    module = rs.derive("x(phi)", only=["rotation_matrix"]).kernels("c").load()
    assert module.rotation_matrix([0.0]).tolist() == np.eye(3).tolist()
    kernels = rs.derive("y(phi)", only=["rotation_matrix"]).kernels("c")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    kernels.load()
    (kept,) = (tmp_path / "rigidsym" / "kernels").iterdir()
    monkeypatch.setattr(c_build, "compile_library", None)  # nothing is compiled any more
    assert kernels.load().__file__ == str(kept / "chain_y_c.py")


@pytest.mark.skipif(not shutil.which("gcc"), reason="no gcc")
def test_it_needs_nothing_and_keeps_nothing(sources):
    run("gcc", "-std=c99", "-O2", "-fno-math-errno", "-c", f"{NAME}.c", "-o", "n.o", cwd=sources)
    symbols = [line.split()[-2:] for line in run("nm", "n.o", cwd=sources).splitlines()]
    assert {kind for kind, _ in symbols} <= {"T", "t", "r"}  # no data, nothing undefined
    text = (sources / f"{NAME}.c").read_text(encoding="utf-8")
    assert not re.search(r"\b(malloc|calloc|alloca|goto|setjmp)\b", text)
    (tile,) = re.findall(r"TILE = (\d+)", text)
    header = (sources / f"{NAME}.h").read_text(encoding="utf-8").replace("\n * ", " ")
    assert f"keeps {tile} orientations" in header


@pytest.mark.campaign
@pytest.mark.parametrize("dtype", [np.float64, np.float32])
@pytest.mark.parametrize("rotation", ["ZYX", "rotation_vector", "z(a) [1,2,3](b) y(c) x(d)"])
def test_compilers_are_silent_and_results_are_those_of_numpy(tmp_path, rotation, dtype):
    some = SOME[:2] if "[" in rotation else SOME  # of a long chain there is no inverse
    motion = rs.derive(rotation, only=some)
    real = {np.float64: "double", np.float32: "float"}[dtype]
    asked = {"conversions": len(rotation) < 4, "derivatives": ["angular_velocity_body by q"]}
    kernels, functions = motion.kernels("c", lean=real, **asked), motion.kernels(**asked).load()
    source, made = kernels.write(tmp_path), tmp_path / "made.so"
    flags = ("-O2", "-shared", "-fPIC", source, "-o", made, "-lm")
    for compiler in ("clang", "gcc"):
        subprocess.run([compiler, *STRICT, *flags], check=True)
    library, random = ctypes.CDLL(str(made)), np.random.default_rng(7)
    for name in (*some, "angular_velocity_body_jacobian_q"):
        inputs = motion.step(name.removesuffix("_jacobian_q")).quantity.inputs
        sizes = [len(motion.argument(n).names) for n in inputs]
        given = [random.uniform(0.2, 1.2, size).astype(dtype) for size in sizes]
        expected = getattr(functions, name)(*given).ravel()
        out = np.empty(expected.shape, dtype)
        function = getattr(library, f"{kernels.name}_{name}{'f' if real == 'float' else ''}")
        function(*(ctypes.c_void_p(array.ctypes.data) for array in (*given, out)))
        largest = max(1.0, np.abs(expected).max())
        most = 500 * np.finfo(dtype).eps * largest
        np.testing.assert_allclose(out, expected, rtol=0, atol=most, err_msg=name)


def test_the_command_line_asks_for_lean_c_which_python_does_not_build(tmp_path):
    command = ("derive", "ZYX", "--only", "rotation_matrix", "--lean", "--out", "a")
    call(*command, cwd=tmp_path)
    source = "a/euler_zyx_intrinsic/euler_zyx_intrinsic.c"
    lean = rs.derive("ZYX", only="rotation_matrix").kernels("c", lean="double").source
    assert (tmp_path / source).read_text("utf-8") == lean
    assert "changed" not in call("check", "a", cwd=tmp_path).stdout
    refused = call("build", source, cwd=tmp_path, status=2)
    assert "derive --target c writes them; omit --lean" in refused.stderr
