"""`rigidsym page`: one HTML file with the note and an interactive figure."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import click

from rigidsym.commands.command import command as make, of_rotation
from rigidsym.commands.derive import applied
from rigidsym.commands.output_folder import printed, with_existing_files, write
from rigidsym.formula.notation import CHOICES
from rigidsym.pipeline import PAGE, integrated, page_name, read


@make("page", **CHOICES)
def command(source: str, **options: Any) -> None:
    """Write an interactive page for a browser: the note, and a figure with sliders."""
    out = options["out"]
    for single in applied(options, integrated(read(source, **of_rotation(options)))).singles():
        output = printed(with_existing_files(replace(single, kernels=(), note=(PAGE,)), out))
        write(output.spec, output.files, out, force=options["force"])
        click.echo(out / single.name / page_name(single.name))
