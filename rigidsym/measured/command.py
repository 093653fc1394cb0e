"""The body of `rigidsym inertia`: a file of particles or a mesh, measured."""

from __future__ import annotations

from pathlib import Path

from rigidsym.measured.inertia import inertia_of
from rigidsym.measured.mesh import ENDINGS, mesh_inertia, read_mesh_file
from rigidsym.measured.result import Measured
from rigidsym.progress import bar


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
    with bar(path.name) as progress:
        found = inertia_of(path, columns=names, allow=allow, scheduler=scheduler, progress=progress)
    return found, "particles"
