"""`rigidsym identify`: the convention that given numbers follow."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import click
import numpy as np
from numpy.typing import ArrayLike

from rigidsym.commands.command import Options, command as make
from rigidsym.system.processes import bar
from rigidsym.tools.identify.identification import Identification, identify_file, identify_source
from rigidsym.tools.identify.readings import ANGLE_NAMES
from rigidsym.tools.identify.samples import (
    SIZES,
    OptionError,
    SampleError,
    from_arrays,
    parts_missing,
)

_BRACKETS = str.maketrans("[](){};", "      ,")


@make("identify")
@click.pass_context
def command(context: click.Context, /, file: Path | None, **options: Any) -> None:
    """Name the convention that angles and a matrix or quaternion follow."""
    texts = {name: options[name] for name in SIZES}
    if (file is None) == (not any(texts.values())):
        raise OptionError(["expected a file, or --angles with --matrix or --quaternion"])
    if file is None:
        result = _from_texts(texts, options)
    else:
        with bar(file.name) as progress:
            try:
                result = identify_file(
                    file,
                    columns=options["columns"] or None,
                    tolerance=options["tolerance"],
                    drops_missing=options["missing"] == "drop",
                    progress=progress,
                )
            except SampleError as error:
                raise error.of(file) from None
    if options["json"]:
        click.echo(json.dumps(result.record(), indent=1, ensure_ascii=False))
    else:
        head, _, rest = result.text(everything=options["all"]).partition("\n")
        click.echo(f"{click.style(head, bold=True)}\n{rest}")
    if not result.fits:
        context.exit(1)


def _from_texts(texts: Mapping[str, Sequence[str]], options: Options) -> Identification:
    """The samples in options; raises OptionError with all faults in them."""
    faults: list[str] = []
    names: Sequence[str] = ANGLE_NAMES
    given: dict[str, ArrayLike | None] = {}
    for name, samples in texts.items():
        read = [_numbers(name, text, faults) for text in samples]
        if not faults and read:
            given[name] = np.array([numbers for _, numbers in read])
        if name == "angles" and read:
            names = read[0][0] or names
    if faults:
        raise OptionError([*faults, *parts_missing({name for name in texts if texts[name]})])
    try:
        return identify_source(from_arrays(given, names), tolerance=options["tolerance"])
    except SampleError as error:
        raise OptionError(error.faults, count=error.count) from None


def _numbers(name: str, text: str, faults: list[str]) -> tuple[list[str], list[float]]:
    """The names and the numbers of `roll=10, pitch=20, yaw=30` or `10,20,30` or `[10 20 30]`."""
    fields = text.translate(_BRACKETS).replace(",", " ").replace("=", " = ").split()
    words = " ".join(fields).replace(" = ", "=").split()
    pairs = [word.rpartition("=") for word in words]
    numbers = []
    for _, _, number in pairs:
        try:
            numbers.append(float(number))
        except ValueError:
            faults.append(f"--{name}: {number!r} is not a number")
    if len(words) != SIZES[name]:
        faults.append(f"--{name}: expected {SIZES[name]} numbers, got {len(words)}")
    return [label for label, _, _ in pairs if label], numbers
