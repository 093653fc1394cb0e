"""Short forms of the campaigns "fuzz" and "kills": hostile inputs, and commands that are killed."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from random import Random

import pytest

from benchmarks import fuzz, kills
from rigidsym.errors import LimitReached

ROOT = Path(__file__).resolve().parents[2]
COUNTS = {"derivation files": 60, "expressions": 300, "command lines": 30}


@pytest.mark.parametrize("kind", fuzz.KINDS)
def test_hostile_inputs_end_in_a_result_or_a_message(kind):
    found = fuzz.campaign(kind, COUNTS.get(kind, 60))
    assert found.failures == []
    assert found.counts["fine"] > 0
    assert found.counts["refused"] > 0


def test_an_input_is_made_again_by_its_number(tmp_path):
    shown = [fuzz.KINDS["derivation files"](Random("7"), tmp_path)[0] for _ in range(2)]
    assert shown[0] == shown[1]


def test_what_is_no_message_is_a_failure():
    def wrong(error: Exception):
        def work() -> None:
            raise error

        return fuzz._outcome(work)

    assert wrong(LimitReached("")) == ("stopped", "")
    assert wrong(OSError("full")) == ("refused", "")
    assert wrong(IndexError("x"))[0] == wrong(OSError("\x1b[2J"))[0] == "failed"


def test_killed_commands_leave_whole_files_or_none():
    """In a process of its own: it forks, which a process with threads should not."""
    program = [sys.executable, str(ROOT / "benchmarks/run.py"), "kills", "--files", "1"]
    done = subprocess.run(program, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""
    assert "met      failures: 0" in done.stdout


def test_a_record_beside_files_of_another_run_is_seen(tmp_path):
    trial = object.__new__(kills.Trial)
    trial.place, folder = tmp_path, tmp_path / "out" / "top"
    folder.mkdir(parents=True)
    old, new = b'{"files": {"top.py": 1}}', b'{"files": {"top.py": 2}}'
    trial.before = {"out/top/top.json": old, "out/top/top.py": b"old"}
    trial.after = {"out/top/top.json": new, "out/top/top.py": b"new"}
    for record, module, fault in (
        (old, b"old", ""),
        (old, b"new", ""),  # killed before the record was written
        (new, b"new", ""),
        (new, b"old", "out/top/top.json is new, and out/top/top.py is not"),
        (old, b"ne", "out/top/top.py is neither old nor new, 2 bytes"),
    ):
        (folder / "top.json").write_bytes(record)
        (folder / "top.py").write_bytes(module)
        assert trial._fault() == fault
