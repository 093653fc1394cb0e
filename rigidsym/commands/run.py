"""`rigidsym run`: derivation files."""

from __future__ import annotations

from typing import Any

from rigidsym.commands.command import command as make, message
from rigidsym.commands.derive import applied, produce
from rigidsym.errors import SpecError
from rigidsym.formula.notation import CHOICES
from rigidsym.spec.derivation_file import read_file
from rigidsym.spec.derivation_spec import DerivationSpec


@make("run", **CHOICES)
def command(files: tuple[str, ...], **options: Any) -> None:
    """Run derivation files, given by path or by the name of a shipped one."""
    specs: list[DerivationSpec] = []
    wrong: list[SpecError] = []
    for file in files:
        try:
            specs.append(applied(options, read_file(file)))
        except SpecError as error:
            wrong.append(error)
    for other in wrong[:-1]:
        message(str(other))
    if wrong:
        raise wrong[-1]
    produce(specs, options)
