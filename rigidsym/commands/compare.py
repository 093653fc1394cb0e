"""`rigidsym compare`: is this formula right?"""

from __future__ import annotations

import json
from dataclasses import dataclass, replace

import click

from rigidsym.commands.command import command as make, option, with_options
from rigidsym.commands.options import RotationOptions
from rigidsym.motion import Motion
from rigidsym.pipeline import motion_of, read
from rigidsym.tools.compare.comparison import compare


@dataclass(frozen=True, kw_only=True)
class CompareOptions(RotationOptions):
    """All options of `compare`."""

    rotation: str | None = option(
        "--rotation", metavar="ROTATION", help="As for `derive`, or a derivation file."
    )
    quantity: str | None = option(
        "--quantity", metavar="NAME", help="What FORMULA should be; `rigidsym list` shows names."
    )
    as_json: bool = option("--json", is_flag=True, help="Print the results as JSON.")

    def motion(self) -> Motion | str | None:
        """The rotation to compare with, with the quantity derived."""
        given = self.of_rotation()
        if self.rotation is None or self.quantity is None:
            if given or self.rotation or self.quantity:
                raise click.UsageError("--rotation and --quantity belong together")
            return None
        spec = read(self.rotation, **given)
        plain = not given and spec.body is None and not spec.dynamics
        is_name = plain and not self.rotation.endswith(".toml")
        return self.rotation if is_name else motion_of(replace(spec, quantities=(self.quantity,)))


@make(
    "rigidsym compare --rotation xyz --quantity rate_matrix_body "
    "'[1 0 -sin(theta); 0 cos(phi) sin(phi)*cos(theta); 0 sin(phi) cos(phi)*cos(theta)]'"
)
@click.argument("formula")
@with_options(CompareOptions)
@click.pass_context
def command(context: click.Context, formula: str, options: CompareOptions) -> None:
    """Compare FORMULA with a quantity of a rotation, or with all known conventions.

    FORMULA is a matrix or vector in Python, SymPy, C, MATLAB or LaTeX; its text is read, never
    run. If it is wrong, the smallest repair is named: a sign, a transpose, sine for cosine, another
    angle or frame, the order of turns, a missing square. Every answer is proved. The exit code is 1
    if the formula is wrong or unknown.
    """
    found = compare(formula, options.motion(), options.quantity)
    text = json.dumps(found.record(), indent=1, ensure_ascii=False)
    click.echo(text if options.as_json else found.text())
    if not found.is_equal:
        context.exit(1)
