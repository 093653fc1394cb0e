"""The templates and shipped derivation files, however this package is installed.

A wheel carries them inside the package, in `_data`; in a checkout or an editable install their
folders are beside the package. Users may write templates of their own, so Jinja2 is sandboxed and
strict about names.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from functools import cache
from pathlib import Path
from pickle import UnpicklingError
from time import monotonic
from traceback import walk_tb
from types import TracebackType
from typing import Any, NoReturn, cast

import jinja2
from jinja2 import (
    BytecodeCache,
    FunctionLoader,
    StrictUndefined,
    Template,
    TemplateError,
    TemplateNotFound,
    TemplateSyntaxError,
    Undefined,
    nodes,
)
from jinja2.bccache import Bucket
from jinja2.exceptions import SecurityError
from jinja2.runtime import Context
from jinja2.sandbox import ImmutableSandboxedEnvironment

from rigidsym.errors import TemplateFault
from rigidsym.system.files import cache_folder, write_bytes

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
    return _shipped(kind, name)[0]


@cache
def _shipped(kind: str, name: str) -> tuple[str, str]:
    """(text, path) of a file of the package, which is read once."""
    path = folder(kind) / name
    return path.read_text(encoding="utf-8"), str(path)


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
    if own is not None and (own / name).is_file():
        return (own / name).read_text(encoding="utf-8"), str(own / name)
    return _shipped(NOTES if is_of_notes else "templates", name)


Find = Callable[[str], tuple[str, str]]  # name -> text, file
_LONGEST = 20_000_000  # characters that one template may print, or put together
_SECONDS = 60.0  # for one template
_PADDING = frozenset({"center", "ljust", "rjust", "zfill", "expandtabs", "format", "format_map"})
_PADDING |= {"replace", "join", "translate"}  # methods of text whose result may be of any length
_FILTERS = (  # whose result is hardly longer than what they are given
    *("abs", "attr", "capitalize", "count", "d", "default", "dictsort", "e", "escape", "first"),
    *("float", "int", "items", "last", "length", "list", "lower", "map", "max", "min", "reject"),
    *("rejectattr", "reverse", "round", "safe", "select", "selectattr", "sort", "string"),
    *("striptags", "title", "trim", "truncate", "unique", "upper", "wordcount"),
)


class _CompiledTemplates(BytecodeCache):
    """Templates compiled by an earlier process, in the user's cache folder."""

    def __init__(self) -> None:
        self._folder = cache_folder("templates")
        self._compiler = f"{jinja2.__version__} {Path(__file__).stat().st_mtime_ns}"

    def get_source_checksum(self, source: str) -> str:
        return super().get_source_checksum(f"{self._compiler} {source}")

    def load_bytecode(self, bucket: Bucket) -> None:
        with suppress(OSError, EOFError, UnpicklingError):
            if self._folder is not None:
                bucket.bytecode_from_string((self._folder / bucket.key).read_bytes())

    def dump_bytecode(self, bucket: Bucket) -> None:
        with suppress(OSError):  # of a disk that is full, say
            if self._folder is not None:
                write_bytes(self._folder / bucket.key, bucket.bytecode_to_string())


class _BoundedTemplate(Template):
    """A template whose output is bounded, and its time."""

    def render(self, *arguments: Any, **names: Any) -> str:
        length, chunks = 0, []
        assert isinstance(self.environment, SandboxedTemplates)
        self.environment.begin()
        for chunk in self.generate(*arguments, **names):
            length += len(chunk)
            if length > _LONGEST:
                raise TemplateFault(f"{self.filename}: it prints more than {_LONGEST} characters")
            chunks.append(chunk)
        return "".join(chunks)


class SandboxedTemplates(ImmutableSandboxedEnvironment):
    """Templates found by a function; every fault in one is a TemplateFault.

    Time is looked at in each turn of a loop, at each call and at each inclusion; what happens
    between two of them is bounded by the length of texts.
    """

    intercepted_binops = frozenset({"+", "*", "**", "%"})  # a short template could fill the memory
    template_class = _BoundedTemplate

    def __init__(self, find: Find, **options: Any) -> None:
        self._files: set[str] = set()
        self._last = monotonic() + _SECONDS
        settings: dict[str, Any] = {
            "loader": FunctionLoader(lambda name: self._load(find, name)),
            "bytecode_cache": _CompiledTemplates(),
            "undefined": StrictUndefined,
            "autoescape": False,
            "finalize": _printable,
            "keep_trailing_newline": True,
            "trim_blocks": True,
            "lstrip_blocks": True,
        }
        super().__init__(**(settings | options))
        self.filters = {name: self.filters[name] for name in _FILTERS}
        self.filters |= {"join": _joined, "_in_time": self._in_time, "_joined": _joined}
        for name in ("lipsum", "joiner", "cycler"):
            self.globals.pop(name, None)

    def begin(self) -> None:
        """The time of a template counts from now on."""
        self._last = monotonic() + _SECONDS

    def _tick(self) -> None:
        if monotonic() > self._last:
            raise SecurityError(f"it takes more than {_SECONDS:g} s")

    def _in_time(self, items: Iterable[Any]) -> Iterator[Any]:
        for item in items:
            self._tick()
            yield item

    def _parse(self, source: str, name: str | None, filename: str | None) -> nodes.Template:
        """As Jinja2 parses, with loops that look at the time, and `~` that looks at the length."""
        tree = super()._parse(source, name, filename)
        for loop in tree.find_all(nodes.For):
            loop.iter = _filtered(loop.iter, "_in_time")
        for parent in tree.find_all(nodes.Node):
            for field, value in parent.iter_fields():
                if isinstance(value, nodes.Concat):
                    setattr(parent, field, _filtered(nodes.List(value.nodes), "_joined"))
                elif isinstance(value, list):
                    value[:] = [
                        _filtered(nodes.List(each.nodes), "_joined")
                        if isinstance(each, nodes.Concat)
                        else each
                        for each in value
                    ]
        return tree

    def call(self, context: Context, called: Any, /, *arguments: Any, **names: Any) -> Any:
        """A call in a template; macros may call one another."""
        self._tick()
        return super().call(context, called, *arguments, **names)

    def get_template(self, *arguments: Any, **options: Any) -> Template:
        """Also the templates that one includes."""
        self._tick()
        return super().get_template(*arguments, **options)

    def wrap_str_format(self, value: Any) -> None:
        """No formatting in place of `str.format`, which `is_safe_attribute` refuses."""

    def is_safe_attribute(self, obj: Any, attr: str, value: Any) -> bool:
        """Refuse methods of text that could fill the memory."""
        is_padding = isinstance(obj, str) and attr in _PADDING
        return not is_padding and super().is_safe_attribute(obj, attr, value)

    def _load(self, find: Find, name: str) -> tuple[str, str, Callable[[], bool]] | None:
        """Text, file, and whether they are still the same: else Jinja2 loads them again."""
        try:
            text, file = find(name)
        except (FileNotFoundError, ValueError) as error:
            if isinstance(error, UnicodeDecodeError):
                raise TemplateFault(f"{name} is not text in UTF-8: {error.reason}") from error
            return None  # also for a name with NUL
        self._files.add(file)
        return text, file, lambda: (self._load(find, name) or ())[:2] == (text, file)

    def call_binop(self, _context: Context, operator: str, left: Any, right: Any) -> Any:
        if operator != "+":
            raise SecurityError(f"templates only place text; {operator} is not allowed")
        if all(hasattr(value, "__len__") for value in (left, right)):
            _check_length(len(left) + len(right))
        return left + right

    def handle_exception(self, source: str | None = None) -> NoReturn:
        """Jinja2 comes here with every exception from a template."""
        names = _names_at(sys.exc_info()[2], set(self.globals))
        try:
            super().handle_exception(source)
        except TemplateSyntaxError as error:
            place = f"{error.filename or error.name}, line {error.lineno}"
            raise TemplateFault(f"{place}: {error.message}") from error
        except TemplateError as error:
            known = f"; names here: {', '.join(names)}" if names else ""
            said = f"no template {error.name}" if isinstance(error, TemplateNotFound) else error
            raise TemplateFault(f"{self._place(error)}: {said}{known}") from error
        except RecursionError as error:
            raise TemplateFault(f"{self._place(error)}: it includes itself") from error
        except (ArithmeticError, TypeError, ValueError) as error:
            if not self._is_of_template(error):
                raise
            raise TemplateFault(f"{self._place(error)}: {error}") from error

    def _place(self, error: BaseException) -> str:
        """The template and the line where an exception passed last."""
        places = [(f.f_code.co_filename, line) for f, line in walk_tb(error.__traceback__)]
        file, line = next(place for place in reversed(places) if place[0] in self._files)
        return f"{file}, line {line}"

    def _is_of_template(self, error: BaseException) -> bool:
        """Whether a template or Jinja2 raised it, and not the code that the template called."""
        *_, (frame, _) = walk_tb(error.__traceback__)
        is_by_jinja = frame.f_globals.get("__name__", "").startswith(("jinja2.", __name__))
        return is_by_jinja or frame.f_code.co_filename in self._files


def _filtered(node: nodes.Node, name: str) -> nodes.Filter:
    given = cast(nodes.Expr, node)
    return nodes.Filter(given, name, [], [], None, None, lineno=node.lineno)


def _joined(items: Iterable[Any], separator: str = "") -> str:
    """Texts one after the other, if they are not too long together."""
    texts = [str(item) for item in items]
    _check_length(sum(map(len, texts)) + len(separator) * len(texts))
    return separator.join(texts)


def _printable(value: Any) -> Any:
    """What a template prints; a function, with its address in memory, is nothing to print."""
    if callable(value) and not isinstance(value, Undefined):
        raise SecurityError("a function is not text")
    return value


def _check_length(length: int) -> None:
    if length > _LONGEST:
        raise SecurityError(f"it makes more than {_LONGEST} characters")


def _names_at(trace: TracebackType | None, common: set[str]) -> list[str]:
    """The names passed to the template, without those of every template."""
    contexts = (frame.f_locals.get("context") for frame, _ in walk_tb(trace))
    found = next((c for c in contexts if isinstance(c, Context)), None)
    return sorted(set(found.get_all()) - common) if found is not None else []
