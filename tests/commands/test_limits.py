"""Work is bounded in time and memory, an interrupt ends it at once, and text stays text."""

from __future__ import annotations

import json
import signal
import threading
from time import sleep

import pytest
from click.testing import CliRunner

import rigidsym as rs
from helpers.command import call
from rigidsym.commands.cli import commands
from rigidsym.errors import LimitReached, RequestError
from rigidsym.notes.formats.record import SCHEMA, SCHEMA_VERSION
from rigidsym.system.processes import time_limit

NINE = [[f"r{i}{j}" for j in "123"] for i in "123"]
UNIT = [
    " + ".join(f"{row[i]}*{row[j]}" for row in NINE) + " - 1" * (i == j)
    for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
]
IDENTITY = "\n".join(f"r{i}{j} = {int(i == j)}" for i in "123" for j in "123")
ENDLESS = f"""\
[rotation]
matrix = {json.dumps(NINE)}
coordinates = {json.dumps([*NINE[0], *NINE[1], *NINE[2]])}
constraints = {json.dumps(UNIT)}
[rotation.example]
{IDENTITY}
"""


def test_a_derivation_stops_when_its_time_is_up(tmp_path):
    (tmp_path / "own.toml").write_text(ENDLESS)
    done = call("run", "own.toml", "--timeout", "0.5", cwd=tmp_path, status=1)
    assert done.stderr == "rigidsym: stopped after 0.5 s; raise the time limit if it needs longer\n"
    assert not (tmp_path / "out").exists()


def test_a_time_limit_holds_in_python():
    with pytest.raises(LimitReached, match=r"stopped after 0\.05 s"), time_limit(0.05):
        sleep(60)
    with pytest.raises(LimitReached):
        rs.derive("z(a) x(b) z(c) x(d) z(e) x(f) z(g) x(h)", timeout=0.01)
    assert rs.derive("z(a)", timeout=60).is_proved
    assert signal.getitimer(signal.ITIMER_REAL) == (0.0, 0.0)


@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
def test_a_stop_that_a_finalizer_loses_is_made_again():
    class Slow:
        def __del__(self):
            sleep(0.2)

    def lose_a_stop_and_go_on():
        with time_limit(0.1):
            slow = Slow()
            del slow
            sleep(60)

    with pytest.raises(LimitReached):
        lose_a_stop_and_go_on()


@pytest.mark.parametrize("seconds", [0, -1, float("nan")])
def test_a_time_limit_is_positive(seconds):
    with pytest.raises(RequestError, match="expected a positive number of seconds"):
        rs.derive("ZXZ", timeout=seconds)


def test_a_time_limit_needs_the_main_thread():
    caught = []

    def work() -> None:
        with pytest.raises(RequestError, match="only in the main thread") as error:
            rs.derive("ZXZ", timeout=9)
        caught.append(error)

    thread = threading.Thread(target=work)
    thread.start()
    thread.join()
    assert caught


LONG = " + ".join(f"a*b**{k}" for k in range(60))
UNBOUNDED = {
    "roots of roots": '[rotation]\nsequence = "z(sqrt(sqrt(a+b)+c)) x(sqrt(sqrt(d)+1))"',
    "nine entries that are bound": ENDLESS,
    "forty turns": f'[rotation]\nsequence = "{" ".join(f"z(a{k})" for k in range(1, 41))}"',
    "derivatives": '[rotation]\nsequence = "z(u) x(v) y(w) x(s)"\n[body]\nshape = "cone"\n'
    '[output]\nderivatives = ["kinetic_energy by q"]',
    "a map of degree 60": '[body]\nshape = "given"\nbounds = [[0, 1], [0, 1], [0, 1]]\n'
    'place = ["x**20*y**20*z**20", "y", "z"]',
    "long entries": f'[body]\ninertia = [["{LONG}", "0", "D"], ["0", "C", "0"], ["D", "0", "B"]]',
}


@pytest.mark.parametrize("work", UNBOUNDED)
def test_work_without_end_is_stopped(tmp_path, monkeypatch, work):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "top.toml").write_text(UNBOUNDED[work])
    done = CliRunner().invoke(commands, ["run", "top.toml", "--timeout", "0.2"])
    assert isinstance(done.exception, LimitReached), done.output
    assert [path.name for path in tmp_path.iterdir()] == ["top.toml"]


@pytest.mark.parametrize(
    "turns",
    [
        "z(a) [1,2,3](b) y(c) [1,2,3](d) x(e)",
        "z(-u1) [-1,2,3](u2+u4) [1,3,3](u2) y(2*pi/5) y(3*u4) [0,-2,-2](-u2)",
        "z(a+b+c+d+e1+f+g+h+k+l+m) x(a)",
    ],
)
def test_chains_are_derived_in_time(turns):
    assert rs.derive(turns, timeout=60).is_proved  # once 81 s, more than 240 s and without end


@pytest.mark.parametrize(
    "rotations",
    [[{"sequence": "z(sqrt(sqrt(a+b)+c)) x(sqrt(sqrt(d)+1))"}], [{"sequence": "ZXZ"}] * 20_000],
    ids=["of roots of roots", "of many rotations"],
)
def test_a_check_is_stopped_too(tmp_path, rotations):
    request = {"name": "top", "rotations": rotations, "kernels": [], "note": ["tex"]}
    record = {"schema": SCHEMA, "schema_version": SCHEMA_VERSION, "request": request}
    (tmp_path / "top.json").write_text(json.dumps(record))
    done = CliRunner().invoke(commands, ["check", str(tmp_path), "--timeout", "0.2"])
    assert isinstance(done.exception, LimitReached), done.output


def test_want_of_memory_is_a_message(tmp_path, monkeypatch):
    def starved(**_: object) -> None:
        raise MemoryError

    monkeypatch.setattr(commands, "main", starved)
    assert call("list", cwd=tmp_path, status=1).stderr == "rigidsym: out of memory\n"


@pytest.mark.parametrize(
    "arguments",
    [
        ("derive", "Z\x1b[2JX"),
        ("derive", "ZXZ", "--only", "\x1b]0;title\x07"),
        ("derive", "ZXZ", "--derivative", "\x1b[2J:q"),
        ("derive", "ZXZ", "--angles", "\x1b[2J,b,c"),
        ("run", "\x1b[2J.toml"),
        ("\x1b[2J",),
        ("eval", "ZXZ", "\x1b[2J.csv", "--out", "a.npy"),
    ],
)
def test_no_message_commands_a_terminal(tmp_path, arguments):
    status = 3 if arguments[0] == "run" else 2
    done = call(*arguments, cwd=tmp_path, status=status)
    assert "\x1b" not in done.stdout + done.stderr
    assert "\\x1b" in done.stderr or "\\u001b" in done.stderr
