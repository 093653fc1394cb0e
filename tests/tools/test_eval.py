"""`rigidsym eval`: the columns that are read, the numbers that are written, and what is refused."""

from __future__ import annotations

import resource
import subprocess
import sys
from pathlib import Path

import numpy as np
import polars as pl
import pytest
from numpy.testing import assert_array_equal

import rigidsym as rs
from helpers.command import run
from rigidsym.data.tables import open_table
from rigidsym.errors import DataError
from rigidsym.tools.evaluate import evaluate

COUNT = 1000
VELOCITY = ("angular_velocity_body",)
NAMES = ("phi", "theta", "psi", "phi_dot", "theta_dot", "psi_dot")
HEAD, WXYZ, ABOUT_X = ",".join(NAMES), "qw,qx,qy,qz", [np.cos(1), np.sin(1), 0, 0]
LAST = "unit_quaternion --scalar-last --quantity"


def as_text(path: Path, table: np.ndarray) -> None:
    lines = [",".join(map(repr, row)) for row in table.tolist()]
    path.write_text("\n".join([",".join(NAMES), *lines]) + "\n", encoding="utf-8")


def as_parquet(path: Path, table: np.ndarray) -> None:
    columns = dict(zip(NAMES, table.T, strict=True))
    pl.DataFrame(columns).write_parquet(path, row_group_size=300)


WRITERS = {".npy": np.save, ".csv": as_text, ".parquet": as_parquet}


def read(path: Path) -> np.ndarray:
    reader = open_table(path)
    return np.concatenate([chunk.table for chunk in reader.batches(range(reader.width))])


def velocities(kernel, table: np.ndarray, rows: int) -> np.ndarray:
    """Ω′ of a log, so many rows at a time: the last bit of a kernel may depend on their number."""
    parts = [table[start : start + rows] for start in range(0, len(table), rows)]
    return np.concatenate([kernel(part[:, :3], part[:, 3:]) for part in parts])


@pytest.fixture(scope="module")
def motion() -> rs.Motion:
    return rs.derive("ZXZ")


@pytest.fixture(scope="module")
def table() -> np.ndarray:
    return np.random.default_rng(7).uniform(-3, 3, (COUNT, 6))


@pytest.mark.parametrize("target", WRITERS)
@pytest.mark.parametrize("source", WRITERS)
def test_each_kind_of_file_to_each(motion, table, tmp_path, source, target):
    given, result = tmp_path / f"given{source}", tmp_path / f"result{target}"
    WRITERS[source](given, table)
    made = evaluate(motion, VELOCITY, given, result, rows=137)
    assert made.rows == COUNT
    kernel = motion.kernels().load().angular_velocity_body
    assert_array_equal(read(result), velocities(kernel, table, 137))
    assert sorted(tmp_path.iterdir()) == sorted([given, result])  # no draft, no marks


@pytest.mark.parametrize(
    ("words", "log", "head", "row"),
    [
        (
            "z(yaw)y(pitch)x(roll) --degrees",  # units in names, in any order
            "t;Yaw [deg];pitch[deg];ROLL (deg);yaw rate;d_pitch;roll_dot\n5;90;0;0;0;0;10\n",
            "angular_velocity_body_1 [deg/s],",
            [10, 0, 0],
        ),
        (
            "ZYX --angles a,b,c --quantity quaternion --keep t,state",  # decimal commas
            "t;a;b;c;state\n0,5;0,0;0;2;1\n",
            "t,state,qw",
            [0.5, 1, *ABOUT_X],
        ),
        (f"{LAST} from_quaternion", f"{WXYZ}\n.5,.1,.7,.5\n", "x,y,z,w\n", [0.1, 0.7, 0.5, 0.5]),
        (f"{LAST} from_quaternion", "z,y,x,w\n.5,.7,.1,.5\n", "x,y,z,w\n", [0.1, 0.7, 0.5, 0.5]),
        (f"{LAST} quaternion", "x,y,z,w\n.1,.7,.5,.5\n", "qx,qy,qz,qw\n", [0.1, 0.7, 0.5, 0.5]),
        ("ZYX --angles a,b_turn,c_deg --quantity quaternion", "0,0,2\n", WXYZ, ABOUT_X),
        ("ZYX --angles a,A,b --quantity quaternion", "0,0,2\n", WXYZ, ABOUT_X),
        ("z(a)x(b) --constants b --given b=2 --quantity quaternion", "a\n0\n", WXYZ, ABOUT_X),
        (
            "ZYX --degrees --quantity from_quaternion",  # of ROS
            "Time,header.seq,header.frame_id,orientation.x,orientation.y,orientation.z,"
            "orientation.w,orientation_covariance_0,angular_velocity.x\n1.7e9,1,imu,0,0,1,0,0,0.1\n",
            "phi [deg],theta [deg],psi [deg]",
            [180, 0, 0],
        ),
    ],
)
def test_columns_are_found_and_named(words, log, head, row):
    done = run("eval", *words.split(), "-", "--out", "-", given=log)
    assert done.stdout.startswith(head), done.stderr
    assert "standard output: 1 row" in done.stderr
    assert np.allclose([float(x) for x in done.stdout.splitlines()[1].split(",")], row)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (b"\xff\xfep\0h\0i\0", "is text in UTF-16; expected text in UTF-8"),
        (b"\x1f\x8b\x08\0", "is compressed by gzip; expected text"),
    ],
)
def test_a_text_that_is_none_is_named(motion, tmp_path, text, message):
    (tmp_path / "log.csv").write_bytes(text)
    with pytest.raises(DataError, match=message):
        evaluate(motion, VELOCITY, tmp_path / "log.csv", tmp_path / "result.npy")
    assert [path.name for path in tmp_path.iterdir()] == ["log.csv"]


@pytest.mark.parametrize(
    ("quantity", "text", "message"),
    [
        ("angular_velocity_body", HEAD, "- has no rows of numbers"),
        ("from_rotation_matrix", "1,0,0,0,1,0,0,0,-1\n", "line 1: matrix: not a rotation but a"),
        ("from_quaternion", "1,0,0,0\n0,0,0,0\n", "1 of 2 rows have no value, the first in line 2"),
        ("heavy_symmetric_top --quantity energy", "phi,theta\n1,2\n", "--given A=NUMBER gives a"),
        ("rotation_matrix", "1,-90,7\n", "theta is as large as 90 radians, which are 5156.62 deg"),
    ],
)
def test_what_a_user_should_know_of_a_result_is_said(quantity, text, message):
    words = quantity.split() if " " in quantity else ["ZXZ", "--quantity", quantity]
    done = run("eval", *words, "-", "--out", "-", given=text)
    assert message in done.stderr
    assert (done.returncode == 0) == done.stdout.startswith((quantity, "phi [rad],"))


def test_what_is_no_table_of_numbers_is_refused(tmp_path):
    np.save(tmp_path / "words.npy", np.array(["a", "b"]))
    np.save(tmp_path / "objects.npy", np.array([{}, {}]), allow_pickle=True)
    np.save(tmp_path / "flat.npy", np.zeros(3))
    (tmp_path / "broken.npy").write_bytes(b"nothing")
    (tmp_path / "broken.parquet").write_bytes(b"nothing")
    for path in sorted(tmp_path.iterdir()):
        with pytest.raises(DataError, match=path.name):
            open_table(path)


def test_a_panic_of_polars_is_a_damaged_file(tmp_path, monkeypatch):
    (tmp_path / "log.parquet").write_bytes(b"PAR1")

    def panic(_):
        raise pl.exceptions.PanicException("called `Option::unwrap()` on a `None` value")

    monkeypatch.setattr(pl, "scan_parquet", panic)
    with pytest.raises(DataError, match="not a Parquet file, or a damaged one"):
        open_table(tmp_path / "log.parquet")


def test_what_no_row_changes_stands_in_every_row(motion, table, tmp_path):
    """Nine rows are as many as a matrix has entries; each still holds the whole matrix."""
    np.save(tmp_path / "rates.npy", table[:9, 3:])
    given = dict(zip(NAMES[:3], (0.1, 0.2, 0.3), strict=True))
    both = ("angular_velocity_body", "rotation_matrix")
    work = evaluate(motion, both, tmp_path / "rates.npy", tmp_path / "r.npy", given=given)
    assert work.rows == 9
    found, module = np.load(tmp_path / "r.npy"), motion.kernels().load()
    same = module.rotation_matrix((0.1, 0.2, 0.3)).ravel()
    assert_array_equal(found[:, 3:], np.broadcast_to(same, (9, 9)))
    velocity = module.angular_velocity_body((0.1, 0.2, 0.3), table[:9, 3:])
    assert_array_equal(found[:, :3], velocity)


def test_the_body_and_the_forces_of_a_derivation_file_act(table, tmp_path):
    text = '[rotation]\nsequence = "ZXZ"\n[body]\nmass = 3\nprincipal_moments = [1.5, "B", 2.5]\n'
    text += '[dynamics]\npotential = "g*cos(theta)"\nforces = { theta = "-k*theta_dot" }\n'
    (tmp_path / "top.toml").write_text(text, encoding="utf-8")
    np.save(tmp_path / "log.npy", table)
    words = (tmp_path / "top.toml", tmp_path / "log.npy", "--out", tmp_path / "r.npy")
    options = ("--quantity", "energy", "--given", "B=2.0", "--given", "g=10")
    assert run("eval", *map(str, words), *options[:2]).stderr.endswith("none for B, g\n")
    done = run("eval", *map(str, words), *options)
    assert done.returncode == 0, done.stderr
    turned = rs.derive("ZXZ").kernels().load().angular_velocity_body(table[:, :3], table[:, 3:])
    energy = 0.5 * turned**2 @ (1.5, 2.0, 2.5) + 10 * np.cos(table[:, 1])
    np.testing.assert_allclose(np.load(tmp_path / "r.npy")[:, 0], energy, rtol=1e-13)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"given": {"phi": 1.0}}, "expected numbers for all of phi, theta, psi, or"),
        ({"given": {"alpha": 1.0}}, "alpha is not an input"),
        ({"keep": ("time",), "columns": NAMES}, "no column time; known: phi, theta"),
    ],
)
def test_a_request_that_no_file_satisfies_is_refused(motion, table, tmp_path, options, message):
    np.save(tmp_path / "given.npy", table)
    with pytest.raises(rs.RigidsymError, match=message):
        evaluate(motion, VELOCITY, tmp_path / "given.npy", tmp_path / "r.npy", **options)


@pytest.mark.parametrize("target", WRITERS)
def test_stopped_work_leaves_the_old_file_and_nothing_else(motion, table, tmp_path, target):
    np.save(tmp_path / "given.npy", table)
    result = tmp_path / f"result{target}"
    result.write_bytes(b"old")

    def stop(share: float) -> None:
        if share > 0.5:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        evaluate(motion, VELOCITY, tmp_path / "given.npy", result, rows=100, progress=stop)
    assert result.read_bytes() == b"old"
    assert {path.name for path in tmp_path.iterdir()} == {"given.npy", result.name}


def test_a_full_disk_is_reported_and_leaves_the_old_file(table, tmp_path):
    """A process may write no file longer than 4 kB; a whole result has 24 kB."""
    np.save(tmp_path / "given.npy", table)
    result = tmp_path / "result.csv"
    result.write_bytes(b"old")
    command = ("eval", "ZXZ", str(tmp_path / "given.npy"), "--out")
    assert run(*command, "-").returncode == 0  # its kernels are kept in a longer file
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (4096, before[1]))
    try:
        done = run(*command, str(result))
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert done.returncode == 1, done.stderr
    assert f"{result}: " in done.stderr
    assert "File too large" in done.stderr
    assert "Traceback" not in done.stderr
    assert result.read_bytes() == b"old"
    assert {path.name for path in tmp_path.iterdir()} == {"given.npy", result.name}


@pytest.mark.campaign
def test_memory_does_not_grow_with_the_file(tmp_path):
    peaks = []
    for count in (100_000, 2_000_000):
        np.save(tmp_path / "given.npy", np.zeros((count, 6)))
        program = (
            "import resource, sys\n"
            "from rigidsym.commands.cli import commands\n"
            "given, result = sys.argv[1:]\n"
            "commands.main(['eval', 'ZXZ', given, '--out', result], standalone_mode=False)\n"
            "print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)\n"
        )
        files = map(str, (tmp_path / "given.npy", tmp_path / "result.npy"))
        done = subprocess.run(
            [sys.executable, "-c", program, *files], capture_output=True, text=True, check=True
        )
        peaks.append(int(done.stdout.split()[-1]) / 1024)
    assert peaks[1] - peaks[0] < 40  # MB; the larger file has 96 MB
