"""Generated files against a fresh derivation, by what their record says they were made from."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from itertools import zip_longest
from pathlib import Path
from typing import Any

from rigidsym.errors import CheckError
from rigidsym.notes.formats.record import SCHEMA, SCHEMA_VERSION
from rigidsym.pipeline import product
from rigidsym.spec.derivation_file import DerivationSpec


@dataclass(frozen=True, kw_only=True, slots=True)
class Finding:
    """What became of one file."""

    path: Path
    problem: str = ""  # "" where it is as derived

    @property
    def is_fine(self) -> bool:
        return not self.problem

    def __str__(self) -> str:
        return f"{self.path}: {self.problem or 'as derived'}"


def findings(paths: Iterable[Path]) -> Iterator[Finding]:
    """One finding for each file that a record under the paths stands for.

    Raises CheckError for a path without a record.
    """
    for path in paths:
        for record in _records(path):
            yield from _compare(record)


def _records(path: Path) -> list[Path]:
    """The records for a folder, recursively, or for one generated file."""
    if path.is_dir():
        found = sorted(file for file in path.rglob("*.json") if _is_record(file))
    else:
        beside = path.with_suffix(".json")
        found = [beside] if beside.is_file() and _is_record(beside) else []
    if not found:
        raise CheckError(
            f"{path}: no record of a derivation here; expected the NAME.json that stands beside "
            "generated files"
        )
    return found


def _is_record(file: Path) -> bool:
    return _read(file).get("schema") == SCHEMA


def _read(file: Path) -> Mapping[str, Any]:
    """The content of a JSON file; empty where it is not an object."""
    try:
        content = json.loads(file.read_text(encoding="utf-8"))
    except (json.JSONDecodeError, UnicodeDecodeError, RecursionError):
        return {}
    return content if isinstance(content, dict) else {}


def _compare(record: Path) -> Iterator[Finding]:
    content = _read(record)
    version = content.get("schema_version")
    if version != SCHEMA_VERSION:
        yield Finding(path=record, problem=f"schema version {version}, expected {SCHEMA_VERSION}")
        return
    fresh = product(DerivationSpec.from_data(content.get("request"), source=str(record)))
    for name, text in fresh.files.items():
        yield _finding(record.parent / name, text)


def _finding(path: Path, expected: str) -> Finding:
    if not path.is_file():
        return Finding(path=path, problem="missing")
    found = path.read_bytes()
    if found == expected.encode("utf-8"):
        return Finding(path=path)
    lines = zip_longest(found.decode("utf-8", "replace").split("\n"), expected.split("\n"))
    line = next((place for place, (a, b) in enumerate(lines, start=1) if a != b), 1)
    return Finding(path=path, problem=f"differs from the derivation at line {line}")
