"""`rigidsym inertia`: mass properties of particles or of a mesh."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path

import click

from rigidsym.commands.command import EXISTING_FILE, NAMES, POSITIVE, command as make
from rigidsym.data.mass import ENDINGS, inertia_of, mesh_inertia, read_mesh_file
from rigidsym.system.processes import bar


@make("rigidsym inertia cloud.npy\n         rigidsym inertia part.stl --density 2700 --scale 0.001")
@click.argument("file", type=EXISTING_FILE)
@click.option(
    "--columns",
    type=NAMES,
    metavar="NAME,...",
    help="Names of the columns, in order, such as x,y,z,m.",
)
@click.option("--mass", type=POSITIVE, metavar="KG", help="Mass of a uniform mesh.")
@click.option("--density", type=POSITIVE, metavar="KG/M3", help="Density of a uniform mesh.")
@click.option(
    "--scale", type=POSITIVE, metavar="M", help="Length unit of a mesh in metres.  [default: 1]"
)
@click.option("--allow", is_flag=True, help="Accept negative masses and open meshes.")
@click.option("--json", "as_json", is_flag=True, help="Print the results as JSON.")
def command(
    file: Path,
    columns: list[str] | None,
    mass: float | None,
    density: float | None,
    scale: float | None,
    allow: bool,
    as_json: bool,
) -> None:
    """Compute the mass, centre, inertia tensor and principal axes of particles or a mesh.

    FILE contains particles (NPY, CSV or Parquet, with the columns m, x, y, z, or x, y, z for
    particles of 1 kg) or a closed mesh (STL, OBJ or PLY).
    """
    of_mesh = {"--mass": mass, "--density": density, "--scale": scale}
    if file.suffix.lower() in ENDINGS:
        noun = "face"
        _refuse({"--columns": columns}, f"{file} is a mesh", "particles")
        if mass is None and density is None:
            raise click.UsageError(f"{file} is a mesh: expected --mass or --density")
        mesh = read_mesh_file(file, scale=1.0 if scale is None else scale)
        body = mesh_inertia(mesh, mass=mass, density=density, allow=allow)
    else:
        noun = "particle"
        _refuse(of_mesh, f"{file} is a file of particles", "meshes")
        with bar(file.name) as progress:
            body = inertia_of(file, columns=columns, allow=allow, progress=progress)
    click.echo(json.dumps(body.record(), indent=1) if as_json else body.text(noun))


def _refuse(options: Mapping[str, object], fact: str, expected: str) -> None:
    for option, value in options.items():
        if value is not None:
            raise click.UsageError(f"{fact}; {option} is for {expected}")
