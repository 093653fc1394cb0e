"""The JavaScript target, run by node: agreement with 50 digits and with NumPy, and its manners."""

from __future__ import annotations

import os
import shutil
import subprocess
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from conftest import derived
from kernel_modules import EPS, turned_by
from test_targets import FOUR, KINEMATICS, error
from test_targets import given as given_at
from witness import evaluate, mp

import rigidsym as rs
from rigidsym.api import derive
from rigidsym.errors import MissingTool
from rigidsym.kernels.ir import Argument, Kernel, Name, Negative
from rigidsym.kernels.targets import javascript

ROTATIONS = ("ZXZ", "rotation_vector", "quaternion", "davenport")
NAME = "euler_zxz_intrinsic"


@pytest.fixture(autouse=True)
def node() -> None:
    """Skip without node, or fail where it is required."""
    if shutil.which("node") is None:
        required = os.environ.get("RIGIDSYM_REQUIRE_NODE") == "1"
        (pytest.fail if required else pytest.skip)("node is not installed")


@cache
def motion_of(rotation: str) -> rs.Motion:
    return derive(rotation)


def given(motion: rs.Motion, inputs: tuple[str, ...], count: int = 2) -> list[np.ndarray]:
    rng = np.random.default_rng(7)
    return [rng.uniform(-3, 3, (count, len(motion.argument(name).symbols))) for name in inputs]


@pytest.mark.parametrize("rotation", ROTATIONS)
def test_every_quantity_agrees_with_fifty_digits_and_with_numpy(rotation):
    motion = motion_of(rotation)
    kernels, known = motion.kernels("javascript").load(), motion.kernels().load()
    for step in motion.steps:
        quantity = step.quantity
        arrays = given(motion, quantity.inputs)
        found = getattr(kernels, quantity.name)(*arrays)
        assert found.shape == (2, *step.shape)
        np.testing.assert_allclose(found, getattr(known, quantity.name)(*arrays), rtol=1e-11)
        for place, values in enumerate(zip(*arrays, strict=True)):
            symbols = [motion.argument(name).symbols for name in quantity.inputs]
            numbers = {
                symbol: mp.mpf(float(number))
                for some, numbers in zip(symbols, values, strict=True)
                for symbol, number in zip(some, numbers, strict=True)
            }
            exact = np.array(evaluate(step.expression, numbers).tolist(), float)
            size = max(1.0, np.abs(exact).max())
            error = np.abs(found[place] - exact.reshape(step.shape)).max()
            assert error <= 200 * EPS * size, quantity.name


@pytest.mark.parametrize("name", KINEMATICS)
def test_kinematics_keep_four_eps_up_to_ten_thousand_radians(name):
    arrays = given_at("ZXZ", name, (40,), size=1e4)
    assert error("ZXZ", "javascript", name, arrays) <= FOUR


@pytest.mark.parametrize("size", [1e6, 1e15, 1e22, 1e300])
def test_large_angles_are_right(size):
    arrays = given_at("ZXZ", "rotation_matrix", (20,), size=size)
    with mp.workdps(400):
        assert error("ZXZ", "javascript", "rotation_matrix", arrays) <= FOUR


def test_where_rates_fail_they_are_nan_and_nothing_else_is():
    motion = derived("ZXZ")
    kernels = motion.kernels("javascript").load()
    pole, rates = [0.3, 0.0, 0.2], [0.1, 0.2, 0.3]
    assert np.isnan(kernels.rates_from_angular_velocity_body(pole, rates)).any()
    assert kernels.singularity_margin([pole, [0.3, 0.5, 0.2]]).tolist() == [0.0, np.sin(0.5)]
    assert np.isfinite(kernels.angular_velocity_body(pole, rates)).all()
    assert np.isnan(kernels.rotation_matrix([np.nan, 0.0, 0.0])).any()


def test_functions_of_the_length_pass_through_zero_and_over_the_switch():
    motion = motion_of("rotation_vector")
    kernels, known = motion.kernels("javascript").load(), motion.kernels().load()
    lengths = np.array([0.0, 1e-12, 1e-3, 1.0, 1.93, 1.94, 2.78, 2.79, 3.99, 4.01, 6.0])
    q = lengths[:, None] * np.array([2.0, -1.0, 2.0]) / 3
    rates = [0.3, -0.5, 0.7]
    for name in ("angular_velocity_body", "angular_acceleration_space"):
        arrays = [q, rates, rates][: 2 + name.startswith("angular_acc")]
        found, expected = getattr(kernels, name)(*arrays), getattr(known, name)(*arrays)
        np.testing.assert_allclose(found, expected, rtol=0, atol=20 * EPS)


def test_an_argument_of_the_wrong_length_is_named():
    kernels = derived("ZXZ").kernels("javascript").load()
    with pytest.raises(ValueError, match="q_dot: expected 3 numbers, got 2"):
        kernels.angular_velocity_body([0.1, 0.2, 0.3], [0.1, 0.2])


def test_text_in_a_title_stays_in_its_comment():
    motion = turned_by("turns", "await", "Math", "of")
    odd = rs.Motion(**{**vars(motion), "title": "*/ throw 1; /* </script>"})
    kernels = odd.kernels("javascript")
    assert "*/ throw" not in kernels.source
    q = [0.1, 0.2, 0.3]
    found = kernels.load().rotation_matrix(q)
    assert np.allclose(found, motion.kernels().load().rotation_matrix(q), atol=1e-15)


def test_a_component_may_be_called_as_its_vector_is():
    vector = Argument(name="q", components=("q",), units=("rad",), about="")
    kernel = Kernel(
        name="minus", arguments=(vector,), assignments=(), outputs=(Negative(Name("q")),), shape=()
    )
    made = javascript.load("made", {"made.mjs": javascript.bare([kernel])})
    assert made.minus([2.0]) == -2.0


def test_a_module_is_written_and_node_accepts_it(tmp_path: Path):
    kernels = derived("ZXZ").kernels("javascript", conversions=True)
    assert "Not in this module, but in the one for NumPy: from_quaternion" in " ".join(
        line.removeprefix(" * ") for line in kernels.source.split("\n")
    )
    path = kernels.write(tmp_path)
    assert path == tmp_path / f"{NAME}.mjs"
    subprocess.run(["node", "--check", path], check=True)
    assert kernels.load().quaternion([0.0, 0.0, 0.0]).tolist() == [1.0, 0.0, 0.0, 0.0]


def test_without_node_it_is_said(monkeypatch):
    monkeypatch.setenv("PATH", "")
    kernels = derived("ZXZ").kernels("javascript")
    with pytest.raises(MissingTool, match="no program `node`"):
        kernels.load()
