"""Each error has its exit code, and a missing program or package is named."""

from __future__ import annotations

import inspect
import re
import sys
from pathlib import Path

import pytest

import rigidsym as rs
from helpers.command import call
from helpers.target_modules import loading
from rigidsym import errors
from rigidsym.data.mass import read_mesh_file
from rigidsym.kernels.targets import compiling
from rigidsym.notes.formats.pdf import typeset

EXIT_CODES = {
    1: "AlgebraError Defect DerivationError EditedFiles LimitReached NotARotation RigidsymError "
    "ToolFailed",
    2: "CheckError ExpressionError KernelError ModelError QuantityError RequestError",
    3: "BodyError DataError SpecError TemplateFault",
    4: "MissingExtra MissingTool",
}


def test_each_error_has_its_exit_code_and_is_raised():
    kinds = filter(inspect.isclass, vars(errors).values())
    codes = {k.__name__: k.exit_code for k in kinds if issubclass(k, errors.RigidsymError)}
    assert codes == {name: code for code, names in EXIT_CODES.items() for name in names.split()}
    sources = "".join(p.read_text("utf-8") for p in Path(rs.__file__).parent.rglob("*.py"))
    assert codes.keys() - {"RigidsymError"} <= {
        *re.findall(r"(?<!class )\b([A-Z]\w+)(?:\(| if)", sources)
    }


def programs(patch: pytest.MonkeyPatch, line: str, *names: str) -> None:
    """Programs of these names in this folder that do what a line of the shell says."""
    for name in names:
        Path(name).write_text(f"#!/bin/sh\n{line}\n")
        Path(name).chmod(0o755)
    patch.setenv("PATH", f"{Path.cwd()}:/bin:/usr/bin")


def test_tex_that_fails_is_quoted(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    programs(monkeypatch, "echo no; exit 1", "pdflatex")
    with pytest.raises(errors.ToolFailed, match="the end of its log:\nno"):
        typeset("x")


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


@pytest.mark.parametrize(
    ("package", "extra", "command"),
    [
        ("polars", "data", "inertia a.parquet"),
        ("scipy.integrate", "simulate", "simulate heavy_symmetric_top --out r.csv"),
        ("trimesh", "mesh", "inertia a.stl --density 1"),
    ],
)
def test_a_missing_package_is_named_by_its_extra(package, extra, command, tmp_path, monkeypatch):
    for name in ("a.parquet", "a.stl"):
        (tmp_path / name).write_bytes(b"PAR1")
    monkeypatch.setitem(sys.modules, package, None)
    done = call(*command.split(), cwd=tmp_path, status=4)
    assert f"pip install '.[{extra}]'" in done.stderr


def test_a_mesh_that_does_not_exist_needs_no_package(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "trimesh", None)
    with pytest.raises(errors.BodyError, match="no such mesh"):
        read_mesh_file(tmp_path / "a.stl")


def test_only_messages_about_shipped_names_refer_to_list():
    own = [f"k{n}" for n in range(11)]
    assert errors.offer("tau", own) == f"known: {', '.join(own)}"
    assert errors.offer("tau", own * 2) == "known: k0, k1, k2 and 19 more"
    assert "`rigidsym list`" in errors.offer("tau", own, listed=True)
