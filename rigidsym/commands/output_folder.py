"""The folder of a derivation: one record describes all files in it."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from rigidsym.commands.command import message
from rigidsym.errors import SpecError
from rigidsym.kernels.targets import TARGETS
from rigidsym.pipeline import PAGE, PDF, Output, note_formats, page_name, read_record
from rigidsym.spec.derivation_spec import DerivationSpec


def with_existing_files(spec: DerivationSpec, out: Path) -> DerivationSpec:
    """The specification of one rotation, with what out/NAME/ already has of the same derivation.

    Other targets and notes of an earlier run are printed again with the rest, so that one record
    describes all of them and `rigidsym check` sees them.
    """
    folder = out / spec.name
    before = _spec_there(folder)
    if before is None or not _is_same(before, spec):
        return spec
    return replace(
        spec,
        kernels=(*spec.kernels, *_kept(before.kernels, spec.kernels, folder)),
        note=(*spec.note, *_kept(before.note, spec.note, folder)),
    )


def report_other_files(output: Output, out: Path) -> None:
    """A message on standard error if out/NAME/ holds another derivation.

    Called when everything is derived and nothing is written yet.
    """
    folder = out / output.name
    before, now = _spec_there(folder), output.spec
    if before is None or _is_same(before, now):
        return
    if before.models != now.models:
        message(f"overwriting {folder}, which held a different rotation (use --out to keep both)")
    left = [*_kept(before.kernels, now.kernels, folder), *_kept(before.note, now.note, folder)]
    if left:
        message(f"{folder} also holds older files that `check` does not see: {', '.join(left)}")


def _is_same(before: DerivationSpec, now: DerivationSpec) -> bool:
    """Whether two specifications differ at most in the files they print."""
    return replace(before, kernels=now.kernels, note=now.note) == now


def _spec_there(folder: Path) -> DerivationSpec | None:
    """The specification in the record of a folder; None without a record that can be read."""
    try:
        content = json.loads((folder / f"{folder.name}.json").read_text(encoding="utf-8"))
        return read_record(content["request"])
    except (OSError, ValueError, KeyError, TypeError, SpecError, RecursionError):
        return None


def _kept(before: tuple[str, ...], now: tuple[str, ...], folder: Path) -> Iterator[str]:
    """Outputs that are there and not asked for; a PDF is slow to make and never compared."""
    for output in before:
        if output not in (*now, PDF) and _file(output, folder).is_file():
            yield output


def _file(output: str, folder: Path) -> Path:
    """The main file of a target or a format."""
    name = folder.name
    if output in TARGETS:
        return folder / f"{name}{TARGETS[output].ending}"
    assert output in note_formats()
    return folder / (page_name(name) if output == PAGE else f"{name}.{output}")
