"""`rigidsym eval` stopped, killed, without room or started twice: no half results, nothing lost."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_array_equal

import rigidsym as rs
from helpers.log_files import COUNT, VELOCITY, WRITERS, command, logged, read, run
from rigidsym.data import writers as sinks
from rigidsym.errors import DraftInUse
from rigidsym.tools.evaluate.evaluate import Evaluation, evaluation


@pytest.fixture(scope="module")
def motion() -> rs.Motion:
    return rs.derive("ZXZ")


@pytest.fixture(scope="module")
def table() -> np.ndarray:
    return logged()


@pytest.fixture(scope="module")
def expected(motion, table):
    return motion.kernels().load().angular_velocity_body(table[:, :3], table[:, 3:])


class _Stopped(Exception):
    pass


def _stop_after(most: float, work: Evaluation) -> None:
    def stop(share: float) -> None:
        if share > most:
            raise _Stopped

    with pytest.raises(_Stopped):
        work.run(stop)


@pytest.mark.parametrize("target", WRITERS)
@pytest.mark.parametrize("source", WRITERS)
def test_stopped_work_goes_on_where_it_was(motion, table, expected, tmp_path, source, target):
    given, result = tmp_path / f"given{source}", tmp_path / f"result{target}"
    WRITERS[source](given, table)
    _stop_after(0.5, evaluation(motion, VELOCITY, given, result, piece=100))
    assert not result.exists()
    made = evaluation(motion, VELOCITY, given, result, piece=100).run()
    assert 400 < made.resumed < COUNT
    assert made.rows == COUNT
    assert_array_equal(read(result), expected)
    assert sorted(tmp_path.iterdir()) == sorted([given, result])


_KILLED = """
import sys, threading, time
from dataclasses import replace
from pathlib import Path
import rigidsym as rs
from rigidsym.tools.evaluate.evaluate import evaluation

def work(ending, degrees):
    def wait(share):
        if share > 0.3:
            sys.stdout.write("here\\n")
            sys.stdout.flush()
            time.sleep(600)
    names = f"given{ending}", f"{'degrees' if degrees else 'radians'}{ending}"
    paths = (Path(sys.argv[1]) / name for name in names)
    asked = evaluation(motion, ("angular_velocity_body",), *paths, piece=100, degrees=degrees)
    replace(asked, settle=0).run(wait)

motion = rs.derive("ZXZ")
asked = [(ending, degrees) for ending in sys.argv[2:] for degrees in (False, True)]
threads = [threading.Thread(target=work, args=each) for each in asked]
for thread in threads:
    thread.start()
for thread in threads:
    thread.join()
"""


def test_killed_work_of_every_kind_goes_on_and_only_one_process_writes(motion, table, tmp_path):
    """One process with six evaluations is killed, with all of them under way."""
    for ending, write in WRITERS.items():
        write(tmp_path / f"given{ending}", table)
    asked = [sys.executable, "-c", _KILLED, str(tmp_path), *WRITERS]
    works = {
        (ending, degrees): evaluation(
            motion,
            VELOCITY,
            tmp_path / f"given{ending}",
            tmp_path / f"{'degrees' if degrees else 'radians'}{ending}",
            piece=100,
            degrees=degrees,
        )
        for ending in WRITERS
        for degrees in (False, True)
    }
    with subprocess.Popen(asked, stdout=subprocess.PIPE, text=True) as process:
        try:
            assert process.stdout
            assert [process.stdout.readline() for _ in works] == ["here\n"] * len(works)
            for work in works.values():
                with pytest.raises(DraftInUse, match=f"{work.path} .* process {process.pid} "):
                    work.run()
        finally:
            process.kill()
    kernel = motion.kernels().load().angular_velocity_body
    for (_, degrees), work in works.items():
        assert not work.path.exists()
        made = work.run()  # the file that claims it is still there, of a dead process
        assert made.resumed in (399, 400)  # of a text, the header is one of 400 lines
        assert made.rows == COUNT
        turn = np.pi / 180 if degrees else 1
        right = kernel(table[:, :3] * turn, table[:, 3:] * turn) * (180 / np.pi if degrees else 1)
        assert_array_equal(read(work.path), right)
    assert {path.stem for path in tmp_path.iterdir()} == {"given", "degrees", "radians"}


@pytest.mark.parametrize("ending", WRITERS)
def test_marks_are_kept_after_the_rows_are_on_the_disk(
    motion, table, tmp_path, ending, monkeypatch
):
    """All that marks speak of was written through before they were: a power cut loses no row."""
    np.save(tmp_path / "given.npy", table)
    result = tmp_path / f"result{ending}"
    synced: list[str] = []
    replaced: list[str] = []
    fsync, replace = os.fsync, os.replace

    def note_fsync(descriptor: int) -> None:
        synced.append(Path(os.readlink(f"/proc/self/fd/{descriptor}")).name)
        fsync(descriptor)

    def note_replace(draft: object, path: Path) -> None:
        replaced.append(f"{Path(path).name} after {' '.join(synced)}")
        synced.clear()
        replace(draft, path)

    monkeypatch.setattr(os, "fsync", note_fsync)
    monkeypatch.setattr(os, "replace", note_replace)
    work = evaluation(motion, VELOCITY, tmp_path / "given.npy", result, piece=500)
    _stop_after(0, work)
    rows = "00000000.parquet result.parquet.part" if ending == ".parquet" else f"{result.name}.part"
    (marks,) = replaced
    assert marks.startswith(f"{result.name}.part.json after {rows} .{result.name}.part.json.")


def test_rows_beyond_the_marks_are_written_anew(motion, table, expected, tmp_path):
    """As after a kill between the rows and their marks."""
    np.save(tmp_path / "given.npy", table)
    result = tmp_path / "result.npy"
    work = evaluation(motion, VELOCITY, tmp_path / "given.npy", result, piece=100)
    _stop_after(0.5, work)
    with (tmp_path / "result.npy.part").open("ab") as draft:
        draft.write(b"half a row")
    work.run()
    assert_array_equal(np.load(result), expected)


@pytest.mark.parametrize("ending", WRITERS)
def test_marks_beyond_the_rows_begin_anew(motion, table, expected, tmp_path, ending):
    """Zeros would stand where a draft was cut short."""
    np.save(tmp_path / "given.npy", table)
    result = tmp_path / f"result{ending}"
    work = evaluation(motion, VELOCITY, tmp_path / "given.npy", result, piece=100)
    _stop_after(0.5, work)
    if ending == ".parquet":
        (sinks.draft_of(result) / "00000002.parquet").unlink()
    else:
        os.truncate(sinks.draft_of(result), 2000)
    assert work.run().resumed == 0
    assert_array_equal(read(result), expected)


def test_a_draft_of_other_work_is_not_taken_up(motion, table, tmp_path):
    np.save(tmp_path / "given.npy", table)
    result = tmp_path / "result.npy"
    _stop_after(0, evaluation(motion, VELOCITY, tmp_path / "given.npy", result, piece=100))
    other = ("angular_velocity_space",)
    made = evaluation(motion, other, tmp_path / "given.npy", result, piece=100).run()
    kernel = motion.kernels().load().angular_velocity_space
    assert made.resumed == 0
    assert_array_equal(np.load(result), kernel(table[:, :3], table[:, 3:]))


def test_marks_do_not_outlive_the_draft_they_speak_of(
    motion, table, expected, tmp_path, monkeypatch
):
    """Other work that was killed early would leave its rows to the marks of the first."""
    np.save(tmp_path / "given.npy", table)
    result = tmp_path / "result.npy"
    first = evaluation(motion, VELOCITY, tmp_path / "given.npy", result, piece=100)
    _stop_after(0.3, first)
    other = evaluation(
        motion, ("angular_velocity_space",), tmp_path / "given.npy", result, piece=900
    )
    with monkeypatch.context() as killed:  # which saves and removes nothing on its way out
        for name in ("save", "remove"):
            killed.setattr(f"rigidsym.tools.evaluate.draft.Draft.{name}", lambda *_: None)
        _stop_after(0, other)
    first.run()
    assert_array_equal(np.load(result), expected)


def test_an_interrupted_command_resumes(tmp_path):
    count = 600_000
    np.save(tmp_path / "given.npy", np.linspace(0, 1, 6 * count).reshape(count, 6))
    result = tmp_path / "result.csv"  # slow to write, so that there is time to interrupt it
    asked = command("ZXZ", tmp_path / "given.npy", "--out", result)
    draft = sinks.draft_of(result)
    with subprocess.Popen(asked, stderr=subprocess.PIPE, stdout=subprocess.PIPE) as process:
        while process.poll() is None and not (draft.exists() and draft.stat().st_size > 6e6):
            pass
        os.kill(process.pid, signal.SIGINT)
        _, said = process.communicate()
    assert process.returncode == 130
    assert not result.exists()
    assert f"{draft} keeps what is done; run it again to go on" in said.decode()
    assert not draft.with_name(f"{draft.name}.lock").exists()
    again = subprocess.run(asked, capture_output=True, text=True, check=True)
    assert f"{count} rows, " in again.stdout
    assert "by an earlier run" in again.stdout
    with result.open(encoding="utf-8") as file:
        assert sum(1 for _ in file) == count + 1


def test_a_full_disk_is_said_and_what_was_done_is_kept(
    motion, table, expected, tmp_path, monkeypatch
):
    np.save(tmp_path / "given.npy", table)
    result = tmp_path / "result.npy"
    work = evaluation(motion, VELOCITY, tmp_path / "given.npy", result, piece=100)
    append = sinks.NpySink.append

    def until_full(sink: sinks.NpySink, rows: np.ndarray) -> int:
        if sink._file.tell() > 10_000:
            sink._file.write(rows.tobytes()[:100])
            raise OSError(28, "No space left on device")
        return append(sink, rows)

    with monkeypatch.context() as full:
        full.setattr(sinks.NpySink, "append", until_full)
        with pytest.raises(OSError, match="No space left"):
            work.run()
    made = work.run()
    assert made.resumed > 0
    assert_array_equal(np.load(result), expected)


def test_memory_does_not_grow_with_the_file(tmp_path):
    peaks = []
    for count in (100_000, 2_000_000):
        np.save(tmp_path / "given.npy", np.zeros((count, 6)))
        program = (
            "import resource, sys\n"
            "from rigidsym.commands.evaluate import evaluated\n"
            "from pathlib import Path\n"
            "evaluated('ZXZ', Path(sys.argv[1]), Path(sys.argv[2]), columns=None, given=(),\n"
            "    quantities=('angular_velocity_body',), degrees=False, threads=1, scheduler=None)\n"
            "print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)\n"
        )
        files = map(str, (tmp_path / "given.npy", tmp_path / "result.npy"))
        done = subprocess.run(
            [sys.executable, "-c", program, *files], capture_output=True, text=True, check=True
        )
        peaks.append(int(done.stdout) / 1024)
    assert peaks[1] - peaks[0] < 40  # MB, where the larger file has 96 MB


@pytest.mark.parametrize("marks", ["", "{}", "[]", '{"marks": {"rows": 1}, "asked": ""'])
def test_marks_that_do_not_read_begin_anew(motion, table, expected, tmp_path, marks):
    np.save(tmp_path / "given.npy", table)
    result = tmp_path / "result.npy"
    (tmp_path / "result.npy.part").write_bytes(b"half")
    (tmp_path / "result.npy.part.json").write_text(marks, encoding="utf-8")
    assert evaluation(motion, VELOCITY, tmp_path / "given.npy", result).run().resumed == 0
    assert_array_equal(np.load(result), expected)


def test_a_scheduler_that_does_not_answer_is_said_and_nothing_is_left(tmp_path, monkeypatch):
    from rigidsym.errors import ClusterError
    from rigidsym.system import cluster

    np.save(tmp_path / "given.npy", logged())
    monkeypatch.setattr(cluster, "PATIENCE", 0.2)
    work = evaluation(
        rs.derive("ZXZ"),
        VELOCITY,
        tmp_path / "given.npy",
        tmp_path / "result.npy",
        scheduler="localhost:1",
    )
    with pytest.raises(ClusterError, match=r"localhost:1: no Dask scheduler answered within 0\.2"):
        work.run()
    assert [path.name for path in tmp_path.iterdir()] == ["given.npy"]


def test_an_address_that_is_none_is_exit_code_4(tmp_path):
    np.save(tmp_path / "given.npy", logged())
    paths = tmp_path / "given.npy", "--out", tmp_path / "result.npy"
    done = run("ZXZ", *paths, "--scheduler", "gibberish")
    assert done.returncode == 4
    connecting, fault = done.stderr.splitlines()
    assert connecting == "rigidsym: connecting to gibberish"
    assert fault.startswith("rigidsym: --scheduler gibberish: expected HOST:PORT")
