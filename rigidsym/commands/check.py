"""`rigidsym check`: generated files against a fresh derivation, by their record."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import zip_longest
from pathlib import Path

import click

from rigidsym.commands.command import command as make, with_options
from rigidsym.commands.options import TemplateOptions
from rigidsym.commands.output_folder import content_of
from rigidsym.errors import CheckError
from rigidsym.notes.formats.record import SCHEMA, SCHEMA_VERSION
from rigidsym.pipeline import output_of, read_record
from rigidsym.tools.certificate.certificate import printed_names
from rigidsym.tools.certificate.checker import BROKEN, verify


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
    records = [record for path in paths for record in _records(path)]
    findings = [finding for record in records for finding in _compare(record)]
    for finding in findings:
        click.echo(str(finding))
    if any(finding.problem for finding in findings):
        context.exit(1)


@dataclass(frozen=True, kw_only=True, slots=True)
class Finding:
    """The state of one file."""

    path: Path
    problem: str = ""  # "" if it is as derived
    note: str = ""

    def __str__(self) -> str:
        return f"{self.path}: {self.problem or 'up to date'}{self.note}"


def _records(path: Path) -> list[Path]:
    """The records in a folder and below it, or beside one generated file.

    Raises CheckError if there is none.
    """
    files = sorted(path.rglob("*.json")) if path.is_dir() else [path.with_suffix(".json")]
    found = [file for file in files if content_of(file).get("schema") == SCHEMA]
    if not found:
        raise CheckError(
            f"{path}: no record of a derivation here; expected NAME.json beside generated files"
        )
    return found


def _compare(record: Path) -> Iterator[Finding]:
    content = content_of(record)
    version = content.get("schema_version")
    if version != SCHEMA_VERSION:
        yield Finding(path=record, problem=f"schema version {version}, expected {SCHEMA_VERSION}")
        return
    fresh = output_of(read_record(content.get("request"), source=str(record)))
    for name, text in fresh.files.items():
        yield finding_of(record.parent / name, text)
    certificate = record.with_suffix(".cert.json")
    if certificate.is_file():
        yield _certified(certificate, record)


def _certified(path: Path, record: Path) -> Finding:
    """What the independent checker says of a certificate, and what it does not cover."""
    content = content_of(record)
    try:
        proved = verify(content, content_of(path))
    except BROKEN as error:
        return Finding(path=path, problem=f"refused: {error}")
    rest = [name for name in printed_names(content) if name not in proved]
    note = f"\n  proved: {', '.join(proved)}\n  not covered: {', '.join(rest) or 'nothing'}"
    return Finding(path=path, note=note)


def finding_of(path: Path, expected: str) -> Finding:
    """What is wrong with one file; nothing if its bytes are those expected."""
    if not path.is_file():
        return Finding(path=path, problem="missing")
    found = path.read_bytes()
    if found == expected.encode("utf-8"):
        return Finding(path=path)
    lines = zip_longest(found.decode("utf-8", "replace").split("\n"), expected.split("\n"))
    line = next((place for place, (a, b) in enumerate(lines, start=1) if a != b), 1)
    return Finding(path=path, problem=f"differs from the derivation at line {line}")
