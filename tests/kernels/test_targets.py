"""One list of rotations and one set of laws for every target that computes on arrays.

A new target is one line of ARRAYS. Values are judged by the derivation's own expressions at 50
digits, of the very floats that the functions are given.
"""

from __future__ import annotations

import json
import os
import pickle
import subprocess
import sys

import numpy as np
import pytest

import rigidsym as rs
from helpers.target_modules import (
    EPS,
    FOUR,
    KINEMATICS,
    ROTATIONS,
    error,
    given,
    module,
    motion,
    names,
)
from helpers.witness import mp
from rigidsym.commands.list import inventory
from rigidsym.errors import MissingExtra, RigidsymError
from rigidsym.kernels import loaded
from rigidsym.kernels.targets import TARGETS

ARRAYS = ("numpy", "c", "numba")
PRESENT = [
    pytest.param(
        name,
        marks=pytest.mark.skipif(bool(TARGETS[name].missing), reason=TARGETS[name].missing),
    )
    for name in ARRAYS
]
MOST = 16  # eps of the largest entry, for rates and matrices of points that are no poles

LEADING = ((), (0,), (1,), (63,), (64,), (65,), (2, 0, 3), (3, 70))


@pytest.mark.parametrize("dtype", EPS, ids=["double", "float"])
@pytest.mark.parametrize("target", PRESENT)
@pytest.mark.parametrize("rotation", ROTATIONS)
def test_functions_agree_with_their_expressions_at_50_digits(rotation, target, dtype):
    for name in names(rotation):
        found = error(rotation, target, name, given(rotation, name, (4,), dtype))
        assert found <= MOST, (name, found)


@pytest.mark.parametrize("dtype", EPS, ids=["double", "float"])
@pytest.mark.parametrize("target", PRESENT)
def test_kinematics_keep_four_eps_up_to_ten_thousand_radians(target, dtype):
    for name in KINEMATICS:
        arrays = given("ZXZ", name, (40,), dtype, size=1e4)
        assert error("ZXZ", target, name, arrays) <= FOUR, name


@pytest.mark.parametrize("size", [1e6, 1e15, 1e22, 1e300])
@pytest.mark.parametrize("target", PRESENT)
def test_large_angles_are_right(target, size):
    arrays = given("ZXZ", "rotation_matrix", (20,), size=size)
    with mp.workdps(400):
        assert error("ZXZ", target, "rotation_matrix", arrays) <= FOUR


@pytest.mark.parametrize("dtype", EPS, ids=["double", "float"])
@pytest.mark.parametrize("target", PRESENT)
def test_nan_and_infinity_give_nan_and_disturb_no_neighbour(target, dtype):
    turned = module("ZXZ", target).rotation_matrix
    (q,) = given("ZXZ", "rotation_matrix", (130,), dtype)
    clean = turned(q)
    q[3, 1], q[70, 1], q[129, 1] = np.nan, np.inf, -np.inf
    wrong = [3, 70, 129]
    found = turned(q)
    assert np.isnan(found[wrong][:, 2, 2]).all()
    assert np.array_equal(np.delete(found, wrong, 0), np.delete(clean, wrong, 0))


@pytest.mark.parametrize("leading", LEADING, ids=str)
@pytest.mark.parametrize("target", PRESENT)
@pytest.mark.parametrize("rotation", ["ZXZ", "rotation_vector"])
def test_a_batch_is_its_orientations_one_by_one(rotation, target, leading):
    for name in names(rotation):
        function = getattr(module(rotation, target), name)
        arrays = given(rotation, name, leading)
        found = function(*arrays)
        assert found.shape == (*leading, *_shape(rotation, name))
        for place in np.ndindex(leading):
            single = function(*(array[place] for array in arrays))
            largest = np.abs(found).max()  # a sum may cancel in one orientation
            assert np.abs(found[place] - single).max() <= MOST * 2.0**-52 * largest, name


def _shape(rotation, name):
    return motion(rotation).step(name).shape


@pytest.mark.parametrize("dtype", EPS, ids=["double", "float"])
@pytest.mark.parametrize("target", PRESENT)
def test_any_strides_broadcasts_and_byte_orders_give_the_same(target, dtype):
    body = module("ZXZ", target).angular_velocity_body
    q, q_dot = given("ZXZ", "angular_velocity_body", (200,), dtype)
    expected = body(q, q_dot)
    wide = np.empty((400, 5), dtype)
    wide[::2, 1:4] = q
    swapped = q.astype(q.dtype.newbyteorder())
    assert np.array_equal(body(wide[::2, 1:4], q_dot), expected)
    assert np.array_equal(body(np.asfortranarray(q), q_dot), expected)
    assert np.array_equal(body(q[::-1], q_dot[::-1]), expected[::-1])
    q.flags.writeable = False
    assert np.array_equal(body(q, q_dot), expected)
    one = body(q[:, np.newaxis], q_dot[np.newaxis])
    for k in (0, 77, 199):
        assert np.allclose(one[k, k], expected[k], rtol=0, atol=MOST * EPS[dtype] * 10)
    assert np.array_equal(body(swapped, q_dot), expected)


@pytest.mark.parametrize("target", PRESENT)
def test_out_is_filled_wherever_it_lies(target):
    loaded = module("ZXZ", target)
    q, q_dot = given("ZXZ", "angular_velocity_body", (150,))
    velocity, matrix = loaded.angular_velocity_body(q, q_dot), loaded.rotation_matrix(q)
    wide = np.zeros((300, 7))
    found = loaded.angular_velocity_body(q, q_dot, out=wide[::2, 1:6:2])
    assert np.array_equal(found, velocity)
    assert not wide[1::2].any()
    turned = np.zeros((3, 3, 150)).transpose(2, 1, 0)
    assert loaded.rotation_matrix(q, out=turned) is turned
    assert np.array_equal(turned, matrix)
    inside = q.copy()
    assert np.array_equal(loaded.angular_velocity_body(inside, q_dot, out=inside), velocity)
    shifted = np.concatenate([q, np.zeros((1, 3))])
    assert np.array_equal(
        loaded.angular_velocity_body(shifted[:-1], q_dot, out=shifted[1:]), velocity
    )


@pytest.mark.parametrize("target", PRESENT)
def test_threads_change_nothing(target):
    loaded = module("ZXZ", target)
    for leading in ((1000,), (2, 501), (1, 1)):
        for name in ("rotation_matrix", "angular_velocity_body"):
            arrays = given("ZXZ", name, leading)
            function = getattr(loaded, name)
            assert np.array_equal(function(*arrays, threads=3), function(*arrays))


@pytest.mark.parametrize("target", PRESENT)
def test_what_cannot_be_taken_is_refused_by_name(target):
    loaded = module("ZXZ", target)
    with pytest.raises(TypeError, match=r"^q: got dtype complex128"):
        loaded.rotation_matrix(np.zeros(3, complex))
    with pytest.raises(ValueError, match=r"^q: got shape \(4,\); expected \(\.\.\., 3\)"):
        loaded.rotation_matrix(np.zeros(4))
    with pytest.raises(TypeError, match=r"^out: got dtype float32"):
        loaded.rotation_matrix(np.zeros(3), out=np.zeros((3, 3), np.float32))


@pytest.mark.parametrize("target", PRESENT)
def test_scalar_twins_agree_with_arrays(target):
    for rotation in ROTATIONS:
        loaded = module(rotation, target)
        for name in names(rotation):
            arrays = given(rotation, name, ())
            scalar = getattr(loaded, f"{name}_scalar")(*np.concatenate(arrays).tolist())
            batch = getattr(loaded, name)(*(array[np.newaxis] for array in arrays))[0]
            assert (
                np.abs(np.array(scalar) - batch).max()
                <= MOST * EPS[np.float64] * np.abs(batch).max()
            ), name


@pytest.mark.parametrize("target", PRESENT)
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


@pytest.mark.parametrize("target", TARGETS)
def test_what_is_written_is_data_with_names_of_its_own(target, tmp_path):
    kernels = motion("ZXZ").kernels(target)
    assert pickle.loads(pickle.dumps(kernels)) == kernels
    path = kernels.write(tmp_path)
    assert path.read_text(encoding="utf-8") == kernels.source
    assert sorted(file.name for file in tmp_path.iterdir()) == sorted(kernels.files)
    others = {name for other in TARGETS if other != target for name in _files(other)}
    assert others.isdisjoint(kernels.files)


def _files(target):
    return motion("ZXZ").kernels(target).files


@pytest.mark.parametrize(
    ("target", "hidden"),
    [("c", None), ("javascript", None), ("jax", "jax.numpy"), ("numba", "numba")],
)
def test_without_its_tools_a_target_is_written_and_loading_ends_in_code_4(
    target, hidden, monkeypatch
):
    monkeypatch.setenv("PATH", "/nowhere")
    monkeypatch.delenv("CC", raising=False)
    if hidden is not None:
        monkeypatch.setitem(sys.modules, hidden, None)
    monkeypatch.setattr("rigidsym.kernels.targets.find_spec", lambda _: None)
    kernels = motion("ZXZ").kernels(target)
    with pytest.raises(RigidsymError) as raised:
        kernels.load()
    assert raised.value.exit_code == 4
    assert TARGETS[target].missing
    assert TARGETS[target].missing in inventory()


def test_a_missing_package_is_named_with_its_extra(monkeypatch):
    monkeypatch.setattr("rigidsym.kernels.targets.find_spec", lambda _: None)
    kernels = motion("ZXZ").kernels("numba")  # written all the same
    with pytest.raises(MissingExtra, match=r"pip install '.\[numba\]'"):
        kernels.load()
    assert TARGETS["numba"].missing == "the package numba"


@pytest.mark.skipif(bool(TARGETS["numba"].missing), reason=TARGETS["numba"].missing)
def test_neither_threads_nor_the_place_in_a_batch_change_a_bit_of_numba():
    motion = rs.derive("rotation_vector", only=["rotation_rate"])
    rotation_rate = motion.kernels("numba").load().rotation_rate
    q, q_dot = np.random.default_rng(1).uniform(-3, 3, (2, 100_003, 3))
    found = rotation_rate(q, q_dot)
    np.testing.assert_array_equal(rotation_rate(q, q_dot, threads=2), found)
    np.testing.assert_array_equal(rotation_rate(q[5:], q_dot[5:]), found[5:])


@pytest.mark.skipif(bool(TARGETS["numba"].missing), reason=TARGETS["numba"].missing)
@pytest.mark.parametrize("count", [7, 300, 100_001])
def test_rows_of_any_number_are_computed_by_compiled_functions(count, monkeypatch):
    functions = module("ZXZ", "numba")
    q = np.random.default_rng(1).uniform(-3, 3, (count, 3))
    expected = functions.angular_velocity_body(q, q)

    def _angular_velocity_body(q, q_dot):
        raise AssertionError(f"NumPy computes {q}, {q_dot}")

    monkeypatch.setattr(functions, "_angular_velocity_body", _angular_velocity_body)
    np.testing.assert_array_equal(functions.angular_velocity_body(q, q), expected)


@pytest.mark.skipif(bool(TARGETS["numba"].missing), reason=TARGETS["numba"].missing)
def test_far_angles_and_poles_change_no_bit_of_other_rows_in_numba():
    rates = module("ZXZ", "numba").rates_from_angular_velocity_body
    q, omega = np.random.default_rng(1).uniform(0.2, 3, (2, 300, 3))
    others = rates(q, omega)[3:]
    q[:3] = [[1.0, 1e9, 2.0], [1.0, 0.0, 2.0], [np.nan, np.nan, 1.0]]
    found = rates(q, omega)
    np.testing.assert_array_equal(found[3:], others)
    for dtype in (np.float64, np.float32):
        given = q[:3].astype(dtype), omega[:3].astype(dtype)
        expected = module("ZXZ", "numpy").rates_from_angular_velocity_body(*given)
        np.testing.assert_allclose(rates(*given), expected, rtol=64 * np.finfo(dtype).eps)


@pytest.mark.skipif(bool(TARGETS["numba"].missing), reason=TARGETS["numba"].missing)
def test_functions_of_numba_are_called_in_compiled_functions():
    from numba import njit

    velocity = module("ZXZ", "numba").angular_velocity_body

    @njit
    def both(q, q_dot):
        return velocity(q[0], q_dot[0]), velocity(q, q_dot[0])

    q, q_dot = np.random.default_rng(1).uniform(-3, 3, (2, 4, 3))
    one, rows = both(q, q_dot)
    np.testing.assert_allclose(one, velocity(q[0], q_dot[0]), rtol=0, atol=1e-15)
    np.testing.assert_allclose(rows, velocity(q, q_dot[0]), rtol=0, atol=1e-15)
    with pytest.raises(ValueError, match="wrong number of components"):
        both(q[:, :2], q_dot)


def test_a_module_with_no_argument_but_those_of_conversions_is_printed():
    motion = rs.derive("axis_angle", only=["principal_axes"], body=rs.solid("cylinder"))
    for target in TARGETS:
        assert motion.kernels(target, conversions=True).source
