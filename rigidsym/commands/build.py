"""`rigidsym build`: kernels in C, compiled into a Python module."""

from __future__ import annotations

from pathlib import Path

import click

from rigidsym.commands.command import command as make
from rigidsym.errors import RequestError
from rigidsym.kernels.targets.compiling import build


@make("build")
def command(sources: tuple[str, ...]) -> None:
    """Compile kernels in C into Python modules, NAME_c.py."""
    for source in map(Path, sources):
        if source.suffix != ".c":
            raise RequestError(
                f"{source}: expected NAME.c, which `rigidsym derive ROTATION --target c` writes"
            )
        click.echo(build(source))
