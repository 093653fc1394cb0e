"""`rigidsym eval`: quantities for every row of a file."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import click

from rigidsym.commands.command import command as make, flag, message, names, numbers
from rigidsym.commands.options import ROTATION, of_rotation
from rigidsym.data.columns import counted
from rigidsym.errors import ModelError
from rigidsym.motion import derive
from rigidsym.pipeline import integrated, read
from rigidsym.system.processes import bar
from rigidsym.tools.evaluate import derived_for, evaluate


@make(
    "rigidsym eval ZYX log.csv --degrees --out rates.npy",
    *ROTATION,
    names(
        "--quantity",
        default=("angular_velocity_body",),
        show_default=True,
        help="Quantities or conversions: quaternion, from_quaternion, from_rotation_matrix. May be "
        "repeated.",
    ),
    click.option(
        "--out",
        required=True,
        type=click.Path(dir_okay=False, allow_dash=True, path_type=Path),
        metavar="RESULT",
        help="Result file: .npy, .parquet or .csv; - writes CSV to standard output.",
    ),
    names("--columns", help="Names of the columns of FILE, in order."),
    numbers("--given", help="A constant input."),
    names("--keep", help="Columns of FILE to copy, such as time."),
    click.option(
        "--missing",
        type=click.Choice(["error", "nan", "drop"]),
        default="error",
        show_default=True,
        help="If a row lacks a number: stop, write NaN, or leave the row out.",
    ),
    flag("--degrees", help="Write degrees, and read columns without a unit as degrees."),
    click.option(
        "--threads",
        type=click.IntRange(1),
        default=1,
        show_default=True,
        help="Number of worker threads.",
    ),
)
@click.argument("rotation")
@click.argument(
    "file", type=click.Path(exists=True, dir_okay=False, allow_dash=True, path_type=Path)
)
def command(rotation: str, file: Path, **options: Any) -> None:
    """Evaluate quantities of ROTATION for every row of FILE, however long.

    ROTATION is as for `derive`, or a derivation file with the parameters of its body. FILE is NPY,
    Parquet, or text with one row per line; - is standard input. Columns are found by name (phi,
    theta, psi, phi_dot, ...); without names they are the inputs in order. Units in names, such as
    "yaw [deg]" or "gyro_x [°/s]", are converted; without a unit, angles are in radians. If the
    command is stopped, an older RESULT is kept.
    """
    spec = read(rotation, **of_rotation(options))
    if len(spec.models) != 1:
        raise ModelError(f"{spec.name} has {len(spec.models)} rotations; expected one")
    quantities, out = tuple(dict.fromkeys(options["quantity"])), options["out"]
    derived = derived_for(quantities)
    motion = derive(spec.models[0], only=derived, body=integrated(spec).body)
    inputs = {name for quantity in derived for name in motion.step(quantity).quantity.inputs}
    values = motion.body.values if motion.body and "parameters" in inputs else {}
    with bar(file.name) as progress:
        result = evaluate(
            motion,
            quantities,
            sys.stdin.buffer if str(file) == "-" else file,
            sys.stdout.buffer if str(out) == "-" else out,
            columns=options["columns"] or None,
            given={s.name: float(value) for s, value in values.items()} | dict(options["given"]),
            keep=options["keep"],
            missing=options["missing"],
            degrees=options["degrees"],
            threads=options["threads"],
            progress=progress,
        )
    shown = f"{result.path}: {counted(result.rows, 'row')}; {', '.join(result.columns)}"
    click.echo(shown, err=str(out) == "-")
    if result.inputs:
        message(f"columns without a unit are read as {', '.join(result.inputs)}")
