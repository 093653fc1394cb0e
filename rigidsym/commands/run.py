"""`rigidsym run`: derivation files."""

from __future__ import annotations

from typing import Any

import click

from rigidsym.commands.command import command as make, message
from rigidsym.commands.derive import produce
from rigidsym.commands.options import PRINTING, applied
from rigidsym.errors import SpecError
from rigidsym.pipeline import read_file
from rigidsym.spec.derivation_spec import DerivationSpec


@make("rigidsym run lecture my_top.toml", *PRINTING)
@click.argument("files", nargs=-1, required=True, metavar="FILE...")
def command(files: tuple[str, ...], **options: Any) -> None:
    """Run derivation files, given by path or by the name of a shipped one.

    All files are checked before the first is run; if one has a fault, nothing is written.
    """
    specs: list[DerivationSpec] = []
    wrong: list[SpecError] = []
    for file in files:
        try:
            specs.append(applied(options, read_file(file)))
        except SpecError as error:
            wrong.append(error)
    if wrong:
        *others, last = wrong
        for other in others:
            message(str(other))
        raise last
    produce(specs, options)
