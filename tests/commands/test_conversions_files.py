"""Conversions by the command line and by derivation files, and in the record."""

from __future__ import annotations

import json
import subprocess
import sys

import pytest
from click.testing import CliRunner

import rigidsym as rs
from rigidsym.commands.cli import commands
from rigidsym.models.library import PARAMETRISATIONS, rotation_from
from rigidsym.pipeline import output_of, read_record, read_spec

FILE = """
[rotation]
sequence = "{}"
[output]
quantities = ["rotation_matrix"]
note = ["tex"]
{}
"""


def test_a_file_asks_for_them():
    spec = read_spec(FILE.format("ZXZ", "conversions = true"), source="a.toml", name="a")
    assert spec.conversions
    assert read_record(spec.to_data()) == spec
    files = output_of(spec).files
    assert "def from_rotation_matrix(" in files["a.py"]
    found = json.loads(files["a.json"])["conversions"]
    assert found["quaternion"]["shape"] == [4]
    assert found["without"] is None
    assert "ψ is 0" in found["coordinates"]["branch"]
    proofs = [
        *found["quaternion"]["proofs"],
        *found["coordinates"]["proofs"],
        found["quaternion_from_matrix"],
    ]
    assert {proof["status"] for proof in proofs} == {"exact"}


def test_what_is_not_offered_stands_in_the_record():
    text = FILE.format("z(phi) x(phi)", "conversions = true")
    found = json.loads(output_of(read_spec(text, source="a.toml", name="a")).record_text)
    assert found["conversions"]["coordinates"] is None
    assert "scipy.optimize" in found["conversions"]["without"]


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    """Modules of every kind of conversion, and one with long names."""
    folder = tmp_path_factory.mktemp("written")
    long = "z(the_first_angle_of_the_three) x(the_second_angle_of_the_three) z(alpha0)"
    texts = ["ZXZ", "zyx", "z(phi) x(b) [0,3,4](c)", "z(a) x(alpha0) z(b) x(c) y(d)", long]
    texts += [
        "z(phi)",
        "[a,b,c](beta) y(w)",
        "z(phi) x(theta) [0,b,c](psi)",
        "z(a) x(b) z(-a)",
        "z(phi) x(phi)",
    ]
    for place, text in enumerate((*texts, *PARAMETRISATIONS)):
        kernels = rs.derive(rotation_from(text)).kernels(conversions=True)
        kernels.write(folder / f"module_{place}.py")
    return folder


@pytest.mark.campaign
@pytest.mark.parametrize("command", [("format", "--check"), ("check",)])
def test_ruff_would_leave_every_module_as_it_is(written, command):
    done = subprocess.run(
        [sys.executable, "-m", "ruff", *command, "--isolated", "--no-cache", str(written)],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert len(list(written.glob("*.py"))) == 10 + len(PARAMETRISATIONS)


@pytest.mark.parametrize("command", [["derive", "gibbs_vector"], ["run", "euler_zxz"]])
def test_the_command_line_asks_for_them(command, tmp_path):
    for option, is_there in (([], False), (["--conversions"], True)):
        done = CliRunner().invoke(commands, [*command, *option, "--out", str(tmp_path)])
        assert done.exit_code == 0, done.output
        (module,) = tmp_path.rglob("*.py")
        assert ("def from_quaternion" in module.read_text(encoding="utf-8")) is is_there
    done = CliRunner().invoke(commands, ["check", str(tmp_path)])
    assert done.exit_code == 0, done.output


@pytest.mark.parametrize("text", ["ZXZ", "z(phi) x(theta)"])
def test_a_note_shows_them_before_the_proofs(text):
    motion = rs.derive(rotation_from(text))
    document = motion.note(conversions=True).document
    titles = [section.title for section in document.sections]
    assert titles.index("Conversions") + 1 == titles.index("Appendix: identities verified")
    number = document.number("quaternion")
    assert number == len(motion.steps) + 1
    module = motion.kernels(conversions=True).source
    assert f"Equation ({number}) of the note" in module
    latex = motion.note(conversions=True).latex()
    assert r"4 \mathbf{p}\,\mathbf{p}^{\mathsf T}" in latex
    is_offered = motion.conversions.inverse is not None
    assert (r"from\_\allowbreak quaternion" in latex) is is_offered
    without = [section.title for section in motion.note().document.sections]
    assert "Conversions" not in without
