"""`rigidsym build`: kernels in C, compiled into a Python module."""

from __future__ import annotations

from pathlib import Path

import click

from rigidsym.commands.command import command as make, flag
from rigidsym.errors import RequestError
from rigidsym.kernels.targets.compiling import build


@make(
    "rigidsym build out/euler_zxz_intrinsic/euler_zxz_intrinsic.c",
    flag("--portable", help="Run on any CPU of this architecture."),
)
@click.argument("sources", nargs=-1, required=True, metavar="NAME.c...")
def command(sources: tuple[str, ...], portable: bool) -> None:
    """Compile kernels in C into Python modules, NAME_c.py.

    `rigidsym derive ROTATION --target c` writes NAME.c and the files that it needs. The binary uses
    this CPU's instruction set; use --portable to share it. Without a C compiler the exit code is 4.
    """
    for source in map(Path, sources):
        if source.suffix != ".c":
            wanted = "expected NAME.c, which `rigidsym derive ROTATION --target c` writes"
            raise RequestError(f"{source}: {wanted}")
        click.echo(build(source, portable=portable))
