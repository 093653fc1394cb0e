"""The command line as a user meets it: output, files, messages, exit codes."""

from __future__ import annotations

import json
import os
import re
import shlex
import signal
import subprocess
import sys
from contextlib import chdir

import pytest
from click.testing import CliRunner

import rigidsym as rs
from helpers.command import RIGIDSYM, ROOT, call, run
from helpers.motions import derived
from rigidsym.commands.cli import commands
from rigidsym.commands.list import inventory
from rigidsym.motion import QUANTITIES
from rigidsym.notes.formats.record import SCHEMA_VERSION
from rigidsym.pipeline import output_of
from rigidsym.spec.derivation_file import read_spec

NAME = "euler_zxz_intrinsic"


def test_derive_shows_the_lecture_and_writes_files_that_check_knows(tmp_path):
    shown = call("derive", "ZXZ", cwd=tmp_path).stdout
    for line in ("φ̇ sin θ sin ψ + θ̇ cos ψ", "φ̇ sin θ cos ψ − θ̇ sin ψ", "φ̇ cos θ + ψ̇"):
        assert line in shown
    assert "Intrinsic rotations: first by φ about the z-axis" in shown
    assert "✗" not in shown
    folder = tmp_path / "out" / NAME
    assert {file.suffix for file in folder.glob(f"{NAME}.*")} == {".py", ".tex", ".html", ".json"}
    written = call("derive", "ZXZ", "--quiet", cwd=tmp_path).stdout.split()
    assert {tmp_path / file for file in written} == {*folder.iterdir()}
    data = json.loads(call("derive", "ZXZ", "--json", cwd=tmp_path).stdout)
    assert (data["schema"], data["schema_version"]) == ("rigidsym.derivation", SCHEMA_VERSION)
    assert data["is_proved"] is True
    assert data["singularities"]["determinant"] == "-sin(theta)"
    assert json.loads((folder / f"{NAME}.json").read_text()) == data
    assert "up to date" in call("check", "out", cwd=tmp_path).stdout
    module = folder / f"{NAME}.py"
    module.write_text(module.read_text().replace("x0 = ", "x0 = 2 * ", 1))
    (folder / f"{NAME}.tex").unlink()
    found = call("check", str(module), cwd=tmp_path, status=1).stdout
    assert f"{NAME}.py: differs from the derivation" in found
    assert f"{NAME}.tex: missing" in found


def test_a_wrong_file_tells_all_faults_and_writes_nothing(tmp_path):
    (tmp_path / "bad.toml").write_text(
        '[rotation]\nsequence = "ZXX"\n\n[output]\nkernels = ["fortran"]\nnote = ["doc"]\n'
    )
    (tmp_path / "worse.toml").write_text('[rotation]\nsequence = "ZXX"\n')
    done = call("run", "euler_zxz", "bad.toml", "worse.toml", cwd=tmp_path, status=3)
    assert "worse.toml: 1 fault" in done.stderr
    assert "bad.toml: 3 faults, nothing written" in done.stderr
    for place in ("rotation.sequence", "output.kernels[0]", "output.note[0]"):
        assert place in done.stderr
    assert not (tmp_path / "out").exists()


def test_wrong_use_is_refused_with_what_was_expected(answered, tmp_path):
    def answer(line: str) -> str:
        with chdir(tmp_path):
            done = run(*shlex.split(line)[1:])
        assert done.returncode in (2, 3), line
        assert done.stdout == ""
        assert list(tmp_path.iterdir()) == []
        said = re.sub(r"see .* --help\n", "", done.stderr)  # it names the program that ran
        said = re.sub(r"\d+ more", "more", said)  # quantities come and go
        return f"{said}exit code {done.returncode}"

    answered("commands/refused.txt", answer)


def test_without_tex_all_else_is_written(tmp_path):
    done = call("derive", "ZXZ", "--pdf", cwd=tmp_path, status=4, PATH="")
    assert done.stderr.endswith(
        "a PDF needs pdflatex, not found here; on Debian: apt install "
        "texlive-latex-recommended texlive-pictures lmodern\n"
    )
    assert "φ̇ cos θ + ψ̇" in done.stdout
    assert len(list((tmp_path / "out" / NAME).iterdir())) == 4


def test_a_profile_of_the_module_is_written(tmp_path):
    words = f"-m cProfile -o {tmp_path}/profile -m rigidsym --version".split()
    subprocess.run([sys.executable, *words], cwd=ROOT, check=True)
    assert (tmp_path / "profile").is_file()


def test_a_closed_pipe_is_no_error():
    lines = '"$@" list | true && "$@" --version | true'
    command = ["bash", "-o", "pipefail", "-c", lines, "bash", *RIGIDSYM]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, check=False)
    assert (done.returncode, done.stderr) == (0, b"")


def test_an_interrupt_among_the_imports_is_no_traceback(tmp_path):
    (tmp_path / "click.py").write_text("raise KeyboardInterrupt")
    done = subprocess.run(RIGIDSYM, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (130, "rigidsym: interrupted\n")


def test_an_interrupt_leaves_whole_files_and_says_so(tmp_path):
    turned = '["ZXZ", "zyx", "XYZ", "xyz", "YXY", "yxy", "XZX", "xzx"]'
    asked = '[output]\nquantities = ["rotation_matrix"]\nnote = ["md"]\n'
    (tmp_path / "many.toml").write_text(f"[rotation]\nsequence = {turned}\n{asked}")
    with subprocess.Popen(
        [*RIGIDSYM, "run", "many.toml"],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    ) as process:
        process.stdout.readline()
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate()
    assert process.returncode == 130
    assert errors.splitlines()[-1] == "rigidsym: interrupted"  # after what is kept, if any is
    for folder in (tmp_path / "out").iterdir():
        assert not [file for file in folder.iterdir() if file.name.startswith(".")]


@pytest.mark.parametrize("closed", ["2>&-", "2>/dev/full", ">/dev/full"])
def test_the_exit_code_does_not_need_streams_that_work(closed):
    words, status = (["--version"], 1) if closed.startswith(">") else (["derive", "ZXX"], 2)
    command = ["sh", "-c", f'exec "$@" {closed}', "sh", *RIGIDSYM, *words]
    buffered = {**os.environ, "PYTHONUNBUFFERED": ""}  # Python tries again to write at its end
    assert subprocess.run(command, check=False, env=buffered).returncode == status


@pytest.mark.parametrize(
    ("words", "heavy"),
    [
        (["--help"], {"sympy", "numpy", "rich", "jinja2"}),
        (
            ["derive", "ZXZ"],
            {"numpy", "scipy", "polars", "trimesh", "tree_sitter", "sympy.combinatorics"},
        ),
        (["identify", "--angles", "1,2,3", "--matrix", "1,0,0,0,1,0,0,0,1"], {"sympy"}),
        (["page", "ZXZ"], {"numpy"}),
    ],
)
def test_heavy_packages_are_imported_only_where_they_are_used(tmp_path, words, heavy):
    probe = (
        "import gc, sys\ngc.set_threshold(0)\nfrom rigidsym.commands.cli import commands\n"
        f"try:\n    commands.main({words})\nexcept SystemExit:\n    pass\n"
        f"print(sorted({heavy} & set(sys.modules)), gc.get_threshold()[0])"
    )
    env = {**os.environ, "PYTHONPATH": str(ROOT)}
    out = subprocess.check_output([sys.executable, "-c", probe], cwd=tmp_path, env=env, text=True)
    assert out.splitlines()[-1] == "[] 0"


@pytest.mark.parametrize(  # with a FIFO to which nobody writes, which would be read for ever
    ("words", "status"),
    [
        ("run fifo.toml", 3),
        ("check fifo.json", 1),
        ("inertia fifo.npy", 3),
        ("eval ZXZ fifo.csv --out r.csv", 3),
    ],
)
def test_an_input_that_is_no_regular_file_is_refused(words, status, tmp_path):
    (name,) = (word for word in words.split() if word.startswith("fifo"))
    os.mkfifo(tmp_path / name)
    done = call(*words.split(), cwd=tmp_path, status=status)
    assert "not a regular file" in done.stdout + done.stderr


BODY = "angular_velocity_body"


@pytest.mark.parametrize("name", commands.list_commands(None))
def test_every_help_has_an_example(name):
    assert f"Example: rigidsym {name}" in run(name, "--help").stdout
    assert run().stdout == run("--help").stdout


def test_one_equation_is_printed_and_nothing_written(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    motion = rs.derive("ZXZ", BODY)
    latex = run("derive", "ZXZ", "--only", BODY, "--format", "latex").stdout
    assert latex == motion.latex(BODY) + "\n"
    assert "Ω′ = Rᵀ Ω" in run("derive", "ZXZ", "--only", BODY, "--format", "text").stdout
    (found,) = json.loads(run("derive", "ZXZ", "--only", BODY, "--format", "json").stdout)
    assert found["name"] == BODY
    assert list(tmp_path.iterdir()) == []


def test_two_derivations_of_one_name_are_refused(tmp_path):
    for axes in ("ZXZ", "ZYX"):
        (tmp_path / axes).mkdir()
        (tmp_path / axes / "own.toml").write_text(f'[rotation]\nsequence = "{axes}"\n')
    done = call("run", "ZXZ/own.toml", "ZYX/own.toml", cwd=tmp_path, status=2)
    assert "two different derivations are named own and would write one folder" in done.stderr


def test_without_colour_no_terminal_codes_are_written():
    done = CliRunner(env={"NO_COLOR": "1"}).invoke(commands, ["list"], color=True)
    assert "\x1b" not in done.stdout


def test_the_list_has_every_quantity_and_straight_columns():
    lines = inventory().splitlines()
    begin, end = map(lines.index, ("Quantities", "Targets of the kernels (--target NAME,...)"))
    rows = lines[begin + 1 : end - 1]
    assert {row.split()[0] for row in rows} == set(QUANTITIES)
    shipped = lines[lines.index("Shipped derivations (rigidsym run NAME)") + 1 :]
    titles = {re.match(r"  \S+ +", line).end() for line in shipped}
    assert len(titles) == 1
    for part in ("ZXZ  R = Rz(φ) Rx(θ) Rz(ψ)\n", "rotation_vector or rotvec  R = ", "numpy  "):
        assert f"  {part}" in inventory()


def test_a_file_asks_for_conversions_which_its_note_shows_before_the_proofs():
    text = '[rotation]\nsequence = "ZXZ"\n[output]\nnote = ["tex"]\nconversions = true\n'
    files = output_of(read_spec(text, source="a.toml", name="a")).files
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
    motion = derived("ZXZ")
    document = motion.note(conversions=True).document
    titles = [section.title for section in document.sections]
    assert titles.index("Conversions") + 1 == titles.index("Appendix: identities verified")
    number = document.number("quaternion")
    assert number == len(motion.steps) + 1
    assert f"Equation ({number}) of the note" in files["a.py"]
    assert r"4 \mathbf{p}\,\mathbf{p}^{\mathsf T}" in files["a.tex"]
    assert r"from\_\allowbreak quaternion" in files["a.tex"]
