"""Rotations beyond Euler angles, from the command line and from derivation files."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from click.testing import CliRunner

import rigidsym as rs
from helpers.command import call
from rigidsym.commands.cli import commands
from rigidsym.models.library import PARAMETRISATIONS, PRESETS, rotation_from
from rigidsym.notes.formats.record import record

BOUND = """\
[rotation]
matrix = [["c", "-s", "0"], ["s", "c", "0"], ["0", "0", "1"]]
coordinates = ["c", "s"]
constraints = ["c**2 + s**2 - 1"]
example = { c = "3/5", s = "4/5" }
"""


@pytest.mark.campaign
@pytest.mark.parametrize("name", [*PARAMETRISATIONS, *PRESETS])
def test_every_named_rotation_runs_from_derive(name, tmp_path):
    """The same record as from Python, all proved, with a word on where the rates fail."""
    done = CliRunner().invoke(commands, ["derive", name, "--json", "--out", str(tmp_path)])
    assert done.exit_code == 0, done.output
    shown = json.loads(done.stdout)
    assert shown["is_proved"] is True
    assert shown["singularities"]["is_solved"] is True
    motion = rs.derive(rotation_from(name))
    mine = json.loads(json.dumps(record(motion, shown["request"])))
    written = shown.pop("files")  # and their digests, which a record from Python has not
    assert set(written) == {f"{motion.name}.{ending}" for ending in ("py", "tex", "html")}
    assert mine == shown


@pytest.mark.parametrize(
    ("arguments", "part", "folder"),
    [
        (("ZYX", "--passive"), "A = Rᵀ", "euler_zyx_intrinsic_passive"),
        (("z(phi) x(incline)", "--constants", "incline"), "incline", "chain_zx"),
    ],
)
def test_derive_takes_names_and_turns(tmp_path, arguments, part, folder):
    done = call("derive", *arguments, cwd=tmp_path)
    assert "✗" not in done.stdout
    assert (tmp_path / "out" / folder / f"{folder}.py").is_file()
    assert part in " ".join(done.stdout.split())


def test_a_matrix_of_ones_own_is_derived_and_proved(tmp_path):
    (tmp_path / "own.toml").write_text(BOUND)
    done = call("run", "own.toml", "--json", cwd=tmp_path)
    assert json.loads(done.stdout)["is_proved"] is True
    call("check", "out", cwd=tmp_path)


def test_a_matrix_that_is_no_rotation_is_refused_with_what_is_left(tmp_path):
    text = BOUND.replace('"-s"', '"s"')
    (tmp_path / "own.toml").write_text(text)
    done = call("run", "own.toml", cwd=tmp_path, status=1)
    assert "own: not a rotation, since R Rᵀ = 1 fails; left over:" in done.stderr
    assert not Path(tmp_path, "out").exists()
