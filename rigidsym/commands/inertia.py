"""The body of `rigidsym inertia`: a file of particles or a mesh, measured."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import click

from rigidsym.data.mass.inertia import inertia_of
from rigidsym.data.mass.mesh import ENDINGS, mesh_inertia, read_mesh_file
from rigidsym.data.mass.properties import Measured
from rigidsym.system.progress import bar


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
    """What a file holds as a body, and what was counted in it: particle or face.

    Raises UsageError for options that are for the other of the two, BodyError and MissingExtra.
    """
    is_mesh = path.suffix.lower() in ENDINGS
    of_mesh = {"--mass": mass, "--density": density, "--scale": None if scale == 1 else scale}
    of_particles = {"--columns": columns, "--scheduler": scheduler}
    if is_mesh:
        _refuse(of_particles, f"{path} holds a mesh", "particles")
        if mass is None and density is None:
            raise click.UsageError(f"{path} holds a mesh: expected --mass or --density")
        mesh = read_mesh_file(path, scale=scale)
        return mesh_inertia(mesh, mass=mass, density=density, allow=allow), "face"
    _refuse(of_mesh, f"{path} holds particles", "a mesh")
    names = None if columns is None else [name.strip() for name in columns.split(",")]
    if scheduler is not None:
        click.echo(f"rigidsym: connecting to {scheduler}", err=True)
    with bar(path.name) as progress:
        found = inertia_of(path, columns=names, allow=allow, scheduler=scheduler, progress=progress)
    return found, "particle"


def _refuse(options: Mapping[str, object], found: str, expected: str) -> None:
    for option, value in options.items():
        if value is not None:
            raise click.UsageError(f"{found}; {option} is for {expected}")
