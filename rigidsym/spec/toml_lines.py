"""The line of each key and each list entry of a TOML text.

tomllib gives no positions. This module reads the text a second time, by the layout of TOML and not
its values, after tomllib has accepted it.
"""

from __future__ import annotations

import re
import tomllib
from bisect import bisect

Path = tuple[str | int, ...]  # ("rotation", "angles", 1)

_BLANK = re.compile(r"(?:[ \t\r\n]|#[^\n]*)*")  # also comments and line ends
_STRING = re.compile(
    r'"""(?:\\.|[^\\])*?"""(?:"{0,2})'  # up to two quotes may precede the closing three
    r"|'''.*?'''(?:'{0,2})"
    r'|"(?:\\.|[^"\\])*"'
    r"|'[^']*'",
    re.DOTALL,
)
_BARE_KEY = re.compile(r"[A-Za-z0-9_-]+")
_BARE_VALUE = re.compile(r"[^,\]}#\n]*")  # a number, a date with its time, true or false


def locate(text: str) -> dict[Path, int]:
    """{path: line} of all tables, keys and list entries; lines count from 1.

    `text` must be valid TOML.
    """
    return _LineReader(text).lines


class _LineReader:
    def __init__(self, text: str) -> None:
        self.lines: dict[Path, int] = {}
        self._text, self._place = text, 0
        self._ends = [k for k, character in enumerate(text) if character == "\n"]
        self._tables: dict[Path, int] = {}  # how many tables a [[list of tables]] holds so far
        table: Path = ()
        while self._skip() < len(text):
            if self._at("["):
                table = self._header()
            else:
                self._pair(table)

    def _header(self) -> Path:
        """[a.b] or [[a.b]], where a name that is a list of tables means its last entry."""
        line = self._line()
        brackets = 1 + self._at("[[")
        self._place += brackets
        *before, last = self._keys()
        self._place += brackets
        path: Path = ()
        for key in before:
            path = self._last((*path, key))
            self.lines.setdefault(path, line)
        path = (*path, last)
        if brackets == 2:
            self.lines.setdefault(path, line)
            self._tables[path] = self._tables.get(path, 0) + 1
            path = self._last(path)
        self.lines[path] = line
        return path

    def _last(self, path: Path) -> Path:
        return (*path, self._tables[path] - 1) if path in self._tables else path

    def _pair(self, path: Path) -> None:
        """key = value, where a dotted key brings tables of its own."""
        line = self._line()
        for key in self._keys():
            path = (*path, key)
            self.lines.setdefault(path, line)
        self._place += 1  # the equals sign
        self._value(path)

    def _keys(self) -> list[str]:
        """A dotted key, and the blanks after it."""
        keys: list[str] = []
        while not keys or self._at("."):
            self._place += bool(keys)
            self._skip()
            is_text = self._at('"') or self._at("'")
            key = self._take(_STRING if is_text else _BARE_KEY)
            keys.append(str(tomllib.loads(f"key = {key}")["key"]) if is_text else key)
            self._skip()
        return keys

    def _value(self, path: Path) -> None:
        self._skip()
        if not (self._at("[") or self._at("{")):
            self._take(_STRING if self._at('"') or self._at("'") else _BARE_VALUE)
            return
        is_list, count = self._at("["), 0
        self._place += 1
        self._skip()
        while not self._at("]" if is_list else "}"):
            if is_list:
                self.lines[*path, count] = self._line()
                self._value((*path, count))
                count += 1
            else:
                self._pair(path)
            self._skip()
            self._place += self._at(",")
            self._skip()
        self._place += 1

    def _at(self, mark: str) -> bool:
        return self._text.startswith(mark, self._place)

    def _skip(self) -> int:
        self._take(_BLANK)
        return self._place

    def _take(self, pattern: re.Pattern[str]) -> str:
        match = pattern.match(self._text, self._place)
        if match is None:
            raise ValueError(f"not TOML at character {self._place}")
        self._place = match.end()
        return match[0]

    def _line(self) -> int:
        return bisect(self._ends, self._place) + 1
