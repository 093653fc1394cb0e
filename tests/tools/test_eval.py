"""`rigidsym eval`: the columns that are read, the numbers that are written, and what is refused."""

from __future__ import annotations

import gzip
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_array_equal

import rigidsym as rs
from helpers.log_files import COUNT, NAMES, VELOCITY, WRITERS, read, run, velocities
from rigidsym.data.tables import open_table
from rigidsym.errors import DataError
from rigidsym.tools.evaluate import evaluate


@pytest.fixture(scope="module")
def kernel(motion):
    return motion.kernels().load().angular_velocity_body


@pytest.mark.parametrize("target", WRITERS)
@pytest.mark.parametrize("source", WRITERS)
def test_each_kind_of_file_to_each(motion, table, kernel, tmp_path, source, target):
    given, result = tmp_path / f"given{source}", tmp_path / f"result{target}"
    WRITERS[source](given, table)
    made = evaluate(motion, VELOCITY, given, result, rows=137)
    assert made.rows == COUNT
    assert_array_equal(read(result), velocities(kernel, table, 137))
    assert sorted(tmp_path.iterdir()) == sorted([given, result])  # no draft, no marks


@pytest.mark.parametrize("target", WRITERS)
def test_single_precision_is_kept(motion, table, tmp_path, target):
    single = table.astype(np.float32)
    np.save(tmp_path / "given.npy", single)
    result = tmp_path / f"result{target}"
    evaluate(motion, VELOCITY, tmp_path / "given.npy", result)
    kernel = motion.kernels().load().angular_velocity_body
    values = kernel(single[:, :3], single[:, 3:])
    assert values.dtype == np.float32
    assert_array_equal(read(result).astype(np.float32), values)


def test_columns_are_found_by_names_with_units_in_any_order(tmp_path):
    text = "t;Yaw [deg];pitch[deg];ROLL (deg);yaw rate;d_pitch;roll_dot\n5;90;0;0;0;0;10\n"
    (tmp_path / "log.csv").write_text(text, encoding="utf-8")
    result = tmp_path / "rates.csv"
    done = run("z(yaw) y(pitch) x(roll)", tmp_path / "log.csv", "--out", result, "--degrees")
    assert done.returncode == 0, done.stderr
    head, line = result.read_text(encoding="utf-8").splitlines()
    assert head.startswith("angular_velocity_body_1 [deg/s],")
    assert np.allclose([float(x) for x in line.split(",")], [10, 0, 0])


@pytest.mark.parametrize("frame", ["space", "body"])
def test_an_angular_velocity_that_was_written_is_read_again(motion, table, tmp_path, frame):
    velocity, log = f"angular_velocity_{frame}", tmp_path / "log.csv"
    WRITERS[".csv"](log, table)
    work = evaluate(motion, (velocity,), log, tmp_path / "o.csv", keep=("phi", "theta", "psi"))
    assert f"{velocity}_1 [rad/s]" in work.columns
    name = f"rates_from_{velocity}"
    evaluate(motion, (name,), tmp_path / "o.csv", tmp_path / "rates.npy")
    np.testing.assert_allclose(np.load(tmp_path / "rates.npy"), table[:, 3:], atol=1e-10)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("phi,theta,psi,phi_dot,theta_dot,psi_dot\n1,2,3,4,5,6\n1,2,x,4,5,6\n", "line 3: field 3"),
        ("phi,theta,psi,phi_dot,theta_dot,psi_dot\n1,2,3\n", "line 2: 3 fields, expected 6"),
        ("phi,theta,psi\n1,2,3\n", "no column phi_dot, theta_dot, psi_dot among phi, theta, psi"),
        ("1,2,3\n", "3 columns without names: expected 6"),
        ("\n\n", "no rows"),
        ('phi,"theta" x,psi\n1,2,3\n', "line 1: quotes that do not end where the field does"),
    ],
)
def test_what_is_wrong_with_a_text_is_said(motion, tmp_path, text, message):
    (tmp_path / "log.csv").write_text(text, encoding="utf-8")
    with pytest.raises(DataError, match=message):
        evaluate(motion, VELOCITY, tmp_path / "log.csv", tmp_path / "result.npy")
    assert [path.name for path in tmp_path.iterdir()] == ["log.csv"]


def test_what_is_no_table_of_numbers_is_refused(tmp_path):
    np.save(tmp_path / "words.npy", np.array(["a", "b"]))
    np.save(tmp_path / "objects.npy", np.array([{}, {}]), allow_pickle=True)
    (tmp_path / "empty.npy").write_bytes(b"")
    (tmp_path / "wide.csv").write_text("1," * 100_000)
    np.save(tmp_path / "flat.npy", np.zeros(3))
    (tmp_path / "broken.npy").write_bytes(b"nothing")
    (tmp_path / "broken.parquet").write_bytes(b"nothing")
    for path in sorted(tmp_path.iterdir()):
        with pytest.raises(DataError, match=path.name):
            open_table(path)
    with pytest.raises(DataError, match="/dev/null: not a regular file"):
        open_table(Path("/dev/null"))


@pytest.mark.parametrize(
    ("content", "found"),
    [
        (gzip.compress(b"1,2,3", mtime=0), r"compressed by gzip \(gunzip unpacks them\)"),
        (b"PK\3\4", "a ZIP archive or a spreadsheet"),
        ("phi,theta".encode("utf-16"), "text in UTF-16"),
        (b"\x93NUMPY", "NPY, but its name does not end in .npy"),
        (b"\7\0\7", "no text"),
    ],
)
def test_a_file_that_is_no_text_is_named_for_what_it_is(tmp_path, content, found):
    (tmp_path / "log.csv").write_bytes(content)
    with pytest.raises(DataError, match=rf"log\.csv holds .*{found}; expected text in UTF-8"):
        open_table(tmp_path / "log.csv")


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


def test_the_body_of_a_derivation_file_is_known(table, tmp_path):
    text = '[rotation]\nsequence = "ZXZ"\n[body]\nmass = 3\nprincipal_moments = [1.5, "B", 2.5]\n'
    (tmp_path / "top.toml").write_text(text, encoding="utf-8")
    np.save(tmp_path / "log.npy", table)
    options = ("--quantity", "rotational_energy", "--given", "B=2.0")
    paths = (tmp_path / "top.toml", tmp_path / "log.npy")
    done = run(*paths, "--out", tmp_path / "r.npy", *options)
    assert done.returncode == 0, done.stderr
    turned = rs.derive("ZXZ").kernels().load().angular_velocity_body(table[:, :3], table[:, 3:])
    energy = 0.5 * turned**2 @ (1.5, 2.0, 2.5)
    np.testing.assert_allclose(np.load(tmp_path / "r.npy")[:, 0], energy, rtol=1e-13)


def test_what_needs_no_rows_is_refused(motion, table, tmp_path):
    np.save(tmp_path / "given.npy", table)
    paths = tmp_path / "given.npy", tmp_path / "r.npy"
    given = dict.fromkeys(NAMES[:3], 0.1)
    with pytest.raises(DataError, match="every row has the same result"):
        evaluate(motion, ("rotation_matrix",), *paths, columns=NAMES, given=given)
    ball = rs.derive("ZXZ", body=rs.principal_moments(1, 1, 1, mass=1))
    with pytest.raises(DataError, match="inertia_tensor takes no input"):
        evaluate(ball, ("rotational_energy", "inertia_tensor"), *paths)


@pytest.mark.parametrize(("name", "found"), [("r.xlsx", "the ending .xlsx"), ("r", "no ending")])
def test_an_ending_that_nobody_writes_is_exit_code_2(tmp_path, name, found):
    (tmp_path / "log.csv").write_text("1,2,3,4,5,6\n", encoding="utf-8")
    done = run("ZXZ", tmp_path / "log.csv", "--out", tmp_path / name)
    assert done.returncode == 2
    assert f"{name} has {found}; expected .npy, .csv, .txt, .parquet, .pq" in done.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["log.csv"]


@pytest.mark.parametrize(
    ("quantity", "options", "message"),
    [
        (VELOCITY, {"given": {"phi": 1.0}}, "expected numbers for all of phi, theta, psi, or"),
        (VELOCITY, {"given": {"alpha": 1.0}}, "alpha is not an input"),
        (VELOCITY, {"keep": ("time",)}, "--keep needs names of columns; --columns gives"),
        (VELOCITY, {"keep": ("time",), "columns": NAMES}, "no column time; known: phi, theta"),
    ],
)
def test_a_request_that_no_file_satisfies_is_refused(
    motion, table, tmp_path, quantity, options, message
):
    np.save(tmp_path / "given.npy", table)
    with pytest.raises(rs.RigidsymError, match=message):
        evaluate(motion, quantity, tmp_path / "given.npy", tmp_path / "r.npy", **options)


def test_columns_that_an_npy_file_cannot_hold_are_refused(motion, tmp_path):
    result = tmp_path / "r.npy"
    for name, message in (("12", ""), ("one", "has texts"), ("9" * 17, "beyond 2\\^53")):
        (tmp_path / "log.csv").write_text(f"phi,theta,psi,run\n1,2,3,{name}\n", encoding="utf-8")
        work = partial(evaluate, motion, ("rotation_matrix",), tmp_path / "log.csv", result)
        if message:
            with pytest.raises(DataError, match=message):
                work(keep=("run",))
        else:
            work(keep=("run",))
            assert np.load(result)[0, 0] == 12


def test_a_rotation_without_an_inverse_names_what_to_use():
    result = run("z(a) x(b)", "-", "--quantity", "from_quaternion", "--out", "-", given="1,0,0,0\n")
    assert result.returncode
    assert "scipy.optimize.least_squares" in result.stderr
