"""Coordinates along a trajectory are continuous, and still the same rotations."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from scipy.spatial.transform import Rotation

import rigidsym as rs
from helpers.conversion_modules import CHAINS, module

TIMES = np.linspace(0.01, 12.0, 2401)
TURNS = (*rs.EULER_SEQUENCES, *CHAINS)


def steps(values: np.ndarray) -> float:
    """The longest step from one sample to the next."""
    return float(np.abs(np.diff(values, axis=0)).max())


@pytest.mark.parametrize("text", TURNS)
def test_angles_are_those_of_the_path_through_poles_and_whole_turns(text):
    """The middle angle swings through both poles, the others turn many times."""
    functions = module(text)
    path = np.stack([3 * TIMES, 4 * np.sin(2 * TIMES) + 0.1, 1 - 2 * TIMES], axis=-1)
    given = functions.from_rotation_matrix(functions.rotation_matrix(path))
    found = functions.unwrap(given)
    assert steps(given) > 1
    assert steps(found) < 0.1
    # The other set of angles goes the same way, its middle angle backwards.
    ways = [np.abs(np.diff(angles, axis=0)) for angles in (found, path)]
    assert_allclose(*ways, atol=1e-8)
    assert_array_equal(found[0], given[0])
    expected = functions.rotation_matrix(path)
    assert_allclose(functions.rotation_matrix(found), expected, atol=1e-13)


def test_long_steps_of_the_outer_angles_do_not_turn_the_middle_one_over():
    """More than a quarter turn a sample, where the other set of angles is further away."""
    functions = module("ZXZ")
    count = np.arange(40.0)
    path = np.stack([1.7 * count, 1.0 + 0 * count, -1.7 * count], axis=-1)
    found = functions.unwrap(functions.from_rotation_matrix(functions.rotation_matrix(path)))
    assert_allclose(found, path, atol=1e-12)


@pytest.mark.parametrize("text", rs.EULER_SEQUENCES)
def test_a_rest_at_the_pole_does_not_jump(text):
    """Samples at the pole itself take what is not determined from the sample before."""
    functions = module(text)
    pole = 0.0 if text[0] == text[2] else np.pi / 2
    middle = pole + np.array([-0.02, -0.01, 0.0, 0.0, 0.0, 0.01, 0.02])
    path = np.stack([np.full(7, 0.4), middle, np.full(7, -1.1)], axis=-1)
    found = functions.unwrap(functions.from_rotation_matrix(functions.rotation_matrix(path)))
    assert steps(found) < 0.0101
    expected = functions.rotation_matrix(path)
    assert_allclose(functions.rotation_matrix(found), expected, atol=1e-14)


@pytest.mark.parametrize("text", ["quaternion", "unit_quaternion", "cayley_klein"])
def test_quaternions_do_not_change_sign(text):
    functions = module(text)
    half = TIMES / 2
    zeros = np.zeros_like(half)
    quaternion = np.stack([np.cos(half), 0.6 * np.sin(half), zeros, 0.8 * np.sin(half)], axis=-1)
    given = functions.from_rotation_matrix(
        Rotation.from_quat(quaternion, scalar_first=True).as_matrix()
    )
    found = functions.unwrap(given)
    assert steps(given) > 1
    assert steps(found) < 0.01
    assert_allclose(functions.quaternion(found), quaternion, atol=1e-14)


@pytest.mark.parametrize("text", ["rotation_vector", "axis_angle"])
def test_axes_and_angles_go_on_through_whole_turns(text):
    functions = module(text)
    axis = np.array([0.36, -0.48, 0.8])
    given = functions.from_rotation_matrix(Rotation.from_rotvec(axis * TIMES[:, None]).as_matrix())
    found = functions.unwrap(given)
    if text == "axis_angle":
        found = found[:, :3] * found[:, 3:]
    assert_allclose(found, axis * TIMES[:, None], atol=1e-13)


def test_an_axis_without_a_turn_is_that_of_its_neighbours():
    functions = module("axis_angle")
    angles = np.array([0.0, 0.1, 0.0, 2 * np.pi - 0.1])
    given = functions.from_rotation_matrix(
        Rotation.from_rotvec(np.array([0.0, 0.6, 0.8]) * angles[:, None]).as_matrix()
    )
    found = functions.unwrap(given)
    assert_allclose(found[:, :3], np.broadcast_to([0.0, 0.6, 0.8], (4, 3)), atol=1e-14)
    assert_allclose(found[:, 3], [0.0, 0.1, 0.0, -0.1], atol=1e-14)


def test_modified_rodrigues_parameters_take_the_shadow_set():
    functions = module("modified_rodrigues")
    angles = np.linspace(-5.0, 5.0, 1001)
    axis = np.array([0.0, 0.6, 0.8])
    start = np.argmin(np.abs(angles + 2.0))
    rotations = Rotation.from_rotvec(axis * angles[start:, None])
    given = functions.from_rotation_matrix(rotations.as_matrix())
    found = functions.unwrap(given)
    assert steps(given) > 1
    assert_allclose(found, axis * np.tan(angles[start:, None] / 4), atol=1e-13)


def test_the_other_axes_are_trajectories_of_their_own():
    functions = module("ZXZ")
    paths = np.stack([np.stack([k * TIMES, 0.5 + 0 * TIMES, TIMES], axis=-1) for k in (1, -2)], 1)
    wrapped = functions.from_rotation_matrix(functions.rotation_matrix(paths))
    found = functions.unwrap(wrapped)
    assert found.shape == (len(TIMES), 2, 3)
    assert_allclose(found, paths, atol=1e-12)
    for k in range(2):
        assert_array_equal(found[:, k], functions.unwrap(wrapped[:, k]))


def test_lost_samples_stay_lost_and_harm_no_other():
    functions = module("ZYX")
    path = np.stack([3 * TIMES, 0.3 * np.sin(TIMES), TIMES], axis=-1)
    wrapped = functions.from_rotation_matrix(functions.rotation_matrix(path))
    wrapped[[0, 1, 700]] = np.nan
    found = functions.unwrap(wrapped)
    assert np.isnan(found[[0, 1, 700]]).all()
    kept = np.isfinite(found).all(axis=-1)
    assert kept.sum() == len(TIMES) - 3
    assert_allclose(found[kept], path[kept], atol=1e-12)


@pytest.mark.parametrize("text", ["ZXZ", "quaternion", "axis_angle", "rotation_vector"])
def test_types_shapes_and_bad_input(text):
    functions = module(text)
    single = functions.from_quaternion(np.ones((5, 4), np.float32))
    assert functions.unwrap(single).dtype == np.float32
    assert functions.unwrap(single[:0]).shape == single[:0].shape
    assert functions.unwrap(single[:1].astype(int)).dtype == np.float64
    with pytest.raises(ValueError, match=r"q: got shape \(\d,\); expected \(m, \.\.\., n\)"):
        functions.unwrap(single[0])
    kept = single.copy()
    functions.unwrap(single)
    assert_array_equal(single, kept)


def test_where_coordinates_are_unique_there_is_nothing_to_unwrap():
    assert not hasattr(module("gibbs_vector"), "unwrap")
    assert not hasattr(module("direction_cosines"), "unwrap")
