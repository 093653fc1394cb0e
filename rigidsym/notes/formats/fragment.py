"""Document -> LaTeX without a preamble, to be read into another document by \\input."""

from __future__ import annotations

from rigidsym.notes.document.document import Document
from rigidsym.notes.formats.latex import rendered

ENDING = "fragment.tex"
TEMPLATE = "fragment.tex.jinja"


def render(document: Document) -> str:
    """The sections and sources of a note; the same document gives the same bytes."""
    return rendered(TEMPLATE, document)
