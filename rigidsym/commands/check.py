"""`rigidsym check`: generated files against a fresh derivation, by their record."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from itertools import zip_longest
from pathlib import Path
from typing import Any

import click

from rigidsym.commands.command import command as make
from rigidsym.commands.options import TemplateOptions, with_options
from rigidsym.errors import CheckError
from rigidsym.notes.formats.record import SCHEMA, SCHEMA_VERSION
from rigidsym.pipeline import output_of, read_record


@make("rigidsym check out")
@click.argument(
    "paths",
    nargs=-1,
    required=True,
    metavar="PATH...",
    type=click.Path(exists=True, path_type=Path),
)
@with_options(TemplateOptions)
@click.pass_context
def command(context: click.Context, paths: tuple[Path, ...], options: TemplateOptions) -> None:  # noqa: ARG001
    """Compare generated files with a fresh derivation.

    PATH is a generated file or a folder; each record NAME.json says how the files beside it were
    made. The exit code is 1 if a file is missing or differs.
    """
    findings = list(_findings(paths))
    for finding in findings:
        click.echo(str(finding))
    if any(finding.problem for finding in findings):
        context.exit(1)


@dataclass(frozen=True, kw_only=True, slots=True)
class Finding:
    """The state of one file."""

    path: Path
    problem: str = ""  # "" if it is as derived

    def __str__(self) -> str:
        return f"{self.path}: {self.problem or 'up to date'}"


def _findings(paths: Iterable[Path]) -> Iterator[Finding]:
    """One finding for each file that a record under the paths describes.

    Raises CheckError for a path without a record.
    """
    for path in paths:
        for record in _records(path):
            yield from _compare(record)


def _records(path: Path) -> list[Path]:
    """The records in a folder and below it, or beside one generated file."""
    if path.is_dir():
        found = sorted(file for file in path.rglob("*.json") if _is_record(file))
    else:
        beside = path.with_suffix(".json")
        found = [beside] if beside.is_file() and _is_record(beside) else []
    if not found:
        raise CheckError(
            f"{path}: no record of a derivation here; expected NAME.json beside generated files"
        )
    return found


def _is_record(file: Path) -> bool:
    return _read(file).get("schema") == SCHEMA


def _read(file: Path) -> Mapping[str, Any]:
    """The object in a JSON file; empty if there is none."""
    try:
        content = json.loads(file.read_text(encoding="utf-8"))
    except (ValueError, RecursionError):
        return {}
    return content if isinstance(content, dict) else {}


def _compare(record: Path) -> Iterator[Finding]:
    content = _read(record)
    version = content.get("schema_version")
    if version != SCHEMA_VERSION:
        yield Finding(path=record, problem=f"schema version {version}, expected {SCHEMA_VERSION}")
        return
    fresh = output_of(read_record(content.get("request"), source=str(record)))
    for name, text in fresh.files.items():
        yield _finding(record.parent / name, text)


def _finding(path: Path, expected: str) -> Finding:
    if not path.is_file():
        return Finding(path=path, problem="missing")
    found = path.read_bytes()
    if found == expected.encode("utf-8"):
        return Finding(path=path)
    lines = zip_longest(found.decode("utf-8", "replace").split("\n"), expected.split("\n"))
    line = next((place for place, (a, b) in enumerate(lines, start=1) if a != b), 1)
    return Finding(path=path, problem=f"differs from the derivation at line {line}")
