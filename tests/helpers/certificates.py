"""Records, changes of them, and Coq."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
from functools import cache
from pathlib import Path
from typing import Any

import pytest

import rigidsym as rs
from rigidsym.models.library import rotation_from
from rigidsym.notes.formats.record import record
from rigidsym.tools.certificate.certificate import DEFINITIONS, definitions


def plain(record: dict[str, Any]) -> dict[str, Any]:
    content: dict[str, Any] = json.loads(json.dumps(record))
    return content


@cache
def record_of(text: str, quantities: tuple[str, ...] | None = None) -> dict[str, Any]:
    motion = rs.derive(rotation_from(text), *([quantities] if quantities else []))
    return plain(record(motion, {"rotations": [{"sequence": text}]}))


def printed(found: dict[str, Any], name: str) -> dict[str, Any]:
    """A quantity, or the first integral "constant NAME"."""
    group = "first_integrals" if name.startswith("constant ") else "quantities"
    return next(each for each in found[group] if each["name"] == name.removeprefix("constant "))


def spoil(found: dict[str, Any], quantity: str, before: str, after: str) -> None:
    """Change what is printed of a quantity, once."""
    text = json.dumps(printed(found, quantity)["expression"])
    assert before in text
    printed(found, quantity)["expression"] = json.loads(text.replace(before, after, 1))


def run_coq(folder: Path, text: str) -> int:
    """The exit code of coqc for theorems; Rotation.v is compiled once a folder."""
    coqc = shutil.which("coqc")
    if coqc is None and os.environ.get("RIGIDSYM_REQUIRE_COQ") != "1":
        pytest.skip("Coq is not installed")
    files = {"claims.v": text}
    if not (folder / DEFINITIONS).with_suffix(".vo").exists():
        files = {DEFINITIONS: definitions(), **files}
    for name, content in files.items():
        (folder / name).write_text(content, encoding="utf-8")
        done = subprocess.run([coqc, name], cwd=folder, check=False, capture_output=True)
    return done.returncode
