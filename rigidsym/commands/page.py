"""`rigidsym page`: one HTML file with the note and an interactive figure."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import click

from rigidsym.commands.command import command as make
from rigidsym.commands.options import (
    FolderOptions,
    NotationOptions,
    RotationOptions,
    SelectionOptions,
    with_options,
)
from rigidsym.commands.output_folder import report_other_files, with_existing_files
from rigidsym.pipeline import PAGE, integrated, output_of, page_name, read
from rigidsym.spec.derivation_spec import DerivationSpec
from rigidsym.system.files import write_text


@dataclass(frozen=True, kw_only=True)
class PageOptions(FolderOptions, NotationOptions, SelectionOptions, RotationOptions):
    """All options of `page`."""


@make("rigidsym page ZXZ --frames inertial,spacecraft")
@click.argument("source", metavar="ROTATION|FILE")
@with_options(PageOptions)
def command(source: str, options: PageOptions) -> None:
    """Write a page for a browser: the note, and a figure with sliders.

    ROTATION is as for `derive`, FILE as for `run`. The page DIR/NAME/NAME_page.html is one file
    that needs no network; NAME.json beside it is the record that `check` reads.
    """
    spec = options.selected(integrated(read(source, **options.of_rotation())))
    for single in options.in_notation(spec).singles():
        folder = write_files(replace(single, kernels=(), note=(PAGE,)), options.out)
        click.echo(folder / page_name(single.name))


def write_files(spec: DerivationSpec, out: Path) -> Path:
    """Derive and print a rotation, write its files, and return their folder."""
    output = output_of(with_existing_files(spec, out))
    report_other_files(output, out)
    for name, text in output.files.items():
        write_text(out / output.name / name, text)
    return out / output.name
