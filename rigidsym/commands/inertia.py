"""`rigidsym inertia`: mass properties of particles or of a mesh."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import click

from rigidsym.commands.command import EXISTING_FILE, JSON, POSITIVE, command as make, flag, names
from rigidsym.data.mass import ENDINGS, inertia_of, mesh_inertia, read_mesh_file
from rigidsym.system.processes import bar


def _positive(name: str, unit: str, about: str) -> Any:
    return click.option(name, type=POSITIVE, metavar=unit, help=about)


@make(
    "rigidsym inertia cloud.npy\n         rigidsym inertia part.stl --density 2700 --scale 0.001",
    names("--columns", help="Names of the columns, in order, such as x,y,z,m."),
    _positive("--mass", "KG", "Mass of a uniform mesh."),
    _positive("--density", "KG/M3", "Density of a uniform mesh."),
    _positive("--scale", "M", "Length unit of a mesh in metres.  [default: 1]"),
    flag("--allow", help="Accept negative masses and open meshes."),
    JSON,
)
@click.argument("file", type=EXISTING_FILE)
def command(file: Path, allow: bool, as_json: bool, **options: Any) -> None:
    """Compute the mass, centre, inertia tensor and principal axes of particles or a mesh.

    FILE contains particles (NPY, CSV or Parquet, with the columns m, x, y, z, or x, y, z for
    particles of 1 kg) or a closed mesh (STL, OBJ or PLY).
    """
    is_mesh = file.suffix.lower() in ENDINGS
    mass, density, scale = (options[name] for name in ("mass", "density", "scale"))
    for name in ("columns",) if is_mesh else ("mass", "density", "scale"):
        if options[name]:
            fact, other = ("a mesh", "particles") if is_mesh else ("a file of particles", "meshes")
            raise click.UsageError(f"{file} is {fact}; --{name} is for {other}")
    if not is_mesh:
        with bar(file.name) as progress:
            columns = options["columns"] or None
            body = inertia_of(file, columns=columns, allow=allow, progress=progress)
    elif mass is None and density is None:
        raise click.UsageError(f"{file} is a mesh: expected --mass or --density")
    else:
        mesh = read_mesh_file(file, scale=scale or 1.0)
        body = mesh_inertia(mesh, mass=mass, density=density, allow=allow)
    noun = "face" if is_mesh else "particle"
    click.echo(json.dumps(body.record(), indent=1) if as_json else body.text(noun))
