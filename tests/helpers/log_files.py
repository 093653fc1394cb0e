"""Logs of angles and rates as files of each kind, and the `eval` command on them."""

from __future__ import annotations

import subprocess
from pathlib import Path

import numpy as np
import polars as pl

from helpers import command as command_line
from helpers.command import RIGIDSYM
from rigidsym.data.tables import open_table

COUNT = 1000
VELOCITY = ("angular_velocity_body",)
NAMES = ("phi", "theta", "psi", "phi_dot", "theta_dot", "psi_dot")


def logged() -> np.ndarray:
    """Rows of three angles and their rates."""
    return np.random.default_rng(7).uniform(-3, 3, (COUNT, 6))


def command(*arguments: object) -> list[str]:
    """The command in a process of its own."""
    return [*RIGIDSYM, "eval", *map(str, arguments)]


def run(*arguments: object, given: str = "") -> subprocess.CompletedProcess[str]:
    """The command in this process, with this on standard input."""
    return command_line.run("eval", *map(str, arguments), given=given)


def _as_npy(path: Path, table: np.ndarray) -> None:
    np.save(path, table)


def _as_text(path: Path, table: np.ndarray) -> None:
    lines = [",".join(map(repr, row)) for row in table.tolist()]
    path.write_text("\n".join([",".join(NAMES), *lines]) + "\n", encoding="utf-8")


def _as_parquet(path: Path, table: np.ndarray) -> None:
    columns = dict(zip(NAMES, table.T, strict=True))
    pl.DataFrame(columns).write_parquet(path, row_group_size=300)


WRITERS = {".npy": _as_npy, ".csv": _as_text, ".parquet": _as_parquet}


def read(path: Path) -> np.ndarray:
    reader = open_table(path)
    return np.concatenate([chunk.table for chunk in reader.batches(range(reader.width))])


def velocities(kernel, table: np.ndarray, rows: int) -> np.ndarray:
    """Ω′ of a log, so many rows at a time: the last bit of a kernel may depend on their number."""
    parts = [table[start : start + rows] for start in range(0, len(table), rows)]
    return np.concatenate([kernel(part[:, :3], part[:, 3:]) for part in parts])
