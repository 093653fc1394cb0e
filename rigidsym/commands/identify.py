"""`rigidsym identify`: the convention that given numbers follow."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import click
import numpy as np
from numpy.typing import ArrayLike

from rigidsym.commands.command import EXISTING_FILE, JSON, Options, command as make, flag, names
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


def _samples(name: str, form: str, about: str) -> Any:
    return click.option(f"--{name}", multiple=True, metavar=form, help=about)


@make(
    "rigidsym identify --angles roll=10,pitch=20,yaw=30 --quaternion 0.95,0.04,0.19,0.24",
    _samples("angles", "A,B,C", "Three angles; roll=A,pitch=B,yaw=C names them."),
    _samples("matrix", "R11,R12,...", "Nine numbers, row by row."),
    _samples("quaternion", "A,B,C,D", "Four numbers, scalar first or last."),
    _samples("rates", "A,B,C", "Rates of the angles; needs --omega."),
    _samples("omega", "X,Y,Z", "Components of the angular velocity."),
    names("--columns", help="Names of the columns of FILE; - skips one."),
    click.option(
        "--tolerance",
        type=float,
        metavar="RADIANS",
        help="Largest angle between the data and a convention that fits.  [default: from the "
        "digits given]",
    ),
    click.option(
        "--missing",
        type=click.Choice(["error", "drop"]),
        default="error",
        show_default=True,
        help="If a sample lacks a number: stop, or leave it out.",
    ),
    flag("--all", "everything", help="Show every convention that fits, with all calls."),
    JSON,
)
@click.argument("file", required=False, metavar="[FILE]", type=EXISTING_FILE)
@click.pass_context
def command(context: click.Context, /, file: Path | None, **options: Any) -> None:
    """Name the convention that angles and a matrix or quaternion follow.

    Give samples as options, each option once per sample, or in FILE. FILE is NPY, Parquet or text.
    Its columns may have names: roll,pitch,yaw or phi,theta,psi or a1,a2,a3; r11,...,r33 or
    q1,...,q4 or qw,qx,qy,qz; a1_dot,... or rate1,...; omega1,omega2,omega3. Without names, they are
    3 angles, then 9 entries of a matrix or 4 of a quaternion, then perhaps 3 rates and 3 components
    of the angular velocity. Units in names, such as "yaw [mrad]", are converted. The exit code is 1
    if no convention fits.
    """
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
    if options["as_json"]:
        click.echo(json.dumps(result.record(), indent=1, ensure_ascii=False))
    else:
        head, _, rest = result.text(everything=options["everything"]).partition("\n")
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
