"""`rigidsym build`: kernels in C, compiled into a Python module."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import click

from rigidsym.commands.command import command as make, option, with_options
from rigidsym.commands.options import FolderOptions, KernelOptions, RotationOptions
from rigidsym.commands.output_folder import printed, with_existing_files, write
from rigidsym.errors import CheckError
from rigidsym.kernels.targets.c import Contents
from rigidsym.kernels.targets.compiling import build
from rigidsym.pipeline import integrated, read


@dataclass(frozen=True, kw_only=True)
class BuildOptions(FolderOptions, KernelOptions, RotationOptions):
    """All options of `build`."""

    portable: bool = option("--portable", help="Run on any CPU of this architecture.")


@make("rigidsym build ZXZ")
@click.argument("sources", nargs=-1, required=True, metavar="ROTATION|FILE...")
@with_options(BuildOptions)
def command(sources: tuple[str, ...], options: BuildOptions) -> None:
    """Compile kernels in C into Python modules, NAME_c.py.

    For a ROTATION or a derivation FILE, `build` first writes the C source, as --target c does. A
    generated FILE NAME.c is compiled as it is. The binary uses this CPU's instruction set; use
    --portable to share it. Without a C compiler, `build` writes only the source, and the exit code
    is 4.
    """
    for source in sources:
        for module in _built(source, options):
            click.echo(module)


def _built(source: str, options: BuildOptions) -> Iterator[Path]:
    """The module of a file NAME.c, or of each rotation."""
    if Path(source).suffix == ".c":
        yield build(Path(source), portable=options.portable)
        return
    spec = options.applied_to(integrated(read(source, **options.of_rotation())))
    for single in spec.singles():
        asked: Mapping[str, Any] = single.target_options.get("c", {})
        if not Contents(**asked).is_module:
            raise CheckError(
                f"{source}: a Python module needs C with arrays and both precisions, which "
                "[output.c] leaves out; rigidsym run writes the source"
            )
        output = printed(with_existing_files(replace(single, kernels=("c",)), options.out))
        write(output, options.out, force=options.force)
        main = next(name for name in output.files if Path(name).suffix == ".c")
        yield build(options.out / single.name / main, portable=options.portable)
