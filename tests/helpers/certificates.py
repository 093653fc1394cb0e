"""Records, changes of them, and Coq."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import sympy as sp

import rigidsym as rs
from rigidsym.models.body import given_inertia
from rigidsym.models.library import rotation_from
from rigidsym.notes.formats.record import record
from rigidsym.tools.certificate.certificate import DEFINITIONS, definitions


def plain(record: dict[str, Any]) -> dict[str, Any]:
    content: dict[str, Any] = json.loads(json.dumps(record))
    return content


@cache
def record_of(text: str, quantities: tuple[str, ...] | None = None) -> dict[str, Any]:
    motion = rs.derive(rotation_from(text), *([quantities] if quantities else []))
    return plain(record(motion, {"rotations": [{"sequence": text}]}))


OF_BODY = ("rotation_matrix", "inertia_tensor", "inertia_tensor_space", "moment_of_inertia")
OF_BODY += ("kinetic_energy", "angular_momentum")
OF_MOTION = ("potential_energy", "lagrangian", "energy", "generalised_momenta", "mass_matrix")
OF_MOTION += ("bias_vector", "accelerations", "hamiltonian")
PRINCIPAL = ("principal_moments", "principal_axes")
A, B, C, M = sp.symbols("A B C M", positive=True)
OF_TOP = ("rotation_matrix", "angular_velocity_body", "mass_matrix", "accelerations", "energy")


def of_top(*names: str) -> rs.Motion:
    body = rs.principal_moments(A, A, C)
    return rs.derive("ZXZ", *([names] if names else []), body=body, potential="m*g*l*cos(theta)")


NEEDS: dict[str, Callable[[], rs.Motion]] = {
    "box": lambda: rs.derive("ZXZ", OF_BODY, body=rs.solid("box")),
    "euler": lambda: rs.derive(
        "ZXZ",
        ["rotation_matrix", "angular_acceleration_from_torque"],
        body=rs.principal_moments(A, B, C),
        potential=0,
    ),
    "damped top": lambda: rs.derive(
        "ZXZ",
        ["rotation_matrix", "angular_velocity_body", *OF_MOTION, *PRINCIPAL],
        body=rs.principal_moments(A, A, C),
        potential="m*g*l*cos(theta)",
        forces={"psi": "-k*psi_dot"},
    ),
    "top": lambda: of_top(*OF_TOP),
    "whole top": of_top,
    "cone on its apex": lambda: rs.derive(
        "ZXZ",
        ["centre_of_mass", "inertia_tensor", "angular_velocity_body", *OF_MOTION],
        body=rs.solid("cone"),
        potential="-3/4*m*g*h*cos(theta)",
        fixed_point=[0, 0, "h"],
    ),
    "torque": lambda: rs.derive(
        "ZYX",
        ["angular_velocity_body", "accelerations"],
        body=rs.principal_moments(A, A, C),
        torque=["l*F", "0", "k*F"],
    ),
    # moments 25 and 50 about axes with the slopes 4/3 and -3/4
    "oblique axes": lambda: rs.derive(
        "ZXZ",
        PRINCIPAL,
        body=given_inertia(sp.Matrix([[41, -12, 0], [-12, 34, 0], [0, 0, 60]]), mass=M),
    ),
}


@cache
def of_motion(name: str) -> dict[str, Any]:
    return plain(record(NEEDS[name](), {}))


def printed(found: dict[str, Any], name: str) -> dict[str, Any]:
    """A quantity, or the first integral "constant NAME"."""
    group = "first_integrals" if name.startswith("constant ") else "quantities"
    return next(each for each in found[group] if each["name"] == name.removeprefix("constant "))


def run_coq(folder: Path, text: str) -> int:
    """The exit code of coqc for theorems; Rotation.v is compiled once a folder."""
    files = {"claims.v": text}
    if not (folder / DEFINITIONS).with_suffix(".vo").exists():
        files = {DEFINITIONS: definitions(), **files}
    for name, content in files.items():
        (folder / name).write_text(content, encoding="utf-8")
        done = subprocess.run(["coqc", name], cwd=folder, check=False, capture_output=True)
    return done.returncode
