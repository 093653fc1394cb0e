"""`rigidsym eval`: quantities for every row of a file."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import click

from rigidsym.commands.command import command as make
from rigidsym.commands.options import names_of
from rigidsym.data.writers import draft_of
from rigidsym.errors import ModelError
from rigidsym.models.rotation import RotationModel
from rigidsym.motion import Body, Motion, derive
from rigidsym.pipeline import integrated, read
from rigidsym.system.progress import Progress, bar
from rigidsym.tools.evaluate.evaluate import Evaluated, Evaluation, evaluation


@make("rigidsym eval ZYX log.csv --degrees --out rates.npy")
@click.argument("rotation")
@click.argument("file", type=click.Path(exists=True, dir_okay=False, path_type=Path))
@click.option(
    "--quantity",
    "--only",
    "quantities",
    multiple=True,
    default=("angular_velocity_body",),
    show_default=True,
    metavar="NAME",
    help="Quantity to evaluate. May be repeated.",
)
@click.option(
    "--out",
    required=True,
    type=click.Path(dir_okay=False, path_type=Path),
    metavar="RESULT",
    help="Result file; the ending .npy or .parquet sets its format, others give CSV.",
)
@click.option("--columns", metavar="NAME,...", help="Names of the columns of FILE, in order.")
@click.option("--given", multiple=True, metavar="NAME=NUMBER", help="An input without a column.")
@click.option("--degrees", is_flag=True, help="Read and write angles and rates in degrees.")
@click.option(
    "--threads", type=click.IntRange(1), default=1, show_default=True, help="Worker threads."
)
@click.option("--scheduler", metavar="ADDRESS", help="Compute on a Dask cluster.")
def command(
    rotation: str,
    file: Path,
    quantities: tuple[str, ...],
    out: Path,
    columns: str | None,
    given: tuple[str, ...],
    degrees: bool,
    threads: int,
    scheduler: str | None,
) -> None:
    """Evaluate quantities of ROTATION for every row of FILE, however long.

    ROTATION is as for `derive`, or a derivation file, whose body provides its numbers. FILE is
    NPY, Parquet, or text with one row a line. Columns are found by name (phi, theta, psi,
    phi_dot, ...); without names they are the inputs in order.
    """
    model, body = _subject(rotation)
    motion = derive(model, only=quantities, body=body)
    work = evaluation(
        motion,
        quantities,
        file,
        out,
        columns=None if columns is None else names_of(columns),
        given=_known(motion, quantities) | dict(map(_number, given)),
        degrees=degrees,
        threads=threads,
        scheduler=scheduler,
    )
    if scheduler is not None:
        click.echo(f"rigidsym: connecting to {scheduler}", err=True)
    with bar(file.name) as progress:
        made = _run(work, progress)
    resumed = f", {made.resumed} of them by an earlier run" if made.resumed else ""
    click.echo(f"{made.path}: {made.rows} rows{resumed}; {', '.join(made.columns)}")


def _run(work: Evaluation, progress: Progress | None) -> Evaluated:
    try:
        return work.run(progress)
    except (KeyboardInterrupt, OSError):
        if (draft := draft_of(work.path)).exists():
            click.echo(
                f"rigidsym: {draft} keeps the rows done so far; run it again to continue",
                err=True,
            )
        raise


def _subject(rotation: str) -> tuple[RotationModel, Body | None]:
    """The rotation, and the body of a derivation file that has one."""
    spec = integrated(read(rotation))
    if len(spec.models) != 1:
        raise ModelError(f"{rotation} has {len(spec.models)} rotations; expected one")
    return spec.models[0], spec.body


def _known(motion: Motion, quantities: Sequence[str]) -> dict[str, float]:
    """The values of the body's parameters, if a quantity takes them."""
    taken = {name for quantity in quantities for name in motion.step(quantity).quantity.inputs}
    if motion.body is None or "parameters" not in taken:
        return {}
    return {p.symbol.name: p.value for p in motion.body.parameters if p.value is not None}


def _number(text: str) -> tuple[str, float]:
    name, _, number = text.partition("=")
    try:
        return name.strip(), float(number)
    except ValueError:
        raise click.UsageError(f"--given {text}: expected NAME=NUMBER") from None
