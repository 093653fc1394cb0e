"""`rigidsym identify`: the convention that given numbers follow."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import click

from rigidsym.commands.command import Options, command as make
from rigidsym.tools.identify.identification import Identification, identify, identify_file
from rigidsym.tools.identify.readings import ANGLE_NAMES
from rigidsym.tools.identify.samples import SIZES, SampleError, parts_missing

_BRACKETS = str.maketrans("[](){};,", " " * 8)
_FIELD = re.compile(r"(?:([^\s=]+)\s*=\s*)?([^\s=]+)")  # a number, perhaps with a name


@make("identify")
@click.pass_context
def command(context: click.Context, /, file: Path | None, **options: Any) -> None:
    """Name the convention that angles and a matrix or quaternion follow."""
    has_samples = any(options[name] for name in SIZES)
    if (file is None) != has_samples:
        raise click.UsageError("expected a file, or --angles with --matrix or --quaternion")
    if file is None:
        result = _from_options(options)
    else:
        result = identify_file(
            file,
            columns=options["columns"] or None,
            tolerance=options["tolerance"],
            drops_missing=options["missing"] == "drop",
        )
    if options["json"]:
        click.echo(json.dumps(result.record(), indent=1, ensure_ascii=False))
    else:
        head, _, rest = result.text(everything=options["all"]).partition("\n")
        click.echo(f"{click.style(head, bold=True)}\n{rest}")
    if not result.fits:
        context.exit(1)


def _from_options(options: Options) -> Identification:
    """The samples in options: `roll=10, pitch=20, yaw=30` or `10,20,30` or `[10 20 30]`."""
    names = list(ANGLE_NAMES)
    parts: dict[str, list[list[float]]] = {}
    faults: list[str] = []
    for part, texts in options.items():
        for text in texts if part in SIZES else ():
            fields = _FIELD.findall(text.translate(_BRACKETS))
            if part == "angles":
                names = [name for name, _ in fields if name] or names
            numbers = []
            for _, number in fields:
                try:
                    numbers.append(float(number))
                except ValueError:
                    faults.append(f"--{part}: expected a number, got {number}")
            parts.setdefault(part, []).append(numbers)
            if len(fields) != SIZES[part]:
                faults.append(f"--{part}: expected {SIZES[part]} numbers, got {len(fields)}")
    faults = faults or parts_missing(parts.keys())
    try:
        if faults:
            raise SampleError(faults)
        return identify(**parts, names=names, tolerance=options["tolerance"])
    except SampleError as error:
        raise click.UsageError(str(error)) from None
