"""What every command has: an example in its help, a time limit, and the kinds of its options."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from functools import partial, reduce
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from rigidsym.errors import printable
from rigidsym.system.processes import time_limit

if TYPE_CHECKING:
    _Type = click.ParamType[Any]
else:  # generic from click 8.2 on
    _Type = click.ParamType

Decorator = Callable[[Callable[..., Any]], Callable[..., Any]]
Options = Mapping[str, Any]  # the values of a command's options, by name

_MANY = (
    "integrate `state_derivative` of the kernels, which takes arrays of states and parameters, as "
    "in docs/howto/simulate.md"
)
_REMOVED = {  # options that left: what to use instead
    "--degrees": "functions take radians; convert angles with np.radians and np.degrees, or a log "
    "with `eval --degrees`",
    "--ensemble": _MANY,
    "--fragment": "write a template with the sections that you need, chosen by --style NAME",
    "--frames": "write the names into a template, chosen by --style NAME",
    "--grid": _MANY,
    "--language": "a language is a folder of templates, chosen by --style LANGUAGE/NAME",
    "--memory": "limit the memory of the shell with `ulimit -v`",
    "--method": "an integrator is chosen by `rigidsym simulate --method`",
    "--moodle": "enter the answers of the sheet with solutions into a quiz of your course",
    "--names": "--angles names the coordinates",
    "--only": "--quantity names the quantities",
    "--quantity": "--only names the quantities",
    "--scheduler": "use dask.array.apply_gufunc with a kernel, as in docs/howto/cluster.md",
    "--seed": _MANY,
    "--spread": _MANY,
}
POSITIVE = click.FloatRange(min=0, min_open=True)


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


def _between_commas(_context: object, _option: object, texts: Sequence[str]) -> tuple[str, ...]:
    """The names in all texts of an option, which may be repeated."""
    return tuple(name.strip() for name in chain.from_iterable(t.split(",") for t in texts))


# Kinds of options
file = partial(click.option, type=click.Path(dir_okay=False, path_type=Path))
flag = partial(click.option, is_flag=True)
names = partial(click.option, multiple=True, callback=_between_commas, metavar="NAME,...")
numbers = partial(click.option, multiple=True, type=_NamedNumber(), metavar="NAME=NUMBER")
EXISTING_FILE = click.Path(exists=True, dir_okay=False, path_type=Path)
JSON = flag("--json", "as_json", help="Print the results as JSON.")


class _Command(click.Command):
    """A command whose time is limited by an option, and which names substitutes of old options."""

    def __init__(self, *arguments: Any, **settings: Any) -> None:
        super().__init__(*arguments, **settings)
        timeout = click.Option(
            ["--timeout"],
            type=POSITIVE,
            default=300.0,
            metavar="SECONDS",
            help="Stop after this time; inf for no limit.  [default: 300]",
        )
        self.params.append(timeout)

    def parse_args(self, context: click.Context, args: list[str]) -> list[str]:
        try:
            return super().parse_args(context, args)
        except click.NoSuchOption as error:
            if error.option_name not in _REMOVED:
                raise
            substitute = f"there is no {error.option_name}: {_REMOVED[error.option_name]}"
            raise click.UsageError(substitute, context) from None

    def invoke(self, context: click.Context) -> Any:
        with time_limit(context.params.pop("timeout")):
            return super().invoke(context)


def command(example: str, *options: Decorator) -> Callable[[Callable[..., Any]], click.Command]:
    """Make a function a command with these options, and an example at the end of its help."""
    mark = "\b\n" if "\n" in example else ""  # by which click keeps the lines
    made = click.command(cls=_Command, epilog=f"{mark}Example: {example}")

    def decorate(function: Callable[..., Any]) -> click.Command:
        with_options = reduce(lambda inner, option: option(inner), reversed(options), function)
        return made(with_options)

    return decorate


def message(text: str) -> None:
    """A message on standard error; if nobody can read it, the exit code still tells."""
    with suppress(OSError):
        click.echo(f"rigidsym: {printable(text)}", err=True)
