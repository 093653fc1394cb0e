"""`identify` names the convention of data from SciPy."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import rigidsym as rs
from helpers.conventions import EVERY, GENERIC, RATES, attitude, holds, rotation, sample, some
from rigidsym.tools.identify.fit import calls
from rigidsym.tools.identify.readings import VELOCITIES, Reading, distinct


def found_alone(reading: Reading, **given) -> rs.Identification:
    """The data leave one answer, and it is this reading."""
    found = rs.identify(**given)
    assert len(found.answers) == 1, found.text()
    assert holds(found.answers[0], reading), found.text()
    return found


def test_each_of_the_4608_readings_stands_once_among_the_answers_and_their_aliases():
    words = []
    for reading in distinct((None,)):
        words += [reading, *reading.aliases()]
    assert len(words) == len(set(words)) == len(EVERY) == 4608
    assert set(words) == set(EVERY)


def test_without_motion_the_frame_of_omega_is_asked_for_with_rates():
    reading = Reading(sequence="ZXZ", velocity=VELOCITIES[0])
    found = rs.identify(**sample(reading, GENERIC[False], (0.0, 0.0, 0.0)))
    assert len(found.answers) == len(VELOCITIES)
    assert {answer.reading for answer in found.answers} == {
        replace(reading, velocity=velocity) for velocity in VELOCITIES
    }
    assert "tells them apart; give it\nthree different rates too." in str(found)


@pytest.mark.parametrize("digits", [2, 6])
def test_printed_numbers_are_given_their_rounding(digits):
    rng = np.random.default_rng(digits)
    reading = Reading(sequence="ZYX", passive=True, degrees=True, scalar_last=False)
    for _ in range(20):
        angles = rng.uniform(20, 75, 3)
        printed = np.round(attitude(reading, angles)["quaternion"], digits)
        found = rs.identify(angles, quaternion=printed)
        assert any(holds(answer, reading) for answer in found.answers)
        assert found.answers[0].residual <= found.tolerance.orientation <= 30 * 10.0**-digits


def test_angles_are_taken_to_be_rounded_where_nothing_fits_otherwise():
    reading = Reading(sequence="ZYX", degrees=True)
    angles = np.array([17.234, 38.441, -63.078])
    found = rs.identify(angles.round(1), **attitude(reading, angles))
    assert holds(found.answers[0], reading)
    assert "from the digits of the angles" in found.tolerance.because
    askew = {"matrix": 1.013 * attitude(reading, angles)["matrix"]}
    assert "from how far the attitude is from a" in rs.identify(angles, **askew).tolerance.because


def test_noise_needs_a_tolerance_and_is_named_without():
    rng = np.random.default_rng(10)
    reading = Reading(sequence="ZXZ", passive=True, degrees=True)
    angles = rng.uniform(-80, 80, (50, 3))
    turned = Rotation.from_rotvec(rng.normal(0, 0.003, (50, 3)))
    matrix = (turned * rotation(reading, angles).inv()).as_matrix()
    found = rs.identify(angles, matrix=matrix)
    assert not found.fits
    assert found.answers == ()
    assert holds(found.nearest, reading)
    assert 0.003 < found.nearest.residual < 0.03
    assert not rs.identify(angles, matrix=matrix, tolerance=0.9 * found.nearest.residual).fits
    (answer,) = rs.identify(angles, matrix=matrix, tolerance=0.03).answers
    assert holds(answer, reading)


def results_of(statements: str, reading: Reading) -> dict[str, np.ndarray]:
    """What the statements leave behind."""
    names = {"np": np, "angles": np.array(GENERIC[reading.degrees]), "rates": np.array(RATES)}
    exec(compile(statements, "<printed>", "exec"), names)
    wanted = ("matrix", "quaternion", "omega")
    return {name: np.array(names[name], float) for name in wanted if name in names}


READINGS = [
    *some(16, seed=1, layouts=(None, False, True), velocities=(None,)),
    *some(16, seed=21, layouts=(None, False, True), velocities=VELOCITIES),
]


@pytest.mark.parametrize("reading", READINGS, ids=str)
def test_a_reading_its_aliases_and_its_calls_give_the_same_data(reading):
    expected = sample(reading, GENERIC[reading.degrees])
    found = found_alone(reading, **expected)
    assert found.answers[0].residual < 1e-13
    for alias in reading.aliases():
        other = sample(alias, GENERIC[alias.degrees])
        for name, values in expected.items():
            np.testing.assert_allclose(other[name], values, rtol=1e-6, atol=1e-13)
    for library, statements in calls(reading).items():
        assert "from rigidsym" not in statements  # public names only
        given = results_of(statements, reading)
        if reading.scalar_last is None:
            np.testing.assert_allclose(given["matrix"], expected["matrix"], atol=1e-13)
        else:
            sign = np.sign(given["quaternion"] @ expected["quaternion"])
            turned = sign * given["quaternion"]
            np.testing.assert_allclose(turned, expected["quaternion"], atol=1e-13)
        if reading.velocity and library != "SciPy":
            omega = given["omega"].ravel()
            np.testing.assert_allclose(omega, expected["omega"], atol=1e-6, rtol=1e-6)
