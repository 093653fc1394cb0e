"""What every command has: an example in its help, options that count once, limits on its work."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from dataclasses import field, fields
from functools import wraps
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from rigidsym.errors import printable
from rigidsym.system.processes import memory_limit, time_limit

if TYPE_CHECKING:
    _Type = click.ParamType[Any]
else:  # generic from click 8.2 on
    _Type = click.ParamType

_REMOVED = {  # options that left: what to use instead
    "--degrees": "functions take radians; convert angles with np.radians and np.degrees, or a log "
    "with `eval --degrees`",
    "--language": "a language is a folder of templates, chosen by --style LANGUAGE/NAME",
    "--scheduler": "use dask.array.apply_gufunc with a kernel, as in docs/howto/cluster.md",
    "--fragment": "write a template with the sections that you need, chosen by --style NAME",
    "--moodle": "enter the answers of the sheet with solutions into a quiz of your course",
    "--method": "an integrator is chosen by `rigidsym simulate --method`",
    "--frames": "write the names into a template, chosen by --style NAME",
}
POSITIVE = click.FloatRange(min=0, min_open=True)
_LIMITS = (
    click.Option(
        ["--timeout"],
        type=POSITIVE,
        default=300.0,
        metavar="SECONDS",
        help="Stop after this time; inf for no limit.  [default: 300]",
    ),
    click.Option(
        ["--memory"],
        type=POSITIVE,
        default=4.0,
        metavar="GB",
        help="Stop if more memory is needed; inf for no limit.  [default: 4]",
    ),
)


class _Names(_Type):
    """Names between commas."""

    name = "names"

    def convert(self, value: Any, param: object, ctx: object) -> list[str]:  # noqa: ARG002
        return value if isinstance(value, list) else [name.strip() for name in value.split(",")]


class _NamedNumber(_Type):
    """NAME=NUMBER, as a pair."""

    name = "number"

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> tuple[str, float]:
        name, _, number = value.partition("=")
        try:
            return name.strip(), float(number)
        except ValueError:
            flag = param.opts[0] if param else ""
            raise click.UsageError(f"{flag} {value}: expected NAME=NUMBER", ctx) from None


NAMES, NAMED_NUMBER = _Names(), _NamedNumber()
EXISTING_FILE = click.Path(exists=True, dir_okay=False, path_type=Path)
FILE = click.Path(dir_okay=False, path_type=Path)
_OPTION = "click option"
_KINDS: dict[Any, dict[str, Any]] = {  # annotation of a field: how click reads its option
    "bool": {"is_flag": True},
    "list[str] | None": {"type": NAMES, "metavar": "NAME,..."},
    "tuple[list[str], ...]": {"type": NAMES, "multiple": True, "metavar": "NAME,..."},
    "tuple[str, ...]": {"multiple": True},
    "tuple[tuple[str, float], ...]": {
        "type": NAMED_NUMBER,
        "multiple": True,
        "metavar": "NAME=NUMBER",
    },
    "Path | None": {"type": FILE},
}


def option(*flags: str, **settings: Any) -> Any:
    """A field of a dataclass that a command-line option sets, of the type of its annotation."""
    if "default" in settings:
        settings["show_default"] = True
    return field(metadata={_OPTION: (flags, settings)})


def with_options(kind: type[Any]) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Give a command the options of a dataclass; it receives them as the argument `options`."""

    def decorate(command: Callable[..., None]) -> Callable[..., None]:
        @wraps(command)
        def run(*arguments: Any, **given: Any) -> None:
            options = kind(**{f.name: given.pop(f.name) for f in fields(kind)})
            command(*arguments, options=options, **given)

        for each in reversed(fields(kind)):
            flags, settings = each.metadata[_OPTION]
            run = click.option(*flags, each.name, **_KINDS.get(each.type, {}) | settings)(run)
        return run

    return decorate


def unique(names: Iterable[Sequence[str]]) -> tuple[str, ...]:
    """The names of an option that may be repeated, each once."""
    return tuple(dict.fromkeys(chain.from_iterable(names)))


class Command(click.Command):
    """A command that refuses null characters, and an option twice where only the last counts."""

    def parse_args(self, context: click.Context, args: list[str]) -> list[str]:
        for text in args:
            if "\0" in text:
                raise click.UsageError(f"{text!r}: expected text without null characters", context)
        try:
            _, _, given = self.make_parser(context).parse_args(list(args))
        except click.NoSuchOption as error:
            if error.option_name not in _REMOVED:
                raise
            substitute = _REMOVED[error.option_name]
            raise click.UsageError(
                f"there is no {error.option_name}: {substitute}", context
            ) from None
        for parameter in given:
            is_many = getattr(parameter, "multiple", False) or getattr(parameter, "is_flag", False)
            if not is_many and given.count(parameter) > 1:
                raise click.UsageError(f"{parameter.opts[0]} is given twice", context)
        return super().parse_args(context, args)


class LimitedCommand(Command):
    """A command whose time and memory are limited by options."""

    def __init__(self, *arguments: Any, **settings: Any) -> None:
        super().__init__(*arguments, **settings)
        self.params += _LIMITS

    def invoke(self, context: click.Context) -> Any:
        timeout, memory = context.params.pop("timeout"), context.params.pop("memory")
        with memory_limit(memory), time_limit(timeout, label=f"rigidsym {self.name}"):
            return super().invoke(context)


def command(
    example: str, *, kind: type[Command] = LimitedCommand
) -> Callable[[Callable[..., Any]], click.Command]:
    """Make a function a command, with an example at the end of its help."""
    mark = "\b\n" if "\n" in example else ""  # by which click keeps the lines
    return click.command(cls=kind, epilog=f"{mark}Example: {example}")


def message(text: str) -> None:
    """A message on standard error; if nobody can read it, the exit code still tells."""
    with suppress(OSError):
        click.echo(f"rigidsym: {printable(text)}", err=True)
