"""The templates and shipped derivation files, wherever this package stands.

A wheel carries them inside the package, in `_data`; in a checkout or an editable install their
folders stand beside the package.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from jinja2 import Environment

_PACKAGE = Path(__file__).resolve().parent
_HOMES = (_PACKAGE / "_data", _PACKAGE.parent)


def folder(kind: str) -> Path:
    """The folder of one kind, "templates" or "derivations".

    Raises FileNotFoundError, naming the places searched, where the package came without it.
    """
    for home in _HOMES:
        if (home / kind).is_dir():
            return home / kind
    places = " and ".join(str(home / kind) for home in _HOMES)
    raise FileNotFoundError(f"rigidsym came without its {kind}: looked for {places}")


def text(kind: str, name: str) -> str:
    """The text of one file of a folder."""
    return (folder(kind) / name).read_text(encoding="utf-8")


def names(kind: str, suffix: str) -> tuple[str, ...]:
    """The files of a folder that end in `suffix`, without it, in alphabetical order."""
    files = folder(kind).iterdir()
    return tuple(sorted(f.name.removesuffix(suffix) for f in files if f.name.endswith(suffix)))


def environment(**options: Any) -> Environment:
    """A Jinja2 environment over the templates; `options` are Jinja2's, delimiters for instance.

    An undefined variable is an error, and what is printed stands in the output as it is: each
    kind of document escapes its own text before it reaches a template.
    """
    from jinja2 import Environment, FunctionLoader, StrictUndefined

    settings: dict[str, Any] = {
        "loader": FunctionLoader(_template),
        "undefined": StrictUndefined,
        "autoescape": False,
        "keep_trailing_newline": True,
        "trim_blocks": True,
        "lstrip_blocks": True,
    }
    return Environment(**(settings | options))


def _template(name: str) -> str | None:
    path = folder("templates") / name
    return path.read_text(encoding="utf-8") if path.is_file() else None
