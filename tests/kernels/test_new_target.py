"""A new target is one new file: here a toy language from a temporary folder prints ZXZ."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

import rigidsym as rs
from rigidsym.commands.list import inventory
from rigidsym.errors import KernelError
from rigidsym.kernels import targets

TARGET = 'TARGET = Target(about="NAME.toy: a list of assignments", ending=".toy")'
PRINTER = """
from types import ModuleType

from rigidsym.kernels.ir import FUNCTIONS
from rigidsym.kernels.targets import Target
from rigidsym.kernels.targets.infix import infix

RESERVED = frozenset({"theta"})


def render(program):
    names = {name: name.upper() for name in FUNCTIONS}
    lines = []
    for kernel in program.kernels:
        lines.append(f"FUNCTION {kernel.name}({', '.join(kernel.components)})")
        lines += [f"  {a.name} := {infix(a.value, names)}" for a in kernel.assignments]
        lines += [f"  RESULT {infix(value, names)}" for value in kernel.outputs]
    return {f"{program.name}.toy": "\\n".join(lines) + "\\n"}


def load(name, files):
    module = ModuleType(name)
    module.text = "".join(files.values())
    return module
"""
ZXZ = """\
FUNCTION angular_velocity_body(phi, theta_, psi, phi_dot, theta_dot, psi_dot)
  sin_theta := SIN(theta_)
  cos_theta := COS(theta_)
  sin_psi := SIN(psi)
  cos_psi := COS(psi)
  x0 := phi_dot * sin_theta
  RESULT theta_dot * cos_psi + x0 * sin_psi
  RESULT x0 * cos_psi - theta_dot * sin_psi
  RESULT phi_dot * cos_theta + psi_dot
"""


def file_of_a_target(folder: Path, described: str = TARGET) -> Path:
    file = folder / "toy.py"
    file.write_text(PRINTER + described, encoding="utf-8")
    return file


@pytest.fixture
def toy(tmp_path):
    targets.register(file_of_a_target(tmp_path))
    yield
    del targets._KNOWN["toy"]
    del sys.modules[f"{targets.__name__}.toy"]


@pytest.mark.usefixtures("toy")
def test_a_registered_file_prints_and_loads():
    motion = rs.derive("ZXZ", only=["angular_velocity_body"])
    kernels = motion.kernels("toy")
    assert kernels.source.splitlines() == ZXZ.splitlines()
    assert kernels.load().text == kernels.source


@pytest.mark.usefixtures("toy")
def test_its_name_is_listed_and_not_taken_twice(tmp_path):
    assert list(targets.TARGETS)[-1] == "toy"
    with pytest.raises(KernelError, match="a target named toy exists already"):
        targets.register(tmp_path / "toy.py")
    with pytest.raises(KernelError, match=r"no target 'toi'; there is numpy, .*toy"):
        targets.check_target("toi")


def test_a_file_that_is_no_target_is_refused(tmp_path):
    with pytest.raises(KernelError, match=r"nothing\.py is not a Python file"):
        targets.register(tmp_path / "nothing.py")
    with pytest.raises(KernelError, match="defines no TARGET"):
        targets.register(file_of_a_target(tmp_path, ""))


def test_every_shipped_target_is_a_file_of_the_same_form():
    for name, target in targets.TARGETS.items():
        printer = targets.printer(name)
        assert {"RESERVED", "render", "load"} <= vars(printer).keys()
        assert target.about.startswith("NAME")
        assert f"{name} " in inventory()
