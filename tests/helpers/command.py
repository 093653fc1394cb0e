"""The `rigidsym` command: its program for a process of its own, and a call in this one."""

from __future__ import annotations

import sys
from contextlib import chdir, redirect_stderr, redirect_stdout
from io import StringIO
from pathlib import Path
from subprocess import CompletedProcess

import pytest

from rigidsym.commands.cli import main

ROOT = Path(__file__).resolve().parents[2]

# A test may run where SIGINT is ignored, under nohup or as a background job, and a child would
# inherit that: it listens again, as a command typed into a terminal does.
_PROGRAM = (
    "import signal; signal.signal(signal.SIGINT, signal.default_int_handler)\n"
    "from rigidsym.commands.cli import main; main()"
)
RIGIDSYM = (sys.executable, "-c", _PROGRAM)


def call(*arguments: str, cwd: Path, status: int = 0, **environment: str) -> CompletedProcess[str]:
    """What a command prints and its exit code; an error that is no message is raised."""
    out, errors = StringIO(), StringIO()
    with pytest.MonkeyPatch.context() as patch, chdir(cwd):
        patch.setattr(sys, "argv", ["rigidsym", *arguments])
        for name, value in environment.items():
            patch.setenv(name, value)
        with redirect_stdout(out), redirect_stderr(errors), pytest.raises(SystemExit) as ended:
            main()
    done = CompletedProcess(arguments, ended.value.code, out.getvalue(), errors.getvalue())
    assert done.returncode == status, done.stdout + done.stderr
    return done
