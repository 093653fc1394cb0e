"""Faults of a file, each with its path in the keys of the file; all are raised together."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from typing import NamedTuple

from rigidsym.errors import ExpressionError, Fault, MissingExtra, RigidsymError, SpecError

Path = tuple[str | int, ...]  # ("rotation", "angles", 1)

_BARE_KEY = re.compile(r"[A-Za-z0-9_-]+")
_SHOWN = 40  # characters of a wrong text that a message repeats
_LONG_NUMBER = 1e12  # larger numbers are not repeated in a message


class Place(NamedTuple):
    """A key of a file, and the faults of the whole file by their paths."""

    faults: dict[tuple[Path, str], None]  # in the order in which they were noted, each once
    path: Path = ()

    def at(self, *steps: str | int) -> Place:
        """The place of a key or an entry below this one."""
        return self._replace(path=(*self.path, *steps))

    def fault(self, message: str) -> None:
        """Note what is wrong here."""
        self.faults[self.path, message] = None

    def mistyped(self, value: object, expected: str) -> None:
        """Note that the value here is missing or has the wrong type."""
        got = f"expected {expected}, got {described(value)}"
        self.fault(f"missing; expected {expected}" if value is None else got)

    def noting(self, *steps: str | int) -> Noting:
        """Note an error of the block as a fault some steps below this place."""
        return Noting(self, self.at(*steps))

    @property
    def is_clean(self) -> bool:
        """Whether no fault is noted here or below."""
        depth = len(self.path)
        return not any(path[:depth] == self.path for path, _ in self.faults)

    def raise_faults(self, source: str) -> None:
        """Raise SpecError with all faults of the file `source`, if there are any."""
        if self.faults:
            raise SpecError(source, [fault_at(*fault) for fault in self.faults])


class Noting(NamedTuple):
    """A block whose error becomes a fault, unless it follows from one noted within `scope`."""

    scope: Place
    place: Place

    def __enter__(self) -> None:
        pass

    def __exit__(self, _kind: object, error: BaseException | None, _trace: object) -> bool:
        if not isinstance(error, RigidsymError) or isinstance(error, MissingExtra):
            return False
        if self.scope.is_clean:
            column = error.column if isinstance(error, ExpressionError) else 1
            self.place.fault(f"column {column}: {error}" if column > 1 else str(error))
        return True


def fault_at(path: Path, message: str) -> Fault:
    """A fault at a key, in one line."""
    return Fault(path=dotted(path), message=message.replace("\n", "; "))


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
        return "a number" if abs(value) >= _LONG_NUMBER else f"the number {value}"
    if isinstance(value, list):
        return f"a list of {len(value)}"
    return "a table" if isinstance(value, Mapping) else "a date or a time"


def shortened(text: str) -> str:
    """The text in quotes, cut to a length that a message can hold, without control characters."""
    cut = text if len(text) <= _SHOWN else text[:_SHOWN] + "…"
    return json.dumps(cut, ensure_ascii=not cut.isprintable())
