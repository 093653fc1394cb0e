"""`rigidsym eval`: quantities for every row of a file."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import click

from rigidsym.commands.command import command as make, message
from rigidsym.commands.options import names_of
from rigidsym.data.chunk import Missing
from rigidsym.data.columns import counted
from rigidsym.errors import ModelError
from rigidsym.mechanics.derive import Body
from rigidsym.models.rotation import RotationModel
from rigidsym.motion import Motion, derive
from rigidsym.pipeline import integrated, read
from rigidsym.system.progress import bar
from rigidsym.tools.evaluate.callables import derived_for
from rigidsym.tools.evaluate.evaluation import Evaluated, evaluation


@make("rigidsym eval ZYX log.csv --degrees --out rates.npy")
@click.argument("rotation")
@click.argument(
    "file", type=click.Path(exists=True, dir_okay=False, allow_dash=True, path_type=Path)
)
@click.option(
    "--quantity",
    "--only",
    "quantities",
    multiple=True,
    default=("angular_velocity_body",),
    show_default=True,
    metavar="NAME",
    help="A quantity, or quaternion, from_quaternion, from_rotation_matrix. May be repeated.",
)
@click.option(
    "--out",
    required=True,
    type=click.Path(dir_okay=False, allow_dash=True, path_type=Path),
    metavar="RESULT",
    help="Result file: NPY, Parquet or CSV by its ending, or - for CSV on standard output.",
)
@click.option("--angles", metavar="A,B,C", help="Names of the coordinates, in their order.")
@click.option("--columns", metavar="NAME,...", help="Names of the columns of FILE, in order.")
@click.option("--given", multiple=True, metavar="NAME=NUMBER", help="An input without a column.")
@click.option("--keep", metavar="NAME,...", help="Columns of FILE to copy, such as time.")
@click.option(
    "--missing",
    type=click.Choice(["error", "nan", "drop"]),
    default="error",
    show_default=True,
    help="If a number of a row is missing: an error, NaN as the result, or no result.",
)
@click.option("--degrees", is_flag=True, help="Write degrees; read them if no unit is stated.")
@click.option(
    "--threads", type=click.IntRange(1), default=1, show_default=True, help="Worker threads."
)
@click.option("--scheduler", metavar="ADDRESS", help="Compute on a Dask cluster.")
def command(
    rotation: str,
    file: Path,
    out: Path,
    angles: str | None,
    columns: str | None,
    keep: str | None,
    **options: Any,
) -> None:
    """Evaluate quantities of ROTATION for every row of FILE, however long.

    ROTATION is as for `derive`, or a derivation file, whose body provides its numbers. FILE is
    NPY, Parquet, or text with one row a line; - is standard input. Columns are found by name
    (phi, theta, psi, phi_dot, ...); without names they are the inputs in order. Units in names,
    such as "yaw [deg]" or "gyro_x [°/s]", are converted; without a unit, angles are in radians.
    RESULT is written as a whole or not at all.
    """
    named = {"angles": angles, "columns": columns, "keep": keep}
    options |= {key: names_of(text) for key, text in named.items() if text is not None}
    made = evaluated(rotation, file, out, **options)
    click.echo(
        f"{made.path}: {counted(made.rows, 'row')}; {', '.join(made.columns)}", err=str(out) == "-"
    )


def evaluated(
    rotation: str,
    source: Path,
    path: Path,
    *,
    quantities: Sequence[str],
    columns: Sequence[str] | None = None,
    given: Sequence[str] = (),
    keep: Sequence[str] = (),
    angles: Sequence[str] | None = None,
    missing: Missing = "error",
    degrees: bool = False,
    threads: int = 1,
    scheduler: str | None = None,
) -> Evaluated:
    """Evaluate quantities of a rotation, or of a derivation file, with a bar."""
    model, body = _subject(rotation, angles)
    motion = derive(model, only=derived_for(quantities), body=body)
    work = evaluation(
        motion,
        quantities,
        sys.stdin.buffer if str(source) == "-" else source,
        sys.stdout.buffer if str(path) == "-" else path,
        columns=columns,
        given=_known(motion, quantities) | dict(map(_number, given)),
        keep=keep,
        missing=missing,
        degrees=degrees,
        threads=threads,
        scheduler=scheduler,
    )
    if scheduler is not None:
        message(f"connecting to {scheduler}")
    with bar(source.name) as progress:
        return work.run(progress)


def _subject(rotation: str, angles: Sequence[str] | None) -> tuple[RotationModel, Body | None]:
    """The rotation, and the body of a derivation file that has one."""
    options = {} if angles is None else {"angles": angles}
    spec = integrated(read(rotation, **options))
    if len(spec.models) != 1:
        raise ModelError(f"{rotation} has {len(spec.models)} rotations; expected one")
    return spec.models[0], spec.body


def _known(motion: Motion, quantities: Sequence[str]) -> dict[str, float]:
    """The values of the body's parameters, if a quantity takes them."""
    taken = {n for q in derived_for(quantities) for n in motion.step(q).quantity.inputs}
    if motion.body is None or "parameters" not in taken:
        return {}
    return {p.symbol.name: p.value for p in motion.body.parameters if p.value is not None}


def _number(text: str) -> tuple[str, float]:
    name, _, number = text.partition("=")
    try:
        return name.strip(), float(number)
    except ValueError:
        raise click.UsageError(f"--given {text}: expected NAME=NUMBER") from None
