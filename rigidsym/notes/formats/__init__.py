"""The formats a note is printed in: one file each, found by the ending of what it writes.

A format file declares `ENDING`, the ending of its files, and `render(document)`, which gives their
text. The files here are those of the package; `register` adds one from anywhere.
"""

from __future__ import annotations

from collections.abc import Mapping
from importlib import import_module
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, NamedTuple, Protocol, cast

from rigidsym.errors import ModelError

if TYPE_CHECKING:
    from rigidsym.notes.document.document import Document

_SHIPPED = {
    "tex": "latex",
    "html": "html",
    "md": "markdown",
}


class _Module(Protocol):
    """The contents of a format's file."""

    ENDING: str

    def render(self, document: Document) -> str: ...


class Format(NamedTuple):
    """One format of a note; its file is imported when something is printed."""

    ending: str
    module: str | _Module

    def render(self, document: Document) -> str:
        """The text of the file; the same document gives the same bytes."""
        found = import_module(self.module) if isinstance(self.module, str) else self.module
        return cast(_Module, found).render(document)


_KNOWN = {ending: Format(ending, f"{__name__}.{module}") for ending, module in _SHIPPED.items()}
FORMATS: Mapping[str, Format] = MappingProxyType(_KNOWN)


def register(path: Path) -> Format:
    """Add the format of a file such as /home/me/asciidoc.py.

    Raises ModelError for an ending that is taken, or a file that does not declare a format.
    """
    spec = spec_from_file_location(f"{__name__}.{path.stem}", path)
    if spec is None or spec.loader is None:
        raise ModelError(f"{path} cannot be imported")
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    missing = [name for name in ("ENDING", "render") if not hasattr(module, name)]
    if missing:
        raise ModelError(
            f"{path} is not the file of a format: it has no {' and no '.join(missing)}"
        )
    if module.ENDING in _KNOWN:
        raise ModelError(f"there is a format {module.ENDING!r} already")
    found = Format(module.ENDING, cast(_Module, module))
    _KNOWN[found.ending] = found
    return found
