"""The folder of a derivation: one record describes all files in it."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

from rigidsym.commands.command import message
from rigidsym.errors import EditedFiles, SpecError
from rigidsym.kernels.targets import TARGETS
from rigidsym.pipeline import (
    PAGE,
    PDF,
    Output,
    digest,
    note_formats,
    output_of,
    page_name,
    read_record,
)
from rigidsym.spec.derivation_spec import DerivationSpec
from rigidsym.system.files import locked, read_bytes, write_text

CERTIFICATE = "cert.json"
CERTIFICATES = (CERTIFICATE, "v")  # NAME.v is for Coq


def printed(spec: DerivationSpec) -> Output:
    """Stages 2 and 3, with the certificates of the record if the specification asks for them."""
    output = output_of(spec)
    if not spec.certificates:
        return output
    from rigidsym.tools.certificate import certificate, formal  # few derivations ask for one

    record = json.loads(output.record_text)
    proved = certificate.certificate_of(record)
    texts = zip(CERTIFICATES, (proved.json, formal.coq(record, proved.claims)), strict=True)
    files = {f"{output.name}.{ending}": text for ending, text in texts}
    return output.joined_by({**files, formal.DEFINITIONS: formal.definitions()})


def with_existing_files(spec: DerivationSpec, out: Path) -> DerivationSpec:
    """The specification of one rotation, with what out/NAME/ already has of the same derivation.

    Other targets and notes of an earlier run are printed again with the rest, so that one record
    describes all of them and `rigidsym check` sees them.
    """
    folder = out / spec.name
    before = _spec_there(folder)
    if before is None or not _is_same(before, spec):
        return spec
    kept = set(_kept(_outputs(before), spec, folder))
    return replace(
        spec,
        kernels=(*spec.kernels, *(name for name in before.kernels if name in kept)),
        note=(*spec.note, *(name for name in before.note if name in kept)),
        certificates=spec.certificates or CERTIFICATE in kept,
    )


def write(output: Output, out: Path, *, force: bool) -> list[Path]:
    """Write the files of a derivation to out/NAME/, the record last.

    Each file is whole or as it was before; another process that writes there is waited for.
    Raises EditedFiles, before anything is written, for files that were edited since, unless
    `force` is set.
    """
    folder = out / output.spec.name
    with locked(folder):
        if not force and (edited := _edited(output, folder)):
            raise EditedFiles(
                f"{', '.join(map(str, edited))} changed since it was generated; use --force to "
                "overwrite it, or --out for another folder"
            )
        _report_other_files(output, folder)
        if PDF not in output.spec.note:
            report_old_pdf(folder / f"{folder.name}.tex", output.files.get(f"{folder.name}.tex"))
        return [write_text(folder / name, text) for name, text in output.files.items()]


def _edited(output: Output, folder: Path) -> list[Path]:
    """The files that are neither as the record there describes them nor as they will be."""
    known = content_of(folder / f"{folder.name}.json").get("files")
    found = []
    for name, text in output.files.items():
        path = folder / name
        if isinstance(known, dict) and name in known and path.is_file():
            content = path.read_bytes()
            if digest(content) != known[name] and content != text.encode():
                found.append(path)
    return found


def _report_other_files(output: Output, folder: Path) -> None:
    """A message on standard error if the folder holds another derivation."""
    before, now = _spec_there(folder), output.spec
    if before is None or _is_same(before, now):
        return
    if before.models != now.models:
        (one,), (other,) = before.models, now.models
        what = "a different rotation"
        if len(one.coordinates) == len(other.coordinates):
            renamed = dict(zip(one.coordinates, other.coordinates, strict=True))
            if one.matrix.xreplace(renamed) == other.matrix:
                names = ", ".join(q.func.__name__ for q in one.coordinates)
                what = f"the same rotation with the coordinates {names}"
        message(f"overwriting {folder}, which held {what} (use --out to keep both)")
    left = list(_kept(_outputs(before), now, folder))
    if CERTIFICATE in left:
        left.remove(CERTIFICATE)
        message(
            f"{folder} keeps certificates of another derivation, which `check` refuses; delete "
            "them, or derive with --certificates"
        )
    if left:
        message(
            f"{folder} still contains {', '.join(left)} from an earlier run, which `check` will "
            "ignore"
        )


def report_old_pdf(source: Path, text: str | None) -> None:
    """A message on standard error if the TeX file of a PDF is about to change, and not the PDF."""
    pdf = source.with_suffix(".pdf")
    if text is None or not (pdf.is_file() and source.is_file()):
        return
    if source.read_bytes() != text.encode():
        message(f"{pdf} is of an earlier run; use --pdf to typeset it again, or delete it")


def _is_same(before: DerivationSpec, now: DerivationSpec) -> bool:
    """Whether two specifications differ at most in the files they print."""
    as_now = {key: getattr(now, key) for key in ("kernels", "note", "certificates")}
    return replace(before, **as_now) == now


def _spec_there(folder: Path) -> DerivationSpec | None:
    """The specification in the record of a folder; None without a record that can be read."""
    request = content_of(folder / f"{folder.name}.json").get("request")
    try:
        return None if request is None else read_record(request)
    except SpecError:
        return None


def content_of(record: Path) -> dict[str, Any]:
    """The object in a JSON file; empty without one that can be read."""
    try:
        content = json.loads(read_bytes(record).decode("utf-8"))
    except (OSError, ValueError, RecursionError):
        return {}
    return content if isinstance(content, dict) else {}


def _kept(outputs: Iterable[str], now: DerivationSpec, folder: Path) -> Iterator[str]:
    """Outputs that are there and not asked for; a PDF is never compared."""
    written = {_file(output, folder) for output in _outputs(now)}
    for output in outputs:
        file = _file(output, folder)
        if output != PDF and file not in written and file.is_file():
            yield output


def _outputs(spec: DerivationSpec) -> tuple[str, ...]:
    return (*spec.kernels, *spec.note, *(CERTIFICATE,) * spec.certificates)


def _file(output: str, folder: Path) -> Path:
    """The main file of a target, a format or the certificates."""
    name = folder.name
    if output == CERTIFICATE:
        return folder / f"{name}.{CERTIFICATE}"
    if output in TARGETS:
        return folder / f"{name}{TARGETS[output].ending}"
    assert output in note_formats()
    return folder / (page_name(name) if output == PAGE else f"{name}.{output}")
