"""Short forms of campaigns: hostile inputs, commands that are killed, kernels that are edited."""

from __future__ import annotations

import subprocess
import sys
from fractions import Fraction
from pathlib import Path
from random import Random

import numpy as np
import pytest

import rigidsym as rs
from benchmarks import chains, fuzz, kernel_mutants, kills
from rigidsym.commands.check import finding_of
from rigidsym.errors import LimitReached
from rigidsym.kernels.lowering.lower import lower

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


def test_random_chains_are_the_rotations_of_scipy():
    found = chains.campaign(20)
    assert found.failures == []
    assert (found.compared, found.velocities) == (1000, 50)


def test_a_chain_with_another_axis_is_a_failure(monkeypatch):
    x = (1.0, 0.0, 0.0)
    other = chains.Chain("z(a)", (x,), (chains.Angle({"a": Fraction(1)}),))
    monkeypatch.setattr(chains, "random_chain", lambda _: other)
    assert len(chains.campaign(1).failures) == 1


def test_check_names_every_change_of_a_kernel(tmp_path):
    motion = rs.derive("ZXZ", ["angular_velocity_body"])
    made = motion.kernels()
    kernel = next(k for k in lower(motion).kernels if k.name == "angular_velocity_body")
    same, *found = kernel_mutants.mutants(made.source, kernel, "numpy")
    points = np.random.default_rng(1).uniform(0.2, 1.2, (6, 2))
    values = kernel_mutants.values_in_python([same, *found], points, made.load())
    assert len(found) > 20
    assert not any(kernel_mutants._same(value, values[0]) for value in values[1:])
    for text, is_named in ((same.module, False), *((mutant.module, True) for mutant in found)):
        (tmp_path / made.main).write_text(text, "utf-8")
        assert bool(finding_of(tmp_path / made.main, made.source).problem) == is_named
