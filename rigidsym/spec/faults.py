"""Faults of a derivation file: collected with their place, and raised together."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from dataclasses import dataclass, field

from rigidsym.errors import Fault, SpecError
from rigidsym.spec.toml_lines import Path

_BARE_KEY = re.compile(r"[A-Za-z0-9_-]+")
_SHOWN = 40  # characters of a wrong text that a message repeats
_LONG_NUMBER = 1e12  # larger numbers are not repeated in a message


@dataclass(frozen=True, slots=True)
class Source:
    """The file that a specification was read from, and the line of each of its keys."""

    name: str
    lines: Mapping[Path, int] = field(default_factory=dict)

    def fault(self, path: Path, message: str) -> Fault:
        """A fault at a key, with its line or that of the table that lacks it; 0 without either."""
        known = path
        while known and known not in self.lines:
            known = known[:-1]
        one_line = message.replace("\n", "; ")
        return Fault(line=self.lines.get(known, 0), path=dotted(path), message=one_line)


class Faults:
    """The faults of one file, in the order in which they were found."""

    def __init__(self, source: Source) -> None:
        self.source = source
        self._found: list[Fault] = []

    def __len__(self) -> int:
        return len(self._found)

    def add(self, path: Path, message: str) -> None:
        """Note a fault, once."""
        fault = self.source.fault(path, message)
        self._found += [] if fault in self._found else [fault]

    def raise_if_any(self) -> None:
        """Raise SpecError with all faults, if there are any."""
        if self._found:
            raise SpecError(self.source.name, self._found)


def dotted(path: Path) -> str:
    """A path as a file would write it: rotation.angles[1]."""
    result = ""
    for part in path:
        if isinstance(part, int):
            result += f"[{part}]"
        else:
            key = part if _BARE_KEY.fullmatch(part) else shortened(part)
            result += f".{key}" if result else key
    return result


def described(value: object) -> str:
    """A value as a message shows it: its kind, and the value itself if it is short."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return f"the text {shortened(value)}"
    if isinstance(value, int | float):
        return f"the number {value}" if abs(value) < _LONG_NUMBER else "a number"
    if isinstance(value, list):
        return "a list"
    return "a table" if isinstance(value, Mapping) else "a date or a time"


def shortened(text: str) -> str:
    """The text in quotes, cut to a length that a message can hold, without control characters."""
    cut = text if len(text) <= _SHOWN else text[:_SHOWN] + "…"
    return json.dumps(cut, ensure_ascii=not cut.isprintable())
