"""`rigidsym templates`: the shipped templates, copied."""

from __future__ import annotations

from pathlib import Path

import click

from rigidsym.commands.command import command as make
from rigidsym.system import resources
from rigidsym.system.files import write_text


@make("templates")
def command(folder: Path) -> None:
    """Copy the shipped templates of notes into DIR, where you can change them."""
    shipped = resources.replaceable()
    taken = [name for name in shipped if (folder / name).exists()]
    if taken:
        raise click.ClickException(f"{folder} already has {', '.join(taken)}; nothing was copied")
    for name in shipped:
        click.echo(write_text(folder / name, resources.text(resources.NOTES, name)))
