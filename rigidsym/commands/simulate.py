"""`rigidsym simulate`: a motion from its equations, with the drift of what it conserves."""

# ruff: noqa: RUF009 -- `option` makes a field, as `dataclasses.field` does

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import click
import numpy as np
from numpy.typing import NDArray

from rigidsym.commands.command import command as make
from rigidsym.commands.options import FILE, NAMED_NUMBER, option, with_options
from rigidsym.data.writers import check_ending, table_writer
from rigidsym.pipeline import motion_of, read
from rigidsym.system.progress import bar

_NUMBERS = {"type": NAMED_NUMBER, "multiple": True, "metavar": "NAME=NUMBER"}


@dataclass(frozen=True, kw_only=True)
class SimulationOptions:
    """All options of `simulate`."""

    constants: tuple[tuple[str, float], ...] = option("--set", **_NUMBERS, help="A parameter.")
    initial: tuple[tuple[str, float], ...] = option(
        "--initial", **_NUMBERS, help="A coordinate or rate; 0 by default."
    )
    t_end: float = option("--time", type=float, default=10.0, show_default=True, help="Seconds.")
    samples: int = option("--samples", type=click.IntRange(2), default=1001, show_default=True)
    out: Path | None = option("--out", type=FILE, help="CSV, NPY or Parquet file.")
    plot: Path | None = option("--plot", type=FILE, help="PNG, SVG or PDF picture.")


@make(
    "rigidsym simulate heavy_symmetric_top --set A=1 --set C=0.5 --set m=1 --set g=9.81 "
    "--set l=1\n      --initial theta=0.5 --initial psi_dot=20 --time 5 --plot top.png"
)
@click.argument("source", metavar="NAME|FILE")
@with_options(SimulationOptions)
def command(source: str, options: SimulationOptions) -> None:
    """Simulate the motion of a derivation file with [dynamics].

    NAME is a shipped derivation such as heavy_symmetric_top. The report shows how far each first
    integral drifts.
    """
    if options.out is not None:
        check_ending(options.out)
    motion = motion_of(read(source))
    rates = (*motion.argument("q").names, *motion.argument("q_dot").names)
    start = dict.fromkeys(rates, 0.0) | dict(options.initial)
    with bar(motion.name) as progress:
        found = motion.simulate(
            start,
            dict(options.constants),
            options.t_end,
            samples=options.samples,
            progress=progress,
        )
    click.echo(found.report())
    if options.out is not None:
        _write(found.columns(), options.out)
        click.echo(options.out)
    if options.plot is not None:
        click.echo(found.plot(options.plot))


def _write(columns: Mapping[str, NDArray[np.float64]], path: Path) -> None:
    rows = np.column_stack([*columns.values()])
    with table_writer(path, tuple(columns), rows.dtype) as writer:
        writer.append(rows)
