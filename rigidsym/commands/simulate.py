"""`rigidsym simulate`: a motion from its equations, with the drift of what it conserves."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

import click
import numpy as np
from numpy.typing import NDArray

from rigidsym.commands.command import command as make
from rigidsym.data.writers import check_ending, table_writer
from rigidsym.pipeline import motion_of, read
from rigidsym.system.progress import bar


@make(
    "rigidsym simulate heavy_symmetric_top --set A=1 --set C=0.5 --set m=1 --set g=9.81 "
    "--set l=1\n      --initial theta=0.5 --initial psi_dot=20 --time 5 --plot top.png"
)
@click.argument("source", metavar="NAME|FILE")
@click.option("--set", "constants", multiple=True, metavar="NAME=NUMBER", help="A parameter.")
@click.option(
    "--initial", multiple=True, metavar="NAME=NUMBER", help="A coordinate or rate; 0 by default."
)
@click.option("--time", "t_end", type=float, default=10.0, show_default=True, help="Seconds.")
@click.option("--samples", type=click.IntRange(2), default=1001, show_default=True)
@click.option(
    "--out", type=click.Path(dir_okay=False, path_type=Path), help="CSV, NPY or Parquet file."
)
@click.option(
    "--plot", type=click.Path(dir_okay=False, path_type=Path), help="PNG, SVG or PDF picture."
)
def command(
    source: str,
    constants: tuple[str, ...],
    initial: tuple[str, ...],
    t_end: float,
    samples: int,
    out: Path | None,
    plot: Path | None,
) -> None:
    """Simulate the motion of a derivation file with [dynamics].

    NAME is a shipped derivation such as heavy_symmetric_top. The report shows how far each first
    integral drifts.
    """
    if out is not None:
        check_ending(out)
    motion = motion_of(read(source))
    rates = (*motion.argument("q").names, *motion.argument("q_dot").names)
    start = dict.fromkeys(rates, 0.0) | _numbers("--initial", initial)
    values = _numbers("--set", constants)
    with bar(motion.name) as progress:
        found = motion.simulate(start, values, t_end, samples=samples, progress=progress)
    click.echo(found.report())
    if out is not None:
        _write(found.columns(), out)
        click.echo(out)
    if plot is not None:
        click.echo(found.plot(plot))


def _numbers(option: str, texts: Iterable[str]) -> dict[str, float]:
    found: dict[str, float] = {}
    for text in texts:
        name, equals, number = text.partition("=")
        try:
            found[name.strip()] = float(number)
        except ValueError:
            raise click.UsageError(f"{option} {text}: expected NAME=NUMBER") from None
        if not equals:
            raise click.UsageError(f"{option} {text}: expected NAME=NUMBER")
    return found


def _write(columns: Mapping[str, NDArray[np.float64]], path: Path) -> None:
    names: Sequence[str] = tuple(columns)
    rows = np.column_stack([*columns.values()])
    with table_writer(path, names, rows.dtype) as writer:
        writer.append(rows)
