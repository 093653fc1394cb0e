"""Bytes and seconds of certificates: written by rigidsym, verified by the checker alone."""

from __future__ import annotations

import json
from time import perf_counter

from benchmarks.measure import Settings, progress
from benchmarks.report import Cell, Column, Figure, Report, Table
from rigidsym.models.rotation_text import rotation_from
from rigidsym.motion import derive
from rigidsym.notes.formats.record import record
from rigidsym.tools.certificate.certificate import certificate_of
from rigidsym.tools.certificate.checker import verify

ROTATIONS = ("ZXZ", "zyx", "quaternion", "unit_quaternion", "gibbs_vector", "davenport")
COLUMNS = (
    Column("rotation", ""),
    Column("entries", "d"),
    Column("bytes of ZXZ.cert.json and the like", "d"),
    Column("to write, s", ".2f"),
    Column("to check, s", ".2f"),
)
MOST = 20_000  # bytes for ZXZ


def run(settings: Settings) -> Report:  # noqa: ARG001  (as the others)
    """All quantities of each rotation, once."""
    rows: list[tuple[Cell, ...]] = []
    for name in ROTATIONS:
        progress(name)
        found = json.loads(
            json.dumps(record(derive(rotation_from(name)), {"rotations": [{"sequence": name}]}))
        )
        start = perf_counter()
        text = certificate_of(found).json
        written = perf_counter()
        proved = verify(found, json.loads(text))
        checked = perf_counter()
        entries = sum(map(len, proved.values()))
        rows.append((name, entries, len(text), written - start, checked - written))
    progress()
    size = rows[0][2]
    assert isinstance(size, int)
    return Report(
        title="Certificates: bytes and seconds",
        tables=(Table("all kinematic quantities", COLUMNS, tuple(rows)),),
        figures=(
            Figure("certificate of ZXZ", f"at most {MOST} bytes", f"{size} bytes", size <= MOST),
        ),
    )
