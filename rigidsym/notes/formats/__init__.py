"""The formats a note is printed in, one file each, which is imported when something is printed."""

from __future__ import annotations

from importlib import import_module
from types import MappingProxyType
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rigidsym.notes.document import Document

# the ending of the files, and the module whose `render(document)` gives their text
FORMATS = MappingProxyType({"tex": "latex", "html": "html", "md": "markdown"})


def render(document: Document, ending: str) -> str:
    """The text of a file in one of FORMATS; the same document gives the same bytes."""
    return str(import_module(f"{__name__}.{FORMATS[ending]}").render(document))
