"""LaTeX -> PDF, by latexmk and pdflatex where they are installed.

TeX runs in a directory of its own, may read and write nowhere else, and may run no program.
"""

from __future__ import annotations

import os
import re
import shutil
import signal
import subprocess
import tempfile
from pathlib import Path
from typing import NamedTuple

from rigidsym.errors import MissingTool, ToolFailed

PROGRAMS = ("latexmk", "pdflatex")
DEBIAN_PACKAGES = ("texlive-latex-recommended", "texlive-pictures", "latexmk", "lmodern")
TIMEOUT = 120.0  # seconds

_COMMAND = (
    "latexmk",
    "-norc",
    "-pdf",
    "-interaction=nonstopmode",
    "-halt-on-error",
    "-file-line-error",
    "-latexoption=-no-shell-escape",
    "note.tex",
)
_CONFINED = {"openin_any": "p", "openout_any": "p"}
_SAME_EVERY_TIME = {"SOURCE_DATE_EPOCH": "0", "FORCE_SOURCE_DATE": "1"}
_WARNING = re.compile(r"^(?:Over|Under)full .*|^.*\bWarning: .*|^No file .*", re.MULTILINE)
_LOG_LINES = 25
# latexmk overlooks this where two runs of TeX end within a second and their files have one size
_UNFINISHED = "Rerun LaTeX"
_NOT_FOUND = re.compile(r"File [`'](\S+?)' not found")
_PACKAGES = {  # of Debian and of TeX Live; most others are named like their file
    "tikz.sty": ("texlive-pictures", "pgf"),
    "lmodern.sty": ("lmodern", "lm"),
}
_MOST_RERUNS = 4


class Typeset(NamedTuple):
    """A PDF, and what TeX complained of: overfull boxes, undefined references, any warning."""

    pdf: bytes
    warnings: tuple[str, ...]


def typeset(tex: str, *, timeout: float = TIMEOUT) -> Typeset:
    """The PDF of a LaTeX document; the same text gives the same bytes.

    Raises MissingTool where TeX or one of its packages is not installed, and ToolFailed, with the
    end of the log, where TeX stops at an error or runs longer than `timeout` seconds.
    """
    missing = missing_programs()
    if missing:
        raise MissingTool(
            f"a PDF needs {' and '.join(missing)}, not found here; on Debian: "
            f"apt install {' '.join(DEBIAN_PACKAGES)}"
        )
    with tempfile.TemporaryDirectory(prefix="rigidsym-") as folder:
        source = Path(folder, "note.tex")
        source.write_text(tex, encoding="utf-8")
        output = _run(folder, timeout)
        for _ in range(_MOST_RERUNS):
            path = source.with_suffix(".log")
            log = path.read_text(encoding="utf-8", errors="replace") if path.is_file() else output
            if _UNFINISHED not in log:
                break
            output = _run(folder, timeout, "-g")
        pdf = source.with_suffix(".pdf")
        if not pdf.is_file():
            if package := _NOT_FOUND.search(log):
                name = package[1]
                usual = ("texlive-latex-recommended", Path(name).stem)
                debian, tex_live = _PACKAGES.get(name, usual)
                raise MissingTool(
                    f"a PDF needs {name}, which TeX does not find; on Debian: apt install "
                    f"{debian}, with TeX Live: tlmgr install {tex_live}"
                )
            last_lines = "\n".join(log.splitlines()[-_LOG_LINES:])
            raise ToolFailed(f"TeX made no PDF; the end of its log:\n{last_lines}")
        return Typeset(pdf=pdf.read_bytes(), warnings=tuple(_WARNING.findall(log)))


def missing_programs() -> tuple[str, ...]:
    """The programs that typesetting needs and that are not on the search path."""
    return tuple(program for program in PROGRAMS if shutil.which(program) is None)


def _run(folder: str, timeout: float, *options: str) -> str:
    """What latexmk prints; whatever ends this process or its patience ends TeX too."""
    process = subprocess.Popen(
        [*_COMMAND, *options],
        cwd=folder,
        env=_SAME_EVERY_TIME | os.environ | _CONFINED,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        start_new_session=True,  # so that latexmk and its pdflatex are ended together
    )
    try:
        output, _ = process.communicate(timeout=timeout)
    except subprocess.TimeoutExpired as error:
        raise ToolFailed(f"TeX was stopped after {timeout:g} seconds") from error
    finally:
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL)
            process.communicate()
    return output.decode("utf-8", "replace")
