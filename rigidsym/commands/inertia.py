"""`rigidsym inertia`: mass properties of particles or of a mesh."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import click

from rigidsym.commands.command import command as make
from rigidsym.data.columns import counted
from rigidsym.data.mass import ENDINGS, inertia_of, mesh_inertia, read_mesh_file


@make("inertia")
def command(file: Path, allow: bool, **options: Any) -> None:
    """Compute the mass, centre, inertia tensor and principal axes of particles or a mesh."""
    is_mesh = file.suffix.lower() in ENDINGS
    mass, density, scale = (options[name] for name in ("mass", "density", "scale"))
    for name in ("columns",) if is_mesh else ("mass", "density", "scale"):
        if options[name]:
            fact, other = ("a mesh", "particles") if is_mesh else ("a file of particles", "meshes")
            raise click.UsageError(f"{file} is {fact}; --{name} is for {other}")
    if not is_mesh:
        body = inertia_of(file, columns=options["columns"] or None, allow=allow)
    elif mass is None and density is None:
        raise click.UsageError(f"{file} is a mesh: expected --mass or --density")
    else:
        mesh = read_mesh_file(file, scale=scale or 1.0)
        body = mesh_inertia(mesh, mass=mass, density=density, allow=allow)
    if options["json"]:
        click.echo(json.dumps(body.record(), indent=1))
    else:
        click.echo(f"{counted(body.count, 'face' if is_mesh else 'particle')}\n{body}")
