"""`rigidsym check`: generated files against a fresh derivation, by their record."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import zip_longest
from pathlib import Path

import click

from rigidsym.commands.command import command as make, with_options
from rigidsym.commands.options import TemplateOptions
from rigidsym.commands.output_folder import CERTIFICATE, CERTIFICATES, content_of, printed
from rigidsym.errors import CheckError
from rigidsym.notes.formats.record import SCHEMA, SCHEMA_VERSION
from rigidsym.pipeline import read_record
from rigidsym.system.files import read_bytes
from rigidsym.tools.certificate import certificate
from rigidsym.tools.certificate.checker import BROKEN, Refused, Unreadable, load, printed_in, verify


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
    files = path.rglob("*.json") if path.is_dir() else [_record_of(path)]
    found = sorted({_record_of(file) for file in files if _is_ours(file)})
    if not found and path.suffix == ".json" and not content_of(path):
        found = [path]  # it was named, and so it is damaged
    if not found:
        raise CheckError(
            f"{path}: no record of a derivation here; expected NAME.json beside generated files"
        )
    return found


def _record_of(file: Path) -> Path:
    """NAME.json beside NAME.cert.json, NAME.d.mts and other files."""
    return file.with_name(file.name.partition(".")[0] + ".json")


def _is_ours(file: Path) -> bool:
    """Whether this is a record, a certificate, or NAME/NAME.json that cannot be read."""
    content = content_of(file)
    is_damaged = (
        file.is_file() and not content and file.stem == file.parent.name and bool(_damage(file))
    )
    return is_damaged or content.get("schema") in (SCHEMA, certificate.SCHEMA)


def _damage(record: Path) -> str:
    """Why a record cannot be read; empty for another file in JSON."""
    if not record.exists():
        return "missing"
    try:
        json.loads(read_bytes(record).decode("utf-8"))
    except OSError as error:
        why = str(error.strerror)
    except json.JSONDecodeError as error:
        at = f"it is not valid JSON, at line {error.lineno}; derive it again"
        why = at if error.doc.strip() else "it is empty; derive it again"
    except (ValueError, RecursionError):
        why = "it is not valid JSON; derive it again"
    else:
        return ""
    return f"cannot be read: {why}"


def _compare(record: Path) -> Iterator[Finding]:
    content = content_of(record)
    version = content.get("schema_version")
    if not content:
        yield Finding(path=record, problem=_damage(record) or "not a record")
        return
    if version != SCHEMA_VERSION:
        yield Finding(path=record, problem=f"schema version {version}, expected {SCHEMA_VERSION}")
        return
    fresh = printed(read_record(content.get("request"), source=str(record)))
    for name, text in fresh.files.items():
        finding = finding_of(record.parent / name, text)
        yield _certified(finding, record) if name.endswith(CERTIFICATE) else finding
    for file in map(record.with_suffix, (f".{ending}" for ending in CERTIFICATES)):
        if file.name not in fresh.files and file.exists():
            yield Finding(
                path=file, problem=f"unknown to {record.name}: derive again with --certificates"
            )


def _certified(finding: Finding, record: Path) -> Finding:
    """What the independent checker says of a certificate that is there, and what it leaves out."""
    if not finding.path.is_file():
        return finding
    try:
        content = load(record)
        proved, printed = verify(content, load(finding.path)), printed_in(content)
    except (Refused, Unreadable) as error:
        return replace(finding, problem=f"refused: {error}")
    except BROKEN:
        return replace(finding, problem="refused: no certificate of what is printed")
    rest = [name for name in printed if name not in proved]
    note = f"\n  proved: {', '.join(proved)}\n  not covered: {', '.join(rest) or 'nothing'}"
    return replace(finding, note=note)


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
