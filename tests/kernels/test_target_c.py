"""The C source by itself: what compilers and sanitizers say, what it needs, how it is built."""

from __future__ import annotations

import ctypes
import json
import os
import platform
import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import rigidsym as rs
from helpers.command import call
from helpers.target_modules import STRICT
from helpers.witness import mp
from rigidsym.errors import CheckError, MissingTool
from rigidsym.kernels.targets import compiling as c_build

REQUIRED = os.environ.get("RIGIDSYM_REQUIRE_COMPILERS") == "1"  # then they fail, not skip
COMPILERS = [
    pytest.param(
        name,
        marks=pytest.mark.skipif(not (REQUIRED or shutil.which(name)), reason=f"no {name}"),
    )
    for name in ("gcc", "clang")
]
CPU = Path("/proc/cpuinfo").read_text("utf-8") if Path("/proc/cpuinfo").is_file() else ""
STREAMS = ("-mavx2", "-DSTREAMED=1") if "avx2" in CPU else ()  # past the caches from one row up
SHUFFLES = "#define SHUFFLE __builtin_shufflevector\n"
ROTATIONS = ("ZXZ", "rotation_vector", "quaternion")
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
    for rotation in ROTATIONS:
        rs.derive(rotation).kernels("c").write(folder)
    return folder


def run(*command: str, cwd) -> str:
    done = subprocess.run(command, cwd=cwd, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.mark.campaign
@pytest.mark.parametrize("compiler", COMPILERS)
def test_compilers_have_nothing_to_say(sources, tmp_path, compiler):
    # gcc warns of more while it optimises, clang of all while it reads
    how = ("-O1", "-c", "-o", "gcc.o") if compiler == "gcc" else ("-fsyntax-only",)
    for rotation in ROTATIONS:
        name = rs.derive(rotation, only=["rotation_matrix"]).name
        run(compiler, *STRICT, *how, f"{name}.c", cwd=sources)
    for rotation in (*ROTATIONS, "direction_cosines", "z(phi) [a,b,c](beta)"):
        alone = rs.derive(rotation, only=["rotation_matrix"])
        source = alone.kernels("c", conversions=True).write(tmp_path)
        run(compiler, *STRICT, "-fsyntax-only", source.name, cwd=tmp_path)


@pytest.mark.parametrize("compiler", COMPILERS)
def test_names_of_angles_may_be_words_of_c(tmp_path, compiler):
    names = ("φ", "double", "NAN")
    motion = rs.derive(rs.EulerAngles("ZXZ", angles=names), only=["rotation_matrix"])
    source = motion.kernels("c").write(tmp_path)
    run(compiler, *STRICT, "-fsyntax-only", source.name, cwd=tmp_path)


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
@pytest.mark.skipif(not shutil.which("gcc"), reason="no gcc")
@pytest.mark.parametrize("contract", ["off", "fast"])
def test_sine_and_cosine_keep_two_eps_of_their_size_at_any_angle(sources, contract):
    made = sources / f"{contract}.so"
    flags = ("-std=c99", "-O2", "-fPIC", "-shared", f"-ffp-contract={contract}", "-march=native")
    run("gcc", *flags, f"{NAME}.c", "-o", str(made), "-lm", cwd=sources)
    library = ctypes.CDLL(str(made))
    random = np.random.default_rng(2)
    for dtype, suffix, most in ((np.float64, "", 300), (np.float32, "f", 37)):
        angles = np.concatenate(
            [
                random.choice([-1.0, 1.0], 150) * 10.0 ** random.uniform(-6, most, 150),
                np.arange(-40, 40) * np.pi / 2,
                random.uniform(-1e4, 1e4, 80),
                random.uniform(-4e6, 4e6, 80),
            ]
        ).astype(dtype)
        q, matrix = np.zeros((len(angles), 3), dtype), np.zeros((len(angles), 9), dtype)
        q[:, 1] = angles
        function = getattr(library, f"{NAME}_rotation_matrix{suffix}")
        for row, out in zip(q, matrix, strict=True):
            function(ctypes.c_void_p(row.ctypes.data), ctypes.c_void_p(out.ctypes.data))
        with mp.workdps(400):
            for angle, row in zip(angles.tolist(), matrix.tolist(), strict=True):
                for found, truth in ((row[7], mp.sin(angle)), (row[8], mp.cos(angle))):
                    limit = 2 * float(np.finfo(dtype).eps) * abs(truth)
                    assert abs(found - truth) <= limit, angle


@pytest.mark.campaign
@pytest.mark.parametrize("compiler", COMPILERS)
def test_sanitizers_find_nothing_at_any_size(tmp_path, compiler):
    rs.derive("ZXZ").kernels("c", conversions=True).write(tmp_path)
    (tmp_path / "main.c").write_text(MAIN, encoding="utf-8")
    sanitizers = "-fsanitize=address,undefined,float-cast-overflow"
    flags = ("-std=c99", "-g", "-O1", sanitizers, *STREAMS)
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


@pytest.mark.campaign
@pytest.mark.parametrize("compiler", COMPILERS)
@pytest.mark.parametrize("way", ["shuffled", "plain", *(["streamed"] if STREAMS else [])])
def test_rows_stand_where_they_belong(sources, compiler, way):
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
        one = getattr(library, f"{NAME}_rotation_matrix{suffix}")
        many = getattr(library, f"{NAME}_rotation_matrix_array{suffix}")
        q = np.random.default_rng(0).uniform(-3, 3, (120, 3)).astype(dtype)
        expected = np.zeros((120, 9), dtype)
        for row, out in zip(q, expected, strict=True):
            one(ctypes.c_void_p(row.ctypes.data), ctypes.c_void_p(out.ctypes.data))
        for start in range(9):
            for count in (0, 1, 31, 32, 33, 64, 95, 111):
                for width in (9, 11):
                    found = np.full((count + 1, width), 7.0, dtype)
                    given, filled = (ctypes.c_void_p(a.ctypes.data) for a in (q[start:], found))
                    steps = map(ctypes.c_ssize_t, (3, 1))
                    across = map(ctypes.c_ssize_t, (width, 1))
                    many(ctypes.c_size_t(count), given, *steps, filled, *across)
                    assert np.array_equal(found[:count, :9], expected[start : start + count])
                    assert (found[count:] == 7).all()
                    assert (found[:, 9:] == 7).all()
                for height in (count, 112, 113):
                    columns = np.full((10, height), 7.0, dtype)
                    given, filled = (ctypes.c_void_p(a.ctypes.data) for a in (q[start:], columns))
                    steps, across = (map(ctypes.c_ssize_t, pair) for pair in ((3, 1), (1, height)))
                    many(ctypes.c_size_t(count), given, *steps, filled, *across)
                    assert np.array_equal(columns[:9, :count].T, expected[start : start + count])
                    assert (columns[:9, count:] == 7).all()
                    assert (columns[9] == 7).all()


@pytest.mark.campaign
@pytest.mark.parametrize("flag", ["-msse2", *(["-mavx2"] if "avx2" in CPU else [])])
@pytest.mark.parametrize("compiler", COMPILERS)
def test_a_tile_of_any_width_is_taken_and_given_back(sources, compiler, flag):
    """Rows of 1 to 14 components, shuffled by fours or one by one."""
    if platform.machine() != "x86_64":
        pytest.skip("other vectors")
    text = (sources / f"{NAME}.c").read_text(encoding="utf-8").removesuffix("#endif\n")
    widths = range(1, 15)
    text += "\nvoid FN(turn)(const int n, const REAL *from, REAL *tile, REAL *to)\n{"
    for n in widths:
        take = f"FN(take_rows)(SHUFFLED, {n}, from, tile);"
        streams = "STREAMED < SIZE_MAX && (uintptr_t)to % 32 == 0"
        give = f"FN(give_rows)(SHUFFLED, {n}, tile, to, {streams});"
        text += f"\n    if (n == {n}) {{\n        {take}\n        {give}\n    }}"
    text += "\n}\n#endif\n"
    name = f"tiles_{compiler}_{flag.strip('-')}"
    widened = re.sub(r"MOST = \d+", f"MOST = {widths[-1]}", text)
    renamed = widened.replace(f'include "{NAME}.c"', f'include "{name}.c"')
    (sources / f"{name}.c").write_text(renamed, encoding="utf-8")
    flags = ("-std=c99", "-O1", "-fPIC", "-shared", flag)
    run(compiler, *flags, f"{name}.c", "-o", f"{name}.so", "-lm", cwd=sources)
    library = ctypes.CDLL(str(sources / f"{name}.so"))
    for function, dtype in ((library.turn, np.float64), (library.turnf, np.float32)):
        for n in widths:
            rows = np.arange(32 * n, dtype=dtype).reshape(32, n)
            tile, back = np.zeros((n, 32), dtype), np.zeros_like(rows)
            function(n, *(ctypes.c_void_p(a.ctypes.data) for a in (rows, tile, back)))
            assert np.array_equal(tile, rows.T)
            assert np.array_equal(back, rows)


@pytest.mark.campaign
@pytest.mark.skipif(not shutil.which("gcc"), reason="no gcc")
@pytest.mark.skipif("avx" not in CPU, reason="a processor without AVX")
@pytest.mark.parametrize("compiler", COMPILERS)
def test_no_loop_leaves_wide_registers_in_use(tmp_path, monkeypatch, compiler):
    """Where one does, all that was compiled for older processors slows down after it."""
    monkeypatch.setenv("CC", compiler)
    rs.derive("ZXZ", only=["rotation_matrix"]).kernels("c").write(tmp_path)
    c_build.build(tmp_path / f"{NAME}.c")
    (library,) = tmp_path.glob("*.so")
    text = run("objdump", "-d", "--no-show-raw-insn", library.name, cwd=tmp_path)
    loops = [part for part in text.split("\n\n") if "_loop" in part.partition("\n")[0]]
    assert len(loops) >= 2
    for loop in loops:
        assert "vzeroupper" in loop


@pytest.mark.campaign
@pytest.mark.skipif(platform.machine() != "x86_64", reason="other vectors")
@pytest.mark.parametrize("compiler", COMPILERS)
def test_a_portable_module_uses_wide_vectors_in_its_clones_only(tmp_path, monkeypatch, compiler):
    monkeypatch.setenv("CC", compiler)
    motion = rs.derive("z(phi) [1,2,2](theta) x(psi)", only=["rotation_matrix"])
    source = motion.kernels("c", conversions=True).write(tmp_path)
    run(compiler, *STRICT, "-DCLONES", "-fsyntax-only", source.name, cwd=tmp_path)
    if compiler == "clang":
        motion.kernels("c").write(tmp_path)  # gcc builds those of the conversions too
    made = call("build", "--portable", source.name, cwd=tmp_path).stdout.strip()
    assert made == f"{source.stem}_c.py"
    (library,) = tmp_path.glob("*.so")
    text = run("objdump", "-d", "--no-show-raw-insn", library.name, cwd=tmp_path)
    functions = [part for part in text.split("\n\n") if ">:" in part.partition("\n")[0]]
    found = {
        (name, register)
        for part in functions
        for register in re.findall(r"%([yz]mm)", part)
        for name in [re.search(r"_(avx2|avx512)f?[.>]|$", part.partition("\n")[0])[1]]
    }
    assert found == {("avx2", "ymm"), ("avx512", "zmm"), ("avx512", "ymm")}
    code = f"import {source.stem}_c as m; print(m.rotation_matrix([[0.1, 0.2, 0.3]] * 40).tolist())"
    rows = np.array(json.loads(run(sys.executable, "-c", code, cwd=tmp_path)))
    expected = motion.kernels().load().rotation_matrix([0.1, 0.2, 0.3])
    assert np.abs(rows - expected).max() < 8 * 2.0**-52


@pytest.mark.skipif(not shutil.which("cc"), reason="no cc")
def test_build_takes_a_rotation_and_a_file_and_says_what_is_missing(tmp_path):
    made = call("build", "quaternion", "--out", ".", cwd=tmp_path).stdout.strip()
    assert made == "quaternion/quaternion_c.py"
    code = (
        "import numpy as np, pickle, quaternion_c as m\n"
        "assert pickle.loads(pickle.dumps(m.rotation_matrix)) is m.rotation_matrix\n"
        "print(m.rotation_matrix(np.array([1.0, 0, 0, 0])).tolist())"
    )
    folder = tmp_path / "quaternion"
    assert run(sys.executable, "-c", code, cwd=folder).startswith("[[1.0, 0.0, 0.0], [0.0")
    (tmp_path / "mine.toml").write_text('[rotation]\nsequence = "z(phi)"\n')
    made = call("build", "mine.toml", "--out", ".", cwd=tmp_path).stdout.strip()
    assert made == "mine/mine_c.py"
    (folder / "quaternion.h").unlink()
    wrong = call("build", "quaternion/quaternion.c", cwd=tmp_path, status=2).stderr
    assert wrong.startswith("rigidsym: quaternion/quaternion.h: not found;")
    bare = call("build", "quaternion", "--out", ".", cwd=tmp_path, status=4, PATH="/nowhere", CC="")
    assert "needs a C compiler, and none was found (cc, gcc, clang)" in bare.stderr
    assert (folder / "quaternion.h").is_file()
    checked = call("check", "quaternion", cwd=tmp_path).stdout
    assert "quaternion/quaternion.c: up to date" in checked
    assert "quaternion/quaternion_module.c: up to date" in checked


def test_a_missing_file_or_compiler_is_named(tmp_path, monkeypatch):
    with pytest.raises(CheckError, match=r"none\.h"):
        c_build.build(tmp_path / "none.c")
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.delenv("CC", raising=False)
    with pytest.raises(MissingTool, match="apt install gcc"):
        c_build.compiler()


MODES = """
#include <math.h>
#include <stdio.h>
#include "euler_zxz_intrinsic.h"

enum { N = 64 };
static double q[3 * N], R[9 * N], one[9];
static float qf[3 * N], Rf[9 * N], onef[9];

int main(void)
{
    double worst = 0.0;
    for (int k = 0; k < N; k++) {
        q[3 * k + 1] = 0.37 * k - 5.0;
        q[3 * k] = 1000.1 * k;
        q[3 * k + 2] = -0.01 * k;
    }
    for (int k = 0; k < 3 * N; k++) {
        qf[k] = (float)q[k];
    }
    euler_zxz_intrinsic_rotation_matrix_array(N, q, 3, 1, R, 9, 1);
    euler_zxz_intrinsic_rotation_matrix_arrayf(N, qf, 3, 1, Rf, 9, 1);
    for (int k = 0; k < N; k++) {
        const double exact = cos(q[3 * k + 1]), far = sin(q[3 * k]) * sin(q[3 * k + 1]);
        euler_zxz_intrinsic_rotation_matrix(q + 3 * k, one);
        euler_zxz_intrinsic_rotation_matrixf(qf + 3 * k, onef);
        worst = fmax(worst, fabs(R[9 * k + 8] - exact));
        worst = fmax(worst, fabs(one[8] - exact));
        worst = fmax(worst, fabs(R[9 * k + 2] - far));
        worst = fmax(worst, 1e-10 * fabs(Rf[9 * k + 8] - exact));
        worst = fmax(worst, 1e-10 * fabs(onef[8] - exact));
    }
    printf("%.3g", worst);
    return 0;
}
"""
REFUSED = {
    "gcc": (
        "-ffast-math",
        "-Ofast",
        "-funsafe-math-optimizations",
        "-fassociative-math -fno-signed-zeros -fno-trapping-math",
        "-freciprocal-math",
        "-ffinite-math-only",
    ),
    "clang": ("-ffast-math", "-Ofast", "-ffinite-math-only"),
}
TAKEN = (
    "-O0",
    "-O3 -march=native -ffp-contract=fast -fno-math-errno -fno-trapping-math",
    "-O3 -fno-signed-zeros",
)
TAKEN_BY_CLANG = (  # which has no macro for them: a pragma takes their effect away
    "-O3 -march=native -funsafe-math-optimizations",
    "-O3 -fassociative-math -fno-signed-zeros -fno-trapping-math",
)


@pytest.mark.parametrize("compiler", COMPILERS)
def test_modes_that_change_values_are_refused_or_have_no_effect(tmp_path, compiler):
    source = rs.derive("ZXZ", only=["rotation_matrix"]).kernels("c").write(tmp_path)
    for flags in REFUSED[compiler]:
        command = (compiler, "-O2", *flags.split(), "-c", source.name, "-o", "refused.o")
        done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
        assert done.returncode != 0, flags
        assert "compile without -ffast-math" in done.stderr, flags
    (tmp_path / "modes.c").write_text(MODES, encoding="utf-8")
    run(compiler, "-O2", "-c", "modes.c", "-o", "modes.o", cwd=tmp_path)
    for flags in (*TAKEN, *(TAKEN_BY_CLANG if compiler == "clang" else ())):
        run(compiler, *flags.split(), "-c", source.name, "-o", "taken.o", cwd=tmp_path)
        run(compiler, "modes.o", "taken.o", "-o", "modes", "-lm", cwd=tmp_path)
        assert float(run("./modes", cwd=tmp_path)) < 4e-16, flags


@pytest.fixture(scope="module")
def both():
    motion = rs.derive("ZXZ", only=["angular_velocity_body", "rotation_matrix"])
    return motion.kernels("c").load(), motion.kernels().load()


@pytest.mark.parametrize(
    "out",
    [
        np.empty((5, 3, 3)),
        np.empty((5, 3, 3), order="F"),
        np.empty((5, 3, 6))[..., ::2],
        np.empty((5, 6, 3))[:, ::2],
        np.empty((10, 3, 3))[::-2],
    ],
    ids=["rows", "columns", "entries apart", "rows apart", "backwards"],
)
def test_a_matrix_fills_an_out_of_any_strides(both, out):
    compiled, _ = both
    q = np.random.default_rng(4).uniform(-3, 3, (5, 3))
    assert compiled.rotation_matrix(q, out=out) is out
    np.testing.assert_array_equal(out, compiled.rotation_matrix(q))


def test_the_memory_of_a_large_result_is_used_again_when_nobody_refers_to_it(both):
    compiled, plain = both
    q = np.random.default_rng(5).uniform(-3, 3, (480_000, 3))  # 35 MB of matrices
    first, second = compiled.rotation_matrix(q), compiled.rotation_matrix(-q)
    assert not np.shares_memory(first, second)
    some, place = first[1000:1005], first.ctypes.data
    del first
    third = compiled.rotation_matrix(q[::-1])
    assert not np.shares_memory(some, third)
    np.testing.assert_allclose(some, plain.rotation_matrix(q[1000:1005]), atol=1e-14)
    np.testing.assert_allclose(second[-3:], plain.rotation_matrix(-q[-3:]), atol=1e-14)
    np.testing.assert_allclose(third[:3], plain.rotation_matrix(q[:-4:-1]), atol=1e-14)
    del some
    for threads in (1, 2):
        again = compiled.rotation_matrix(q, threads=threads)
        assert again.ctypes.data == place or not sys.platform.startswith("linux")
        assert again.flags.writeable
        np.testing.assert_array_equal(again[::-1][:50], third[:50])
        del again


@pytest.mark.parametrize(("count", "is_shared"), [(10_000, False), (100_000, True)])
def test_threads_share_only_what_takes_longer_than_handing_it_over(
    both, monkeypatch, count, is_shared
):
    compiled, _ = both
    shared, share = [], compiled._share

    def counted(*arguments):
        shared.append(arguments)
        share(*arguments)

    monkeypatch.setattr(compiled, "_share", counted)
    q = np.random.default_rng(5).uniform(-3, 3, (count, 3))
    for given in (q, q.T.copy().T, q.astype(np.float32), [*map(tuple, q[:9])]):
        found = compiled.rotation_matrix(given, threads=2)
        np.testing.assert_array_equal(found, compiled.rotation_matrix(given))
    assert bool(shared) is is_shared
    with pytest.raises(ValueError, match="threads"):
        compiled.rotation_matrix(q, threads=0)


def test_a_source_is_compiled_once_and_kept_in_the_cache(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    kernels = rs.derive("ZXZ", only=["rotation_matrix"]).kernels("c")
    first = kernels.load()
    (kept,) = (tmp_path / "rigidsym" / "kernels").iterdir()
    monkeypatch.setattr(c_build, "compile_library", None)  # nothing is compiled any more
    again = kernels.load()
    assert again.__file__ == str(kept / f"{NAME}_c.py")
    q = [0.1, 0.2, 0.3]
    np.testing.assert_array_equal(first.rotation_matrix(q), again.rotation_matrix(q))


def test_without_a_cache_folder_modules_are_built_all_the_same(tmp_path, monkeypatch):
    (tmp_path / "file").write_text("", encoding="utf-8")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    module = rs.derive("x(phi)", only=["rotation_matrix"]).kernels("c").load()
    assert module.rotation_matrix([0.0]).tolist() == np.eye(3).tolist()
