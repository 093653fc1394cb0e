"""`rigidsym problems`: a problem sheet with its worked solutions."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import click

from rigidsym.commands.command import command as make
from rigidsym.notes.formats import render
from rigidsym.notes.formats.pdf import typeset
from rigidsym.notes.problems import SUBJECTS, sheets_of
from rigidsym.system.files import write_bytes, write_text

_ENDINGS = ("tex", "html")


@make("problems", subject=list(SUBJECTS))
def command(
    subject: str, number: int, variant: int, author: str, course: str, pdf: bool, **options: Any
) -> None:
    """Write a problem sheet and its worked solutions."""
    byline = tuple(filter(None, (author, course)))
    documents = [
        replace(document, author=author, byline=byline)
        for document in sheets_of(subject, count=number, variant=variant)
    ]
    folder = options["out"] / documents[0].name
    for place, section in enumerate(() if options["quiet"] else documents[0].sections, start=1):
        click.echo(f"{place}  {section.title}")
    for document in documents:
        for ending in _ENDINGS:
            click.echo(write_text(folder / f"{document.name}.{ending}", render(document, ending)))
    for document in documents if pdf else ():
        path = folder / f"{document.name}.pdf"
        click.echo(write_bytes(path, typeset(render(document, "tex")).pdf))
