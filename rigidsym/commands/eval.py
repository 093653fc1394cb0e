"""`rigidsym eval`: quantities for every row of a file."""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import click

from rigidsym.commands.command import command as make, message, of_rotation
from rigidsym.data.columns import counted
from rigidsym.mechanics.derivation import remark
from rigidsym.pipeline import motion_of, read
from rigidsym.system.processes import bar
from rigidsym.tools.evaluate import derived_for, evaluate


@make("eval")
def command(rotation: str, file: Path, **options: Any) -> None:
    """Evaluate quantities of ROTATION for every row of FILE, however long."""
    spec = read(rotation, **of_rotation(options))
    quantities, out = tuple(dict.fromkeys(options["quantity"])), options["out"]
    derived = derived_for(quantities)
    motion = motion_of(replace(spec, quantities=derived, theory=False))
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
            progress=progress,
            **{key: options[key] for key in ("keep", "missing", "degrees", "threads")},
        )
    summary = f"{result.path}: {counted(result.rows, 'row')}; {', '.join(result.columns)}"
    click.echo(summary, err=str(out) == "-")
    if not result.rows:
        message(remark("no_rows", file=file))
    for each in result.remarks:
        message(each)
