"""Tables of a derivation file, read key by key; faults are noted, and reading continues.

Each fault has its path in the keys of the file. At the end all are raised together.
"""

from __future__ import annotations

import json
import re
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple, TypeVar
from unicodedata import category

from rigidsym.errors import ExpressionError, Fault, MissingExtra, RigidsymError, SpecError, offer

Path = tuple[str | int, ...]  # ("rotation", "angles", 1)

_BARE_KEY = re.compile(r"[A-Za-z0-9_-]+")
_ONE_LINE = (("about",), ("unit",), ("label",))  # keys whose texts become part of a line
_SHOWN = 40  # characters of a wrong text that a message repeats
_LONG_NUMBER = 1e12  # larger numbers are not repeated in a message


class Faults:
    """The faults of one file, in the order in which they were found."""

    def __init__(self, source: str) -> None:
        self.source = source  # the file, in messages
        self._found: list[Fault] = []

    def __len__(self) -> int:
        return len(self._found)

    def add(self, path: Path, message: str) -> None:
        """Note a fault, once."""
        fault = fault_at(path, message)
        self._found += [] if fault in self._found else [fault]

    def raise_if_any(self) -> None:
        """Raise SpecError with all faults, if there are any."""
        if self._found:
            raise SpecError(self.source, self._found)

    def refuse_control_characters(self, data: object) -> None:
        """Note every text that would end a comment or a line of what is printed from it.

        Sentences and expressions may take several lines.
        """
        stack: list[tuple[Path, object]] = [((), data)]
        while stack:
            path, value = stack.pop()
            if isinstance(value, Mapping):
                stack += [((*path, str(key)), entry) for key, entry in value.items()]
            elif isinstance(value, list):
                stack += [((*path, place), entry) for place, entry in enumerate(value)]
            elif isinstance(value, str):
                allowed = "" if path[-1:] in _ONE_LINE else "\n\t"
                for character in value:
                    if category(character) in ("Cc", "Cs") and character not in allowed:
                        code = f"U+{ord(character):04X}"
                        self.add(path, f"the text contains the control character {code}")
                        break


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
        return f"the number {value}" if abs(value) < _LONG_NUMBER else "a number"
    if isinstance(value, list):
        return "a list"
    return "a table" if isinstance(value, Mapping) else "a date or a time"


def shortened(text: str) -> str:
    """The text in quotes, cut to a length that a message can hold, without control characters."""
    cut = text if len(text) <= _SHOWN else text[:_SHOWN] + "…"
    return json.dumps(cut, ensure_ascii=not cut.isprintable())


T = TypeVar("T")
MOST_CHARACTERS = 50_000
_LONGEST_LINE = 1000  # tomllib's time grows with the square of the dots in a key


class Table:
    """A table at a path. The readers return None for a missing or wrong key."""

    def __init__(self, data: Mapping[str, object], path: Path, faults: Faults) -> None:
        self.data = data  # all keys and values, as the file has them
        self.path = path
        self._faults = faults

    def value(self, key: str) -> object:
        return self.data.get(key)

    def instead(self, data: Mapping[str, object]) -> Table:
        """A table with other data at this path."""
        return Table(data, self.path, self._faults)

    def fault(self, message: str, *at: str | int) -> None:
        """Note a fault at a path below this table."""
        self._faults.add((*self.path, *at), message)

    def mistyped(self, value: object, expected: str, *at: str | int) -> None:
        """Note that the value at a path below this table is missing or has the wrong type."""
        found = f"expected {expected}, got {described(value)}"
        self.fault(f"missing; expected {expected}" if value is None else found, *at)

    def noting(self, *at: str | int) -> _Noting:
        """Note an error from inside as a fault at a path, unless a fault inside has led to it."""
        return _Noting(self._faults, (*self.path, *at), len(self._faults))

    def refuse_others(self, known: Sequence[str], hints: Mapping[str, str] | None = None) -> None:
        """Note every key that is not known; a hint replaces the nearest name."""
        for key in self.data:
            if key not in known:
                self.fault(f"unknown key; {(hints or {}).get(key) or offer(key, known)}", key)

    def text(self, key: str) -> str | None:
        return self._of_kind(key, str, "a text in quotes")

    def number(self, key: str) -> float | None:
        return self._of_kind(key, (int, float), "a number")

    def flag(self, key: str) -> bool | None:
        return self._of_kind(key, bool, "true or false")

    def _of_kind(self, key: str, kind: type[T] | tuple[type[T], ...], expected: str) -> T | None:
        """The value of a key; true and false are no numbers."""
        value = self.value(key)
        if isinstance(value, kind) and isinstance(value, bool) == (kind is bool):
            return value
        if value is not None:
            self.mistyped(value, expected, key)
        return None

    def choice(self, key: str, known: Sequence[str]) -> str | None:
        """One of the names that are known."""
        text = self.text(key)
        if text is None or text in known:
            return text
        self.fault(f"unknown name {shortened(text)}; {offer(text, known)}", key)
        return None

    def table(self, key: str) -> Table | None:
        value = self.value(key)
        if isinstance(value, Mapping):
            return Table(value, (*self.path, key), self._faults)
        if value is not None:
            self.mistyped(value, f"a table [{dotted((*self.path, key))}]", key)
        return None

    def tables(self, key: str, expected: str) -> list[Table]:
        """A list of tables; empty, with the fault noted, if it is missing or wrong."""
        value = self.value(key)
        if isinstance(value, list) and value and all(isinstance(v, Mapping) for v in value):
            return [Table(v, (*self.path, key, k), self._faults) for k, v in enumerate(value)]
        self.fault(f"expected {expected}", key)
        return []

    def texts(self, key: str, expected: str, *, may_be_empty: bool = False) -> dict[int, str]:
        """The texts of a list by their places in it; empty if it is missing or wrong."""
        value = self.value(key)
        if value is None:
            return {}
        if not isinstance(value, list):
            self.mistyped(value, expected, key)
            return {}
        if not value and not may_be_empty:
            self.fault(f"the list is empty; expected {expected}", key)
        found = {place: text for place, text in enumerate(value) if isinstance(text, str)}
        for place in set(range(len(value))) - found.keys():
            self.mistyped(value[place], "a text in quotes", key, place)
        for place, text in found.items():
            if text in value[:place]:
                self.fault(f"{text} is named twice", key, place)
        return found

    def choices(
        self, key: str, known: Sequence[str], *, may_be_empty: bool = False
    ) -> tuple[str, ...] | None:
        """A list of different known names."""
        if self.value(key) is None:
            return None
        expected = f'a list of names such as ["{known[0]}"]'
        texts = self.texts(key, expected, may_be_empty=may_be_empty)
        for place, text in texts.items():
            if text not in known:
                self.fault(f"unknown name {shortened(text)}; {offer(text, known)}", key, place)
        return tuple(texts.values())


class _Noting(NamedTuple):
    """A block whose errors become faults, and which is then left."""

    faults: Faults
    at: Path
    before: int  # faults that were noted

    def __enter__(self) -> None:
        pass

    def __exit__(self, _kind: object, error: BaseException | None, _trace: object) -> bool:
        if not isinstance(error, RigidsymError) or isinstance(error, MissingExtra):
            return False
        if len(self.faults) == self.before:
            column = error.column if isinstance(error, ExpressionError) else 1
            self.faults.add(self.at, f"column {column}: {error}" if column > 1 else str(error))
        return True


def read_toml(text: str, source: str) -> tuple[Table, Faults]:
    """The table of a whole file; raises SpecError for a text that is not TOML."""
    text = text.removeprefix("\ufeff")  # some editors put this mark before everything else
    if faults := list(_too_long(text)):
        raise SpecError(source, faults)
    try:
        data = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise SpecError(source, [Fault(message=f"not TOML: {error}")]) from None
    except RecursionError:
        message = "lists or tables nested too deeply to be read"
        raise SpecError(source, [Fault(message=message)]) from None
    noted = Faults(source)
    noted.refuse_control_characters(data)
    return Table(data, (), noted), noted


def _too_long(text: str) -> Iterator[Fault]:
    if len(text) > MOST_CHARACTERS:
        yield Fault(message=f"a file of {len(text)} characters; expected at most {MOST_CHARACTERS}")
        return
    for line, length in enumerate(map(len, text.split("\n")), start=1):
        if length > _LONGEST_LINE:
            yield Fault(f"line {line} has {length} characters; expected at most {_LONGEST_LINE}")
