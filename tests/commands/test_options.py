"""Options of the commands: which there are where, and what they choose."""

from __future__ import annotations

import json
import re

import pytest
from click.testing import CliRunner, Result

import rigidsym as rs
from rigidsym.commands.cli import commands
from rigidsym.commands.list import inventory
from rigidsym.commands.options import MOST_LINES
from rigidsym.motion import QUANTITIES

NAMES = commands.list_commands(None)
BODY = "angular_velocity_body"


def run(*arguments: str) -> Result:
    return CliRunner().invoke(commands, arguments)


@pytest.mark.parametrize("name", NAMES)
def test_every_help_has_an_example(name):
    assert f"Example: rigidsym {name}" in run(name, "--help").stdout


def test_the_summaries_are_not_cut_off():
    shown = run("--help").stdout
    assert all(f"\n  {name} " in shown for name in NAMES)
    assert "..." not in shown.split("Commands:")[1]


def test_one_equation_is_printed_and_nothing_written(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    motion = rs.derive("ZXZ", BODY)
    latex = run("derive", "ZXZ", "--only", BODY, "--format", "latex").stdout
    assert latex == motion.latex(BODY) + "\n" == motion.steps[0].latex() + "\n"
    assert "Ω′ = Rᵀ Ω" in run("derive", "ZXZ", "--only", BODY, "--format", "text").stdout
    (found,) = json.loads(run("derive", "ZXZ", "--only", BODY, "--format", "json").stdout)
    assert found["name"] == BODY
    assert list(tmp_path.iterdir()) == []


def test_a_long_derivation_is_cut_unless_asked_for_in_full(tmp_path):
    chain = "z(a) x(b) z(c) x(d)"
    short = run("derive", chain, "--out", str(tmp_path)).stdout.splitlines()
    full = run("derive", chain, "--full", "--out", str(tmp_path)).stdout.splitlines()
    cut = next(k for k, line in enumerate(short) if line.startswith("... and "))
    assert cut <= MOST_LINES + 1 < len(full)
    assert short[:MOST_LINES] == full[:MOST_LINES]


def test_kernels_without_a_note_are_possible(tmp_path):
    (tmp_path / "top.toml").write_text('[rotation]\nsequence = "ZXZ"\n[output]\nnote = []\n')
    done = run("run", str(tmp_path / "top.toml"), "--out", str(tmp_path / "out"))
    assert done.exit_code == 0, done.output
    files = {path.name for path in (tmp_path / "out" / "top").iterdir()}
    assert files == {"top.py", "top.json"}
    assert run("check", str(tmp_path / "out")).exit_code == 0


def test_two_derivations_of_one_name_are_refused(tmp_path):
    files = [tmp_path / name / "own.toml" for name in "ab"]
    for file, axes in zip(files, ("ZXZ", "ZYX"), strict=True):
        file.parent.mkdir()
        file.write_text(f'[rotation]\nsequence = "{axes}"\n')
    done = run("run", *map(str, files), "--out", str(tmp_path / "out"))
    assert done.exit_code == 2
    assert "two different derivations are named own and would write one folder" in done.stderr


def test_without_colour_no_terminal_codes_are_written(monkeypatch):
    monkeypatch.setenv("NO_COLOR", "1")
    assert "\x1b" not in CliRunner().invoke(commands, ["list"], color=True).stdout


def test_completion_offers_names_of_users():
    assert [name for name in dir(rs) if name.startswith("_")] == ["__version__"]
    assert {"Any", "TYPE_CHECKING", "import_module"}.isdisjoint(dir(rs))
    assert "angular_velocity_body" in dir(rs.derive("ZXZ"))


def test_kernels_are_one_step():
    functions = rs.kernels("ZYX", only=BODY)
    assert functions.angular_velocity_body([0.0, 0.0, 0.0], [1.0, 2.0, 3.0]).tolist() == [3, 2, 1]
    assert rs.kernels("ZYX", only=BODY).__name__ == functions.__name__  # not the room of this name


def test_the_list_has_every_quantity_and_straight_columns():
    lines = inventory().splitlines()
    begin, end = map(lines.index, ("Quantities", "Targets of the kernels (--target NAME,...)"))
    rows = lines[begin + 1 : end - 1]
    assert {row.split()[0] for row in rows} == set(QUANTITIES)
    shipped = lines[lines.index("Shipped derivations (rigidsym run NAME)") + 1 :]
    titles = {re.match(r"  \S+ +", line).end() for line in shipped}
    assert len(titles) == 1
    for part in (
        "ZXZ  R = Rz(φ) Rx(θ) Rz(ψ)\n",
        "rotation_vector or rotvec  R = ",
        "numpy  ",
        "euler_all ",
    ):
        assert f"  {part}" in inventory()
