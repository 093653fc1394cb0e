"""Several derivations on several cores: the same files and messages in the same order."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from click.testing import CliRunner

from rigidsym.commands.cli import commands
from rigidsym.errors import Fault, SpecError
from rigidsym.system import processes
from rigidsym.system.processes import in_processes

FOUR = '[rotation]\nsequence = ["ZXZ", "xyz", "ZYX", "zxz"]\n[output]\nnote = ["html", "page"]\n'


def run(folder: Path, cores: int, monkeypatch: pytest.MonkeyPatch) -> tuple[str, dict[str, bytes]]:
    """What is printed, and all files written."""
    monkeypatch.setattr(processes, "cores", lambda: cores)
    monkeypatch.chdir(folder)
    done = CliRunner().invoke(commands, ["run", "four.toml", "--out", str(cores)])
    assert done.exit_code == 0, done.output
    files = {path.name: path.read_bytes() for path in Path(str(cores)).rglob("*.*")}
    return done.output.replace(f"{cores}/", "OUT/"), files


def test_two_processes_write_what_one_writes(tmp_path: Path, monkeypatch):
    (tmp_path / "four.toml").write_text(FOUR, encoding="utf-8")
    one, two = (run(tmp_path, cores, monkeypatch) for cores in (1, 2))
    assert len(one[1]) == 4 * 4
    assert one == two


def inverse(number: int) -> int:
    if number == 5:
        raise SpecError("five", [Fault(message="five has none")])
    return -number


@pytest.mark.parametrize("cores", [1, 2, 3, 9])
def test_results_come_in_order_and_errors_where_they_arise(cores: int, monkeypatch):
    monkeypatch.setattr(processes, "cores", lambda: cores)

    found = in_processes(inverse, range(8))
    assert [next(found) for _ in range(5)] == [0, -1, -2, -3, -4]
    with pytest.raises(SpecError, match="five has none") as caught:
        next(found)
    assert caught.value.faults == (Fault(message="five has none"),)
    assert list(in_processes(inverse, range(5))) == [0, -1, -2, -3, -4]
    assert list(in_processes(inverse, [])) == []


ENDED = """
from pathlib import Path
from time import sleep
from rigidsym.system import processes

processes.cores = lambda: 2
started, ended = Path("started"), Path("ended")

def work(item):
    if item == "c":
        try:
            started.touch()
            sleep(60)
        finally:
            sleep(0.5)  # while it cleans up, the executor asks it to end once more
            ended.touch()
    return item

found = processes.in_processes(work, "abc")
assert [next(found), next(found)] == ["a", "b"]
while not started.exists():
    sleep(0.01)
found.close()
assert ended.exists()
"""


def test_a_copy_that_is_ended_ends_what_it_started(tmp_path: Path):
    command = [sys.executable, "-c", ENDED]  # a process without JAX, which is not copied
    subprocess.run(command, cwd=tmp_path, check=True, timeout=50)


def test_a_run_that_stops_says_how_much_is_kept(tmp_path: Path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    text = FOUR + 'quantities = ["rotation_matrix"]\nkernels = []\n'
    Path("four.toml").write_text(text.replace('"html", "page"', '"md"'), encoding="utf-8")
    command = ["run", "four.toml"]
    assert CliRunner().invoke(commands, command).exit_code == 0
    Path("out/euler_zyx_intrinsic/euler_zyx_intrinsic.md").write_text("mine", encoding="utf-8")
    done = CliRunner().invoke(commands, command)
    assert "2 of 4 derivations are finished and kept in out" in done.output


HERE = os.getpid()


def upper(item: str) -> str:
    if item == "c" and os.getpid() != HERE:
        os._exit(1)
    return item.upper()


def test_the_work_of_a_process_that_was_killed_is_done_again(monkeypatch):
    monkeypatch.setattr(processes, "cores", lambda: 2)
    assert "".join(in_processes(upper, "abcdef")) == "ABCDEF"
