"""What every command has: an example in its help, options that count once, limits on its work."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import click

from rigidsym.errors import printable
from rigidsym.system.limits import memory_limit, time_limit

_POSITIVE = click.FloatRange(min=0, min_open=True)
_LIMITS = (
    click.Option(
        ["--timeout"],
        type=_POSITIVE,
        default=300.0,
        metavar="SECONDS",
        help="Stop after this time; inf for no limit.  [default: 300]",
    ),
    click.Option(
        ["--memory"],
        type=_POSITIVE,
        default=4.0,
        metavar="GB",
        help="Stop when this much memory is needed; inf for no limit.  [default: 4]",
    ),
)


class Command(click.Command):
    """A command that refuses an option given twice when only the last would count."""

    def parse_args(self, context: click.Context, args: list[str]) -> list[str]:
        _, _, given = self.make_parser(context).parse_args(list(args))
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
    return click.command(cls=kind, epilog=f"Example: {example}")


def message(text: str) -> None:
    """A message on standard error."""
    click.echo(f"rigidsym: {printable(text)}", err=True)
