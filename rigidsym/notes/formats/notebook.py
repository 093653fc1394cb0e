"""Document -> Jupyter notebook: the Markdown of the note, with its programs as cells to run."""

from __future__ import annotations

from types import ModuleType
from typing import Any

from rigidsym.errors import MissingExtra
from rigidsym.notes.document.document import CodeBlock, Document
from rigidsym.notes.formats.markdown import parts
from rigidsym.version import OWNERSHIP

ENDING = "ipynb"
_METADATA = {
    "kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"},
    "rigidsym": {"ownership": OWNERSHIP},
}


def render(document: Document) -> str:
    """The note as an .ipynb file; the same document gives the same bytes.

    Raises MissingExtra without nbformat.
    """
    nbformat = _nbformat()
    pieces = list(parts(document, has_pictures=True))
    if document.program and not any(isinstance(part, CodeBlock) for part in pieces):
        pieces += [document.language.words("In Python:"), CodeBlock(document.program)]
    cells = [_cell(nbformat, part, place) for place, part in enumerate(pieces, start=1)]
    notebook = nbformat.v4.new_notebook(cells=cells, metadata=_METADATA)
    nbformat.validate(notebook)
    return str(nbformat.writes(notebook)) + "\n"


def _cell(nbformat: ModuleType, part: str | CodeBlock, place: int) -> Any:
    # nbformat would draw an id by chance
    if isinstance(part, CodeBlock):
        return nbformat.v4.new_code_cell(part.code, id=f"cell-{place}")
    return nbformat.v4.new_markdown_cell(part, id=f"cell-{place}")


def _nbformat() -> ModuleType:
    try:
        import nbformat
    except ImportError as error:
        raise MissingExtra("a notebook", "notebook") from error
    return nbformat
