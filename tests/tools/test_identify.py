"""`identify` names the convention of data from SciPy, also in files, and lists every fault."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import polars as pl
import pytest
from scipy.spatial.transform import Rotation

import rigidsym as rs
from helpers.command import call
from helpers.conventions import (
    EVERY,
    GENERIC,
    RATES,
    attitude,
    holds,
    omega,
    rotation,
    sample,
    some,
)
from rigidsym.tools.identify.fit import calls
from rigidsym.tools.identify.identification import identify_file
from rigidsym.tools.identify.readings import VELOCITIES, Reading, distinct
from rigidsym.tools.identify.samples import SampleError


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


AEROSPACE = Reading(sequence="ZYX", passive=True, degrees=True, velocity=VELOCITIES[1])
MATRIX = [f"r{row}{column}" for row in (1, 2, 3) for column in (1, 2, 3)]


def rows(count: int, reading: Reading = AEROSPACE) -> np.ndarray:
    """Angles, matrix, rates and Ω in `count` rows of 18 numbers."""
    rng = np.random.default_rng(count)
    angles, rates = rng.uniform(-70, 70, (count, 3)), rng.uniform(-5, 5, (count, 3))
    turns = rotation(reading, angles)
    matrix = (turns.inv() if reading.passive else turns).as_matrix().reshape(count, 9)
    velocity = [omega(reading, a, r) for a, r in zip(angles, rates, strict=True)]
    return np.hstack([angles, matrix, rates, velocity])


def written(path, table: np.ndarray, header: str = "", separator: str = ",", form="%.9f"):
    np.savetxt(path, table, fmt=form, delimiter=separator, header=header, comments="")
    return path


HEADERS = {
    "numbered": "a1,a2,a3," + ",".join(MATRIX) + ",a1_dot,a2_dot,a3_dot,omega1,omega2,omega3",
    "named": "yaw,pitch,roll," + ",".join(MATRIX) + ",yaw_rate,pitch_rate,roll_rate,wx,wy,wz",
}


@pytest.mark.parametrize("header", HEADERS.values(), ids=HEADERS)
@pytest.mark.parametrize("separator", [",", " "], ids=["comma", "blank"])
def test_columns_by_name(tmp_path, header, separator):
    path = written(tmp_path / "log.csv", rows(30), header.replace(",", separator), separator)
    (answer,) = identify_file(path).answers
    assert holds(answer, AEROSPACE)


def test_columns_without_a_header_by_their_number_or_by_given_names(tmp_path):
    table = rows(20)
    (answer,) = identify_file(written(tmp_path / "plain.csv", table)).answers
    assert holds(answer, AEROSPACE)
    timed = np.hstack([np.arange(20)[:, None], table])
    path = written(tmp_path / "timed.csv", timed)
    with pytest.raises(SampleError, match="19 columns without names: expected 7 "):
        identify_file(path)
    found = identify_file(path, columns=["-", *HEADERS["named"].split(",")])
    assert holds(found.answers[0], AEROSPACE)
    assert found.columns.names == ("yaw", "pitch", "roll")


def test_the_names_of_a_quaternion_tell_which_is_the_scalar(tmp_path):
    reading = Reading(sequence="ZXZ", scalar_last=True)
    angles = np.random.default_rng(1).uniform(-1, 1, (10, 3))
    table = np.hstack([angles, rotation(reading, angles).as_quat()])
    named = identify_file(written(tmp_path / "named.csv", table, "phi,theta,psi,qx,qy,qz,qw"))
    assert [answer.reading.scalar_last for answer in named.answers] == [True]
    assert named.tried == 1152
    first = np.roll(table[:, 3:], 1, axis=1)
    for header, quaternion in (("qw,qx,qy,qz", first), ("qy,qx,qz,qw", table[:, [4, 3, 5, 6]])):
        rows = np.hstack([angles, quaternion])
        found = identify_file(written(tmp_path / "named.csv", rows, f"phi,theta,psi,{header}"))
        assert [answer.reading.scalar_last for answer in found.answers] == [False]


def test_all_bad_samples_are_named_with_their_amounts():
    good = sample(Reading(sequence="ZYX"), GENERIC[False])["matrix"]
    angles = np.tile(GENERIC[False], (5, 1))
    angles[1, 2] = np.nan
    with pytest.raises(SampleError) as error:
        rs.identify(angles, matrix=[good, good, 1.1 * good, good * [1, 1, -1], np.inf * good])
    assert error.value.exit_code == 3
    assert str(error.value).splitlines() == [
        "the data: 4 faults",
        "  sample 2: angles: a number that is missing or not finite",
        "  sample 3: matrix: not a rotation, M Mᵀ differs from 1 by 0.21 in an entry "
        "(det M = 1.331)",
        "  sample 4: matrix: not a rotation but a reflection, its determinant is -1",
        "  sample 5: matrix: a number that is missing or not finite",
    ]


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({}, "a matrix or a quaternion is missing"),
        ({"matrix": np.eye(3), "quaternion": [1, 0, 0, 0]}, "not both"),
        ({"matrix": np.eye(4)}, r"matrix: expected .* \(n, 3, 3\) or \(n, 9\), got \(4, 4\)"),
        ({"matrix": [np.eye(3)] * 2}, "row per sample in every array, got 1 of angles, 2 of mat"),
        ({"matrix": np.eye(3), "names": ("a", "b")}, "three different names of angles, got a, b"),
        ({"matrix": np.eye(3), "tolerance": -1.0}, "between 0 and π radians, got -1"),
        ({"angles": np.empty((0, 3)), "matrix": np.empty((0, 3, 3))}, "no samples"),
    ],
)
def test_arguments_that_do_not_belong_together(given, message):
    with pytest.raises(SampleError, match=message):
        rs.identify(**{"angles": (0.1, 0.2, 0.3), **given})


def test_a_gyroscope_without_rates_of_the_angles_is_left_out(tmp_path):
    columns = [*range(12), *range(15, 18)]
    header = ",".join(np.array(HEADERS["named"].split(","))[columns])
    found = identify_file(written(tmp_path / "log.csv", rows(30)[:, columns], header))
    assert found.answers[0].reading.velocity is None
    assert holds(found.answers[0], replace(AEROSPACE, velocity=None))
    assert "not used: wx, wy, wz, since there are no columns for rates" in found.text()


def test_a_data_frame_is_read_by_its_names():
    names = HEADERS["named"].split(",")
    order = np.random.default_rng(1).permutation(18)
    frame = pl.DataFrame(rows(30), schema=names).select(np.array(names)[order].tolist())
    (answer,) = rs.identify(frame).answers
    expected = [name for name in frame.columns if name in names[:3]]
    assert answer.reading.product(expected) == "(Rz(yaw) Ry(pitch) Rx(roll))ᵀ"
    with pytest.raises(SampleError, match="matrix: its columns have names; expected an array"):
        rs.identify(rows(30)[:, :3], matrix=frame[:, 3:12])


YAW_PITCH_ROLL = Reading(sequence="ZYX", columns=(2, 1, 0), passive=True, degrees=True)


def listed(numbers) -> str:
    return ",".join(repr(float(number)) for number in np.ravel(numbers))


def options(given) -> list[str]:
    return [word for name, part in given.items() for word in (f"--{name}", listed(part))]


def test_one_sample_is_named_first_and_its_calls_follow(tmp_path):
    matrix = listed(attitude(YAW_PITCH_ROLL, (10, 20, 30))["matrix"])
    angles = "roll=10, pitch=20, yaw=30"
    done = call("identify", "--angles", angles, "--matrix", matrix, cwd=tmp_path)
    lines = done.stdout.splitlines()
    assert lines[:4] == [
        "xyz extrinsic, passive, degrees, columns (roll, pitch, yaw)",
        "= ZYX intrinsic, passive, columns (yaw, pitch, roll)",
        "",
        "matrix = (Rz(yaw) Ry(pitch) Rx(roll))ᵀ",
    ]
    assert 'Rotation.from_euler("xyz", angles, degrees=True).inv()' in done.stdout
    assert max(map(len, lines)) <= 80
    assert done.stderr == ""
    assert list(tmp_path.iterdir()) == []


def test_several_samples_with_signs_and_velocity_as_json(tmp_path):
    reading = Reading(sequence="ZXZ", scalar_last=True, velocity=VELOCITIES[1])
    rows = (GENERIC[False], (-0.2, 0.5, 0.6))
    words = [word for angles in rows for word in options(sample(reading, angles))]
    data = json.loads(call("identify", *words, "--json", cwd=tmp_path).stdout)
    assert (data["schema"], data["fits"], data["samples"]) == ("rigidsym.identification", True, 2)
    (answer,) = data["answers"]
    assert answer["reading"]["words"].startswith("ZXZ intrinsic, active, radians")
    assert answer["reading"]["velocity"] == {"frame": "body", "is_opposite": False, "units": ""}
    assert set(answer["calls"]) == {"SciPy", "rigidsym"}
    assert len(answer["aliases"]) == 3
    assert data["nearest"] is None
    assert [*data["tolerance"]] == ["if_radians", "if_degrees", "velocity", "because"]


def test_several_answers_are_cut_short_and_say_what_would_separate_them(tmp_path):
    words = options(sample(Reading(sequence="ZYX", degrees=True), (0, 0, 40)))
    done = call("identify", *words, cwd=tmp_path)
    assert "96 conventions fit 1 sample" in done.stdout
    assert "and 90 more; --all shows them" in done.stdout
    assert "three different angles, none near 0 or 90°, tells them apart" in done.stdout
    assert max(map(len, done.stdout.splitlines())) <= 80
    everything = call("identify", *words, "--all", cwd=tmp_path).stdout
    assert everything.count("from scipy.spatial.transform") == 96


def test_no_fit_is_an_answer_with_exit_code_1(tmp_path):
    matrix = listed(attitude(YAW_PITCH_ROLL, (10, 20, 30.5))["matrix"])
    words = ("identify", "--angles", "10,20,30", "--matrix", matrix)
    done = call(*words, cwd=tmp_path, status=1)
    assert "No convention fits 1 sample: 1152 were tried," in done.stdout
    assert "Nearest: xyz extrinsic, passive, degrees, columns (a1, a2, a3)" in done.stdout
    assert "residual 0.0087 rad (0.5°), worst at sample 1" in done.stdout
    assert "as far off as that, --tolerance 0.0092 accepts it." in done.stdout
    assert done.stderr == ""
    call(*words, "--tolerance", "0.0092", cwd=tmp_path)
    far = call(*words[:2], "0,0,0", "--matrix", "1,0,0,0,-1,0,0,0,-1", cwd=tmp_path, status=1)
    assert "residual 3.1 rad (180°), worst" in far.stdout
    assert "Even the best match is 180° off" in far.stdout
    data = json.loads(call(*words, "--json", cwd=tmp_path, status=1).stdout)
    assert (data["fits"], data["answers"]) == (False, [])
    assert data["nearest"]["residual"] == pytest.approx(np.radians(0.5))


def test_units_in_names_are_converted(tmp_path):
    names = HEADERS["named"].split(",")
    names[:3] = (f"{name} [arcmin]" for name in names[:3])
    table = rows(30) * np.where(np.arange(18) < 3, 60, 1)
    found = identify_file(written(tmp_path / "log.csv", table, ",".join(names)))
    assert holds(found.answers[0], AEROSPACE)
    assert f"converted to degrees: {', '.join(names[:3])}" in found.text()


def test_units_in_names_that_the_numbers_contradict_are_named(tmp_path):
    names = HEADERS["named"].replace("yaw,", "yaw [deg],")
    mixed = names.replace("_rate", "_rate [deg/s]").replace("wx", "wx [rad/s]")
    for header, contradicted in (
        (names, ()),
        (names.replace("[deg]", "[rad]"), ("angles in rad",)),
        (mixed, ("rates in deg/s", "omega in rad/s")),
    ):
        found = identify_file(written(tmp_path / "log.csv", rows(30), header))
        assert found.contradicted == contradicted
        words = f"say {', '.join(contradicted)}: the numbers"
        assert (words in " ".join(found.text().split())) == bool(contradicted)
