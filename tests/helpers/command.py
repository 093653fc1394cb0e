"""The `rigidsym` command as a user runs it: a process of its own."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]

RIGIDSYM = (sys.executable, "-c", "from rigidsym.commands.cli import main; main()")


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
