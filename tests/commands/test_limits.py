"""Work is bounded in time and memory, an interrupt ends it at once, and text stays text."""

from __future__ import annotations

import gc
import os
import signal
from contextlib import ExitStack
from pathlib import Path
from time import sleep

import pytest
from click.testing import CliRunner

import rigidsym as rs
from helpers.command import call
from rigidsym.commands.cli import commands
from rigidsym.errors import Fault, LimitReached, RequestError, SpecError
from rigidsym.system import processes
from rigidsym.system.processes import in_processes, rare_collections, time_limit


def test_a_time_limit_holds_in_python():
    with pytest.raises(LimitReached, match=r"stopped after 0\.05 s"), time_limit(0.05):
        sleep(60)
    with pytest.raises(LimitReached):
        rs.derive("z(a) x(b) z(c) x(d) z(e) x(f) z(g) x(h)", timeout=0.01)
    with pytest.raises(RequestError, match="expected a positive number of seconds"):
        rs.derive("ZXZ", timeout=float("nan"))
    assert rs.derive("z(a)", timeout=60).is_proved
    assert signal.getitimer(signal.ITIMER_REAL) == (0.0, 0.0)


def test_derivations_that_overlap_leave_the_searches_for_cycles_as_they_were():
    before = gc.get_threshold()
    with ExitStack() as first, ExitStack() as second:
        first.enter_context(rare_collections())
        second.enter_context(rare_collections())
        first.close()
        assert gc.get_threshold()[0] >= processes.NEW_OBJECTS
    assert gc.get_threshold() == before


UNBOUNDED = {
    "roots of roots": '[rotation]\nsequence = "z(sqrt(sqrt(a+b)+c)) x(sqrt(sqrt(d)+1))"',
    "forty turns": f'[rotation]\nsequence = "{" ".join(f"z(a{k})" for k in range(1, 41))}"',
}


@pytest.mark.parametrize("work", UNBOUNDED)
def test_work_without_end_is_stopped(tmp_path, monkeypatch, work):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "top.toml").write_text(UNBOUNDED[work])
    done = CliRunner().invoke(commands, ["run", "top.toml", "--timeout", "0.2"])
    assert isinstance(done.exception, LimitReached), done.output
    assert str(done.exception) == "stopped after 0.2 s; raise the time limit if it needs longer"
    assert [path.name for path in tmp_path.iterdir()] == ["top.toml"]


@pytest.mark.parametrize("words", ["derive {}", "run {}.toml", "{}", "eval ZXZ {}.csv --out a.npy"])
def test_no_message_commands_a_terminal(tmp_path, words):
    status = 3 if words.startswith("run") else 2
    done = call(*words.format("Z\x1b[2JX").split(), cwd=tmp_path, status=status)
    assert "\x1b" not in done.stdout + done.stderr
    assert "\\x1b" in done.stderr or "\\u001b" in done.stderr


FOUR = """\
[rotation]
sequence = ["ZXZ", "xyz", "ZYX", "zxz"]
[output]
note = ["html", "page"]
quantities = ["rotation_matrix"]
"""


def run_of_four(folder, cores, monkeypatch) -> tuple[str, dict[str, bytes]]:
    """What is printed, and all files written."""
    monkeypatch.setattr(processes, "cores", lambda: cores)
    monkeypatch.chdir(folder)
    done = CliRunner().invoke(commands, ["run", "four.toml", "--out", str(cores)])
    assert done.exit_code == 0, done.output
    files = {path.name: path.read_bytes() for path in Path(str(cores)).rglob("*.*")}
    return done.output.replace(f"{cores}/", "OUT/"), files


def test_two_processes_write_what_one_writes(tmp_path: Path, monkeypatch):
    (tmp_path / "four.toml").write_text(FOUR, encoding="utf-8")
    one, two = (run_of_four(tmp_path, cores, monkeypatch) for cores in (1, 2))
    assert len(one[1]) == 4 * 4
    assert one == two


def inverse(number: int) -> int:
    if number == 5:
        raise SpecError("five", [Fault(message="five has none")])
    return -number


@pytest.mark.parametrize("cores", [1, 3])
def test_results_come_in_order_and_errors_where_they_arise(cores: int, monkeypatch):
    monkeypatch.setattr(processes, "cores", lambda: cores)
    found = in_processes(inverse, range(8))
    assert [next(found) for _ in range(5)] == [0, -1, -2, -3, -4]
    with pytest.raises(SpecError, match="five has none") as caught:
        next(found)
    assert caught.value.faults == (Fault(message="five has none"),)
    assert list(in_processes(inverse, range(5))) == [0, -1, -2, -3, -4]
    assert list(in_processes(inverse, [])) == []


HERE = os.getpid()


def upper(item: str) -> str:
    if item == "c" and os.getpid() != HERE:
        os._exit(1)
    return item.upper()


def test_the_work_of_a_process_that_was_killed_is_done_again(monkeypatch):
    monkeypatch.setattr(processes, "cores", lambda: 2)
    assert "".join(in_processes(upper, "abcdef")) == "ABCDEF"
