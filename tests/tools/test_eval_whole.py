"""`rigidsym eval` killed, stopped, out of disk or run twice: the old file or a whole new one."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest
from numpy.testing import assert_array_equal

import rigidsym as rs
from helpers.log_files import COUNT, VELOCITY, WRITERS, command, logged, read, run, velocities
from rigidsym.data import writers
from rigidsym.tools.evaluate.evaluation import evaluation


class _Stopped(Exception):
    pass


@pytest.mark.parametrize("target", WRITERS)
def test_stopped_work_leaves_the_old_file_and_nothing_else(motion, table, tmp_path, target):
    np.save(tmp_path / "given.npy", table)
    result = tmp_path / f"result{target}"
    result.write_bytes(b"old")

    def stop(share: float) -> None:
        if share > 0.5:
            raise _Stopped

    with pytest.raises(_Stopped):
        evaluation(motion, VELOCITY, tmp_path / "given.npy", result, rows=100).run(stop)
    assert result.read_bytes() == b"old"
    assert {path.name for path in tmp_path.iterdir()} == {"given.npy", result.name}


@pytest.mark.parametrize("target", WRITERS)
def test_a_full_disk_is_reported_and_leaves_the_old_file(
    motion, table, tmp_path, monkeypatch, target
):
    np.save(tmp_path / "given.npy", table)
    result = tmp_path / f"result{target}"
    result.write_bytes(b"old")
    kind = writers._WRITERS[target]
    append, calls = kind.append, []

    def until_full(writer, rows, kept=()):
        calls.append(len(rows))
        if len(calls) > 3:
            raise OSError(28, "No space left on device")
        append(writer, rows, kept)

    monkeypatch.setattr(kind, "append", until_full)
    with pytest.raises(OSError, match=rf"No space left on device: .*{result.name}"):
        evaluation(motion, VELOCITY, tmp_path / "given.npy", result, rows=100).run()
    assert result.read_bytes() == b"old"
    assert {path.name for path in tmp_path.iterdir()} == {"given.npy", result.name}


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="needs the device that is always full")
def test_a_full_standard_output_is_a_message(tmp_path):
    np.save(tmp_path / "given.npy", logged())
    asked = command("ZXZ", tmp_path / "given.npy", "--out", "-")
    with open("/dev/full", "wb") as full:
        done = subprocess.run(asked, stdout=full, stderr=subprocess.PIPE, text=True, check=False)
    assert done.returncode == 1
    assert "No space left on device" in done.stderr
    assert "Traceback" not in done.stderr


@pytest.mark.parametrize("how", [signal.SIGKILL, signal.SIGINT])
def test_a_killed_command_leaves_the_old_file_and_runs_again(tmp_path, how):
    count = 150_000
    np.save(tmp_path / "given.npy", np.linspace(0, 1, 6 * count).reshape(count, 6))
    result = tmp_path / "result.csv"  # slow to write, so that there is time to stop it
    result.write_text("old")
    asked = command("ZXZ", tmp_path / "given.npy", "--out", result)
    with subprocess.Popen(asked, stderr=subprocess.PIPE, stdout=subprocess.PIPE) as process:
        while process.poll() is None and not any(
            path.stat().st_size > 1e6 for path in tmp_path.glob(".result.csv.*")
        ):
            time.sleep(0.01)
        os.kill(process.pid, how)
        process.communicate()
    assert process.returncode == (130 if how == signal.SIGINT else -signal.SIGKILL)
    assert result.read_text() == "old"
    assert len(list(tmp_path.glob(".result.csv.*"))) == (how == signal.SIGKILL)
    subprocess.run(asked, capture_output=True, check=True)
    with result.open(encoding="utf-8") as file:
        assert sum(1 for _ in file) == count + 1


def test_two_at_once_write_one_whole_result_each(motion, table, tmp_path):
    np.save(tmp_path / "given.npy", table)
    result = tmp_path / "result.npy"
    both = threading.Barrier(2, timeout=30)

    def meet(share: float) -> None:
        if share == 1:
            both.wait()  # neither is done before the other has written all its rows

    work = evaluation(motion, VELOCITY, tmp_path / "given.npy", result, rows=100)
    threads = [threading.Thread(target=work.run, args=(meet,)) for _ in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    kernel = motion.kernels().load().angular_velocity_body
    assert_array_equal(read(result), velocities(kernel, table, 100))
    assert {path.name for path in tmp_path.iterdir()} == {"given.npy", "result.npy"}


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


def test_a_scheduler_that_does_not_answer_is_reported_and_nothing_is_left(tmp_path, monkeypatch):
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


def test_rows_are_counted(motion, table, tmp_path):
    np.save(tmp_path / "given.npy", table)
    made = evaluation(motion, VELOCITY, tmp_path / "given.npy", tmp_path / "r.npy").run()
    assert made.rows == COUNT
