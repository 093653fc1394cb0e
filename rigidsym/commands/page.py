"""`rigidsym page`: one HTML file with the note and an interactive figure."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import click

from rigidsym.commands.command import command as make
from rigidsym.commands.options import FOLDER, NOTATION, ROTATION, SELECTION, applied, of_rotation
from rigidsym.commands.output_folder import printed, with_existing_files, write
from rigidsym.pipeline import PAGE, integrated, page_name, read


@make("rigidsym page ZXZ", *FOLDER, *NOTATION, *SELECTION, *ROTATION)
@click.argument("source", metavar="ROTATION|FILE")
def command(source: str, **options: Any) -> None:
    """Write an interactive page for a browser: the note, and a figure with sliders.

    ROTATION is as for `derive`, FILE as for `run`. The page DIR/NAME/NAME_page.html is one file
    that needs no network; NAME.json beside it is the record that `check` reads.
    """
    out = options["out"]
    spec = applied(options, integrated(read(source, **of_rotation(options))))
    for single in spec.singles():
        asked = replace(single, kernels=(), note=(PAGE,))
        write(printed(with_existing_files(asked, out)), out, force=options["force"])
        click.echo(out / single.name / page_name(single.name))
