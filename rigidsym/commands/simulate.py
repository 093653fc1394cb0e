"""`rigidsym simulate`: a motion from its equations, with the drift of its first integrals."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
import numpy as np

from rigidsym.commands.command import command as make, file, numbers
from rigidsym.data.tables import check_ending, write_table
from rigidsym.errors import DerivationError, ModelError
from rigidsym.models.forces import Example
from rigidsym.motion import Motion
from rigidsym.pipeline import motion_of, read
from rigidsym.simulation.problem import NEEDED
from rigidsym.simulation.solver import METHODS
from rigidsym.simulation.trajectory import PICTURES, check_picture
from rigidsym.system.files import whole_file, write_text
from rigidsym.system.processes import bar

if TYPE_CHECKING:
    from rigidsym.simulation.trajectory import Trajectory

_ARCHIVE = ".npz"


@make(
    "rigidsym simulate heavy_symmetric_top --set A=1 --set C=0.5 --set m=1\n"
    "         --set g=9.81 --set l=0.5 --initial theta=0.5 --initial psi_dot=20 --time 5",
    numbers(
        "--set",
        "constants",
        help="Value of a parameter.  [default: from the first example of the file]",
    ),
    numbers(
        "--initial",
        help="Initial value of a coordinate, a rate, or, instead of the rates, "
        "angular_velocity_body_1, _2 or _3. The others are 0.  [default: from the first example "
        "of the file, else R = 1 and at rest]",
    ),
    click.option(
        "--time",
        "t_end",
        type=float,
        metavar="SECONDS",
        help="Duration.  [default: from the first example of the file, else 10]",
    ),
    click.option(
        "--method",
        type=click.Choice(METHODS),
        default=METHODS[0],
        show_default=True,
        help="Integrator; exact is for free bodies.",
    ),
    click.option(
        "--samples",
        type=click.IntRange(2),
        default=1001,
        show_default=True,
        help="Number of output times.",
    ),
    file("--out", help="Write the motion: .csv, .npy, .npz or .parquet."),
    file("--plot", help="Draw the motion: .png, .svg or .pdf."),
    file("--animate", help="Write a live page of the motion: .html."),
)
@click.argument("source", metavar="NAME|FILE")
def command(source: str, **options: Any) -> None:
    """Simulate the motion that a derivation file with [dynamics] describes.

    NAME is a shipped derivation such as heavy_symmetric_top. The report shows how far each first
    integral drifts. If the integration stops early, the motion up to that time is written, and the
    exit code is 1.
    """
    out, plot, animate = (options[name] for name in ("out", "plot", "animate"))
    if out is not None:
        check_ending(out, _ARCHIVE)
    for path, endings in ((plot, PICTURES), (animate, (".html",))):
        if path is not None:
            check_picture(path, endings)
    motion = _motion(source, is_page=animate is not None)
    examples = motion.forces.examples if motion.forces else ()
    example = examples[0] if examples else Example({}, {}, 10.0)
    initial = dict(options["initial"] or example.initial)
    constants = {**example.parameters, **dict(options["constants"])}
    t_end = example.time if options["t_end"] is None else options["t_end"]
    with bar(motion.name) as progress:
        result = motion.simulate(
            initial,
            constants,
            t_end,
            samples=options["samples"],
            method=options["method"],
            progress=progress,
        )
    click.echo(result.report())
    if out is not None:
        _write(result, out)
    if plot is not None:
        click.echo(result.plot(plot))
    if animate is not None:
        start = dict(constants)
        for k, name in enumerate(result.coordinates):
            start |= {name: result.q[0, k], f"{name}_dot": result.q_dot[0, k]}
        click.echo(write_text(animate, motion.page(start=start)))
    if result.ended:  # what was computed is written before
        raise DerivationError(f"{result.name}: {result.ended}")


def _motion(source: str, *, is_page: bool) -> Motion:
    """The rotation with the quantities that a simulation needs, or with all for a page."""
    spec = read(source)
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


def _write(result: Trajectory, out: Path) -> None:
    """The times and states in a table, or with the rotation matrices in an archive of NumPy."""
    columns = result.columns()
    if out.suffix == _ARCHIVE:
        arrays: dict[str, Any] = {**columns, "rotation_matrix": result.rotation_matrix}
        with whole_file(out) as archive:
            np.savez(archive, **arrays)
    else:
        rows = np.column_stack([*columns.values()])
        write_table(out, tuple(columns), rows.dtype, [(rows, ())])
    click.echo(out)
