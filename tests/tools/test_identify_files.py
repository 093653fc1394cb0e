"""Samples from files and arrays: columns by name, a piece at a time, and every fault said."""

from __future__ import annotations

import tracemalloc
from dataclasses import replace

import numpy as np
import polars as pl
import pytest
from scipy.spatial.transform import Rotation

import rigidsym as rs
from helpers.conventions import GENERIC, holds, omega, rotation, sample
from rigidsym.errors import DataError
from rigidsym.tools.identify import samples
from rigidsym.tools.identify.fit import rounding_of
from rigidsym.tools.identify.identification import identify_file
from rigidsym.tools.identify.readings import VELOCITIES, Reading
from rigidsym.tools.identify.samples import BLOCK, SampleError, by_name, by_width

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
    "units": "Psi [deg],Theta [deg],Phi [deg],"
    + ",".join(name.replace("r", "M") for name in MATRIX)
    + ",psi dot,theta dot,phi dot,omega_x,omega_y,omega_z",
    "other": "angle1,angle2,angle3,"
    + ",".join(name.replace("r", "dcm") for name in MATRIX)
    + ",rate1,rate2,rate3,p,q,r",
}


@pytest.mark.parametrize("header", HEADERS.values(), ids=HEADERS)
@pytest.mark.parametrize(
    "separator", [",", ";", "\t", " "], ids=["comma", "semicolon", "tab", "blank"]
)
def test_columns_by_name(tmp_path, header, separator):
    if separator == " ":
        header = header.replace(" [deg]", "").replace(" dot", "dot")
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
    assert found.names == ("yaw", "pitch", "roll")


def test_columns_between_others_in_any_order(tmp_path):
    table = rows(20)[:, :12]
    order = np.random.default_rng(0).permutation(12)
    header = ",".join(np.array(["roll", "pitch", "yaw", *MATRIX])[order])
    lines = [header + ",comment"]
    lines += [",".join(f"{x:.9f}" for x in row[order]) + ",“text”" for row in table]
    path = tmp_path / "mixed.csv"
    path.write_text("\ufeff" + "\n\n".join(lines) + "\n", encoding="utf-8")
    found = identify_file(path)
    names = ["roll", "pitch", "yaw"]
    columns = tuple([name for name in header.split(",") if name in names].index(n) for n in names)
    expected = Reading(sequence="ZYX", passive=True, degrees=True, columns=columns)
    assert holds(found.answers[0], expected)


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
    numbered = identify_file(written(tmp_path / "numbered.csv", table, "phi,theta,psi,q1,q2,q3,q4"))
    assert [answer.reading.scalar_last for answer in numbered.answers] == [True]
    assert numbered.tried == 2304


@pytest.mark.parametrize("width", [7, 12, 13, 18])
def test_npy_by_width(tmp_path, width):
    table = rows(50)
    if width in (7, 13):
        table = np.hstack(
            [table[:, :3], rotation(AEROSPACE, table[:, :3]).inv().as_quat(), table[:, 12:]]
        )
    np.save(tmp_path / "log.npy", table[:, :width])
    (answer,) = identify_file(tmp_path / "log.npy").answers
    assert (answer.reading.sequence, answer.reading.passive) == ("ZYX", True)
    assert (answer.reading.velocity is not None) == (width in (13, 18))


# --- large files ----------------------------------------------------------------------------


def test_a_large_file_is_read_in_bounded_memory(tmp_path):
    count = 300_000
    angles = np.random.default_rng(2).uniform(-70, 70, (count, 3))
    path = tmp_path / "large.npy"
    whole = np.lib.format.open_memmap(path, "w+", np.float64, (count, 12))
    whole[:, :3] = angles
    whole[:, 3:] = rotation(AEROSPACE, angles).inv().as_matrix().reshape(count, 9)
    whole.flush()
    del angles
    identify_file(path)  # once, so that what is loaded on first use does not count
    shares: list[float] = []
    tracemalloc.start()
    found = identify_file(path, progress=shares.append)
    _, peak = tracemalloc.get_traced_memory()
    given = rs.identify(whole[:, :3], matrix=whole[:, 3:])
    _, again = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert found.samples == given.samples == count
    assert holds(given.answers[0], AEROSPACE.orientation)
    assert max(peak, again) < 16e6 < whole.nbytes
    assert shares == sorted(shares)
    assert (len(shares), shares[-1]) == (-(-count // BLOCK), 1.0)


def test_text_is_read_in_pieces_and_its_last_line_counts(tmp_path):
    count = 2 * BLOCK + 17
    table = np.tile(rows(1009)[:, :12], (count // 1009 + 1, 1))[:count]
    path = written(tmp_path / "log.csv", table, "a1,a2,a3," + ",".join(MATRIX), form="%.8f")
    shares: list[float] = []
    found = identify_file(path, progress=shares.append)
    assert (found.samples, len(shares), shares[-1]) == (count, 3, 1.0)
    table[-1, 0] += 3
    written(path, table, "a1,a2,a3," + ",".join(MATRIX), form="%.8f")
    found = identify_file(path)
    assert (found.fits, found.nearest.worst) == (False, f"line {count + 1}")


def test_many_candidates_are_verified_on_every_row():
    angles = np.zeros((3000, 3))
    angles[:, 0] = np.linspace(-50, 50, 3000)
    angles[1234] = (20, 30, 40)  # between the rows that are looked at first
    matrix = Rotation.from_euler("ZYX", angles, degrees=True).as_matrix()
    (answer,) = rs.identify(angles, matrix=matrix).answers
    assert holds(answer, Reading(sequence="ZYX", degrees=True))


# --- bad input ------------------------------------------------------------------------------


def test_all_bad_samples_are_named_with_their_amounts():
    good = sample(Reading(sequence="ZYX"), GENERIC[False])["matrix"]
    angles = np.tile(GENERIC[False], (5, 1))
    angles[1, 2] = np.nan
    stretched = good * 1.1
    mirrored = good @ np.diag([1, 1, -1])
    with pytest.raises(SampleError) as error:
        rs.identify(angles, matrix=[good, good, stretched, mirrored, np.full((3, 3), np.inf)])
    assert error.value.exit_code == 3
    assert str(error.value).splitlines() == [
        "the samples cannot be read",
        "  sample 2: angles: a number that is missing or not finite",
        "  sample 3: matrix: not a rotation, M Mᵀ differs from 1 by 0.21 in an entry "
        "(det M = 1.331)",
        "  sample 4: matrix: not a rotation but a reflection, its determinant is -1",
        "  sample 5: matrix: a number that is missing or not finite",
    ]


@pytest.mark.parametrize(
    ("quaternion", "message"),
    [
        ((0, 0, 0, 0), "zero, which is not a rotation"),
        ((1, 1, 0, 0), "its length is 1.414, expected 1"),
        ((np.nan, 1, 0, 0), "not finite"),
    ],
)
def test_quaternions_that_are_not_unit(quaternion, message):
    with pytest.raises(SampleError, match=message):
        rs.identify((0.1, 0.2, 0.3), quaternion=quaternion)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({}, "a matrix or a quaternion is missing"),
        ({"matrix": np.eye(3), "quaternion": [1, 0, 0, 0]}, "not both"),
        ({"matrix": np.eye(3), "rates": [1, 2, 3]}, "expected both rates and omega"),
        (
            {"matrix": np.eye(4)},
            r"matrix: expected the shape \(n, 3, 3\) or \(n, 9\), got \(4, 4\)",
        ),
        (
            {"matrix": [np.eye(3)] * 2},
            "one row per sample in every array, got 1 of angles, 2 of matrix",
        ),
        ({"matrix": np.eye(3) * 1j}, "matrix: expected real numbers, got complex128"),
        ({"matrix": [[1, 2], [3]]}, "matrix: not an array of numbers"),
        ({"matrix": np.eye(3), "names": ("a", "b")}, "three different names of angles, got a, b"),
        ({"matrix": np.eye(3), "tolerance": -1.0}, "between 0 and π radians, got -1"),
        ({"matrix": np.eye(3), "tolerance": np.nan}, "got nan"),
        ({"angles": np.empty((0, 3)), "matrix": np.empty((0, 3, 3))}, "no samples"),
    ],
)
def test_arguments_that_do_not_belong_together(given, message):
    with pytest.raises(SampleError, match=message):
        rs.identify(**{"angles": (0.1, 0.2, 0.3), **given})


@pytest.mark.parametrize(
    ("part", "note"),
    [
        (slice(15, 18), "wx, wy, wz, since there are no columns for rates of the angles"),
        (slice(12, 15), "yaw_rate, pitch_rate, roll_rate, since there are no columns for an ang"),
    ],
)
def test_a_gyroscope_without_rates_of_the_angles_is_left_out(tmp_path, part, note):
    columns = [*range(12), *range(18)[part]]
    header = ",".join(np.array(HEADERS["named"].split(","))[columns])
    found = identify_file(written(tmp_path / "log.csv", rows(30)[:, columns], header))
    assert found.answers[0].reading.velocity is None
    assert holds(found.answers[0], replace(AEROSPACE, velocity=None))
    assert f"not used: {note}" in found.text()


def test_a_data_frame_is_read_by_its_names():
    names = HEADERS["named"].split(",")
    order = np.random.default_rng(1).permutation(18)
    frame = pl.DataFrame(rows(30), schema=names).select(np.array(names)[order].tolist())
    (answer,) = rs.identify(frame).answers
    expected = [name for name in frame.columns if name in names[:3]]
    assert answer.reading.product(expected) == "(Rz(yaw) Ry(pitch) Rx(roll))ᵀ"
    with pytest.raises(SampleError, match="matrix: its columns have names; expected an array"):
        rs.identify(rows(30)[:, :3], matrix=frame[:, 3:12])


def test_missing_columns_are_named_with_the_nearest_that_are_there():
    with pytest.raises(SampleError) as error:
        by_name(["time", "rol", "pitch", "yaw", *MATRIX[:8], "r3"])
    assert "no column roll: did you mean rol" in str(error.value)
    assert "no column r33: did you mean r3" in str(error.value)
    assert "--columns names the columns in order" in str(error.value)
    with pytest.raises(SampleError, match="both a matrix and a quaternion"):
        by_name(["a1", "a2", "a3", *MATRIX, "qw", "qx", "qy", "qz"])
    with pytest.raises(SampleError, match="5 columns without names"):
        by_width(5)


@pytest.mark.parametrize(
    ("text", "messages"),
    [
        ("", ["no rows"]),
        ("\n \n", ["no rows"]),
        ("HEADER\n", ["no samples"]),
        ("HEADER\n1,2,3\n", ["line 2: 3 fields, expected 12"]),
        ("HEADER\nx,0,0,1,0,0,0,1,0,0,0,1\n", ["line 2: field 1: 'x' is not a number"]),
        (
            "HEADER\n0,0,0,1,0,0,0,1,0,0,0,1\n\n0,z,0,1,0,0,0,1,0,0,0,y\n0,0,0\n",
            ["line 4: field 2: 'z' is", "line 4: field 12: 'y' is", "line 5: 3 fields"],
        ),
        ("HEADER\n0,,0,1,0,0,0,1,0,0,0,1\n", ["line 2: angles: a number that is missing"]),
        ("HEADER\n0,0,0,1,0,0,0,1,0,0,0,nan\n", ["line 2: matrix: a number that is miss"]),
        ("HEADER\n0,0,1_0,1,0,0,0,1,0,0,0,1\n", ["line 2: field 3: '1_0' is not a number"]),
        ("HEADER\n0,0,1°,1,0,0,0,1,0,0,0,1\n", ["'1°' is not a number; write degrees without °"]),
        ("a1;a2;a3;w;x;y;z\n0;0,5;0;1.0;0;0;0\n", ["line 2: decimal commas and decimal points"]),
    ],
)
def test_texts_that_do_not_read(tmp_path, text, messages):
    path = tmp_path / "bad.csv"
    path.write_text(text.replace("HEADER", "a1,a2,a3," + ",".join(MATRIX)))
    with pytest.raises(DataError) as error:
        identify_file(path)
    for message in messages:
        assert message in str(error.value)


def test_only_the_first_of_many_faults_are_listed(tmp_path):
    table = rows(60)[:, :12]
    table[::2, 3] = 7
    path = written(tmp_path / "bad.csv", table, "a1,a2,a3," + ",".join(MATRIX))
    with pytest.raises(SampleError) as error:
        identify_file(path)
    lines = str(error.value).splitlines()
    assert lines[1].startswith("  line 2: matrix: not a rotation")
    assert (len(lines), lines[-1]) == (12, "  and 20 more")


@pytest.mark.parametrize(
    ("row", "rounding"),
    [
        ([0.123, 0.5, 0.01], 5e-4),
        ([0.1234, 0.00001234], 5e-5),  # %.4g
        ([1.0, 0.012], 5e-4),
        ([1.0, 0.0, -1.0], 0.0),
        ([12.5, 3.0], 0.05),
        ([1.5e-7, 0.0], 5e-9),
        ([1e20, 3.0], 0.0),
        ([0.0, 0.0], 0.0),
    ],
)
def test_the_rounding_of_printed_numbers(row, rounding):
    assert rounding_of(np.array([row])) == pytest.approx(rounding)


def test_a_log_of_faults_describes_only_those_that_are_shown(monkeypatch):
    """Describing each of n faults looked at all n rows: minutes for 100,000 of them."""
    described = []
    monkeypatch.setattr(samples, "_what_is_wrong", lambda row: described.append(len(row)) or "")
    with pytest.raises(SampleError, match="and 4990 more"):
        rs.identify(np.zeros((5000, 3)), matrix=np.tile(-np.eye(3), (5000, 1, 1)))
    assert set(described) == {1}
    assert len(described) <= 20
