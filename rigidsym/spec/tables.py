"""Tables of a derivation file, read key by key: faults are noted, and reading goes on.

Each fault has its line and its path in the keys of the file. At the end all are raised together.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Mapping, Sequence

from rigidsym.errors import Fault, SpecError, offer
from rigidsym.spec.faults import Faults, Source, described, dotted, shortened
from rigidsym.spec.toml_lines import Path, locate

MOST_CHARACTERS = 50_000
_LONGEST_LINE = 1000  # tomllib's time grows with the square of the dots in a key
_PLACE = re.compile(r" \(at (?:line (\d+), column (\d+)|end of document)\)$")


class Table:
    """A table at a path. The readers return None for a missing or wrong key."""

    def __init__(self, data: Mapping[str, object], path: Path, faults: Faults) -> None:
        self._data = data
        self._path = path
        self._faults = faults

    def value(self, key: str) -> object:
        return self._data.get(key)

    @property
    def data(self) -> Mapping[str, object]:
        """All keys and values, as the file has them."""
        return self._data

    @property
    def path(self) -> Path:
        return self._path

    def instead(self, data: Mapping[str, object]) -> Table:
        """A table with other data at this path."""
        return Table(data, self._path, self._faults)

    def fault(self, message: str, *at: str | int) -> None:
        """Note a fault at a path below this table."""
        self._faults.add((*self._path, *at), message)

    def mistyped(self, value: object, expected: str, *at: str | int) -> None:
        """Note that the value at a path below this table has the wrong type."""
        self.fault(f"expected {expected}, got {described(value)}", *at)

    def refuse_others(self, known: Sequence[str], hints: Mapping[str, str] | None = None) -> None:
        """Note every key that is not known; a hint replaces the nearest name."""
        for key in self._data:
            if key not in known:
                hint = (hints or {}).get(key) or offer(key, known)
                self.fault(f"unknown key; {hint}", key)

    def text(self, key: str) -> str | None:
        value = self.value(key)
        if value is None or isinstance(value, str):
            return value
        self.mistyped(value, "a text in quotes", key)
        return None

    def number(self, key: str) -> float | None:
        value = self.value(key)
        if value is None or (isinstance(value, int | float) and not isinstance(value, bool)):
            return value
        self.mistyped(value, "a number", key)
        return None

    def choice(self, key: str, known: Sequence[str]) -> str | None:
        """One of the names that are known."""
        text = self.text(key)
        if text is not None and text not in known:
            self.fault(f"unknown name {shortened(text)}; {offer(text, known)}", key)
            return None
        return text

    def flag(self, key: str) -> bool | None:
        value = self.value(key)
        if value is None or isinstance(value, bool):
            return value
        self.mistyped(value, "true or false", key)
        return None

    def table(self, key: str) -> Table | None:
        value = self.value(key)
        if isinstance(value, Mapping):
            return Table(value, (*self._path, key), self._faults)
        if value is not None:
            self.mistyped(value, f"a table [{dotted((*self._path, key))}]", key)
        return None

    def tables(self, key: str, expected: str) -> list[Table]:
        """A list of tables; empty, with the fault noted, if it is missing or wrong."""
        value = self.value(key)
        if isinstance(value, list) and value and all(isinstance(v, Mapping) for v in value):
            return [Table(v, (*self._path, key, k), self._faults) for k, v in enumerate(value)]
        self.fault(f"expected {expected}", key)
        return []

    def texts(
        self, key: str, expected: str, *, may_be_empty: bool = False
    ) -> list[str | None] | None:
        """A list of texts, with None for each entry that is not a text."""
        value = self.value(key)
        if value is None:
            return None
        if not isinstance(value, list):
            self.mistyped(value, expected, key)
            return None
        if not value and not may_be_empty:
            self.fault(f"the list is empty; expected {expected}", key)
        for place, entry in enumerate(value):
            if not isinstance(entry, str):
                self.mistyped(entry, "a text in quotes", key, place)
        return [entry if isinstance(entry, str) else None for entry in value]

    def choices(
        self, key: str, known: Sequence[str], *, may_be_empty: bool = False
    ) -> tuple[str, ...] | None:
        """A list of different known names."""
        expected = f'a list of names such as ["{known[0]}"]'
        texts = self.texts(key, expected, may_be_empty=may_be_empty)
        if texts is None:
            return None
        for place, text in enumerate(texts):
            if text is None:
                continue
            if text not in known:
                self.fault(f"unknown name {shortened(text)}; {offer(text, known)}", key, place)
            elif text in texts[:place]:
                self.fault(f"{text} is named twice", key, place)
        return tuple(text for text in texts if text is not None)


def read_toml(text: str, source: str) -> tuple[Table, Faults]:
    """The table of a whole file; raises SpecError for a text that is not TOML."""
    text = text.removeprefix("\ufeff")  # some editors put this mark before everything else
    _check_length(text, source)
    try:
        data = tomllib.loads(text)
        faults = Faults(Source(source, locate(text)))
    except tomllib.TOMLDecodeError as error:
        raise SpecError(source, [_syntax_fault(text, error)]) from None
    except RecursionError:
        fault = Fault(line=0, path="", message="lists or tables nested too deeply to be read")
        raise SpecError(source, [fault]) from None
    return Table(data, (), faults), faults


def _check_length(text: str, source: str) -> None:
    faults = [
        Fault(
            line=line,
            path="",
            message=f"a line of {length} characters; expected at most {_LONGEST_LINE}",
        )
        for line, length in enumerate(map(len, text.split("\n")), start=1)
        if length > _LONGEST_LINE
    ]
    if len(text) > MOST_CHARACTERS:
        message = f"a file of {len(text)} characters; expected at most {MOST_CHARACTERS}"
        faults = [Fault(line=0, path="", message=message)]
    if faults:
        raise SpecError(source, faults)


def _syntax_fault(text: str, error: tomllib.TOMLDecodeError) -> Fault:
    """What tomllib says, with the line as a number; it stops at the first fault."""
    message = str(error)
    place = _PLACE.search(message)
    if place is None:
        return Fault(line=0, path="", message=f"not TOML: {message}")
    line = int(place[1] or text.rstrip().count("\n") + 1)
    where = f"column {place[2]}" if place[2] else "the end of the file"
    return Fault(line=line, path="", message=f"not TOML: {message[: place.start()]}, at {where}")
