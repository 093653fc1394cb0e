"""The folder of a derivation: one record describes all files in it."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from rigidsym.commands.command import message
from rigidsym.errors import EditedFiles, SpecError
from rigidsym.mechanics.derivation import remark
from rigidsym.pipeline import PDF, Output, digest, output_of
from rigidsym.spec.derivation_spec import DerivationSpec
from rigidsym.system.files import read_bytes, write_text

CERTIFICATE = "v"  # NAME.v, theorems for Coq


def printed(spec: DerivationSpec) -> Output:
    """Stages 2 and 3, with the certificates of the record if the specification asks for them."""
    output = output_of(spec)
    if not spec.certificates:
        return output
    from rigidsym.tools.certificate import certificate  # few derivations ask for one

    theorems = certificate.certificate_of(json.loads(output.record_text))
    files = {f"{output.name}.{CERTIFICATE}": theorems.text}
    joined = output.joined_by({**files, certificate.DEFINITIONS: certificate.definitions()})
    return joined._replace(uncovered=tuple(theorems.uncovered))


def with_existing_files(spec: DerivationSpec, out: Path) -> DerivationSpec:
    """The specification of one rotation, with what out/NAME/ already has of the same derivation.

    Other targets and notes of an earlier run are printed again with the rest, so that one record
    describes all of them and `rigidsym check` sees them.
    """
    before = _spec_of(content_of(out / spec.name / f"{spec.name}.json"), spec)
    files = {key: getattr(spec, key) for key in ("kernels", "note", "certificates")}
    if replace(before, **files) != spec:  # more than the files differs
        return spec
    notes = [name for name in before.note if name != PDF]  # it is typeset when it is asked for
    return replace(
        spec,
        kernels=tuple(dict.fromkeys([*spec.kernels, *before.kernels])),
        note=tuple(dict.fromkeys([*spec.note, *notes])),
        certificates=spec.certificates or before.certificates,
    )


def write(spec: DerivationSpec, files: Mapping[str, str], out: Path, *, force: bool) -> list[Path]:
    """Write the files of a derivation to out/NAME/, the record last.

    Each file is whole or as it was before. What an earlier run printed there and this one does not
    is removed, unless it was edited. Raises EditedFiles, before anything is written, for edited
    files that would be overwritten, unless `force` is set.
    """
    folder = out / spec.name
    record = content_of(folder / f"{folder.name}.json")
    digests = record["files"] if isinstance(record.get("files"), dict) else {}
    own = [folder / name for name in digests if Path(name).name == name]  # none elsewhere
    contents = {path: path.read_bytes() for path in own if path.is_file()}
    edited = {path for path, text in contents.items() if digest(text) != digests[path.name]}
    new = {folder / name: text for name, text in files.items()}
    lost = [path for path in edited & new.keys() if contents[path] != new[path].encode()]
    if lost and not force:
        raise EditedFiles(
            f"{', '.join(sorted(map(str, lost)))} changed since it was generated; use --force to "
            "overwrite it, or --out for another folder"
        )
    before = _spec_of(record, spec)
    gone = sorted(contents.keys() - edited - new.keys())
    if before.models != spec.models:
        message(remark("replacing_rotation", folder=folder))
    elif gone:
        message(remark("removing_files", names=", ".join(p.name for p in gone), folder=folder))
    for path in gone:
        path.unlink()
    return [write_text(path, text) for path, text in new.items()]


def _spec_of(content: dict[str, Any], spec: DerivationSpec) -> DerivationSpec:
    """The specification in the content of a record; `spec` if that is the same, or unreadable."""
    request = content.get("request")
    if request in (None, spec.to_data()):
        return spec
    from rigidsym.spec.derivation_file import read_record

    try:
        return read_record(request)
    except SpecError:
        return spec


def content_of(record: Path) -> dict[str, Any]:
    """The object in a JSON file; empty without one. Raises OSError for what is no regular file."""
    try:
        content = json.loads(read_bytes(record).decode("utf-8"))
    except (FileNotFoundError, ValueError, RecursionError):
        return {}
    return content if isinstance(content, dict) else {}
