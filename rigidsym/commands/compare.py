"""`rigidsym compare`: is this formula right?"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import click

from rigidsym.commands.command import command as make, message, option, with_options
from rigidsym.commands.options import RotationOptions
from rigidsym.data.columns import counted
from rigidsym.motion import Motion, derive
from rigidsym.pipeline import motion_of, read
from rigidsym.system.processes import bar
from rigidsym.tools.compare.comparison import compare
from rigidsym.tools.compare.search import disappointment, search, source_files
from rigidsym.tools.compare.targets import KnownQuantity

_OF_BODY = ("mass_matrix", "coriolis_matrix")


@dataclass(frozen=True, kw_only=True)
class CompareOptions(RotationOptions):
    """All options of `compare`."""

    formula: str | None = option(
        "--formula", metavar="TEXT", help="A matrix or vector in Python, C, MATLAB or LaTeX."
    )
    rotation: str | None = option(
        "--rotation", metavar="ROTATION", help="A rotation as for `derive`, or a derivation file."
    )
    quantity: str | None = option(
        "--quantity", metavar="NAME", help="The quantity that the formula should give."
    )
    expect: str | None = option(
        "--expect",
        metavar="ROTATION",
        help='In programs: the order of axes that is meant, such as "z(yaw) y(pitch) x(roll)".',
    )
    expect_active: bool = option(
        "--expect-active", help="In programs: a transposed (passive) rotation matrix is a fault."
    )
    require: int = option(
        "--require", metavar="N", default=0, help="In programs: fail if fewer formulas are known."
    )
    why: bool = option("--why", help="In programs: list what could not be read, with the reason.")
    github: bool = option("--github", help="In programs: print faults as GitHub annotations.")
    as_json: bool = option("--json", help="Print the results as JSON.")

    def motion(self) -> Motion | str | None:
        """The rotation to compare with, with the quantity derived."""
        given = self.of_rotation()
        if self.rotation is None or self.quantity is None:
            if self.rotation:
                raise click.UsageError(
                    f"--rotation {self.rotation} needs a quantity to compare with, such as "
                    "--quantity rotation_matrix; without both, all known quantities are tried"
                )
            if self.quantity:
                raise click.UsageError(
                    f"--quantity {self.quantity} needs the rotation that it belongs to, such as "
                    "--rotation ZYX; without both, all known quantities are tried"
                )
            if given:
                flag = "--" + next(iter(given)).replace("_", "-")
                raise click.UsageError(f"{flag} needs --rotation and --quantity")
            return None
        spec = read(self.rotation, **given)
        is_name = not given and spec.body is None and not self.rotation.endswith(".toml")
        return self.rotation if is_name else motion_of(replace(spec, quantities=(self.quantity,)))


@make('rigidsym compare src/\n         rigidsym compare --formula "[c -s 0; s c 0; 0 0 1]"')
@click.argument("paths", nargs=-1, type=click.Path(exists=True, path_type=Path))
@with_options(CompareOptions)
@click.pass_context
def command(context: click.Context, paths: tuple[Path, ...], options: CompareOptions) -> None:
    """Check the formula TEXT, or all formulas in source files.

    The formula TEXT is compared with a quantity of a rotation, or with all known conventions. If
    it is wrong, `compare` names the smallest repair: a sign, a transpose, sine for cosine, another
    angle or frame, the order of turns, a missing square. Answers are proved wherever possible.

    PATHS are files or folders. In Python, C, C++, JavaScript, TypeScript, MATLAB, Rust, Java and
    C#, `compare` finds rotation matrices, rate matrices, quaternion kinematics, Euler angles, and
    the mass and Coriolis matrices of quadcopters. Source code is parsed, never run. The exit code
    is 1 if a formula is wrong or not as expected.
    """
    if (options.formula is None) == (not paths):
        raise click.UsageError("expected --formula TEXT, or paths")
    motion = options.motion()
    if options.formula is not None:
        result = compare(options.formula, motion, options.quantity)
        click.echo(_json(result.record()) if options.as_json else result.text())
        context.exit(not result.is_equal)
    if motion is not None:
        raise click.UsageError("--rotation and --quantity need --formula")
    context.exit(_searched(paths, options))


def _searched(paths: Sequence[Path], options: CompareOptions) -> bool:
    """Print the formulas in source files; whether one is wrong, or too few were recognised."""
    body = _quadcopter()
    also = [KnownQuantity(motion=body, rotation=body.name, quantity=name) for name in _OF_BODY]
    axes = derive(options.expect, "rotation_matrix").model if options.expect else None
    files = list(source_files(paths))
    is_wrong, records, unreadable = False, [], 0
    with bar("files") as progress:
        for place, file in enumerate(files):
            for formula in search(file, also):
                comparison = formula.comparison
                if comparison is None:
                    unreadable += 1
                    if options.why:
                        message(str(formula))
                    continue
                fault = disappointment(comparison, axes, is_active=options.expect_active)
                is_fault = bool(fault) or not (comparison.is_equal or comparison.is_reflection)
                is_wrong |= is_fault
                records.append(formula.record() | {"unexpected": fault or None})
                text = f"{formula}; {fault}" if fault else str(formula)
                if options.github and is_fault:
                    where = f"file={formula.path},line={formula.formula.line}"
                    click.echo(f"::error {where}::{text.replace('%', '%25')}")
                elif not options.as_json:
                    click.echo(text)
            if progress is not None:
                progress((place + 1) / len(files))
    if options.as_json:
        click.echo(_json(records))
    count = counted(len(records), "formula") if records else "no known formula"
    hint = "" if options.why or not unreadable else "; --why lists them"
    message(f"{count} in {counted(len(files), 'file')}, {unreadable} not readable{hint}")
    if len(records) < options.require:
        message(f"expected at least {options.require} (--require)")
    return is_wrong or len(records) < options.require


def _quadcopter() -> Motion:
    """The equations of motion of a body, in roll, pitch and yaw."""
    spec = read("quadcopter_attitude")
    model = derive("xyz", "rotation_matrix").model
    return motion_of(replace(spec, models=(model,), quantities=_OF_BODY))


def _json(data: Any) -> str:
    return json.dumps(data, indent=1, ensure_ascii=False)
