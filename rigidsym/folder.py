"""The folder of a derivation: one record speaks for all the files in it."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import click

from rigidsym.kernels.targets import TARGETS
from rigidsym.pipeline import PAGE, PDF, page_name
from rigidsym.spec import NOTE_FORMATS, DerivationSpec

_OUTPUTS = ("kernels", "note")  # of which a request may have more without being another


def with_what_is_there(spec: DerivationSpec, out: Path) -> DerivationSpec:
    """The specification of one rotation, with what out/NAME/ has of the same derivation already.

    What an earlier run printed for other targets, or as another note, is printed with the rest:
    the record speaks for all of them, and `rigidsym check` sees them. Where the folder holds
    another derivation, a message on standard error says so.
    """
    folder = out / spec.name
    before = _request_in(folder / f"{spec.name}.json")
    if before is None:
        return spec
    now = json.loads(json.dumps(spec.to_data()))  # as it stands in a record
    kept = {key: tuple(_kept(before.get(key), now[key], folder)) for key in _OUTPUTS}
    if all(before.get(key) == now.get(key) for key in {*before, *now} - {*_OUTPUTS}):
        return replace(spec, kernels=spec.kernels + kept["kernels"], note=spec.note + kept["note"])
    is_another = before.get("rotations") != now["rotations"]
    _say(folder, [*kept["kernels"], *kept["note"]], is_another=is_another)
    return spec


def _request_in(record: Path) -> dict[str, Any] | None:
    try:
        request = json.loads(record.read_text(encoding="utf-8"))["request"]
    except (OSError, ValueError, KeyError, TypeError):  # none, or no record
        return None
    return request if isinstance(request, dict) else None


def _kept(before: object, now: list[str], folder: Path) -> Iterator[str]:
    """The outputs that are there and not asked for; a PDF takes seconds, and nobody compares it."""
    for output in before if isinstance(before, list) else ():
        if output not in (*now, PDF) and _is_there(output, folder):
            yield output


def _is_there(output: object, folder: Path) -> bool:
    name = folder.name
    if output in TARGETS:
        return (folder / f"{name}{TARGETS[str(output)].ending}").is_file()
    if output == PAGE:
        return (folder / page_name(name)).is_file()
    return output in NOTE_FORMATS and (folder / f"{name}.{output}").is_file()


def _say(folder: Path, left: list[str], *, is_another: bool) -> None:
    said = [f"{folder} held another rotation and is written over; --out keeps both"]
    if left:
        said.append(f"{folder} keeps {', '.join(left)} of what was there, which check does not see")
    for line in said if is_another else said[1:]:
        click.echo(f"rigidsym: {line}", err=True)
