"""What every command of rigidsym has: an example in its help, and options that count once."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import click


class Command(click.Command):
    """A command that refuses an option given twice when only the last would count."""

    def parse_args(self, context: click.Context, args: list[str]) -> list[str]:
        _, _, given = self.make_parser(context).parse_args(list(args))
        for parameter in given:
            is_many = getattr(parameter, "multiple", False) or getattr(parameter, "is_flag", False)
            if not is_many and given.count(parameter) > 1:
                raise click.UsageError(f"{parameter.opts[0]} is given twice", context)
        return super().parse_args(context, args)


def command(example: str) -> Callable[[Callable[..., Any]], click.Command]:
    """Make a function a command, with an example at the end of its help."""
    return click.command(cls=Command, epilog=f"Example: {example}")
