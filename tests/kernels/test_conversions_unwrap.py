"""Coordinates along a trajectory are continuous, and still the same rotations."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from scipy.spatial.transform import Rotation

from helpers.conversion_modules import module

TIMES = np.linspace(0.01, 12.0, 2401)


def steps(values: np.ndarray) -> float:
    """The longest step from one sample to the next."""
    return float(np.abs(np.diff(values, axis=0)).max())


@pytest.mark.parametrize("text", ["ZXZ", "zyx"])
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


def nearest(functions, q: np.ndarray) -> np.ndarray:
    """Sample by sample, of all sets of angles of a rotation the one nearest to that before."""

    def near(angles, before):
        return angles - 2 * np.pi * np.round((angles - before) / (2 * np.pi))

    path = [q[0]]
    for first, middle, third in q[1:]:
        before, sets = path[-1], []
        for middle_of_set in (-middle, np.pi - middle, middle):
            turned = 0.0 if middle_of_set == middle else np.pi
            angles = near(np.array([first + turned, middle_of_set, third + turned]), before)
            for sign in (1, -1):  # at a pole, which of first ± third is determined
                step = np.array([1.0, 0.0, -sign])
                short = (angles - before) @ [1.0, 0.0, sign]
                short -= 2 * np.pi * np.round(short / (2 * np.pi))
                along = np.array([before[0] + short / 2, angles[1], before[2] + sign * short / 2])
                same = functions.rotation_matrix(np.stack([angles, angles + step]))
                if np.abs(same[0] - same[1]).max() < 1e-12:
                    sets.append(along)
            sets.append(angles)
        matrices = functions.rotation_matrix(np.array(sets))
        truth = functions.rotation_matrix(np.array([first, middle, third]))
        sets = [s for s, R in zip(sets, matrices, strict=True) if np.abs(R - truth).max() < 1e-9]
        path.append(min(sets, key=lambda angles: ((angles - before) ** 2).sum()))
    return np.array(path)


@pytest.mark.parametrize("text", ["ZXZ", "zyx"])
def test_each_sample_gets_the_nearest_of_all_its_sets_of_angles(text):
    """Among samples anywhere, many are at one of the poles, alone or several together."""
    functions = module(text)
    source = np.random.default_rng(sum(map(ord, text)))
    q = source.uniform(-7, 7, (120, 3))
    pole = 0.0 if text[0] == text[2] else np.pi / 2
    for start in range(5, 120, 10):  # up to 4 samples at a pole: two poles in a row would be a tie
        q[start : start + source.integers(1, 5), 1] = pole + np.pi * source.integers(-2, 3)
    assert_allclose(functions.unwrap(q), nearest(functions, q), atol=1e-11)
    pi = np.pi
    row = np.array([[0.4 - pi, 0.0005, 0.35 - pi], [0.75, 0.0, 0.0], [0.4, 0.0005, 0.35]])
    if text[0] == text[2]:
        assert_allclose(functions.unwrap(row)[1], [0.4 - pi, 0.0, 0.35 - pi], atol=1e-12)


def test_a_start_at_a_pole_takes_the_angles_of_the_first_sample_away_from_it():
    q = np.array([[0.0, 0.0, 0.0], [0.3, 0.0, 0.0], [1.2, 0.01, -0.8]])
    expected = [[1.0, 0.0, -1.0], [1.15, 0.0, -0.85], [1.2, 0.01, -0.8]]
    assert_allclose(module("ZXZ").unwrap(q), expected, atol=1e-14)


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
