"""`rigidsym identify`: whole processes for one sample, and large files with their memory."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path

import numpy as np

from benchmarks.cold_start import rigidsym_command
from benchmarks.measure import Settings, Spread, interleaved, peak_memory, run_process, timed
from benchmarks.report import Column, Figure, Report, Table, spread_columns
from rigidsym.models.euler_angles import EulerAngles
from rigidsym.motion import derive
from rigidsym.tools.identify.identification import identify_file
from rigidsym.tools.identify.readings import Reading
from rigidsym.tools.identify.turns import Array

MOST_SECONDS = 1.0
MOST_MEGABYTES = 32
REPEATS = 5
SEQUENCE = "ZYX"


def samples(count: int) -> Array:
    """Rows of angles in radians, matrix, rates and Ω′ of one convention, 18 numbers each."""
    kernels = derive(EulerAngles(SEQUENCE)).kernels().load()
    rng = np.random.default_rng(0)
    q, q_dot = rng.uniform(-1.2, 1.2, (count, 3)), rng.uniform(-2, 2, (count, 3))
    matrix = kernels.rotation_matrix(q).reshape(count, 9)
    return np.hstack([q, matrix, q_dot, kernels.angular_velocity_body(q, q_dot)])


def commands() -> dict[str, list[str]]:
    """What is timed as a process: the parts of a sample that are given."""
    row = samples(1)[0]
    parts = {"angles": row[:3], "matrix": row[3:12], "rates": row[12:15], "omega": row[15:]}
    words = {n: [f"--{n}", ",".join(map(repr, part.tolist()))] for n, part in parts.items()}
    orientation = [*rigidsym_command(), "identify", *words["angles"], *words["matrix"]]
    nothing = [*rigidsym_command(), "identify", "--angles", "0,0,0"]
    return {
        "angles and a matrix": orientation,
        "with rates and Ω": [*orientation, *words["rates"], *words["omega"]],
        "all angles zero: 1152 readings left": [*nothing, "--quaternion", "1,0,0,0"],
    }


def run(settings: Settings) -> Report:
    """Processes in turn, then each file once for its time and once for its memory."""
    actions = {n: partial(timed, partial(run_process, c)) for n, c in commands().items()}
    seconds = interleaved(actions, settings.repeats or REPEATS)
    with tempfile.TemporaryDirectory() as folder:
        return report(seconds, measured(Path(folder), settings.size), settings.size)


def measured(folder: Path, count: int) -> dict[str, tuple[float, int, float]]:
    """Seconds, bytes at the worst moment, and megabytes on disk, by the kind of file."""
    table = samples(count)
    npy, text = folder / "samples.npy", folder / "samples.csv"
    np.save(npy, table)
    np.savetxt(text, table, fmt="%.9g", delimiter=",")
    del table
    return {path.suffix: _file(path) for path in (npy, text)}


def _file(path: Path) -> tuple[float, int, float]:
    def read() -> Reading:
        (answer,) = identify_file(path).answers
        return answer.reading

    read()  # loads what is loaded on first use
    return timed(read), peak_memory(read), path.stat().st_size / 1e6


def report(
    seconds: Mapping[str, Sequence[float]],
    files: Mapping[str, tuple[float, int, float]],
    count: int,
) -> Report:
    """Times of one sample, and of files of `count` samples."""
    spreads = {name: Spread.of(times) for name, times in seconds.items()}
    columns = (Column("one sample"), *spread_columns("ms", 0))
    rows = tuple((name, *spread.in_order(1000)) for name, spread in spreads.items())
    heads = (Column("file"), Column("s", ".2f"), Column("peak MB", ".1f"), Column("size MB", ".0f"))
    read = tuple((kind, t, held / 1e6, size) for kind, (t, held, size) in files.items())
    slowest = max(spread.middle for spread in spreads.values())
    most = max(held for _, held, _ in files.values()) / 1e6
    return Report(
        title="The convention of samples",
        tables=(
            Table("Wall time of a whole process", columns, rows),
            Table(f"{count} samples with rates and Ω", heads, read),
        ),
        figures=(
            Figure(
                "one sample",
                f"under {MOST_SECONDS:g} s",
                f"{slowest:.2f} s",
                slowest < MOST_SECONDS,
            ),
            Figure(
                f"memory of {count} samples",
                f"at most {MOST_MEGABYTES} MB",
                f"{most:.1f} MB",
                most <= MOST_MEGABYTES,
            ),
        ),
    )
