"""The command line: the group of commands, and how errors become messages and exit codes.

Results go to standard output, progress and messages to standard error. The file of a command is
imported when the command is called, so that `rigidsym --help` imports neither SymPy nor NumPy.
"""

from __future__ import annotations

import atexit
import io
import os
import sys
import warnings
from importlib import import_module
from typing import NoReturn

import click

from rigidsym.commands.command import message
from rigidsym.errors import RigidsymError
from rigidsym.system.files import table_beside
from rigidsym.system.processes import rare_collections
from rigidsym.version import __version__

_SUMMARIES = table_beside(__file__, "commands.toml")
_NUMERICAL = {"build", "identify", "inertia", "templates"}  # commands that do without SymPy


@rare_collections()
def main() -> NoReturn:
    """The process of the `rigidsym` command.

    It ends without freeing every object of SymPy by itself, which takes 25 ms. `python -m rigidsym`
    ends as any program does, so that profilers and debuggers, which come after it, can finish.
    """
    status = run()
    atexit._run_exitfuncs()
    os._exit(status)


def run() -> int:
    """Run a command, and turn errors into messages; returns the exit code."""
    for name in ("stdout", "stderr"):  # None if the caller closed them, as `2>&-` does
        stream = getattr(sys, name) or open(os.devnull, "w", encoding="utf-8")  # noqa: SIM115
        setattr(sys, name, stream)
        if isinstance(stream, io.TextIOWrapper):  # a terminal that cannot show φ shows a ?
            stream.reconfigure(errors="replace")
    warnings.showwarning = lambda text, *_: message(str(text))
    try:
        status = commands.main(standalone_mode=False)
        sys.stdout.flush()
    except click.ClickException as error:
        context = getattr(error, "ctx", None)
        hint = f"\nsee {context.command_path} --help" if context else ""
        message(error.format_message() + hint)
        status = error.exit_code
    except RigidsymError as error:
        message(str(error))
        status = error.exit_code
    except SystemExit:  # from Click, if the reader (`| head`) had enough, which is no error
        status = 0
    except (KeyboardInterrupt, click.Abort):
        message("interrupted")
        status = 130  # as of a process that SIGINT ends
    except MemoryError:
        message("out of memory")
        status = 1
    except OSError as error:
        place = f"{error.filename}: " if error.filename else ""
        message(f"{place}{error.strerror or error}")
        status = 1
    return status if isinstance(status, int) else 0


class _Commands(click.Group):
    """Commands that are imported when they are called."""

    def list_commands(self, context: click.Context) -> list[str]:  # noqa: ARG002
        return list(_SUMMARIES)

    def get_command(self, context: click.Context, name: str) -> click.Command | None:
        if name not in _SUMMARIES:
            from difflib import get_close_matches  # few commands are misspelt

            near = get_close_matches(name, _SUMMARIES, n=1)
            hint = f"; did you mean {near[0]}?" if near else ""
            raise click.UsageError(f"no command {name!r}{hint}", context)
        if name not in _NUMERICAL:
            # SymPy's modules import each other, from frame to frame. If they start further down,
            # Python takes and returns the last piece of its stack 1,500 times, in 50 ms.
            import_module("sympy")
        command = import_module(f"rigidsym.commands.{name}").command
        assert isinstance(command, click.Command)
        return command

    def format_commands(self, context: click.Context, formatter: click.HelpFormatter) -> None:  # noqa: ARG002
        with formatter.section("Commands"):
            formatter.write_dl(list(_SUMMARIES.items()))


@click.group(
    cls=_Commands,
    invoke_without_command=True,
    context_settings={"help_option_names": ["-h", "--help"]},
    epilog="Example: rigidsym derive ZXZ",
)
@click.version_option(__version__, prog_name="rigidsym")
@click.pass_context
def commands(context: click.Context) -> None:
    """Derive the kinematics of a rotation, prove each step, and write kernels and notes."""
    if os.environ.get("NO_COLOR"):
        context.color = False
    if context.invoked_subcommand is None:
        click.echo(context.get_help())
