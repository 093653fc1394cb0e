"""The `rigidsym` command: its program for a process of its own, and a call in this one."""

from __future__ import annotations

import sys
from contextlib import chdir, redirect_stderr, redirect_stdout
from io import BytesIO, TextIOWrapper
from pathlib import Path
from subprocess import CompletedProcess

import pytest

from rigidsym.commands import cli

ROOT = Path(__file__).resolve().parents[2]

# A test may run where SIGINT is ignored, under nohup or as a background job, and a child would
# inherit that: it listens again, as a command typed into a terminal does.
_PROGRAM = (
    "import signal; signal.signal(signal.SIGINT, signal.default_int_handler)\n"
    "import sys; from rigidsym.__main__ import main; sys.exit(main())"  # as the installed command
)
RIGIDSYM = (sys.executable, "-c", _PROGRAM)


def run(*arguments: str, given: str = "", **environment: str) -> CompletedProcess[str]:
    """What a command makes of standard input; an error that is no message is raised."""
    stdin, out, errors = (TextIOWrapper(BytesIO(), encoding="utf-8") for _ in range(3))
    stdin.write(given)
    stdin.seek(0)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(sys, "argv", ["rigidsym", *arguments])
        patch.setattr(sys, "stdin", stdin)
        for name, value in environment.items():
            patch.setenv(name, value)
        with redirect_stdout(out), redirect_stderr(errors):
            status = cli.run()
    texts = []
    for stream in (out, errors):
        stream.seek(0)
        texts.append(stream.read())
    return CompletedProcess(arguments, status, *texts)


def call(*arguments: str, cwd: Path, status: int = 0, **environment: str) -> CompletedProcess[str]:
    """A command in a folder that ends with this exit code."""
    with chdir(cwd):
        done = run(*arguments, **environment)
    assert done.returncode == status, done.stdout + done.stderr
    return done
