"""`rigidsym compare`: is this formula right?"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from operator import itemgetter
from pathlib import Path
from typing import Any
from urllib.parse import quote

import click

from rigidsym.commands.command import Options, command as make, message, of_rotation
from rigidsym.data.columns import counted
from rigidsym.errors import DataError
from rigidsym.motion import Motion, derive
from rigidsym.pipeline import motion_of, read
from rigidsym.system.files import read_bytes
from rigidsym.system.processes import in_processes
from rigidsym.system.resources import environment
from rigidsym.tools.compare.comparison import compare
from rigidsym.tools.compare.search import disappointment, search, source_files
from rigidsym.version import __version__


@make("compare")
@click.pass_context
def command(context: click.Context, /, paths: tuple[Path, ...], **options: Any) -> None:
    """Check the formula TEXT, or all formulas in source files."""
    formula = options["formula"]
    if (formula is None) == (not paths):
        raise click.UsageError("expected --formula TEXT, or paths")
    motion = _motion(options)
    if formula is not None:
        result = compare(formula, motion, options["quantity"])
        click.echo(result.text() if options["format"] == "text" else _json(result.record()))
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
                "a formula is compared with --quantity NAME of --rotation NAME, or without either"
            )
        return None
    spec = read(rotation, **spelling)
    is_name = not spelling and spec.body is None and not rotation.endswith(".toml")
    return str(rotation) if is_name else motion_of(replace(spec, quantities=(quantity,)))


def _searched(paths: Sequence[Path], options: Options) -> int:
    """Print the formulas in source files, and return the exit code.

    It is 1 if a formula is wrong or too few were recognised, or else 3 if reading a file failed.
    """
    baseline: Path | None = options["baseline"]
    accepted = _faults(baseline) if baseline else []
    files = list(source_files(paths))
    records: list[dict[str, Any]] = []
    unreadable, cut, has_failed = 0, 0, False
    work = partial(_records, options["expect"], options["expect_active"])
    done = 0
    try:
        for done, own in enumerate(in_processes(work, files), 1):  # noqa: B007 (below)
            for record in own:
                is_failure, is_end = record.pop("is_failure"), record.pop("is_end")
                has_failed |= is_failure
                cut += is_end
                if record.pop("is_unreadable"):
                    unreadable += not is_end
                    if options["why"] or is_failure or is_end:
                        message(_line(record))
                    continue
                same = [each for each in accepted if record["fault"] and _key(each) == _key(record)]
                record["accepted"] = bool(same)
                for old in same[:1]:  # a copy of an accepted fault is another fault
                    accepted.remove(old)
                records.append(record)
                if options["format"] == "text" and not record["accepted"]:
                    click.echo(_line(record))
    finally:  # also if the time is up
        if options["format"] == "json":
            left = [{"path": str(p), "fault": False, "text": "not compared"} for p in files[done:]]
            click.echo(_json([*records, *left]))
    faults = [record for record in records if record["fault"] and not record["accepted"]]
    if options["format"] in ("sarif", "github"):
        here = Path.cwd()
        for record in faults:  # GitHub expects paths below this folder, if they are
            path = Path(record["path"])
            record["path"] = path.relative_to(here) if path.is_relative_to(here) else path
            record["uri"] = quote(record["path"].as_posix())
        template = environment().get_template(f"compare/{options['format']}.jinja")
        click.echo(template.render(faults=faults, version=__version__), nl=False)
    if baseline:
        count = sum(record["accepted"] for record in records)
        message(f"{counted(count, 'fault')} accepted by {baseline}")
        for old in accepted:
            if (path := Path(old["path"])) in files or not path.exists():
                message(f"{baseline}: no longer found: {_line(old)}")
    count = counted(len(records), "formula") if records else "no known formula"
    rest = f", {cut} not compared to the end" if cut else ""
    rest += f", {unreadable} not readable" if unreadable else ""
    hint = "; --why lists them" if unreadable and not options["why"] else ""
    message(f"{count} in {counted(len(files), 'file')}{rest}{hint}")
    if len(records) < options["require"]:
        message(f"expected at least {options['require']} (--require)")
    return 1 if faults or len(records) < options["require"] else 3 * has_failed


def _records(expected: str | None, is_active: bool, file: Path) -> list[dict[str, Any]]:
    """The formulas of a file: where they are, what they are, and whether that is a fault."""
    records, model = [], expected is not None and derive(expected, "rotation_matrix").model
    order = " ".join(turn.axis for turn in model.turns) if model else ""
    for formula in search(file, (order,) if order else ()):
        record, comparison = formula.record(), formula.comparison
        other = disappointment(comparison, order, is_active=is_active) if comparison else ""
        record |= {"unexpected": other or None, "is_unreadable": comparison is None}
        record |= {"is_failure": formula.is_failure, "is_end": formula.formula.is_end}
        record["text"] = f"{formula.text}; {other}" if other else formula.text
        record["fault"] = bool(other or (comparison and comparison.is_wrong))
        records.append(record)
    return records


_KEYS = ("path", "name", "formula", "unexpected")  # what a fault keeps if lines are added above it
_key = itemgetter(*_KEYS)
_line = "{path}:{line}: {text}".format_map
_json = partial(json.dumps, indent=1, ensure_ascii=False)


def _faults(baseline: Path) -> list[dict[str, Any]]:
    """The faults in an earlier result; raises DataError for another file."""
    try:
        # a slice, so that no object is taken for a list
        faults = [each for each in json.loads(read_bytes(baseline))[:] if each["fault"]]
        is_old = any({*_KEYS, "line", "text"} - {*record} for record in faults)
    except (ValueError, KeyError, TypeError) as error:
        what = f"not JSON: {error}" if isinstance(error, ValueError) else "another JSON file"
        raise DataError(
            f"{baseline}: {what}; expected a result of `rigidsym compare --format json`"
        ) from None
    if is_old:
        raise DataError(f"{baseline}: made by an earlier version; write it again")
    return faults
