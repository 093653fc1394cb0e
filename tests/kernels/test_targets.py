"""One law for every target: a function has the value of its expression at 50 digits.

The expressions are those of the derivation, which `tests/laws` compares with witnesses. They are
evaluated at the very floats that the functions are given. A new target is one line of TARGETS.
"""

from __future__ import annotations

import json
import os
import pickle
import subprocess
import sys
from math import prod

import numpy as np
import pytest
import sympy as sp

from helpers.target_modules import (
    EPS,
    EVERY,
    OTHERS,
    ROTATIONS,
    exact,
    inputs,
    module,
    motion,
    names,
    rows_of,
    worst_error,
)
from helpers.witness import mp
from rigidsym.commands.list import inventory
from rigidsym.errors import RigidsymError
from rigidsym.kernels import loaded
from rigidsym.kernels.lowering.rounding import SINE
from rigidsym.kernels.targets import TARGETS

ARRAYS = [each for each in EVERY if each.values[0] in ("numpy", "c", "numba")]  # alike in manners
KINEMATICS = ("rotation_matrix", "angular_velocity_space", "angular_velocity_body")
PROVED = 7  # eps of one, or of the largest rate: `rounding` proves 6.8 for R and 4.6 for Ω and Ω′
MOST = 70  # eps of the largest entry, where nothing is near a pole; 7 were measured


def types(target: str) -> tuple[type, ...]:
    return (np.float64, np.float32)[: 1 + (target != "javascript")]


@pytest.mark.parametrize("target", EVERY)
@pytest.mark.parametrize(
    "rotation",
    [
        pytest.param(name, marks=[pytest.mark.campaign] if name == "rotation_vector" else [])
        for name in ROTATIONS
    ],
)
def test_functions_have_the_values_of_their_expressions(rotation, target):
    for dtype in types(target):
        for name in names(rotation, target):
            arrays = inputs(rotation, name, (4,), dtype)
            found = rows_of(rotation, target, name, arrays)
            assert found.dtype == dtype
            assert worst_error(found, exact(motion(rotation), name, arrays)) <= MOST, name


@pytest.mark.parametrize("target", EVERY)
def test_kinematics_keep_their_bounds_at_angles_of_every_size(target):
    """Special angles, too. Rates that cancel leave a small Ω, whose error is that of a rate."""
    source = np.random.default_rng(3)
    quarters = np.pi / 4 * source.integers(-4, 5, (40, 3))
    q = np.concatenate([*(source.uniform(-s, s, (20, 3)) for s in (1e-8, 3.0, 1e4)), quarters])
    q_dot = source.uniform(-3, 3, q.shape)
    for dtype in types(target):
        for name in KINEMATICS:
            count = len(motion("ZXZ").step(name).quantity.inputs)
            arrays = [array.astype(dtype) for array in (q, q_dot)[:count]]
            scales = np.abs(arrays[1]).max(axis=1) if count == 2 else np.ones(len(q))
            found = rows_of("ZXZ", target, name, arrays)
            assert worst_error(found, exact(motion("ZXZ"), name, arrays), scales) <= PROVED, name


@pytest.mark.parametrize("target", EVERY)
def test_sines_are_within_what_the_bounds_rest_on(target):
    source = np.random.default_rng(12)
    with mp.workdps(400):
        for dtype, sizes in zip(
            types(target), ((4.0, 1e4, 1e15, 1e22, 1e300), (4.0, 1e4, 1e30)), strict=False
        ):
            q = np.concatenate([source.uniform(-s, s, (100, 1)) for s in sizes]).astype(dtype)
            found = rows_of("x(phi)", target, "rotation_matrix", [q])[:, [4, 7]]
            truth = [mp.cos_sin(mp.mpf(float(angle))) for angle in q[:, 0]]
            assert worst_error(found, truth, np.ones(len(q))) <= SINE


LENGTHS = [0.0, 1e-12, 1e-3, 1.0, 1.93, 1.94, 2.78, 2.79, 3.99, 4.01, 6.0]  # beside each switch


@pytest.mark.parametrize("target", OTHERS)
@pytest.mark.parametrize("name", ["rotation_matrix", "angular_acceleration_body"])
def test_functions_of_the_length_pass_through_zero_and_over_their_switches(target, name):
    q = np.outer(LENGTHS, [2 / 3, -1 / 3, 2 / 3])
    rate = np.tile([0.3, -0.5, 0.7], (len(q), 1))
    given = [q] if name == "rotation_matrix" else [q, rate, rate]
    found, expected = (rows_of("rotation_vector", t, name, given) for t in (target, "numpy"))
    np.testing.assert_allclose(found, expected, rtol=0, atol=20 * 2.0**-52)


@pytest.mark.parametrize("target", EVERY)
def test_what_depends_on_nan_or_an_infinite_angle_is_nan_and_nothing_else_is(target):
    for name in ("rotation_matrix", "angular_velocity_body", "rates_from_angular_velocity_body"):
        step = motion("ZXZ").step(name)
        cases = [
            (place, component, symbol, bad)
            for place, vector in enumerate(step.quantity.inputs)
            for component, symbol in enumerate(motion("ZXZ").argument(vector).symbols)
            for bad in ((np.nan, np.inf, -np.inf) if vector == "q" else (np.nan,))
        ]
        arrays = [np.repeat(array, len(cases) + 1, axis=0) for array in inputs("ZXZ", name, (1,))]
        for row, (place, component, _, bad) in enumerate(cases):
            arrays[place][row, component] = bad
        found = rows_of("ZXZ", target, name, arrays)
        assert np.isfinite(found[-1]).all()
        for values, (_, _, symbol, _) in zip(found, cases, strict=False):
            rates = step.expression.atoms(sp.Derivative) - {symbol}  # no φ stands in φ̇
            others = {rate: sp.Dummy() for rate in rates}
            depends = [entry.xreplace(others).has(symbol) for entry in step.expression]
            assert np.isnan(values[depends]).all(), (name, symbol)


@pytest.mark.parametrize("target", EVERY)
def test_at_a_pole_rates_are_nan_and_the_margin_is_zero(target):
    poles = np.array([[0.3, 0.0, 0.2], [0.3, 0.5, 0.2]])
    rates = rows_of("ZXZ", target, "rates_from_angular_velocity_body", [poles, np.ones((2, 3))])
    assert np.isnan(rates).tolist() == [[True, False, True], [False] * 3]  # θ has its rate
    margin = rows_of("ZXZ", target, "singularity_margin", [poles])
    np.testing.assert_allclose(margin[:, 0], [0.0, np.sin(0.5)], rtol=1e-14)


# --- the manners that targets on arrays share with NumPy


@pytest.mark.parametrize("target", ARRAYS)
@pytest.mark.parametrize("rotation", ["ZXZ", "rotation_vector"])
def test_a_batch_is_its_orientations_one_by_one(rotation, target):
    # NumPy's kernels take other ways to the sines from 80, 240 and some thousand rows up
    for leading in ((), (0,), (1,), (64,), (65,), (2, 0, 3), (3, 70), (240,), (4096,)):
        for name in names(rotation, target)[::2]:
            function = getattr(module(rotation, target), name)
            arrays = inputs(rotation, name, leading)
            found = function(*arrays)
            assert found.shape == (*leading, *motion(rotation).step(name).shape)
            for place in list(np.ndindex(leading))[:: 1 + prod(leading) // 8]:
                single = function(*(array[place] for array in arrays))
                largest = np.abs(found).max()  # a sum may cancel in one orientation
                assert np.abs(found[place] - single).max() <= MOST * 2.0**-52 * largest, name


@pytest.mark.parametrize("target", [ARRAYS[0], ARRAYS[-1]])
@pytest.mark.parametrize("rotation", ROTATIONS)
def test_scalar_twins_agree_with_arrays(rotation, target):
    for name in names(rotation, target):
        arrays = inputs(rotation, name, ())
        twin = getattr(module(rotation, target), f"{name}_scalar")
        scalar = np.array(twin(*np.concatenate(arrays).tolist()))
        batch = getattr(module(rotation, target), name)(*(array[np.newaxis] for array in arrays))[0]
        assert np.abs(scalar - batch).max() <= MOST * EPS[np.float64] * np.abs(batch).max(), name


def every_second(array: np.ndarray) -> np.ndarray:
    wide = np.full(tuple(2 * n + 1 for n in array.shape), np.nan)
    view = wide[tuple(slice(1, 2 * n + 1, 2) for n in array.shape)]
    view[...] = array
    return view


LAYOUTS = {
    "rows": np.asarray,
    "every second": every_second,
    "read-only": lambda a: np.frombuffer(a.tobytes()).reshape(a.shape),
    "backwards": lambda a: a[::-1].copy()[::-1],
    "one row": lambda a: a[:1],
    "one": lambda a: a[0],
    "three axes": lambda a: a.reshape(len(a), 1, -1),
    "single precision": lambda a: a.astype(np.float32),
    "other byte order": lambda a: a.astype(">f8"),
    "integers": lambda a: a.astype(np.int64),
    "list": lambda a: a.tolist(),
    "unaligned": lambda a: np.frombuffer(b"x" + a.tobytes(), "u1")[1:].view(float).reshape(a.shape),
}


@pytest.mark.parametrize("first", LAYOUTS)
@pytest.mark.parametrize("target", ARRAYS)
def test_any_layout_broadcasts_as_in_numpy_and_gives_the_same(target, first):
    body = module("ZXZ", target).angular_velocity_body
    names = [*LAYOUTS]
    for second in ("rows", names[names.index(first) - 1], "three axes"):
        q, q_dot = inputs("ZXZ", "angular_velocity_body", (70,))  # more than a tile in C
        given = LAYOUTS[first](q), LAYOUTS[second](q_dot)
        numbers = [np.asarray(array, float) for array in given]
        before = [np.array(array) for array in given]
        wide = np.broadcast_arrays(*numbers)
        expected = body(*map(np.ascontiguousarray, wide))
        found = body(*given)
        singles = all(np.asarray(array).dtype.char == "f" for array in given)
        assert type(found) is np.ndarray
        assert found.flags.c_contiguous
        assert (found.shape, found.dtype.char) == (expected.shape, "f" if singles else "d")
        np.testing.assert_allclose(found, expected, atol=1e-5 if singles else 1e-14)
        for array, copy in zip(given, before, strict=True):
            assert np.array_equal(array, copy)
        out = every_second(np.zeros(expected.shape)).astype(found.dtype)
        assert body(*given, out=out) is out
        assert np.array_equal(out, found)


@pytest.mark.parametrize("count", [1, 40, 10_001])
@pytest.mark.parametrize("target", ARRAYS)
def test_out_may_overlap_the_arguments_and_threads_change_nothing(target, count):
    body = module("ZXZ", target).angular_velocity_body
    for shift in (0, 1, 3, 10):
        for threads in (1, 3):
            memory = np.random.default_rng(3).uniform(-3, 3, 3 * count + 10)
            q, out = (memory[k : k + 3 * count].reshape(-1, 3) for k in (0, shift))
            q_dot = np.ones((count, 3))
            expected = body(q.copy(), q_dot)
            assert body(q, q_dot, out=out, threads=threads) is out
            assert np.array_equal(out, expected)
    q = inputs("ZXZ", "rotation_matrix", (count,))[0]
    expected = body(q, q.copy())
    assert np.array_equal(body(q, q, out=q[::-1]), expected)


@pytest.mark.parametrize("target", ARRAYS)
def test_functions_of_loaded_kernels_are_unpickled_by_another_process(target, tmp_path):
    """As the workers of process pools do, which start without the module."""
    function = module("ZXZ", target).rotation_matrix
    assert pickle.loads(pickle.dumps(function)) is function
    (tmp_path / "function").write_bytes(pickle.dumps(function))
    code = (
        "import pickle; function = pickle.load(open('function', 'rb'))\n"
        "print(function([0.0, 0.0, 0.0]).tolist())"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=True
    )
    assert json.loads(done.stdout) == np.eye(3).tolist()


def test_the_cache_keeps_the_packages_that_were_used_last(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setattr(loaded, "_KEPT", 2)
    folder = tmp_path / "rigidsym" / "kernels"
    for place in range(3):
        loaded.load("one", {"one.py": f"value = {place}"})
        for package in folder.glob("kernels_*"):
            os.utime(package, (0, package.stat().st_mtime - 60))
    assert len(list(folder.iterdir())) == 2
    assert sorted(path.read_text()[-1] for path in folder.glob("*/one.py")) == ["1", "2"]


@pytest.mark.parametrize(("target", "hidden"), [("c", None), ("jax", "jax.numpy")])
def test_without_its_tools_a_target_is_written_and_loading_ends_in_code_4(
    target, hidden, monkeypatch
):
    monkeypatch.setenv("PATH", "/nowhere")
    monkeypatch.delenv("CC", raising=False)
    if hidden is not None:
        monkeypatch.setitem(sys.modules, hidden, None)
    monkeypatch.setattr("rigidsym.kernels.targets.find_spec", lambda _: None)
    with pytest.raises(RigidsymError) as raised:
        motion("ZXZ").kernels(target).load()
    assert raised.value.exit_code == 4
    assert TARGETS[target].missing
    assert TARGETS[target].missing in inventory()


@pytest.mark.skipif(bool(TARGETS["numba"].missing), reason=TARGETS["numba"].missing)
def test_scalar_functions_of_numba_are_called_in_compiled_functions():
    from numba import njit

    velocity = module("ZXZ", "numba").angular_velocity_body_scalar
    compiled = njit(lambda a, b, c, x, y, z: velocity(a, b, c, x, y, z))
    for phi in (0.1, 1e9):  # too large for a loop without branches
        expected = module("ZXZ").angular_velocity_body([phi, 0.2, 0.3], [1.0, 2.0, 3.0])
        found = compiled(phi, 0.2, 0.3, 1.0, 2.0, 3.0)
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-14)
