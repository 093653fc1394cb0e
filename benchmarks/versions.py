"""The same bytes on the lowest and newest versions of Python, SymPy, NumPy, Jinja2, click and rich.

Each interpreter that is found (python3.11, python3.12, ...) gets two virtual environments: one with
the lower bounds of pyproject.toml, one with the newest releases. In each, `rigidsym derive` writes
the same models, every time with another hash seed, locale and time zone. Needs a package index.
"""

from __future__ import annotations

import hashlib
import os
import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path
from tempfile import TemporaryDirectory

from benchmarks.measure import ROOT, Settings, progress
from benchmarks.report import Column, Figure, Report, Table

MODELS = (
    ("ZXZ", "--certificates", "--conversions"),
    ("quaternion", "--derivative", "angular_velocity_body:q"),
    ("z(2*phi - psi) x(theta) z(psi/3)", "--style", "audit"),
    ("rotation_vector", "--only", "rotation_matrix,angular_velocity_body"),
)
TARGETS = "numpy,c,javascript,jax,numba"
ZONES = (("C", "UTC"), ("C.UTF-8", "Asia/Tokyo"), ("POSIX", "America/St_Johns"))
COMMAND = "from rigidsym.commands.cli import main; main()"


def interpreters() -> list[str]:
    """The interpreters that run; a name on the path may belong to one that is not installed."""
    named = (shutil.which(f"python3.{minor}") for minor in range(11, 20))
    started = [path for path in named if path and _starts(path)]
    return started or [sys.executable]


def _starts(path: str) -> bool:
    return subprocess.run([path, "-c", ""], capture_output=True, check=False).returncode == 0


def requirements(*, lowest: bool) -> list[str]:
    """What the package needs, at its lower bounds or without any."""
    whole = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    needed = whole["project"]["dependencies"]
    return [text.replace(">=", "==") if lowest else re.split("[>=]", text)[0] for text in needed]


def environment(folder: Path, python: str, packages: list[str]) -> str:
    """The interpreter of a new virtual environment; raises RuntimeError if pip fails."""
    subprocess.run([python, "-m", "venv", folder], check=True)
    inside = str(folder / "bin" / "python")
    pip = [
        inside,
        "-m",
        "pip",
        "install",
        "--quiet",
        "--no-compile",
        "--only-binary=:all:",
        *packages,
    ]
    done = subprocess.run(pip, capture_output=True, text=True, check=False)
    if done.returncode:
        raise RuntimeError(f"{' '.join(packages)}: {done.stderr.strip().splitlines()[-1]}")
    return inside


def digest(python: str, out: Path, place: int) -> tuple[str, int]:
    """SHA-256 of all files that are derived, and their number; raises RuntimeError for none."""
    locale, zone = ZONES[place % len(ZONES)]
    inside = {"LC_ALL": locale, "TZ": zone, "PYTHONHASHSEED": str(place), "PYTHONPATH": str(ROOT)}
    for model in MODELS:
        command = [python, "-c", COMMAND, "derive", *model, "--target", TARGETS, "--out", str(out)]
        done = subprocess.run(
            command, env={**os.environ, **inside}, capture_output=True, text=True, check=False
        )
        if done.returncode:
            raise RuntimeError(f"{' '.join(model)}: {done.stderr.strip().splitlines()[-1]}")
    total, files = hashlib.sha256(), sorted(path for path in out.rglob("*") if path.is_file())
    for path in files:
        total.update(str(path.relative_to(out)).encode() + b"\0" + path.read_bytes() + b"\0")
    return total.hexdigest()[:16], len(files)


def run(settings: Settings) -> Report:  # noqa: ARG001  (as the others)
    """Each interpreter with the lowest and the newest packages."""
    rows: list[tuple[str, str, str, int]] = []
    left_out = []
    for python in interpreters():
        for kind in ("lowest", "newest"):
            progress(f"{python}, {kind} packages")
            packages = requirements(lowest=kind == "lowest")
            with TemporaryDirectory() as name:
                try:
                    inside = environment(Path(name, "venv"), python, packages)
                except RuntimeError as error:  # no wheels for this interpreter
                    left_out.append(f"{Path(python).name}, {kind}: {error}")
                    continue
                try:
                    found = digest(inside, Path(name, "out"), len(rows))
                except RuntimeError as error:
                    found = str(error), 0
            rows.append((Path(python).name, kind, *found))
    progress()
    same = len({row[2] for row in rows}) == 1 and all(row[3] for row in rows)
    heads = ("interpreter", "packages", "SHA-256 of all files, or what went wrong", "files")
    return Report(
        title="Versions: the same bytes everywhere",
        tables=(
            Table(", ".join(requirements(lowest=True)), tuple(map(Column, heads)), tuple(rows)),
        ),
        figures=(Figure("different outputs", "1", str(len({row[2] for row in rows})), same),),
        notes=tuple(left_out),
    )
