"""The body of `rigidsym inertia`: a file of particles or a mesh, measured."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from rigidsym.measured.inertia import Progress, inertia_of
from rigidsym.measured.mesh import ENDINGS, mesh_inertia, read_mesh_file
from rigidsym.measured.result import Measured


def measure(
    path: Path,
    *,
    columns: str | None = None,
    mass: float | None = None,
    density: float | None = None,
    scale: float = 1.0,
    allow: bool = False,
    scheduler: str | None = None,
) -> tuple[Measured, str]:
    """What a file holds as a body, and what was counted in it: particles, or faces.

    Raises BodyError and MissingExtra.
    """
    if path.suffix.lower() in ENDINGS:
        mesh = read_mesh_file(path, scale=scale)
        return mesh_inertia(mesh, mass=mass, density=density, allow=allow), "faces"
    names = None if columns is None else [name.strip() for name in columns.split(",")]
    with _bar(path.name) as progress:
        found = inertia_of(path, columns=names, allow=allow, scheduler=scheduler, progress=progress)
    return found, "particles"


@contextmanager
def _bar(label: str) -> Iterator[Progress | None]:
    """A bar on standard error, where that is a terminal."""
    if not sys.stderr.isatty():
        yield None
        return
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn

    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(label, total=None)
        yield lambda done, total: bar.update(task, completed=done, total=total or None)
