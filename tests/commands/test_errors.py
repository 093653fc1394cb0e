"""Every error that a user can meet is provoked here; each has an exit code."""

from __future__ import annotations

import inspect
import sys
from pathlib import Path
from time import sleep

import pytest
import sympy as sp
from click.testing import CliRunner

import rigidsym as rs
from helpers.target_modules import loading
from rigidsym import errors
from rigidsym.algebra.matrix import RingMatrix
from rigidsym.commands.cli import commands
from rigidsym.data.mass import read_mesh_file
from rigidsym.kernels.targets import compiling
from rigidsym.mechanics.body import BodyValues
from rigidsym.notes.formats.pdf import typeset
from rigidsym.system.processes import time_limit

phi = sp.Function("phi")(sp.Symbol("t"))


def said(*words: str) -> None:
    """A command, whose error is raised."""
    done = CliRunner().invoke(commands, words, standalone_mode=False)
    assert done.exception is not None, done.output
    raise done.exception


def late(_: pytest.MonkeyPatch) -> None:
    with time_limit(0.01):
        sleep(9)


def not_in_the_ring(_: pytest.MonkeyPatch) -> None:
    rs.derive(rs.given(sp.diag(1, 1, sp.gamma(phi)), name="own"))


def false_claim(patch: pytest.MonkeyPatch) -> None:
    right = BodyValues.shifted_inertia
    patch.setattr(BodyValues, "shifted_inertia", lambda values: 2 * right(values))
    rs.derive("ZXZ", ["inertia_tensor_point"], body=rs.solid("cone"))


def defect(patch: pytest.MonkeyPatch) -> None:
    patch.setattr(RingMatrix, "is_zero", lambda *_: True)
    rs.derive(rs.given(sp.diag(sp.cos(phi), 1, 1), name="own"))


def no_tex(patch: pytest.MonkeyPatch) -> None:
    patch.setenv("PATH", str(Path.cwd()))
    typeset("x")


def programs(patch: pytest.MonkeyPatch, line: str, *names: str) -> None:
    """Programs of these names that do what a line of the shell says."""
    for name in names:
        Path(name).write_text(f"#!/bin/sh\n{line}\n")
        Path(name).chmod(0o755)
    patch.setenv("PATH", f"{Path.cwd()}:/bin:/usr/bin")


def failing_tex(patch: pytest.MonkeyPatch) -> None:
    programs(patch, "exit 1", "pdflatex")
    typeset("x")


def no_extra(patch: pytest.MonkeyPatch) -> None:
    patch.setitem(sys.modules, "trimesh", None)
    Path("a.stl").write_text("solid")
    said("inertia", "a.stl", "--density", "1")


def broken_template(_: pytest.MonkeyPatch) -> None:
    Path("own").mkdir()
    Path("own/note.html.jinja").write_text("{{ nothing }}")
    said("derive", "ZXZ", "--only", "rotation_matrix", "--templates", "own")


def edited(_: pytest.MonkeyPatch) -> None:
    words = ("derive", "ZXZ", "--only", "rotation_matrix", "--quiet")
    written = Path(CliRunner().invoke(commands, words).output.splitlines()[0])
    written.write_text(written.read_text() + "# mine\n")
    said(*words)


def bad_file(_: pytest.MonkeyPatch) -> None:
    Path("a.toml").write_text('[rotation]\nsequence = "ZXX"\n')
    said("run", "a.toml")


def bad_data(_: pytest.MonkeyPatch) -> None:
    Path("a.csv").write_text("phi,theta,psi\n1,2,three\n")
    said("eval", "ZXZ", "a.csv", "--quantity", "rotation_matrix", "--out", "r.csv")


@loading("c")
@pytest.mark.parametrize(
    ("program", "said"), [("echo no >&2; exit 1", "it says:\nno"), ("sleep 9", "after 0.2 seconds")]
)
def test_a_compiler_that_fails_is_quoted(program, said, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    programs(monkeypatch, program, "cc", "gcc", "clang")
    monkeypatch.delenv("CC", raising=False)
    monkeypatch.setattr(compiling, "TIMEOUT", 0.2 if "sleep" in program else 9)
    with pytest.raises(errors.ToolFailed, match=said):
        compiling.compile_library([tmp_path / "none.c"], str(tmp_path / "none.so"))


PROVOKED = {
    errors.LimitReached: late,
    errors.AlgebraError: not_in_the_ring,
    errors.ModelError: lambda _: said("derive", "ZXX"),
    errors.NotARotation: lambda _: rs.derive(rs.given(sp.diag(sp.cos(phi), 1, 1), name="own")),
    errors.BodyError: lambda _: rs.solid("sphere", radius=-1),
    errors.DerivationError: false_claim,
    errors.Defect: defect,
    errors.QuantityError: lambda _: said("derive", "ZXZ", "--only", "weight"),
    errors.ExpressionError: lambda _: said("derive", "z(phi"),
    errors.SpecError: bad_file,
    errors.MissingTool: no_tex,
    errors.MissingExtra: no_extra,
    errors.TemplateFault: broken_template,
    errors.ToolFailed: failing_tex,
    errors.DataError: bad_data,
    errors.RequestError: lambda _: said("derive", "ZXZ", "--timeout", "nan"),
    errors.KernelError: lambda _: said("derive", "ZXZ", "--target", "fortran"),
    errors.EditedFiles: edited,
    errors.CheckError: lambda _: said("check", "."),
}


@pytest.mark.parametrize("kind", PROVOKED, ids=lambda kind: kind.__name__)
def test_each_error_is_provoked(kind, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(kind) as caught:
        PROVOKED[kind](monkeypatch)
    assert caught.type is kind
    assert str(caught.value)
    assert kind.exit_code in (1, 2, 3, 4)


@pytest.mark.parametrize(
    ("package", "extra", "command"),
    [
        ("polars", "data", "inertia a.parquet"),
        ("scipy.integrate", "simulate", "simulate heavy_symmetric_top --out r.csv"),
    ],
)
def test_a_missing_package_is_named_by_its_extra(package, extra, command, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("a.parquet").write_bytes(b"PAR1")
    monkeypatch.setitem(sys.modules, package, None)
    with pytest.raises(errors.MissingExtra, match=rf"pip install '\.\[{extra}\]'"):
        said(*command.split())


def test_a_mesh_that_does_not_exist_needs_no_package(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "trimesh", None)
    with pytest.raises(errors.BodyError, match="no such mesh"):
        read_mesh_file(tmp_path / "a.stl")


def test_only_messages_about_shipped_names_refer_to_list():
    own = [f"k{n}" for n in range(11)]
    assert errors.offer("tau", own) == f"known: {', '.join(own)}"
    assert errors.offer("tau", own * 2) == "known: k0, k1, k2 and 19 more"
    assert "`rigidsym list`" in errors.offer("tau", own, listed=True)


def test_no_error_is_left_out():
    kinds = filter(inspect.isclass, vars(errors).values())
    known = {kind for kind in kinds if issubclass(kind, errors.RigidsymError)}
    assert known == {errors.RigidsymError, *PROVOKED}
