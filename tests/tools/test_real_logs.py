"""Logs as instruments, spreadsheets and exporters write them, each as a file made for it."""

from __future__ import annotations

from functools import partial

import numpy as np
import polars as pl
import pytest
from scipy.spatial.transform import Rotation

import rigidsym as rs
from rigidsym.data.mass import inertia_of
from rigidsym.data.tables import TextTable
from rigidsym.errors import DataError, RigidsymError
from rigidsym.tools.evaluate import evaluate
from rigidsym.tools.identify.identification import identify_file

ANGLES = np.array([[10.0, 20.0, 30.0], [-40.0, 50.5, 60.0], [1.5, -2.5, 3.5]])  # degrees
ATTITUDE = rs.EulerAngles("ZYX", angles=("yaw", "pitch", "roll"))
MATRIX = Rotation.from_euler("ZYX", ANGLES, degrees=True).as_matrix().reshape(-1, 9)
ROWS = [",".join(map(repr, row)) for row in ANGLES.tolist()]


@pytest.fixture(scope="module")
def motion() -> rs.Motion:
    return rs.derive(ATTITUDE)


def matrices(motion, path, **options) -> np.ndarray:
    result = path.with_name("result.npy")
    evaluate(motion, ("rotation_matrix",), path, result, **options)
    return np.load(result)


def text(path, *lines, encoding="utf-8", end="\n"):
    path.write_bytes(end.join([*lines, ""]).encode(encoding))
    return path


HEADER = "yaw [deg],pitch [deg],roll [deg]"
SEMICOLONS = [row.replace(",", ";").replace(".", ",") for row in ROWS]
FILES = {
    "comments everywhere": ("# flight 7", "", "# rig 2", HEADER, "# start", *ROWS, "# end"),
    "a header in a comment between others": ("# flight 7", f"# {HEADER}", "# start", *ROWS),
    "the header of rostopic echo -p": (
        "%time,field.yaw_deg,field.pitch_deg,field.roll_deg",
        *(f"1700000000123456789,{row}" for row in ROWS),
    ),
    "a text column with commas in quotes": (
        f"note,{HEADER}",
        *(f'"calm, then gusts",{row}' for row in ROWS),
    ),
    "decimal commas": (HEADER.replace(",", ";"), *SEMICOLONS),
    "blanks": ("yaw_deg pitch_deg roll_deg", *(row.replace(",", "   ") for row in ROWS)),
    "a separator at the end of each row": (HEADER, *(f"{row}," for row in ROWS)),
    "blank lines and spaces": ("", HEADER, *(f"  {row.replace(',', ' , ')}  \n" for row in ROWS)),
    "an ArduPilot attitude": (
        "timestamp,TimeUS,DesRoll,Roll,DesPitch,Pitch,DesYaw,Yaw",
        *(
            f"1700000000.5,{k},0,{roll},0,{pitch},0,{yaw}"
            for k, (yaw, pitch, roll) in enumerate(ANGLES.tolist())
        ),
    ),
}


@pytest.mark.parametrize("name", FILES)
def test_eval_reads(motion, tmp_path, name):
    found = matrices(motion, text(tmp_path / "log.csv", *FILES[name]), degrees="Ardu" in name)
    np.testing.assert_allclose(found, MATRIX, atol=1e-14)


def test_units_are_converted_column_by_column_whatever_degrees_says(motion, tmp_path):
    header = "yaw [cdeg],pitch [mrad],roll [arcmin],yaw_rate [rpm],pitch_rate [deg/h],roll_rate"
    row = "1000,349.0658503988659,1800,60,3600,0.5"
    path = text(tmp_path / "log.csv", header, row)
    velocity = motion.kernels().load().angular_velocity_body
    for degrees, last in ((False, 0.5), (True, np.radians(0.5))):
        result = tmp_path / "result.npy"
        evaluate(motion, ("angular_velocity_body",), path, result, degrees=degrees)
        expected = velocity(np.radians([10, 20, 30]), (2 * np.pi, np.radians(1), last))
        expected = np.degrees(expected) if degrees else expected
        np.testing.assert_allclose(np.load(result), [expected], rtol=1e-14)


GAPS = (HEADER, ROWS[0], "-40.0,,60.0", "NaN,1,2", "1,N/A,null", ROWS[2])


def test_missing_numbers_are_an_error_unless_a_policy_says_otherwise(motion, tmp_path):
    path = text(tmp_path / "log.csv", *GAPS)
    with pytest.raises(DataError, match=r"log\.csv, line 3: pitch is missing; --missing nan"):
        matrices(motion, path)
    found = matrices(motion, path, missing="drop")
    np.testing.assert_allclose(found, MATRIX[[0, 2]], atol=1e-14)
    found = matrices(motion, path, missing="nan")
    np.testing.assert_allclose(found[[0, 4]], MATRIX[[0, 2]], atol=1e-14)
    assert np.isnan(found[1:4]).any(axis=1).all()


def test_identify_drops_samples_with_missing_numbers_on_request(tmp_path):
    names = ",".join(f"r{i}{j}" for i in (1, 2, 3) for j in (1, 2, 3))
    lines = [f"{a},{','.join(map(repr, m))}" for a, m in zip(ROWS, MATRIX.tolist(), strict=True)]
    lines.append(lines[0].replace("20.0", ""))
    path = text(tmp_path / "log.csv", f"yaw,pitch,roll,{names}", *lines)
    with pytest.raises(DataError, match="line 5: angles: a number that is missing"):
        identify_file(path)
    assert identify_file(path, drops_missing=True).samples == 3


@pytest.mark.parametrize("ending", [".csv", ".parquet", ".npy"])
def test_time_stamps_of_nanoseconds_keep_every_digit_or_are_refused(motion, tmp_path, ending):
    stamps = [f"{1700000000123456789 + k},{row}" for k, row in enumerate(ROWS)]
    path = text(tmp_path / "log.csv", f"stamp,{HEADER}", *stamps)
    work = partial(evaluate, motion, ("quaternion",), path, tmp_path / f"r{ending}")
    if ending == ".npy":
        with pytest.raises(DataError, match=r"so --keep needs \.csv or"):
            work(keep=["stamp"])
        return
    work(keep=["stamp"])
    if ending == ".csv":
        lines = (tmp_path / "r.csv").read_text(encoding="utf-8").splitlines()
        assert [line.partition(",")[0] for line in lines[1:]] == [s[:19] for s in stamps]
    else:
        table = pl.read_parquet(tmp_path / "r.parquet")
        assert list(map(str, table["stamp"])) == [s[:19] for s in stamps]


@pytest.mark.parametrize(
    ("row", "message"),
    [
        ('"a\nb",1,2,3', "line 3: quotes that do not end where the field does"),
        ("calm,1,2,3,4\ncalm,1,2", "line 3: 5 fields, expected 4"),  # as many on the whole
        ("calm,0,5,1,5,2,5", "line 3: 7 fields, expected 4"),  # decimal commas
    ],
)
def test_rows_of_odd_quotes_or_lengths_are_refused_with_their_line(motion, tmp_path, row, message):
    path = text(tmp_path / "log.csv", "note,yaw,pitch,roll", "calm,1,2,3", row)
    for keep in ((), ("note",)):
        with pytest.raises(DataError, match=message):
            matrices(motion, path, keep=keep)


NUMBERS = (
    *("1.5", "-2", "+3", "1e5", "1E+05", ".5", "5.", " 1.5", "1.5 ", "1,5", "1.000,5", "4.9e-324"),
    *("0.1000000000000000055511151231257827", "9" * 30, "1e400", "inf", "-Infinity", "iNf"),
    *("", "-", "NA", "n/a", "NULL", "None", "nan", "NaN", "nAn", "-nan", "nan(1)"),
    *("1_000", "0x10", "1d5", "true", "１", "1 2", "--1", "1e", '"1"', "1\r"),
)
GAPS_IN_TEXT = {"", "-", "na", "n/a", "null", "none"}


@pytest.mark.parametrize("separator", [",", ";"])
def test_a_field_is_the_number_that_python_reads_or_refused(tmp_path, separator):
    for number in NUMBERS:
        if separator in number:
            continue
        path = text(tmp_path / "log.csv", f"1{separator}2", f"{number}{separator}7")
        bare = number.strip('" \r').replace(",", ".")
        try:
            expected = float("nan" if bare.lower() in GAPS_IN_TEXT else bare)
            is_number = bare.isascii() and "_" not in bare
        except ValueError:
            is_number = False
        if is_number:
            (batch,) = TextTable(path).batches((0, 1))
            np.testing.assert_array_equal(batch.table, [[1, 2], [expected, 7]], repr(number))
        else:
            with pytest.raises(DataError, match=r"line 2: field 1: .* is not a number"):
                list(TextTable(path).batches((0, 1)))


def test_what_a_log_lacks_is_said_by_every_tool_and_no_word_of_a_stranger(answered, tmp_path):
    motion, path = rs.derive("ZXZ"), tmp_path / "log.csv"

    def answer(log: str) -> str:
        path.write_text(f"{log}\n", encoding="utf-8")
        said = []
        for work in (
            lambda: evaluate(motion, ("angular_velocity_body",), path, tmp_path / "r.csv"),
            lambda: identify_file(path),
            lambda: inertia_of(path),
        ):
            with pytest.raises(RigidsymError) as caught:
                work()
            said.append(str(caught.value).replace(f"{tmp_path}/", ""))
        return "\n".join(said)

    answered("data/faulty_logs.txt", answer)
