"""`rigidsym check`: generated files against a fresh derivation, by their record."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import chain
from pathlib import Path

import click

from rigidsym.commands.command import command as make
from rigidsym.commands.output_folder import CERTIFICATE, content_of, printed
from rigidsym.errors import CheckError, SpecError, printable
from rigidsym.mechanics.derivation import remark
from rigidsym.notes.formats.record import SCHEMA, SCHEMA_VERSION
from rigidsym.spec.derivation_file import read_record
from rigidsym.tools.certificate.checker import BROKEN, load, reason, verify


@make("check")
@click.pass_context
def command(context: click.Context, paths: tuple[Path, ...]) -> None:
    """Compare generated files with a fresh derivation."""
    records = dict.fromkeys(record for path in paths for record in _records(path))
    is_wrong, derived = False, set[Path]()
    for path, problem, note in chain(*map(_findings, records), _strangers(paths, derived)):
        finding = printable(f"{path}: {problem or 'up to date'}").replace("\n", "\\n")
        click.echo(finding + note)
        derived.add(path)
        is_wrong = is_wrong or bool(problem)
    context.exit(is_wrong)


def _strangers(paths: Iterable[Path], derived: set[Path]) -> Iterator[tuple[Path, str, str]]:
    """Files that no record derives: those named, and theorems, which may prove something else."""
    beside = {file.parent for file in derived}  # elsewhere, a .v may be of another language
    folders = [path.rglob if path.is_dir() else path.parent.glob for path in paths]
    # Coq would load this Reals.vo instead of its own
    endings = [f".{CERTIFICATE}{end}" for end in ("", "o", "ok", "os", "io")]
    near = (p for files in folders for e in endings for p in files(f"*{e}") if p.parent in beside)
    for path in sorted({*filter(Path.is_file, paths), *near}):
        # coqc writes no .vio, but loads a newer Rotation.vio instead of the Rotation.vo it wrote
        is_theorem = path.suffix in endings[:-1] and path.with_suffix(endings[0]) in derived
        if path not in derived and not is_theorem:
            yield path, remark("no_record_of_file"), ""


def _records(path: Path) -> list[Path]:
    """The records in a folder and below it, or the record beside one file.

    Raises CheckError if there is none.
    """
    if path.is_dir():
        files = sorted(filter(_is_record, path.rglob("*.[jJ][sS][oO][nN]")))
    else:  # NAME.json is also beside NAME.d.mts
        files = [path.with_name(path.name.partition(".")[0] + ".json")]
    if not any(file.exists() for file in files):
        raise CheckError(f"{path}: no record of a derivation; expected NAME.json beside the files")
    return files


def _is_record(file: Path) -> bool:
    """Whether it claims to be one, even under another schema, which is a fault."""
    content, keys = content_of(file), {"rotation", "quantities"}
    is_like_one = content.get("schema") == SCHEMA or keys <= content.keys()
    return is_like_one or file.stem == file.parent.name


def _findings(record: Path) -> Iterator[tuple[Path, str, str]]:
    """Each file, what is wrong with it, and what its certificate proves."""
    content = content_of(record)
    version = content.get("schema_version") if content.get("schema") == SCHEMA else None
    if version != SCHEMA_VERSION:
        problem = f"its schema version is {version!r}, expected {SCHEMA_VERSION}"
        problem = problem if version else remark("no_record")
        yield record, f"{problem}; derive it again", ""
        return
    try:
        fresh = printed(read_record(content.get("request"), source=str(record)))
    except SpecError as error:  # the other records are checked all the same
        faults = "; ".join(map(str, error.faults))
        yield record, remark("request_not_derived", faults=faults), ""
        return
    if record.name not in fresh.files:
        yield record, remark("record_renamed", name=fresh.name), ""
        return
    for name, text in fresh.files.items():
        path = record.with_name(name)
        is_same = path.is_file() and path.read_bytes() == text.encode("utf-8")
        differs = "differs from the derivation" if path.is_file() else "missing"
        problem, note = "" if is_same else differs, ""
        if name == f"{record.stem}.{CERTIFICATE}" and path.is_file():
            try:
                proved, reasons = verify(load(record))
            except BROKEN as error:
                problem = f"{record.name} is refused: {reason(error)}"
            else:
                is_edited = record.read_bytes() != fresh.files[record.name].encode("utf-8")
                source = f"{record.name}{' as it was edited' * is_edited}"
                note = f"\n  proved in {source}: {', '.join(proved) or 'nothing'}"
                note += "\n  not proved: " + ", ".join([str(len(reasons)), *reasons])
        yield path, problem, note
