"""`rigidsym compare`: is this formula right?"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import click

from rigidsym.commands.command import Options, command as make, flag, message
from rigidsym.commands.options import ROTATION, of_rotation
from rigidsym.data.columns import counted
from rigidsym.errors import DataError
from rigidsym.motion import Motion, derive
from rigidsym.pipeline import motion_of, read
from rigidsym.system.files import read_bytes
from rigidsym.system.resources import environment
from rigidsym.tools.compare.comparison import compare
from rigidsym.tools.compare.search import disappointment, search, source_files


@make(
    'rigidsym compare src/\n         rigidsym compare --formula "[c -s 0; s c 0; 0 0 1]"',
    *ROTATION,
    click.option(
        "--formula", metavar="TEXT", help="A matrix or vector in Python, C, MATLAB or LaTeX."
    ),
    click.option(
        "--rotation", metavar="ROTATION", help="A rotation as for `derive`, or a derivation file."
    ),
    click.option("--quantity", metavar="NAME", help="The quantity that the formula should give."),
    click.option(
        "--expect",
        metavar="ROTATION",
        help='In programs: the order of axes that is meant, such as "z(yaw) y(pitch) x(roll)".',
    ),
    flag("--expect-active", help="In programs: a transposed (passive) rotation matrix is a fault."),
    click.option(
        "--require",
        type=int,
        metavar="N",
        default=0,
        show_default=True,
        help="In programs: fail if fewer formulas are known.",
    ),
    flag("--why", help="In programs: list what could not be read, with the reason."),
    click.option(
        "--format",
        "form",
        type=click.Choice(["text", "json", "sarif", "github"]),
        default="text",
        show_default=True,
        help="Print text, JSON, a SARIF log, or faults as GitHub annotations.",
    ),
    click.option(
        "--baseline",
        metavar="FILE",
        help="In programs: ignore the faults that FILE lists, an earlier result of --format json.",
    ),
)
@click.argument("paths", nargs=-1, type=click.Path(exists=True, path_type=Path))
@click.pass_context
def command(context: click.Context, /, paths: tuple[Path, ...], **options: Any) -> None:
    """Check the formula TEXT, or all formulas in source files.

    The formula TEXT is compared with a quantity of a rotation, or with all known conventions. If
    it is wrong, `compare` names the smallest repair: a sign, a transpose, sine for cosine, another
    angle or frame, the order of turns, a missing square. Answers are proved wherever possible.

    PATHS are files or folders. In Python, C, C++, JavaScript, TypeScript, MATLAB, Rust, Java and
    C#, `compare` finds rotation matrices, rate matrices, quaternions and their products and
    rates, Euler angles, Euler's equations and the parallel-axis theorem. Source code is parsed,
    never run. The exit code is 1 if a formula is wrong or not as expected.
    """
    formula = options["formula"]
    if (formula is None) == (not paths):
        raise click.UsageError("expected --formula TEXT, or paths")
    motion = _motion(options)
    if formula is not None:
        result = compare(formula, motion, options["quantity"])
        click.echo(result.text() if options["form"] == "text" else _json(result.record()))
        context.exit(not result.is_equal)
    if motion is not None:
        raise click.UsageError("--rotation and --quantity need --formula")
    context.exit(_searched(paths, options))


def _motion(options: Options) -> Motion | str | None:
    """The rotation to compare with, with the quantity derived."""
    rotation, quantity = options["rotation"], options["quantity"]
    spelling = of_rotation(options)
    if rotation is None or quantity is None:
        if rotation or quantity or spelling:
            raise click.UsageError(
                "a formula is compared with --quantity NAME of --rotation ROTATION, such as "
                "--rotation ZYX --quantity rotation_matrix; without both, all known "
                "quantities are tried"
            )
        return None
    spec = read(rotation, **spelling)
    is_name = not spelling and spec.body is None and not rotation.endswith(".toml")
    return str(rotation) if is_name else motion_of(replace(spec, quantities=(quantity,)))


def _searched(paths: Sequence[Path], options: Options) -> bool:
    """Print the formulas in source files; whether one is wrong, or too few were recognised."""
    axes = derive(options["expect"], "rotation_matrix").model if options["expect"] else None
    accepted = _accepted(Path(options["baseline"])) if options["baseline"] else ()
    files = list(source_files(paths))
    records: list[dict[str, Any]] = []
    unreadable = 0
    for formula in (formula for file in files for formula in search(file)):
        comparison = formula.comparison
        if comparison is None:
            unreadable += 1
            if options["why"]:
                message(str(formula))
            continue
        other = disappointment(comparison, axes, is_active=options["expect_active"])
        record = formula.record() | {"unexpected": other or None}
        record["text"] = f"{formula}; {other}" if other else str(formula)
        is_right = comparison.is_equal or comparison.is_reflection
        record["fault"] = (bool(other) or not is_right) and _key(record) not in accepted
        records.append(record)
        if options["form"] == "text":
            click.echo(record["text"])
    faults = [record for record in records if record["fault"]]
    if options["form"] == "json":
        click.echo(_json(records))
    elif options["form"] != "text":
        template = environment().get_template(f"compare/{options['form']}.jinja")
        click.echo(template.render(faults=faults), nl=False)
    count = counted(len(records), "formula") if records else "no known formula"
    hint = "" if options["why"] or not unreadable else "; --why lists them"
    message(f"{count} in {counted(len(files), 'file')}, {unreadable} not readable{hint}")
    if len(records) < options["require"]:
        message(f"expected at least {options['require']} (--require)")
    return bool(faults) or len(records) < options["require"]


def _key(record: dict[str, Any]) -> str:
    """What a fault keeps if lines are added above it."""
    return str(record["path"] + record["text"].partition(f":{record['line']}:")[2])


def _accepted(baseline: Path) -> set[str]:
    """The faults in an earlier result; raises DataError for another file."""
    try:
        return {_key(record) for record in json.loads(read_bytes(baseline)) if record["fault"]}
    except (ValueError, KeyError, TypeError) as error:
        expected = "expected a result of `rigidsym compare --format json`"
        raise DataError(f"{baseline}: {expected}") from error


def _json(data: Any) -> str:
    return json.dumps(data, indent=1, ensure_ascii=False)
