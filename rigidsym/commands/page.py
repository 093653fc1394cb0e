"""`rigidsym page`: one HTML file with the note and an interactive figure."""

from __future__ import annotations

from dataclasses import dataclass, replace

import click

from rigidsym.commands.command import command as make, with_options
from rigidsym.commands.options import (
    FolderOptions,
    NotationOptions,
    RotationOptions,
    SelectionOptions,
)
from rigidsym.commands.output_folder import printed, with_existing_files, write
from rigidsym.pipeline import PAGE, integrated, page_name, read


@dataclass(frozen=True, kw_only=True)
class PageOptions(FolderOptions, NotationOptions, SelectionOptions, RotationOptions):
    """All options of `page`."""


@make("rigidsym page ZXZ")
@click.argument("source", metavar="ROTATION|FILE")
@with_options(PageOptions)
def command(source: str, options: PageOptions) -> None:
    """Write an interactive page for a browser: the note, and a figure with sliders.

    ROTATION is as for `derive`, FILE as for `run`. The page DIR/NAME/NAME_page.html is one file
    that needs no network; NAME.json beside it is the record that `check` reads.
    """
    spec = integrated(read(source, **options.of_rotation()))
    for single in options.applied_to(spec).singles():
        asked = replace(single, kernels=(), note=(PAGE,))
        output = printed(with_existing_files(asked, options.out))
        write(output, options.out, force=options.force)
        click.echo(options.out / single.name / page_name(single.name))
