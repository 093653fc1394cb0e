"""The commands. What they write is written here or in `production`, and nowhere else.

Results go to standard output, progress and messages to standard error. Heavy imports stand in
the functions that need them, so that `rigidsym --help` imports neither SymPy nor NumPy.
"""

from __future__ import annotations

import io
import json
import os
import sys
from pathlib import Path
from typing import Any

import click

from rigidsym.commands.options import (
    JSON,
    OUT,
    TEMPLATES,
    OnceCommand,
    in_notation,
    names_of,
    of_production,
)
from rigidsym.errors import RigidsymError
from rigidsym.version import __version__

_INTERRUPTED = 130
_POSITIVE = click.FloatRange(min=0, min_open=True)


def main() -> None:
    """The `rigidsym` command: runs, and turns errors into messages and exit codes."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):  # φ on a terminal that cannot show it is a ?
            stream.reconfigure(errors="replace")
    try:
        status = commands.main(standalone_mode=False)
    except click.ClickException as error:
        error.show()
        status = error.exit_code
    except RigidsymError as error:
        click.echo(f"rigidsym: {error}", err=True)
        status = error.exit_code
    except (KeyboardInterrupt, click.Abort):
        click.echo("rigidsym: interrupted", err=True)
        status = _INTERRUPTED
    except OSError as error:
        place = f"{error.filename}: " if error.filename else ""
        click.echo(f"rigidsym: {place}{error.strerror or error}", err=True)
        status = 1
    sys.exit(status if isinstance(status, int) else 0)


class _Commands(click.Group):
    """Commands whose reader (`| head`) may have had enough: nothing is wrong then."""

    command_class = OnceCommand

    def invoke(self, context: click.Context) -> Any:
        try:
            return super().invoke(context)
        except BrokenPipeError:  # of which click makes exit code 1
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
            raise click.exceptions.Exit(0) from None


@click.group(cls=_Commands, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, prog_name="rigidsym")
@click.pass_context
def commands(context: click.Context) -> None:
    """Derive the kinematics of a rotation, proved step by step; print kernels and notes."""
    if os.environ.get("NO_COLOR"):
        context.color = False


@commands.command()
@click.argument("rotation")
@click.option(
    "--angles", "--names", metavar="A,B,C", help="Names of the coordinates, in their order."
)
@click.option("--constants", metavar="A,B", help="Names in turns that are constants.")
@click.option("--scalar-last", is_flag=True, help="Quaternions as (x, y, z, w).")
@click.option("--passive", is_flag=True, help="Present the direction cosine matrix A = Rᵀ.")
@of_production
def derive(
    rotation: str,
    angles: str | None,
    constants: str | None,
    scalar_last: bool,
    passive: bool,
    out: Path,
    pdf: bool,
    as_json: bool,
) -> None:
    """Derive one rotation, show it, and write its module and note.

    ROTATION is ZXZ or 313 (intrinsic: about the turning axes), zxz (extrinsic: about the fixed
    axes), turns such as "z(phi) x(theta) [1,1,0](psi)", or a name: `rigidsym list` has them all.
    """
    from rigidsym.commands.derive import produce
    from rigidsym.spec.derivation_file import spec_for

    spec = spec_for(
        rotation,
        angles=None if angles is None else names_of(angles),
        constants=names_of(constants) if constants else (),
        scalar_last=scalar_last,
        passive=passive,
    )
    produce([spec], out, pdf=pdf, as_json=as_json)


@commands.command()
@click.argument("files", nargs=-1, required=True, metavar="FILE...")
@of_production
def run(files: tuple[str, ...], out: Path, pdf: bool, as_json: bool) -> None:
    """Run derivation files, given by path or by the name of a shipped one.

    All files are checked before any is run; a fault in one writes nothing.
    """
    from rigidsym.commands.derive import produce, read_all

    produce(read_all(files), out, pdf=pdf, as_json=as_json)


@commands.command()
@click.argument("asked", nargs=-1, required=True, metavar="ROTATION|FILE...")
@click.option("--portable", is_flag=True, help="For any processor of this kind; slower.")
@TEMPLATES
@OUT
def build(asked: tuple[str, ...], out: Path, *, portable: bool) -> None:
    """Compile functions in C into Python modules, NAME_c.py.

    Given a rotation or a derivation FILE, its C is written first, as by --target c; given
    NAME.c, the others of its derivation stand beside it. What is compiled belongs to processors
    with the instructions of this one, unless --portable. Exit code 4 without a C compiler; what is
    written stays.
    """
    from rigidsym.commands.build import built

    for each in asked:
        for module in built(each, out, portable=portable):
            click.echo(module)


@commands.command()
@click.argument("source", metavar="ROTATION|FILE")
@in_notation
@TEMPLATES
@OUT
def page(source: str, out: Path) -> None:
    """Write a page for a browser: the note, and a figure with sliders that moves.

    ROTATION is what `derive` takes, FILE what `run` takes. One file, DIR/NAME/NAME_page.html,
    which loads nothing from anywhere; beside it the record that `check` reads.
    """
    from rigidsym.commands.build import paged

    for each in paged(source, out):
        click.echo(each)


@commands.command("list")
def list_() -> None:
    """List rotations, quantities, targets and shipped derivations."""
    from rigidsym.commands.list import inventory

    click.echo(inventory())


@commands.command()
@click.argument("folder", metavar="DIR", type=click.Path(file_okay=False, path_type=Path))
def templates(folder: Path) -> None:
    """Copy the shipped templates into DIR, to change them; see --templates."""
    from rigidsym.system import resources
    from rigidsym.system.files import write_text

    shipped = [f"{name}.jinja" for name in resources.names("templates", ".jinja")]
    taken = [name for name in shipped if (folder / name).exists()]
    if taken:
        raise click.ClickException(f"{folder} has {', '.join(taken)} already; nothing is copied")
    for name in shipped:
        click.echo(write_text(folder / name, resources.text("templates", name)))


@commands.command()
@click.argument(
    "paths",
    nargs=-1,
    required=True,
    metavar="PATH...",
    type=click.Path(exists=True, path_type=Path),
)
@TEMPLATES
@click.pass_context
def check(context: click.Context, paths: tuple[Path, ...]) -> None:
    """Compare generated files with a fresh derivation.

    PATH is a generated file or a folder; every NAME.json in it says how its neighbours came
    about. Exit code 1 where a file is missing or differs.
    """
    from rigidsym.commands.check import findings

    results = list(findings(paths))
    for finding in results:
        click.echo(str(finding))
    if not all(finding.is_fine for finding in results):
        context.exit(1)


@commands.command()
@click.argument(
    "file",
    required=False,
    metavar="[FILE]",
    type=click.Path(exists=True, dir_okay=False, path_type=Path),
)
@click.option(
    "--angles", multiple=True, metavar="A,B,C", help="In your order; roll=A,... names them."
)
@click.option("--matrix", multiple=True, metavar="R11,R12,...", help="Nine numbers, row by row.")
@click.option("--quaternion", multiple=True, metavar="A,B,C,D", help="Scalar first or last.")
@click.option("--rates", multiple=True, metavar="A,B,C", help="Of the angles, with --omega.")
@click.option("--omega", multiple=True, metavar="X,Y,Z", help="The angular velocity.")
@click.option("--columns", metavar="NAME,...", help="Names of the columns of FILE; - skips one.")
@click.option("--tolerance", type=float, metavar="RADIANS", help="Else from the digits given.")
@click.option("--all", "everything", is_flag=True, help="Show all readings, with all calls.")
@JSON
@click.pass_context
def identify(
    context: click.Context,
    /,
    file: Path | None,
    columns: str | None,
    tolerance: float | None,
    everything: bool,
    as_json: bool,
    **texts: tuple[str, ...],
) -> None:
    """Name the convention that angles and a matrix or quaternion follow.

    Samples are given as options, each as often as there are samples, or in FILE: NPY with 3
    angles and 9 or 4 numbers a row (then 3 rates and 3 of the angular velocity), or text with
    named columns: roll,pitch,yaw or phi,theta,psi or a1,a2,a3; r11,...,r33 or q1,...,q4 or
    qw,qx,qy,qz; a1_dot,... or rate1,...; omega1,omega2,omega3. Exit code 1 where nothing fits.
    """
    from rigidsym.commands.identify import identified

    found = identified(file, texts, columns=columns, tolerance=tolerance)
    if as_json:
        click.echo(json.dumps(found.record(), indent=1, ensure_ascii=False))
    else:
        head, _, rest = found.text(everything=everything).partition("\n")
        click.echo(f"{click.style(head, bold=True)}\n{rest}")
    if not found.fits:
        context.exit(1)


@commands.command()
@click.argument("file", type=click.Path(exists=True, dir_okay=False, path_type=Path))
@click.option("--columns", metavar="NAME,...", help="Of particles: m,x,y,z in your order.")
@click.option("--mass", type=_POSITIVE, metavar="KG", help="Of a mesh, filled uniformly.")
@click.option("--density", type=_POSITIVE, metavar="KG/M3", help="Of a mesh, filled uniformly.")
@click.option("--scale", type=_POSITIVE, default=1.0, metavar="M", help="One unit of a mesh, in m.")
@click.option("--scheduler", metavar="ADDRESS", help="A Dask cluster that sees the NPY file.")
@click.option("--allow", is_flag=True, help="Take negative masses, open meshes.")
@JSON
def inertia(file: Path, as_json: bool, **options: Any) -> None:
    """Mass, centre, inertia tensor and principal axes of particles or of a mesh.

    FILE holds particles, NPY (mapped into memory, one pass), CSV or Parquet, with the columns m, x,
    y, z or x, y, z (1 kg each), or a closed mesh: STL, OBJ, PLY.
    """
    from rigidsym.commands.inertia import measure

    found, noun = measure(file, **options)
    click.echo(json.dumps(found.record(), indent=1) if as_json else found.text(noun))


@commands.command("eval")
@click.argument("rotation")
@click.argument("file", type=click.Path(exists=True, dir_okay=False, path_type=Path))
@click.option(
    "--quantity",
    "quantities",
    multiple=True,
    default=("angular_velocity_body",),
    show_default=True,
    metavar="NAME",
    help="What to evaluate; once for each.",
)
@click.option(
    "--out",
    required=True,
    type=click.Path(dir_okay=False, path_type=Path),
    metavar="RESULT",
    help="NPY, Parquet, or else text with commas, by its ending.",
)
@click.option("--columns", metavar="NAME,...", help="Names of the columns of FILE, in order.")
@click.option("--given", multiple=True, metavar="NAME=NUMBER", help="An input without a column.")
@click.option("--degrees", is_flag=True, help="Angles and rates in degrees, read and written.")
@click.option("--threads", type=click.IntRange(1), default=1, show_default=True)
@click.option("--scheduler", metavar="ADDRESS", help="Compute on a Dask cluster.")
def evaluate(rotation: str, file: Path, out: Path, **options: Any) -> None:
    """Evaluate a quantity of ROTATION for every row of FILE, whatever its length.

    ROTATION is what `derive` takes, or a derivation file. FILE is NPY, Parquet, or text with one
    row a line; its columns are found by their names (phi, theta, psi, phi_dot, ...) or, without
    names, are the inputs in their order. Interrupted, the same command goes on where it stopped.
    """
    from rigidsym.commands.evaluate import evaluated

    made = evaluated(rotation, file, out, **options)
    resumed = f", {made.resumed} of them by an earlier run" if made.resumed else ""
    click.echo(f"{made.path}: {made.rows} rows{resumed}; {', '.join(made.columns)}")
