"""`rigidsym eval`: quantities for every row of a file."""

# ruff: noqa: RUF009 -- `option` makes a field, as `dataclasses.field` does

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import click

from rigidsym.commands.command import command as make, option, unique, with_options
from rigidsym.commands.options import RotationOptions
from rigidsym.data.columns import counted
from rigidsym.data.tables import Missing
from rigidsym.errors import ModelError
from rigidsym.motion import Motion, derive
from rigidsym.pipeline import integrated, read
from rigidsym.spec.derivation_spec import DerivationSpec
from rigidsym.system.processes import bar
from rigidsym.tools.evaluate import Evaluated, derived_for, evaluate


@dataclass(frozen=True, kw_only=True)
class EvaluationOptions(RotationOptions):
    """All options of `eval`."""

    quantities: tuple[list[str], ...] = option(
        "--quantity",
        "--only",
        default=("angular_velocity_body",),
        help="Quantities or conversions: quaternion, from_quaternion, from_rotation_matrix. May be "
        "repeated.",
    )
    out: Path = option(
        "--out",
        required=True,
        type=click.Path(dir_okay=False, allow_dash=True, path_type=Path),
        metavar="RESULT",
        help="Result file: .npy, .parquet or .csv; - writes CSV to standard output.",
    )
    columns: list[str] | None = option("--columns", help="Names of the columns of FILE, in order.")
    given: tuple[tuple[str, float], ...] = option("--given", help="A constant input.")
    keep: list[str] | None = option("--keep", help="Columns of FILE to copy, such as time.")
    missing: Missing = option(
        "--missing",
        type=click.Choice(["error", "nan", "drop"]),
        default="error",
        help="If a row lacks a number: stop, write NaN, or leave the row out.",
    )
    degrees: bool = option(
        "--degrees", help="Write degrees, and read columns without a unit as degrees."
    )
    threads: int = option(
        "--threads", type=click.IntRange(1), default=1, help="Number of worker threads."
    )


@make("rigidsym eval ZYX log.csv --degrees --out rates.npy")
@click.argument("rotation")
@click.argument(
    "file", type=click.Path(exists=True, dir_okay=False, allow_dash=True, path_type=Path)
)
@with_options(EvaluationOptions)
def command(rotation: str, file: Path, options: EvaluationOptions) -> None:
    """Evaluate quantities of ROTATION for every row of FILE, however long.

    ROTATION is as for `derive`, or a derivation file with the parameters of its body. FILE is NPY,
    Parquet, or text with one row per line; - is standard input. Columns are found by name (phi,
    theta, psi, phi_dot, ...); without names they are the inputs in order. Units in names, such as
    "yaw [deg]" or "gyro_x [°/s]", are converted; without a unit, angles are in radians. If the
    command is stopped, an older RESULT is kept.
    """
    made = _evaluated(read(rotation, **options.of_rotation()), file, options)
    rows, columns = counted(made.rows, "row"), ", ".join(made.columns)
    click.echo(f"{made.path}: {rows}; {columns}", err=str(options.out) == "-")


def _evaluated(spec: DerivationSpec, source: Path, options: EvaluationOptions) -> Evaluated:
    """Evaluate quantities of a rotation, or of a derivation file, with a bar."""
    if len(spec.models) != 1:
        raise ModelError(f"{spec.name} has {len(spec.models)} rotations; expected one")
    quantities = unique(options.quantities)
    motion = derive(spec.models[0], only=derived_for(quantities), body=integrated(spec).body)
    with bar(source.name) as progress:
        return evaluate(
            motion,
            quantities,
            sys.stdin.buffer if str(source) == "-" else source,
            sys.stdout.buffer if str(options.out) == "-" else options.out,
            columns=options.columns,
            given=_known(motion, quantities) | dict(options.given),
            keep=options.keep or (),
            missing=options.missing,
            degrees=options.degrees,
            threads=options.threads,
            progress=progress,
        )


def _known(motion: Motion, quantities: Sequence[str]) -> dict[str, float]:
    """The values of the body's parameters, if a quantity takes them."""
    taken = {n for q in derived_for(quantities) for n in motion.step(q).quantity.inputs}
    if motion.body is None or "parameters" not in taken:
        return {}
    return {p.symbol.name: p.value for p in motion.body.parameters if p.value is not None}
