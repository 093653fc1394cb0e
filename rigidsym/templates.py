"""Jinja2 for templates that users may write: sandboxed, and strict about names."""

from __future__ import annotations

import sys
from collections.abc import Callable
from traceback import walk_tb
from types import TracebackType
from typing import Any, NoReturn

from jinja2 import FunctionLoader, StrictUndefined, TemplateError, TemplateSyntaxError
from jinja2.runtime import Context
from jinja2.sandbox import SandboxedEnvironment

from rigidsym.errors import TemplateFault

Find = Callable[[str], tuple[str, str]]  # name -> text, file


class SandboxedTemplates(SandboxedEnvironment):
    """Templates found by a function; every fault in one is a TemplateFault."""

    def __init__(self, find: Find, **options: Any) -> None:
        self._files: set[str] = set()
        settings: dict[str, Any] = {
            "loader": FunctionLoader(lambda name: self._load(find, name)),
            "undefined": StrictUndefined,
            "autoescape": False,
            "keep_trailing_newline": True,
            "trim_blocks": True,
            "lstrip_blocks": True,
        }
        super().__init__(**(settings | options))

    def _load(self, find: Find, name: str) -> tuple[str, str, None] | None:
        try:
            text, file = find(name)
        except FileNotFoundError:
            return None
        self._files.add(file)
        return text, file, None

    def handle_exception(self, source: str | None = None) -> NoReturn:
        """Jinja2 comes here with every exception from a template."""
        names = _names_at(sys.exc_info()[2], set(self.globals))
        try:
            super().handle_exception(source)
        except TemplateSyntaxError as error:
            place = f"{error.filename or error.name}, line {error.lineno}"
            raise TemplateFault(f"{place}: {error.message}") from error
        except TemplateError as error:
            lines = walk_tb(error.__traceback__)
            places = [(f.f_code.co_filename, n) for f, n in lines]
            file, line = next(place for place in reversed(places) if place[0] in self._files)
            known = f"; names here: {', '.join(names)}" if names else ""
            raise TemplateFault(f"{file}, line {line}: {error.message}{known}") from error


def _names_at(trace: TracebackType | None, common: set[str]) -> list[str]:
    """The names that the template was given, without those that every template has."""
    contexts = (frame.f_locals.get("context") for frame, _ in walk_tb(trace))
    found = next((c for c in contexts if isinstance(c, Context)), None)
    return sorted(set(found.get_all()) - common) if found is not None else []
