"""A new target is one file and a line of the table: here a toy language prints ZXZ."""

from __future__ import annotations

import sys

import pytest

import rigidsym as rs
from rigidsym.commands.list import inventory
from rigidsym.errors import KernelError
from rigidsym.kernels import targets

PRINTER = """
from types import ModuleType

from rigidsym.kernels.ir import FUNCTIONS
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


def test_a_file_and_its_line_print_and_load(tmp_path, monkeypatch):
    (tmp_path / "toy.py").write_text(PRINTER, encoding="utf-8")
    monkeypatch.setattr(targets, "__path__", [*targets.__path__, str(tmp_path)])
    monkeypatch.setitem(targets.TARGETS, "toy", targets.Target(about="NAME.toy", ending=".toy"))
    motion = rs.derive("ZXZ", only=["angular_velocity_body"])
    kernels = motion.kernels("toy")
    del sys.modules[f"{targets.__name__}.toy"]
    assert kernels.source.splitlines() == ZXZ.splitlines()
    assert kernels.load().text == kernels.source
    with pytest.raises(KernelError, match=r"no target 'toi'; there is numpy, .*toy"):
        motion.kernels("toi")


def test_every_target_is_a_file_of_the_same_form():
    for name, target in targets.TARGETS.items():
        printer = targets.printer(name)
        assert {"RESERVED", "render", "load"} <= vars(printer).keys()
        assert target.about.startswith("NAME")
        assert f"{name} " in inventory()
