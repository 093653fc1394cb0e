"""The templates and shipped derivation files, however this package is installed.

A wheel carries them inside the package, in `_data`; in a checkout or an editable install their
folders are beside the package. Users may write templates of their own, so Jinja2 is sandboxed and
strict about names.
"""

from __future__ import annotations

import re
import sys
import tomllib
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from functools import cache
from pathlib import Path
from typing import Any, NoReturn

import jinja2
from jinja2.meta import find_referenced_templates
from jinja2.sandbox import ImmutableSandboxedEnvironment

from rigidsym.errors import TemplateFault, offer
from rigidsym.system.files import cache_folder

_PACKAGE = Path(__file__).resolve().parent.parent
_OWN: ContextVar[Path | None] = ContextVar("own templates", default=None)
NOTES = "templates/notes"  # those that users may replace
STYLES = ("lecture", "audit")  # of notes, the default first
# Tables of sentences that users may replace. What others hold is proved or read before.
_TABLES = ("en/equations.toml", "en/quantities.toml", "en/reasons.toml")
_ALIKE = 0.9  # share of characters that a misspelt name has in common with the right one
_HOMES = (_PACKAGE / "_data", _PACKAGE.parent)


@cache
def folder(kind: str) -> Path:
    """The folder of one kind: "templates", "templates/notes" or "derivations".

    Raises FileNotFoundError, with the places searched, if the package came without it.
    """
    for home in _HOMES:
        if (home / kind).is_dir():
            return home / kind
    places = " and ".join(str(home / kind) for home in _HOMES)
    raise FileNotFoundError(f"rigidsym is installed without its {kind}: looked for {places}")


@cache  # each is read once
def text(kind: str, name: str) -> str:
    """The text of one file of a folder."""
    return (folder(kind) / name).read_text(encoding="utf-8")


def names(kind: str, suffix: str) -> tuple[str, ...]:
    """The files of a folder and its folders that end in `suffix`, without it, in order."""
    home = folder(kind)
    files = [file.relative_to(home).as_posix() for file in home.rglob(f"*{suffix}")]
    return tuple(sorted(file.removesuffix(suffix) for file in files))


def replaceable() -> tuple[str, ...]:
    """The files that users may replace: the templates of notes, and tables of sentences."""
    return (*(f"{name}.jinja" for name in names(NOTES, ".jinja")), *_TABLES)


@contextmanager
def overridden_by(own: Path) -> Iterator[None]:
    """Inside, the templates in a folder of the user replace those of the same name.

    Raises TemplateFault if the folder holds none of these, and no style, LANGUAGE/NAME.md.jinja.
    """
    shipped = replaceable()
    if not any((own / name).is_file() for name in shipped) and not any(own.glob("*/*.md.jinja")):
        raise TemplateFault(
            f"{own} contains no template of notes: expected a style, such as en/handout.md.jinja, "
            f"or one of {', '.join(shipped)}; `rigidsym templates {own}` copies these there"
        )
    token = _OWN.set(own)
    try:
        yield
    finally:
        _OWN.reset(token)


def check_names(style: str) -> None:
    """Raises TemplateFault for a file of the user's that is no template of a note in this style.

    That is one nearly with the name of a shipped file, to which no template refers. Folders of
    other languages than English hold styles of any name.
    """
    if (own := _OWN.get()) is None:
        return
    from difflib import get_close_matches  # few users have templates of their own

    texts = _texts_of(own)
    shipped = [file.name for file in folder(NOTES).rglob("*.*")]
    for name in texts.keys() - {*replaceable(), style}:
        file = Path(name).name
        near = get_close_matches(file, shipped, n=1, cutoff=_ALIKE)
        # lecture_2 is a style of its own, and lectrue is not
        is_style = not near or (file != near[0] and near[0].partition(".")[0] in file)
        is_english = name.startswith("en/") or "/" not in name
        if is_english and not is_style and not any(name in text for text in texts.values()):
            raise TemplateFault(
                f"{own}/{name} would be ignored, since no template refers to it; "
                f"{offer(name, replaceable())}"
            )


def _texts_of(home: Path) -> dict[str, str]:
    """The templates of a folder, and the tables in the folders of its languages, by their names.

    Names that begin with a dot are those of backups and locks of editors.
    """
    files = sorted((*home.glob("[!.]*.jinja"), *home.glob("[!.]*/**/[!.]*.*")))
    return {
        file.relative_to(home).as_posix(): file.read_text(encoding="utf-8", errors="replace")
        for file in files
        if file.suffix in (".jinja", ".toml") and file.is_file()
    }


def sentences(name: str) -> Mapping[str, Any]:
    """The sentences of a table such as "en/reasons.toml" by their keys, the user's own first.

    Raises TemplateFault, with the file, for one that is not TOML, and for an unknown key.
    """
    text, file = template(name)
    own, shipped = _sentences(text, file), _sentences(*template(f"rigidsym/{name}"))
    if own is shipped:  # which is read for each phrase that a note prints
        return shipped
    for key, sentence in own.items():
        if key not in shipped:
            raise TemplateFault(f"{file}: no sentence has the key {key}; {offer(key, shipped)}")
        if type(sentence) is not type(shipped[key]):
            raise TemplateFault(f"{file}, {key}: expected a text in quotes")
        if name == "en/reasons.toml" and re.search("[$`]", sentence):
            raise TemplateFault(f"{file}, {key}: expected plain words and symbols such as Ω′")
    return {**shipped, **own}


@cache
def _sentences(text: str, file: str) -> Mapping[str, Any]:
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise TemplateFault(f"{file}: not TOML: {error}") from None


def place_of(words: str, name: str) -> str:
    """The file and line where words stand in a template or those that it uses, or its file."""
    names, texts = [name], dict[str, str]()
    for used in names:  # the list is extended while it is read
        with suppress(FileNotFoundError):  # after `ignore missing`
            text, file = template(used)
            texts[file] = text
            found = find_referenced_templates(environment().parse(text))
            names += dict.fromkeys(other for other in found if other and other not in names)
    for is_there in (str.__eq__, str.__contains__):  # another line may hold the words as well
        for file, text in texts.items():
            for number, line in enumerate(text.splitlines(), start=1):
                if is_there(line.strip(), words.strip()):
                    return f"{file}, line {number}"
    return template(name)[1]


@cache
def environment(**options: Any) -> SandboxedTemplates:
    """A Jinja2 environment over the templates; `options` are Jinja2's, delimiters for instance.

    Templates do not escape: each kind of document escapes its own text before it reaches a
    template. It is kept for all documents, with the templates that it has compiled.
    """
    return SandboxedTemplates(**options)


def template(name: str) -> tuple[str, str]:
    """(text, file) of one template, such as "en/note.md.jinja": the user's own if there is one.

    "rigidsym/en/note.md.jinja" is the shipped one, which the user's own may extend. Raises
    FileNotFoundError if there is none and for a name that leads out of the folder, and
    TemplateFault if it is not text.
    """
    path, own = _path(name), _OWN.get()
    if own is not None and (own / path).is_file():
        try:
            return (own / path).read_text(encoding="utf-8"), str(own / path)
        except UnicodeDecodeError as error:
            raise TemplateFault(f"{name} is not text in UTF-8: {error.reason}") from error
    return _shipped(name.removeprefix("rigidsym/"))


@cache  # Jinja2 asks for each template whenever it is used, a thousand times for 24 notes
def _path(name: str) -> Path:
    path = Path(name)
    if path.is_absolute() or ".." in path.parts:
        raise FileNotFoundError(f"{name} is not the name of a file among the templates")
    return path


@cache
def _shipped(name: str) -> tuple[str, str]:
    home = folder(NOTES) if (folder(NOTES) / name).is_file() else folder("templates")
    return (home / name).read_text(encoding="utf-8"), str(home / name)


# of Jinja2, and of Python for what a template includes, computes and calls
_FAULTS = (jinja2.TemplateError, RecursionError, ArithmeticError, TypeError, ValueError)


class SandboxedTemplates(ImmutableSandboxedEnvironment):
    """Templates in Jinja's sandbox, shipped ones and the user's own.

    An undefined name, bad syntax or a forbidden access raises TemplateFault with the template and
    the line. `--timeout` ends a template that does not.
    """

    def __init__(self, **options: Any) -> None:
        compiled = cache_folder("templates")
        settings: dict[str, Any] = {
            "loader": jinja2.FunctionLoader(self._load),
            "bytecode_cache": compiled and jinja2.FileSystemBytecodeCache(str(compiled)),
            "undefined": jinja2.StrictUndefined,
            "autoescape": False,
            "keep_trailing_newline": True,
            "trim_blocks": True,
            "lstrip_blocks": True,
        }
        super().__init__(**(settings | options))
        self._safe: dict[tuple[type, str], bool] = {}

    def is_safe_attribute(self, obj: Any, attr: str, value: Any) -> bool:
        """As Jinja2 says of the type; asked each time, it takes a twentieth of 24 notes."""
        if (key := (type(obj), attr)) not in self._safe:
            self._safe[key] = super().is_safe_attribute(obj, attr, value)
        return self._safe[key]

    def _load(self, name: str) -> tuple[str, str, Callable[[], bool]] | None:
        """Text, file, and whether they are still the same: else Jinja2 loads them again."""
        try:
            text, file = template(name)
        except (FileNotFoundError, ValueError):  # also a name with NUL
            return None
        if _OWN.get() and not Path(file).is_relative_to(folder("templates")):
            self._check_blocks(name, text, file)
        return text, file, lambda: (self._load(name) or ())[:2] == (text, file)

    def _check_blocks(self, name: str, text: str, file: str) -> None:
        """Raises TemplateFault if a template overrides a block that its parent does not have.

        Jinja2 ignores such a block, so that a misspelt name would change nothing.
        """
        own = base = self.parse(text, name, file)
        known: set[str] = set()
        while extended := base.find(jinja2.nodes.Extends):
            try:
                base = self.parse(*template(extended.template.as_const()))
            except (FileNotFoundError, ValueError, jinja2.nodes.Impossible):  # Jinja2 says so
                return
            known |= {block.name for block in base.find_all(jinja2.nodes.Block)}
        for block in own.body if base is not own else ():
            if isinstance(block, jinja2.nodes.Block) and block.name not in known:
                fault = f"there is no block {block.name} to override; {offer(block.name, known)}"
                raise TemplateFault(f"{file}, line {block.lineno}: {fault}")

    def handle_exception(self, source: str | None = None) -> NoReturn:
        """Jinja2 comes here with every exception from a template."""
        from traceback import walk_tb

        *_, (frame, _) = walk_tb(sys.exc_info()[2])
        try:
            super().handle_exception(source)
        except jinja2.TemplateSyntaxError as error:
            place = f"{error.filename or error.name}, line {error.lineno}"
            raise TemplateFault(f"{place}: {error.message}") from error
        except _FAULTS as error:
            is_of_jinja = frame.f_globals.get("__name__", "").startswith("jinja2.")
            is_of_template = is_of_jinja or "__jinja_template__" in frame.f_globals
            if not (is_of_template or isinstance(error, jinja2.TemplateError | RecursionError)):
                raise  # from a function that the template calls
            missing = f"no template {error}"
            texts = {jinja2.TemplateNotFound: missing, RecursionError: "it includes itself"}
            raise TemplateFault(f"{_place(error)}: {texts.get(type(error), error)}") from error


def _place(error: BaseException) -> str:
    """The template and the line where an exception passed last."""
    from traceback import walk_tb

    frames = list(walk_tb(error.__traceback__))
    inside = [(f, line) for f, line in frames if "__jinja_exception__" in f.f_globals]
    frame, line = inside[-1]
    return f"{frame.f_code.co_filename}, line {line}"
