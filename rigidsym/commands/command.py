"""Commands made of the tables beside them, each with a time limit; messages.

Nothing here imports NumPy or SymPy, so that `rigidsym --help` answers at once.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import Any

import click

from rigidsym.errors import printable
from rigidsym.system.files import table_beside
from rigidsym.system.processes import time_limit

Options = Mapping[str, Any]  # the values of a command's options, by name


def _between_commas(_context: object, _option: object, texts: Sequence[str]) -> tuple[str, ...]:
    """The names in all texts of an option, which may be repeated."""
    return tuple(name.strip() for text in texts for name in text.split(","))


def _by_name(
    context: click.Context, option: click.Parameter, texts: Sequence[str]
) -> dict[str, float]:
    """The numbers in texts NAME=NUMBER."""
    numbers: dict[str, float] = {}
    for text in texts:
        name, _, number = text.partition("=")
        try:
            numbers[name.strip()] = float(number)
        except ValueError:
            message = f"{option.opts[0]} {text}: expected NAME=NUMBER"
            raise click.UsageError(message, context) from None
    return numbers


def _use_templates(context: click.Context, _: object, folder: Path | None) -> None:
    """Use the templates of the directory until the command ends."""
    if folder is not None:
        from rigidsym.system.resources import overridden_by  # imports Jinja2

        context.with_resource(overridden_by(folder))


class _Path(click.Path):
    """A path; an empty text, as of a shell variable that is not set, is not the current folder."""

    def convert(self, value: Any, option: Any, context: Any) -> Any:
        return super().convert(value, option, context) if value else self.fail("an empty path")


class _Number(click.FloatRange):
    """A number, which Click's message about another text calls a float range."""

    name = "number"


class _Integer(click.IntRange):
    """A whole number."""

    name = "integer"


_path = partial(_Path, path_type=Path)
KINDS: Mapping[str, Mapping[str, Any]] = {  # what click knows of an option or argument
    "flag": {"is_flag": True},
    "names": {"multiple": True, "callback": _between_commas, "metavar": "NAME,..."},
    "numbers": {"multiple": True, "callback": _by_name, "metavar": "NAME=NUMBER"},
    "positive": {"type": _Number(min=0, min_open=True)},
    "number": {"type": _Number()},
    "count": {},  # a whole number from `least`, by default 1, to `most`
    "path": {"type": _path(exists=True)},
    "file": {"type": _path(exists=True, dir_okay=False)},
    "input": {"type": _path(exists=True, dir_okay=False, allow_dash=True)},
    "result": {"type": _path(dir_okay=False, allow_dash=True)},
    "folder": {"type": _path(file_okay=False)},
    "templates": {
        "type": _path(exists=True, file_okay=False),
        "callback": _use_templates,
        "expose_value": False,
    },
    "text": {},
}


_OURS = ("kind", "choices", "least", "most")  # keys of an entry that click does not take


class _Option(click.Option):
    """An option, which cannot be combined with those that would have no effect beside it."""

    def __init__(self, names: Sequence[str], excludes: Sequence[str] = (), **settings: Any) -> None:
        super().__init__(names, **settings)
        self.excludes = excludes

    def handle_parse_result(
        self, context: click.Context, on_line: Mapping[str, Any], rest: list[str]
    ) -> tuple[Any, list[str]]:
        given = {f"--{name}".replace("_", "-") for name in on_line}
        for other in self.excludes if self.opts[0] in given else ():
            if other in given:
                raise click.UsageError(f"{self.opts[0]} cannot be combined with {other}", context)
        return super().handle_parse_result(context, on_line, rest)


def _parameter(
    name: str, entry: Mapping[str, Any], choices: Mapping[str, Sequence[str]]
) -> click.Parameter:
    """An option, or an argument if its name has no dashes."""
    own = {key: value for key, value in entry.items() if key not in _OURS}
    settings = {**KINDS[entry.get("kind", "text")], **own}
    if words := choices.get(name.strip("-").replace("-", "_"), entry.get("choices")):
        settings["type"] = click.Choice(words)
    if entry.get("kind") == "count":
        settings["type"] = _Integer(entry.get("least", 1), entry.get("most"))
    if not name.startswith("-"):
        return click.Argument([name], **settings)
    return _Option([name], show_default=entry.get("default", "") != "", **settings)


class _Command(click.Command):
    """A command whose time is limited by an option, and which names substitutes of old options."""

    def parse_args(self, context: click.Context, args: list[str]) -> list[str]:
        try:
            return super().parse_args(context, args)
        except click.NoSuchOption as error:
            removed = table_beside(__file__, "removed_options.toml").items()
            old = (text for names, text in removed if error.option_name in names.split())
            if (substitute := next(old, None)) is None:
                raise
            message = f"there is no {error.option_name}: {substitute}"
            raise click.UsageError(message, context) from None

    def invoke(self, context: click.Context) -> Any:
        with time_limit(context.params.pop("timeout")):
            return super().invoke(context)


def command(name: str, **choices: Sequence[str]) -> Callable[[Callable[..., Any]], click.Command]:
    """Make a function the command of this name, as NAME.toml describes it.

    `choices` are the words that an option or argument may take, if only the code knows them.
    """
    entry, groups = table_beside(__file__, f"{name}.toml"), table_beside(__file__, "options.toml")
    tables: Iterable[Mapping[str, Any]] = (
        entry.get("arguments", {}),
        *(groups[group] for group in entry.get("groups", ())),
        entry.get("options", {}),
        groups["every"],
    )
    parameters = [_parameter(key, table[key], choices) for table in tables for key in table]
    return lambda function: _Command(
        name,
        callback=function,
        params=parameters,
        help=entry["help"],
        epilog=f"\b\nExample: {entry['example']}",  # by \b click keeps the lines
    )


def of_rotation(options: Options) -> dict[str, Any]:
    """The user's options of ROTATION, as `spec_for` takes them."""
    keys = ("angles", "constants", "scalar_last", "passive")
    return {key: options[key] for key in keys if options[key]}


def message(text: str) -> None:
    """A message on standard error; if nobody can read it, the exit code still tells."""
    with suppress(OSError):
        click.echo(f"rigidsym: {printable(text)}", err=True)
