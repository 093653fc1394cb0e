"""The folder of a derivation: one record speaks for all the files in it."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import click

from rigidsym.kernels.targets import TARGETS
from rigidsym.pipeline import PAGE, PDF, Product, page_name
from rigidsym.spec.derivation_file import NOTE_FORMATS, DerivationSpec

_OUTPUTS = ("kernels", "note")  # of which a request may have more without being another


def with_what_is_there(spec: DerivationSpec, out: Path) -> DerivationSpec:
    """The specification of one rotation, with what out/NAME/ has of the same derivation already.

    What an earlier run printed for other targets, or as another note, is printed with the rest:
    the record speaks for all of them, and `rigidsym check` sees them.
    """
    folder = out / spec.name
    before = _request_there(folder)
    now = json.loads(json.dumps(spec.to_data()))  # as it stands in a record
    if before is None or not _is_same(before, now):
        return spec
    kernels, note = (tuple(_kept(before.get(key), now[key], folder)) for key in _OUTPUTS)
    return replace(spec, kernels=spec.kernels + kernels, note=spec.note + note)


def say_what_was_there(made: Product, out: Path) -> None:
    """A message on standard error where out/NAME/ holds another derivation.

    To be called when all is derived, and before it is written: what is refused writes over nothing.
    """
    folder = out / made.name
    before = _request_there(folder)
    if before is None:
        return
    now = _request_in(made.record_text)
    if now is None or _is_same(before, now):
        return
    if before.get("rotations") != now["rotations"]:
        _say(f"{folder} held another rotation and is written over; --out keeps both")
    left = [output for key in _OUTPUTS for output in _kept(before.get(key), now[key], folder)]
    if left:
        _say(f"{folder} keeps {', '.join(left)} of what was there, which check does not see")


def _is_same(before: Mapping[str, Any], now: Mapping[str, Any]) -> bool:
    """Whether two requests are one, but for what is printed."""
    return all(before.get(key) == now.get(key) for key in {*before, *now} - {*_OUTPUTS})


def _request_there(folder: Path) -> dict[str, Any] | None:
    try:
        return _request_in((folder / f"{folder.name}.json").read_text(encoding="utf-8"))
    except (OSError, ValueError):  # none, or no text
        return None


def _request_in(record: str) -> dict[str, Any] | None:
    try:
        request = json.loads(record)["request"]
    except (ValueError, KeyError, TypeError):  # no record
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


def _say(message: str) -> None:
    click.echo(f"rigidsym: {message}", err=True)
