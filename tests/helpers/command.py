"""The `rigidsym` command as a user runs it: a process of its own."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]

# A test may run where SIGINT is ignored, under nohup or as a background job, and a child would
# inherit that: it listens again, as a command typed into a terminal does.
_PROGRAM = (
    "import signal; signal.signal(signal.SIGINT, signal.default_int_handler)\n"
    "from rigidsym.commands.cli import main; main()"
)
RIGIDSYM = (sys.executable, "-c", _PROGRAM)


def call(*arguments: str, cwd: Path, status: int = 0, **environment: str):
    done = subprocess.run(
        [*RIGIDSYM, *arguments],
        cwd=cwd,
        env={**os.environ, "PYTHONPATH": str(ROOT), **environment},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == status, done.stdout + done.stderr
    return done
