"""`rigidsym simulate`: a motion from its equations, with the drift of its first integrals."""

from __future__ import annotations

import reprlib
from contextlib import suppress
from dataclasses import replace
from typing import Any

import click
import numpy as np

from rigidsym.commands.command import command as make
from rigidsym.data.tables import check_ending, write_table
from rigidsym.errors import DerivationError, ExpressionError, ModelError, nearest
from rigidsym.models.forces import Example
from rigidsym.motion import Motion
from rigidsym.pipeline import motion_of, read
from rigidsym.simulation.problem import needed
from rigidsym.simulation.solver import METHODS
from rigidsym.system.files import write_text
from rigidsym.system.processes import bar
from rigidsym.system.resources import names


@make("simulate", method=METHODS)
def command(source: str, **options: Any) -> None:
    """Simulate the motion that a derivation file with [dynamics] describes."""
    out, animate = options["out"], options["animate"]
    if out is not None:
        check_ending(out)
    if animate is not None and animate.suffix != ".html":
        raise ModelError(f"{animate}: expected a file that ends in .html")
    motion = _motion(source, is_page=animate is not None)
    examples = motion.forces.examples if motion.forces else ()
    example = next(iter(examples), Example({}, {}, 10.0))
    initial = options["initial"] or dict(example.initial)
    constants = {**example.parameters, **options["set"]}
    t_end = example.time if options["time"] is None else options["time"]
    with bar(motion.name) as progress:
        how = {key: options[key] for key in ("samples", "method")}
        result = motion.simulate(initial, constants, t_end, progress=progress, **how)
    click.echo(replace(result, ended="").report())  # the error at the end says it
    if out is not None:
        columns = result.columns()
        write_table(out, tuple(columns), [(np.column_stack([*columns.values()]), ())])
        click.echo(out)
    if animate is not None:
        start = dict(constants)
        for k, name in enumerate(result.coordinates):
            start |= {name: result.q[0, k], f"{name}_dot": result.q_dot[0, k]}
        click.echo(write_text(animate, motion.page(start=start)))
    if result.ended:  # what was computed is written before
        raise DerivationError(f"{result.name}: {result.ended}")


def _motion(source: str, *, is_page: bool) -> Motion:
    """The rotation with the quantities that a simulation needs, or with all for a page."""
    spec = None
    with suppress(ModelError, ExpressionError):  # neither a file nor a rotation
        spec = read(source)
    if spec is None or spec.dynamics is None:
        near = nearest(source, [n for n in names("derivations", ".toml") if read(n).dynamics])
        example = ", or a shipped one such as heavy_symmetric_top (`rigidsym list`)"
        hint = f"; did you mean {' or '.join(near)}?" if near else example
        raise ModelError(
            f"{reprlib.repr(source)} has no equations of motion; expected a derivation file with "
            f"[body] and [dynamics]{hint}"
        )
    if len(spec.models) == 1 and not is_page:
        spec = replace(spec, quantities=needed(spec.dynamics.get("parts")))
    motion = motion_of(spec)
    if is_page:
        from rigidsym.page.print_page import check_shown

        check_shown(motion)  # before minutes of simulation
    return motion
