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
import sympy as sp

import rigidsym as rs
from helpers.command import RIGIDSYM, ROOT, call, run
from rigidsym.motion import derive
from rigidsym.notes.formats.record import SCHEMA_VERSION
from rigidsym.text.expression import parse_expression

NAME = "euler_zxz_intrinsic"


def test_derive_shows_the_lecture_and_writes_its_files(tmp_path):
    shown = call("derive", "ZXZ", cwd=tmp_path).stdout
    for line in ("φ̇ sin θ sin ψ + θ̇ cos ψ", "φ̇ sin θ cos ψ − θ̇ sin ψ", "φ̇ cos θ + ψ̇"):
        assert line in shown
    assert "Intrinsic rotations: first by φ about the z-axis" in shown
    assert "✗" not in shown
    folder = tmp_path / "out" / NAME
    assert {file.name for file in folder.iterdir()} == {
        f"{NAME}.{e}" for e in ("py", "tex", "html", "json")
    }


def test_json_is_one_object_with_its_schema_version(tmp_path):
    data = json.loads(call("derive", "ZXZ", "--json", cwd=tmp_path).stdout)
    assert data["schema"] == "rigidsym.derivation"
    assert data["schema_version"] == SCHEMA_VERSION
    assert data["is_proved"] is True
    quantities = {quantity["name"]: quantity for quantity in data["quantities"]}
    assert quantities["angular_velocity_body"]["shape"] == [3]
    assert all(proof["status"] == "exact" for q in quantities.values() for proof in q["proofs"])
    assert data["singularities"]["determinant"] == "-sin(theta)"
    assert json.loads((tmp_path / "out" / NAME / f"{NAME}.json").read_text()) == data


def test_expressions_in_json_are_read_back_by_the_safe_parser(tmp_path):
    data = json.loads(call("derive", "XYZ", "--json", cwd=tmp_path).stdout)
    names = {c["name"]: sp.Symbol(c["name"]) for a in data["arguments"] for c in a["components"]}
    motion = derive(rs.EulerAngles("XYZ"))
    symbols = {
        symbol: names[name]
        for argument in reversed(motion.arguments)
        for symbol, name in zip(argument.symbols, argument.names, strict=True)
    }
    for quantity in data["quantities"]:
        texts = sp.flatten(quantity["expression"])
        for text, entry in zip(texts, motion.step(quantity["name"]).expression, strict=True):
            assert sp.expand(parse_expression(text, names) - entry.xreplace(symbols)) == 0


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
        return f"{said}exit code {done.returncode}"

    answered("commands/refused.txt", answer)


def test_check_finds_what_was_changed_and_what_is_missing(tmp_path):
    call("derive", "ZXZ", cwd=tmp_path)
    folder = tmp_path / "out" / NAME
    assert "up to date" in call("check", "out", cwd=tmp_path).stdout
    module = folder / f"{NAME}.py"
    module.write_text(module.read_text().replace("x0 = ", "x0 = 2 * ", 1))
    (folder / f"{NAME}.tex").unlink()
    found = call("check", str(module), cwd=tmp_path, status=1).stdout
    assert f"{NAME}.py: differs from the derivation at line" in found
    assert f"{NAME}.tex: missing" in found


def test_without_tex_all_else_is_written(tmp_path):
    empty = tmp_path / "bin"
    empty.mkdir()
    done = call("derive", "ZXZ", "--pdf", cwd=tmp_path, status=4, PATH=str(empty))
    assert "texlive-latex-recommended" in done.stderr
    assert "φ̇ cos θ + ψ̇" in done.stdout
    assert len(list((tmp_path / "out" / NAME).iterdir())) == 4


def test_a_closed_pipe_is_no_error():
    command = " ".join(f"'{part}'" for part in RIGIDSYM) + " list | true"
    done = subprocess.run(
        ["bash", "-o", "pipefail", "-c", command],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stderr) == (0, "")


def test_an_interrupt_leaves_whole_files_and_says_so(tmp_path):
    with subprocess.Popen(
        [*RIGIDSYM, "run", "euler_all"],
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


@pytest.mark.parametrize("closed", ["2>&-", "2>/dev/full"])
@pytest.mark.parametrize(("arguments", "status"), [(("derive", "ZXX"), 2), (("run", "none"), 3)])
def test_the_exit_code_does_not_need_standard_error(closed, arguments, status):
    done = subprocess.run(
        ["sh", "-c", f'exec "$@" {closed}', "sh", *RIGIDSYM, *arguments], check=False
    )
    assert done.returncode == status


@pytest.mark.parametrize(
    ("words", "heavy"),
    [
        (["--help"], {"sympy", "numpy", "rich", "jinja2"}),
        (["derive", "ZXZ"], {"scipy", "polars", "trimesh", "tree_sitter"}),
    ],
)
def test_heavy_packages_are_imported_only_where_they_are_used(tmp_path, words, heavy):
    probe = (
        "import sys\nfrom rigidsym.commands.cli import commands\n"
        f"commands.main({words}, standalone_mode=False)\n"
        f"print(sorted({heavy} & set(sys.modules)))"
    )
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    done = subprocess.run(
        [sys.executable, "-c", probe],
        cwd=tmp_path,
        env=environment,
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout.splitlines()[-1] == "[]"


FIFOS = {  # a command with a FIFO to which nobody writes, which would be read for ever: exit code
    **{f"{command} fifo.toml": 3 for command in ("run", "page", "simulate")},
    "check fifo.json": 1,
    "inertia fifo.npy": 3,
    "eval ZXZ fifo.csv --out r.csv": 3,
    "eval fifo.toml log.csv --out r.csv": 3,
    "identify fifo.csv": 3,
}


@pytest.mark.parametrize("words", FIFOS)
def test_an_input_that_is_no_regular_file_is_refused(words, tmp_path):
    (name,) = (word for word in words.split() if word.startswith("fifo"))
    os.mkfifo(tmp_path / name)
    (tmp_path / "log.csv").write_text("1,2,3\n")
    done = call(*words.split(), cwd=tmp_path, status=FIFOS[words])
    assert "not a regular file" in done.stdout + done.stderr
