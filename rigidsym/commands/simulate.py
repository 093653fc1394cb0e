"""`rigidsym simulate`: a motion from its equations, with the drift of its first integrals."""

# ruff: noqa: RUF009 -- `option` makes a field, as `dataclasses.field` does

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
import numpy as np

from rigidsym.commands.command import command as make, option, with_options
from rigidsym.data.tables import check_ending, write_table
from rigidsym.errors import DerivationError, ModelError
from rigidsym.models.forces import Example
from rigidsym.motion import Motion
from rigidsym.pipeline import motion_of, read
from rigidsym.simulation.problem import NEEDED
from rigidsym.simulation.solver import METHODS
from rigidsym.simulation.trajectory import PICTURES, check_picture
from rigidsym.system.files import whole_file
from rigidsym.system.processes import bar

if TYPE_CHECKING:
    from rigidsym.simulation.ensemble import Ensemble
    from rigidsym.simulation.trajectory import Trajectory

_ARCHIVE = ".npz"


def _grid(context: click.Context, _: object, given: Sequence[str]) -> dict[str, Any]:
    """Values by name, each axis of the grid as NAME=FROM:TO:COUNT."""
    axes = {}
    for text in given:
        name, _, values = text.partition("=")
        try:
            first, last, count = values.split(":")
            axes[name] = np.linspace(float(first), float(last), int(count))
            if not axes[name].size:
                raise ValueError
        except ValueError:
            raise click.UsageError(
                f"--grid {text}: expected NAME=FROM:TO:COUNT, as in theta=0.1:1.2:50", context
            ) from None
    points = np.meshgrid(*axes.values(), indexing="ij")
    return {name: each.ravel() for name, each in zip(axes, points, strict=True)}


@dataclass(frozen=True, kw_only=True)
class SimulationOptions:
    """All options of `simulate`."""

    constants: tuple[tuple[str, float], ...] = option(
        "--set", help="Value of a parameter.  [default: from the first example of the file]"
    )
    initial: tuple[tuple[str, float], ...] = option(
        "--initial",
        help="Initial value of a coordinate, a rate, or, instead of the rates, "
        "angular_velocity_body_1, _2 or _3. The others are 0.  [default: from the first example "
        "of the file, else R = 1 and at rest]",
    )
    t_end: float | None = option(
        "--time",
        type=float,
        metavar="SECONDS",
        help="Duration.  [default: from the first example of the file, else 10]",
    )
    method: str = option(
        "--method",
        type=click.Choice(METHODS),
        default=METHODS[0],
        help="Integrator; exact is for free bodies.",
    )
    samples: int | None = option(
        "--samples",
        type=click.IntRange(2),
        help="Number of output times.  [default: 1001; 101 for an ensemble]",
    )
    ensemble: int | None = option(
        "--ensemble", type=click.IntRange(1), help="Simulate this many motions at once."
    )
    spread: tuple[tuple[str, float], ...] = option(
        "--spread", help="With --ensemble, standard deviation of an initial value or parameter."
    )
    seed: int = option(
        "--seed", type=click.IntRange(0), default=0, help="Random seed of --ensemble."
    )
    grid: dict[str, Any] = option(
        "--grid",
        multiple=True,
        callback=_grid,
        metavar="NAME=FROM:TO:COUNT",
        help="Simulate COUNT values of an initial value or parameter; if repeated, every "
        "combination.",
    )
    out: Path | None = option("--out", help="Write the motion: .csv, .npy, .npz or .parquet.")
    plot: Path | None = option("--plot", help="Draw the motion: .png, .svg or .pdf.")
    animate: Path | None = option("--animate", help="Write a live page of the motion: .html.")


@make(
    "rigidsym simulate heavy_symmetric_top --set A=1 --set C=0.5 --set m=1\n"
    "         --set g=9.81 --set l=0.5 --initial theta=0.5 --initial psi_dot=20 --time 5"
)
@click.argument("source", metavar="NAME|FILE")
@with_options(SimulationOptions)
def command(source: str, options: SimulationOptions) -> None:
    """Simulate the motion that a derivation file with [dynamics] describes.

    NAME is a shipped derivation such as heavy_symmetric_top. The report shows how far each first
    integral drifts. If the integration stops early, the motion up to that time is written, and the
    exit code is 1.
    """
    if options.out is not None:
        check_ending(options.out, _ARCHIVE)
    for path, endings in ((options.plot, PICTURES), (options.animate, (".html",))):
        if path is not None:
            check_picture(path, endings)
    motion = _motion(source, options)
    if options.ensemble is not None or options.grid:
        _ensemble(motion, options)
        return
    if options.spread:
        raise click.UsageError("--spread is for ensembles; expected --ensemble or --grid as well")
    initial, constants, t_end = _given(motion, options)
    with bar(motion.name) as progress:
        found = motion.simulate(
            initial,
            constants,
            t_end,
            samples=options.samples or 1001,
            method=options.method,
            progress=progress,
        )
    _reported(found, options.out)
    if options.plot is not None:
        click.echo(found.plot(options.plot))
    if options.animate is not None:
        click.echo(_animated(motion, found, constants, options.animate))
    _check_end(found)


def _motion(source: str, options: SimulationOptions) -> Motion:
    """The rotation with the quantities that a simulation needs, or with all for a page."""
    spec = read(source)
    is_page = options.animate is not None
    if spec.dynamics is None:
        raise ModelError(
            f"{source} has no equations of motion; expected a derivation file with [body] and "
            "[dynamics], or a shipped one such as heavy_symmetric_top (`rigidsym list`)"
        )
    if len(spec.models) == 1 and not is_page:
        spec = replace(spec, quantities=NEEDED)
    motion = motion_of(spec)
    if is_page:
        from rigidsym.page.print_page import check_shown

        check_shown(motion)  # before minutes of simulation
    return motion


def _animated(
    motion: Motion, found: Trajectory, constants: Mapping[str, float], path: Path
) -> Path:
    """The live page, which begins as the motion does."""
    start = dict(constants)
    for k, name in enumerate(found.coordinates):
        start |= {name: found.q[0, k], f"{name}_dot": found.q_dot[0, k]}
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(motion.page(start=start), encoding="utf-8")
    return path


def _ensemble(motion: Motion, options: SimulationOptions) -> None:
    """Motions over a grid, or with normally distributed initial values and parameters."""
    if options.plot is not None or options.animate is not None:
        raise click.UsageError("--plot and --animate show one motion, not an ensemble")
    if options.method != METHODS[0]:
        raise click.UsageError("an ensemble has its own integrator; leave --method out")
    if options.grid and options.ensemble is not None:
        raise click.UsageError("expected --grid or --ensemble, not both")
    if options.ensemble is not None and not options.spread:
        raise click.UsageError(
            f"--ensemble {options.ensemble}: all motions would be the same; expected "
            "--spread NAME=NUMBER, the standard deviation of what varies"
        )
    generator = np.random.default_rng(options.seed)
    initial, constants, t_end = _given(motion, options)
    names = {name for each in motion.arguments if each.name == "parameters" for name in each.names}
    for name, values in options.grid.items():
        (constants if name in names else initial)[name] = values
    count = options.ensemble or len(next(iter(options.grid.values())))
    for name, deviation in options.spread:
        known = constants if name in names else initial
        if name not in known:
            raise click.UsageError(
                f"--spread {name}: expected its mean as well, by --initial or --set"
            )
        if not 0 <= deviation < np.inf:
            raise click.UsageError(
                f"--spread {name}={deviation:g}: expected a standard deviation, 0 or more"
            )
        known[name] = generator.normal(known[name], deviation, count)
    first = motion.argument("q").names[0]
    initial[first] = np.broadcast_to(initial.get(first, 0.0), count)
    with bar(motion.name) as progress:
        found = motion.simulate_many(
            initial,
            constants,
            t_end,
            samples=options.samples or 101,
            progress=progress,
        )
    _reported(found, options.out)
    _check_end(found)


def _check_end(found: Trajectory | Ensemble) -> None:
    """What was computed is written before. Raises DerivationError if that is not all."""
    if found.ended:
        raise DerivationError(f"{found.name}: {found.ended}")


def _reported(found: Trajectory | Ensemble, out: Path | None) -> None:
    click.echo(found.report())
    if out is None:
        return
    columns = found.columns()
    if out.suffix == _ARCHIVE:
        others = ("t", "states", "rotation_matrix")  # arrays of more axes than a table has
        whole: dict[str, Any] = {n: getattr(found, n) for n in others if hasattr(found, n)}
        with whole_file(out) as file:
            np.savez(file, **columns | whole)
    else:
        rows = np.column_stack([*columns.values()])
        write_table(out, tuple(columns), rows.dtype, [(rows, ())])
    click.echo(out)


def _given(
    motion: Motion, options: SimulationOptions
) -> tuple[dict[str, Any], dict[str, Any], float]:
    """Initial values, constants and time; without them those of the first example of the file."""
    examples = motion.forces.examples if motion.forces else ()
    example = examples[0] if examples else Example({}, {}, 10.0)
    return (
        dict(options.initial or example.initial),
        {**example.parameters, **dict(options.constants)},
        example.time if options.t_end is None else options.t_end,
    )
