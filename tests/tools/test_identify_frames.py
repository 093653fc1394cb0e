"""Data in other frames: permuted and reversed axes and misalignments are found and named."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import rigidsym as rs
from helpers.conventions import EVERY, GENERIC, RATES, omega, rotation
from rigidsym.tools.identify.calls import calls
from rigidsym.tools.identify.readings import IDENTITY, PERMUTATIONS, VELOCITIES, Frames, Reading

NED_ENU = np.array([[0, 1, 0], [1, 0, 0], [0, 0, -1]])
FRD_FLU = np.diag([1, -1, -1])
ANGLES = np.array([[10.0, 20.0, 30.0], [-40.0, 50.5, 60.0], [71.5, -32.5, 13.5]])
YAW_PITCH_ROLL = {"names": ("yaw", "pitch", "roll")}


def framed(reading: Reading, angles, space=IDENTITY, body=IDENTITY) -> np.ndarray:
    """The matrices S R B of a reading, or their transposes if it is passive."""
    matrix = np.array(space) @ rotation(reading, angles).as_matrix() @ np.array(body)
    return np.swapaxes(matrix, -1, -2) if reading.passive else matrix


@pytest.mark.parametrize("passive", [False, True], ids=["active", "passive"])
def test_ned_and_enu_with_frd_and_flu_are_named(passive):
    truth = Reading(sequence="ZYX", degrees=True, passive=passive)
    matrix = framed(truth, ANGLES[0], NED_ENU, FRD_FLU)
    found = rs.identify(ANGLES[0], matrix=matrix, **YAW_PITCH_ROLL)
    (answer,) = found.answers
    assert answer.reading.sequence == "ZYX"
    assert answer.reading.passive == passive
    assert "space axes (y x −z) as between NED and ENU" in answer.reading.words()
    assert "body axes (x −y −z) as between FRD and FLU" in answer.reading.words()
    assert answer.residual < 1e-13
    assert max(map(len, found.text().splitlines())) <= 80


def drawn(count: int, seed: int):
    rng = np.random.default_rng(seed)
    for _ in range(count):
        reading = EVERY[rng.integers(len(EVERY))]
        space, body = (PERMUTATIONS[k] for k in rng.integers(24, size=2))
        yield reading, space, body


@pytest.mark.parametrize(("reading", "space", "body"), list(drawn(12, seed=3)))
def test_any_reading_between_any_axes_is_found_from_one_sample(reading, space, body):
    angles = GENERIC[reading.degrees]
    found = rs.identify(angles, matrix=framed(reading, angles, space, body))
    assert len(found.answers) == 1
    answer = found.answers[0].reading
    other = np.array(angles) * (0.7, -0.3, 1.1)  # and it predicts another sample
    predicted = framed(answer, other, answer.frames.space, answer.frames.body)
    np.testing.assert_allclose(predicted, framed(reading, other, space, body), atol=1e-13)


@pytest.mark.parametrize("scalar_last", [False, True])
def test_quaternions_between_other_axes(scalar_last):
    truth = Reading(sequence="XYZ", scalar_last=scalar_last)
    matrix = framed(truth, GENERIC[False], NED_ENU, FRD_FLU)
    quaternion = Rotation.from_matrix(matrix).as_quat(scalar_first=not scalar_last)
    (answer,) = rs.identify(GENERIC[False], quaternion=quaternion).answers
    assert (answer.reading.sequence, answer.reading.scalar_last) == ("XYZ", scalar_last)


@pytest.mark.parametrize("velocity", VELOCITIES[:4], ids=str)
def test_angular_velocities_between_other_axes(velocity):
    truth = Reading(sequence="ZYX", velocity=velocity)
    angles = GENERIC[False]
    turned = omega(truth, angles, RATES)
    turned = NED_ENU @ turned if velocity.frame == "space" else FRD_FLU.T @ turned
    matrix = framed(truth, angles, NED_ENU, FRD_FLU)
    (answer,) = rs.identify(angles, matrix=matrix, rates=RATES, omega=turned).answers
    assert answer.reading.velocity == velocity
    assert answer.reading.frames == Frames(space=_plain(NED_ENU), body=_plain(FRD_FLU))


def _plain(matrix):
    return tuple(map(tuple, np.asarray(matrix, float).tolist()))


@pytest.mark.parametrize("side", ["space", "body"])
def test_a_constant_misalignment_is_found_from_two_samples(side):
    truth = Reading(sequence="ZYX", degrees=True)
    turn = Rotation.from_rotvec(np.radians(3.2) * np.array([0.6, 0.0, 0.8])).as_matrix()
    sides = {"space": turn.T} if side == "space" else {"body": turn}
    given = {"matrix": framed(truth, ANGLES, **sides), **YAW_PITCH_ROLL}
    (answer,) = rs.identify(ANGLES, **given).answers
    assert answer.reading.sequence == "ZYX"
    assert f"{side} frame misaligned by 3.2° about (0.6 0 0.8)" in answer.reading.words()
    two = rs.identify(ANGLES[:2], matrix=given["matrix"][:2])
    assert any(each.reading == answer.reading for each in two.answers) or two.fits


def test_one_sample_does_not_tell_a_misalignment_from_anything_else():
    truth = Reading(sequence="ZYX", degrees=True)
    turn = Rotation.from_rotvec([0.02, -0.03, 0.01]).as_matrix()
    assert not rs.identify(ANGLES[0], matrix=framed(truth, ANGLES[0], body=turn)).fits
    same = np.tile(ANGLES[0], (5, 1))
    assert not rs.identify(same, matrix=framed(truth, same, body=turn)).fits


def test_noise_and_attitudes_of_something_else_still_fit_nothing():
    rng = np.random.default_rng(5)
    for count in (1, 2, 5):
        for _ in range(15):
            angles = rng.uniform(-80, 80, (count, 3))
            assert not rs.identify(angles, matrix=Rotation.random(count, rng=rng).as_matrix()).fits
            rounded = Rotation.random(count, rng=rng).as_matrix().round(2)
            assert not rs.identify(angles.round(1), matrix=rounded).fits


@pytest.mark.parametrize("library", ["SciPy", "rigidsym"])
@pytest.mark.parametrize("passive", [False, True], ids=["active", "passive"])
def test_the_calls_give_the_data_back(library, passive):
    turn = _plain(Rotation.from_rotvec([0.02, -0.03, 0.01]).as_matrix())
    for space, body in ((NED_ENU, FRD_FLU), (IDENTITY, turn), (turn, IDENTITY)):
        frames = Frames(space=_plain(space), body=_plain(body))
        for velocity in (None, *VELOCITIES[:2]):
            if library == "SciPy" and velocity:
                continue
            reading = Reading(
                sequence="ZYX", degrees=True, passive=passive, frames=frames, velocity=velocity
            )
            names = {"np": np, "angles": ANGLES[0], "rates": np.array(RATES)}
            exec(compile(calls(reading)[library], "<printed>", "exec"), names)
            expected = framed(reading, ANGLES[0], space, body)
            np.testing.assert_allclose(np.array(names["matrix"], float), expected, atol=1e-13)
            if velocity:
                turned = omega(reading, ANGLES[0], RATES)
                side = np.array(space) if velocity.frame == "space" else np.array(body).T
                found = np.array(names["omega"], float).ravel()
                np.testing.assert_allclose(found, side @ turned, atol=1e-6)


def test_rotations_of_scipy_are_taken_as_they_are():
    one = Rotation.from_euler("ZYX", ANGLES[0], degrees=True)
    for given in ({"matrix": one}, {"quaternion": one}):
        (answer,) = rs.identify(ANGLES[0], **given).answers
        assert answer.reading.sequence == "ZYX"
    many = Rotation.from_euler("ZYX", ANGLES, degrees=True)
    assert len(rs.identify(ANGLES, matrix=many).answers) == 1
