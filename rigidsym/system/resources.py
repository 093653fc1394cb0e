"""The templates and shipped derivation files, however this package is installed.

A wheel carries them inside the package, in `_data`; in a checkout or an editable install their
folders are beside the package.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from functools import cache
from pathlib import Path
from typing import Any

from rigidsym.errors import TemplateFault
from rigidsym.system.sandbox import SandboxedTemplates

_PACKAGE = Path(__file__).resolve().parent.parent
_DEPTH = 2  # a template is named by its file, or by its folder and file
_OWN: ContextVar[Path | None] = ContextVar("own templates", default=None)
NOTES = "templates/notes"  # those that users may replace
_HOMES = (_PACKAGE / "_data", _PACKAGE.parent)


def folder(kind: str) -> Path:
    """The folder of one kind: "templates", "templates/notes" or "derivations".

    Raises FileNotFoundError, with the places searched, if the package came without it.
    """
    for home in _HOMES:
        if (home / kind).is_dir():
            return home / kind
    places = " and ".join(str(home / kind) for home in _HOMES)
    raise FileNotFoundError(f"rigidsym is installed without its {kind}: looked for {places}")


def text(kind: str, name: str) -> str:
    """The text of one file of a folder."""
    return (folder(kind) / name).read_text(encoding="utf-8")


def names(kind: str, suffix: str) -> tuple[str, ...]:
    """The files of a folder that end in `suffix`, without it, in alphabetical order."""
    files = folder(kind).iterdir()
    return tuple(sorted(f.name.removesuffix(suffix) for f in files if f.name.endswith(suffix)))


def languages() -> tuple[str, ...]:
    """The codes of the languages of a note: English, and those with a catalogue of sentences."""
    return ("en", *names(NOTES, ".toml"))


@contextmanager
def overridden_by(own: Path) -> Iterator[None]:
    """Inside, the templates in a folder of the user replace those of the same name.

    Raises TemplateFault, with their names, if the folder holds none of the templates.
    """
    known = names(NOTES, ".jinja")
    if not any((own / f"{name}.jinja").is_file() for name in known):
        listed = ", ".join(f"{name}.jinja" for name in known)
        raise TemplateFault(f"{own} contains none of the templates: {listed}")
    token = _OWN.set(own)
    try:
        yield
    finally:
        _OWN.reset(token)


def environment(**options: Any) -> SandboxedTemplates:
    """A Jinja2 environment over the templates; `options` are Jinja2's, delimiters for instance.

    Templates are sandboxed and do not escape: each kind of document escapes its own text before
    it reaches a template. An undefined name, bad syntax or
    a forbidden access raises TemplateFault with the template, the line and the names there are.
    What is rendered next has the whole time of a template.
    """
    found = _environment(tuple(options.items()))
    found.begin()
    return found


@cache
def _environment(options: tuple[tuple[str, Any], ...]) -> SandboxedTemplates:
    """Kept for all documents, with the templates that it has compiled."""
    return SandboxedTemplates(template, **dict(options))


def template(name: str) -> tuple[str, str]:
    """(text, file) of one template: "note.tex.jinja" of a note, the user's own if there is one, or
    of another folder, "numpy/module.py.jinja", which is always the shipped one.

    Raises FileNotFoundError if there is none and for a name that leads out of the folder, and
    UnicodeDecodeError if it is not text.
    """
    path = Path(name)
    if path.is_absolute() or ".." in path.parts or len(path.parts) > _DEPTH:
        raise FileNotFoundError(f"{name} is not the name of a file among the templates")
    is_of_notes = len(path.parts) == 1
    own = _OWN.get() if is_of_notes else None
    shipped = folder(NOTES if is_of_notes else "templates") / name
    path = own / name if own is not None and (own / name).is_file() else shipped
    return path.read_text(encoding="utf-8"), str(path)
