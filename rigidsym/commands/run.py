"""`rigidsym run`: derivation files."""

from __future__ import annotations

from collections.abc import Iterable

import click

from rigidsym.commands.command import command as make, message, with_options
from rigidsym.commands.derive import produce
from rigidsym.commands.options import PrintingOptions
from rigidsym.errors import SpecError
from rigidsym.pipeline import read_file
from rigidsym.spec.derivation_spec import DerivationSpec


@make("rigidsym run lecture my_top.toml")
@click.argument("files", nargs=-1, required=True, metavar="FILE...")
@with_options(PrintingOptions)
def command(files: tuple[str, ...], options: PrintingOptions) -> None:
    """Run derivation files, given by path or by the name of a shipped one.

    All files are checked before the first is run; if one has a fault, nothing is written.
    """
    produce(map(options.applied_to, _read_all(files)), options)


def _read_all(files: Iterable[str]) -> list[DerivationSpec]:
    """Read every file; the faults of all files are reported."""
    specs: list[DerivationSpec] = []
    wrong: list[SpecError] = []
    for file in files:
        try:
            specs.append(read_file(file))
        except SpecError as error:
            wrong.append(error)
    if wrong:
        *others, last = wrong
        for other in others:
            message(str(other))
        raise last
    return specs
