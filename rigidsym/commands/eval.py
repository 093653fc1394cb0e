"""`rigidsym eval`: quantities for every row of a file."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import click

from rigidsym.commands.command import command as make, message, of_rotation
from rigidsym.data.columns import counted
from rigidsym.errors import ModelError
from rigidsym.motion import derive
from rigidsym.pipeline import integrated, read
from rigidsym.system.processes import bar
from rigidsym.tools.evaluate import derived_for, evaluate


@make("eval")
def command(rotation: str, file: Path, **options: Any) -> None:
    """Evaluate quantities of ROTATION for every row of FILE, however long."""
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
            given={s.name: float(value) for s, value in values.items()} | options["given"],
            keep=options["keep"],
            missing=options["missing"],
            degrees=options["degrees"],
            threads=options["threads"],
            progress=progress,
        )
    shown = f"{result.path}: {counted(result.rows, 'row')}; {', '.join(result.columns)}"
    click.echo(shown, err=str(out) == "-")
    if not result.rows:
        message(f"{file} has no rows of numbers: the result is only a header")
    if result.inputs:
        message(f"columns without a unit are read as {', '.join(result.inputs)}")
