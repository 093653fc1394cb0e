"""Faults of a file, each with its path in the keys of the file; all are raised together."""

from __future__ import annotations

import re
import reprlib
from collections.abc import Iterator
from contextlib import contextmanager

from rigidsym.errors import ExpressionError, Fault, MissingExtra, RigidsymError, SpecError
from rigidsym.system.records import NamedTuple

Path = tuple[str | int, ...]  # ("rotation", "angles", 1)

_BARE_KEY = re.compile(r"[A-Za-z0-9_-]+")


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
        got = f"expected {expected}, got {reprlib.repr(value)}"
        self.fault(f"missing; expected {expected}" if value is None else got)

    @contextmanager
    def noting(self, *steps: str | int) -> Iterator[None]:
        """Note an error of the block as a fault some steps below, unless one is noted here."""
        try:
            yield
        except MissingExtra:
            raise
        except RigidsymError as error:
            if self.is_clean:
                column = error.column if isinstance(error, ExpressionError) else 1
                message = f"column {column}: {error}" if column > 1 else str(error)
                self.at(*steps).fault(message)

    @property
    def is_clean(self) -> bool:
        """Whether no fault is noted here or below."""
        depth = len(self.path)
        return not any(path[:depth] == self.path for path, _ in self.faults)

    def raise_faults(self, source: str) -> None:
        """Raise SpecError with all faults of the file `source`, if there are any."""
        if self.faults:
            raise SpecError(source, [fault_at(*fault) for fault in self.faults])


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
            key = part if _BARE_KEY.fullmatch(part) else reprlib.repr(part)
            result += f".{key}" if result else key
    return result
