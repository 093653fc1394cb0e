"""Certificates of the whole catalogue and of the lecture: processor time, and who accepts them."""

from __future__ import annotations

import json
import subprocess
import tempfile
from collections.abc import Iterator
from os import times
from pathlib import Path
from shutil import which
from typing import Any

import sympy as sp

from benchmarks.measure import Settings, progress
from benchmarks.report import Cell, Column, Figure, Report, Table
from rigidsym.models.body import principal_moments
from rigidsym.models.library import PARAMETRISATIONS, rotation_from
from rigidsym.models.parametrisations import EULER_SEQUENCES
from rigidsym.motion import derive
from rigidsym.notes.formats.record import record
from rigidsym.tools.certificate.certificate import DEFINITIONS, certificate_of, definitions
from rigidsym.tools.certificate.checker import verify

UNCOVERED = ("rotation_vector", "direction_cosines")  # a root; conditions that are no spheres
LECTURE = (
    *("rotation_matrix", "spin_matrix", "angular_velocity_space", "angular_velocity_body"),
    *("inertia_tensor", "translational_energy", "rotational_energy", "kinetic_energy"),
    *("angular_momentum_centre", "angular_momentum_rotation_body", "angular_momentum_rotation"),
    "angular_momentum",
)
COLUMNS = (
    Column("rotation", ""),
    Column("claims", "d"),
    Column("without a theorem", "d"),
    Column("to check, s", ".2f"),
    Column("to write, s", ".2f"),
    Column("Coq, s", ".1f"),
)


def run(settings: Settings) -> Report:  # noqa: ARG001  (as the others)
    """Each rotation once."""
    refused: list[str] = []
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / DEFINITIONS).write_text(definitions(), encoding="utf-8")
        _compiles(Path(folder), DEFINITIONS)
        rows = [_row(Path(folder), *case, refused) for case in _cases()]
    progress()
    accepted = f"{len(rows) - len(refused)} of {len(rows)}"
    return Report(
        title="Certificates: seconds",
        tables=(
            Table("all kinematic quantities; the lecture's with a body", COLUMNS, tuple(rows)),
        ),
        figures=(Figure("certificates accepted by Coq", "all", accepted, not refused),),
    )


def _cases() -> Iterator[tuple[str, dict[str, Any]]]:
    others = (name for name in PARAMETRISATIONS if name not in UNCOVERED)
    for name in (*EULER_SEQUENCES, *others):
        yield name, record(derive(rotation_from(name)), {})
    body = principal_moments(*sp.symbols("A B C", positive=True))
    yield "lecture", record(derive(rotation_from("ZXZ"), LECTURE, body=body), {})


def _row(folder: Path, name: str, data: dict[str, Any], refused: list[str]) -> tuple[Cell, ...]:
    progress(name)
    content: dict[str, Any] = json.loads(json.dumps(data))
    start = _seconds()
    verify(content)
    checked = _seconds()
    certificate = certificate_of(content)
    (folder / "claims.v").write_text(certificate.text, encoding="utf-8")
    written = _seconds()
    if not _compiles(folder, "claims.v"):
        refused.append(name)
    seconds = checked - start, written - checked, _seconds() - written
    return (name, len(certificate.claims), len(certificate.uncovered), *seconds)


def _seconds() -> float:
    """Of the processor, for this process and for coqc: another load changes them little."""
    return sum(times()[:4])


def _compiles(folder: Path, name: str) -> bool:
    """True without Coq as well; the column shows no time then."""
    coqc = which("coqc")
    return coqc is None or not subprocess.run([coqc, name], cwd=folder, check=False).returncode
