"""Certificates of the whole catalogue and of the lecture: bytes, seconds, and who accepts them.

The checker verifies all kinematic quantities of each rotation, and all of the lecture's; Coq those
of VELOCITIES, in seconds instead of minutes, and all of the lecture's.
"""

from __future__ import annotations

import json
import subprocess
import tempfile
from collections.abc import Iterator
from pathlib import Path
from shutil import which
from time import perf_counter
from typing import Any

import sympy as sp

from benchmarks.measure import Settings, progress
from benchmarks.report import Cell, Column, Figure, Report, Table
from rigidsym.models.body import principal_moments
from rigidsym.models.euler_angles import EULER_SEQUENCES
from rigidsym.models.library import PARAMETRISATIONS
from rigidsym.models.rotation_text import rotation_from
from rigidsym.motion import derive
from rigidsym.notes.formats.record import record
from rigidsym.tools.certificate.certificate import Certificate, certificate_of
from rigidsym.tools.certificate.checker import BROKEN, verify
from rigidsym.tools.certificate.formal import coq

SLOW = ("rotation_vector", "direction_cosines")  # all quantities take minutes, or have none
VELOCITIES = ("rotation_matrix", "angular_velocity_space", "angular_velocity_body")
LECTURE = (
    *("rotation_matrix", "spin_matrix", "angular_velocity_space", "angular_velocity_body"),
    *("inertia_tensor", "translational_energy", "rotational_energy", "kinetic_energy"),
    *("angular_momentum_centre", "angular_momentum_rotation_body", "angular_momentum_rotation"),
    "angular_momentum",
)
COLUMNS = (
    Column("rotation", ""),
    Column("entries", "d"),
    Column("bytes", "d"),
    Column("to write, s", ".2f"),
    Column("to check, s", ".2f"),
    Column("Coq, s", ".1f"),
)
MOST = 20_000  # bytes for ZXZ


def run(settings: Settings) -> Report:  # noqa: ARG001  (as the others)
    """Each rotation once."""
    refused: list[str] = []
    rows = [_row(*case, refused) for case in _cases()]
    progress()
    size = next(row[2] for row in rows if row[0] == "ZXZ")
    assert isinstance(size, int)
    accepted = f"{len(rows) - len(refused)} of {len(rows)}"
    return Report(
        title="Certificates: bytes and seconds",
        tables=(
            Table("all kinematic quantities; the lecture's with a body", COLUMNS, tuple(rows)),
        ),
        figures=(
            Figure("certificates accepted by all programs", "all", accepted, not refused),
            Figure("certificate of ZXZ", f"at most {MOST} bytes", f"{size} bytes", size <= MOST),
        ),
    )


def _cases() -> Iterator[tuple[str, dict[str, Any], dict[str, Any]]]:
    """A name, the record that the checker gets, and the one that Coq gets."""
    for name in (*EULER_SEQUENCES, *(name for name in PARAMETRISATIONS if name not in SLOW)):
        model = rotation_from(name)
        yield name, _plain(record(derive(model), {})), _plain(record(derive(model, VELOCITIES), {}))
    body = principal_moments(*sp.symbols("A B C", positive=True))
    whole = _plain(record(derive(rotation_from("ZXZ"), LECTURE, body=body), {}))
    yield "lecture", whole, whole


def _plain(found: dict[str, Any]) -> dict[str, Any]:
    plain: dict[str, Any] = json.loads(json.dumps(found))
    return plain


def _row(
    name: str, whole: dict[str, Any], short: dict[str, Any], refused: list[str]
) -> tuple[Cell, ...]:
    progress(name)
    start = perf_counter()
    certificate = certificate_of(whole)
    text = certificate.json
    written = perf_counter()
    try:
        verify(whole, json.loads(text))
    except BROKEN:
        refused.append(name)
    checked = perf_counter()
    if not _accepted_by_coq(certificate if short is whole else certificate_of(short)):
        refused.append(f"{name} by Coq")
    entries = sum(map(len, certificate.claims.values()))
    times = written - start, checked - written, perf_counter() - checked
    return (name, entries, len(text), *times)


def _accepted_by_coq(certificate: Certificate) -> bool:
    """True without Coq as well; the column shows no time then."""
    coqc = which("coqc")
    if coqc is None:
        return True
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "claims.v").write_text(coq(certificate), encoding="utf-8")
        return not subprocess.run([coqc, "claims.v"], cwd=folder, check=False).returncode
