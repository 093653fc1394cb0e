"""`rigidsym eval` killed, stopped, out of disk or run twice: the old file or a whole new one."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time
from functools import partial

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from helpers.log_files import VELOCITY, WRITERS, command, logged, read, velocities
from rigidsym.tools.evaluate import evaluate


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
        evaluate(motion, VELOCITY, tmp_path / "given.npy", result, rows=100, progress=stop)
    assert result.read_bytes() == b"old"
    assert {path.name for path in tmp_path.iterdir()} == {"given.npy", result.name}


@pytest.mark.parametrize("target", WRITERS)
def test_a_full_disk_is_reported_and_leaves_the_old_file(tmp_path, target):
    """A process may write no file longer than 4 kB; a whole result has 24 kB."""
    np.save(tmp_path / "given.npy", logged()[:, :6])
    result = tmp_path / f"result{target}"
    result.write_bytes(b"old")
    program = (
        "import resource, signal, sys\n"
        "from rigidsym.commands.cli import commands, main\n"
        "commands.main([*sys.argv[1:-1], '-'], standalone_mode=False)\n"  # fills the cache
        "signal.signal(signal.SIGXFSZ, signal.SIG_IGN)\n"
        "resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))\n"
        "main()\n"
    )
    asked = ["eval", "ZXZ", str(tmp_path / "given.npy"), "--out", str(result)]
    done = subprocess.run(
        [sys.executable, "-c", program, *asked], capture_output=True, text=True, check=False
    )
    assert done.returncode == 1, done.stderr
    assert f"{result}: " in done.stderr
    assert "File too large" in done.stderr
    assert "Traceback" not in done.stderr
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


@pytest.mark.campaign
@pytest.mark.parametrize("how", [signal.SIGKILL, signal.SIGINT])
def test_a_killed_command_leaves_the_old_file_and_runs_again(tmp_path, how):
    count = 600_000
    np.save(tmp_path / "given.npy", np.linspace(0, 1, 6 * count).reshape(count, 6))
    result = tmp_path / "result.csv"  # long enough to be stopped on the way
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

    options = {"rows": 100, "progress": meet}
    work = partial(evaluate, motion, VELOCITY, tmp_path / "given.npy", result, **options)
    threads = [threading.Thread(target=work) for _ in range(2)]
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
