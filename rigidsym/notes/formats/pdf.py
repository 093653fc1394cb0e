"""LaTeX -> PDF, by pdflatex if it is installed.

TeX runs in a directory of its own, may read and write nowhere else, and may run no program.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import tempfile
import time
from pathlib import Path

from rigidsym.errors import MissingTool, ToolFailed
from rigidsym.system.records import NamedTuple

DEBIAN_PACKAGES = ("texlive-latex-recommended", "texlive-pictures", "lmodern")
TIMEOUT = 120.0  # seconds

_OPTIONS = ("-interaction=nonstopmode", "-halt-on-error", "-file-line-error", "-no-shell-escape")
_COMMAND = ("pdflatex", *_OPTIONS, "note.tex")
_CONFINED = {"openin_any": "p", "openout_any": "p"}
_SAME_EVERY_TIME = {"SOURCE_DATE_EPOCH": "0", "FORCE_SOURCE_DATE": "1"}
_WARNING = re.compile(r"^(?:Over|Under)full .*|^.*\bWarning: .*|^No file .*", re.MULTILINE)
_NOT_FOUND = re.compile(r"File [`'](\S+?)' not found")
_UNFINISHED = re.compile(r"Rerun|^No file note\.", re.MULTILINE)
_LOG_LINES = 25
_MOST_RUNS = 5  # the first writes the numbers, the next uses them; tables may need more


class Typeset(NamedTuple):
    """A PDF, and what TeX complained of: overfull boxes, undefined references, any warning."""

    pdf: bytes
    warnings: tuple[str, ...]


def typeset(tex: str, *, timeout: float = TIMEOUT) -> Typeset:
    """The PDF of a LaTeX document; the same text gives the same bytes.

    Raises MissingTool if TeX or one of its packages is not installed, and ToolFailed, with the
    end of the log, if TeX stops at an error or runs longer than `timeout` seconds.
    """
    on_debian = f"on Debian: apt install {' '.join(DEBIAN_PACKAGES)}"
    if not has_tex():
        raise MissingTool(f"a PDF needs pdflatex, not found here; {on_debian}")
    end = time.monotonic() + timeout
    with tempfile.TemporaryDirectory(prefix="rigidsym-") as folder:
        source = Path(folder, "note.tex")
        source.write_text(tex, encoding="utf-8")
        for _ in range(_MOST_RUNS):
            try:
                run = _run(folder, end - time.monotonic())
            except subprocess.TimeoutExpired as error:
                raise ToolFailed(f"TeX was stopped after {timeout:g} seconds") from error
            log = run.stdout
            if package := _NOT_FOUND.search(log):
                raise MissingTool(f"a PDF needs {package[1]}, which TeX does not find; {on_debian}")
            if run.returncode:
                last_lines = "\n".join(log.splitlines()[-_LOG_LINES:])
                raise ToolFailed(f"TeX made no PDF; the end of its log:\n{last_lines}")
            if not _UNFINISHED.search(log):
                break
        return Typeset(source.with_suffix(".pdf").read_bytes(), tuple(_WARNING.findall(log)))


def has_tex() -> bool:
    """Whether pdflatex is on the search path."""
    return shutil.which(_COMMAND[0]) is not None


def _run(folder: str, timeout: float) -> subprocess.CompletedProcess[str]:
    """One run of TeX, which ends with this process or its patience."""
    return subprocess.run(
        _COMMAND,
        cwd=folder,
        # What confines TeX comes last, so that the environment of the user cannot undo it.
        env=_SAME_EVERY_TIME | os.environ | _CONFINED,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        encoding="utf-8",
        errors="replace",
        timeout=timeout,
        check=False,
    )
