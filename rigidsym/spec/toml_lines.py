"""The line of each key and each list entry of a TOML text.

tomllib gives no positions. This module reads the text a second time, by the layout of TOML and not
its values, after tomllib has accepted it.
"""

from __future__ import annotations

import re
import tomllib

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
    reader = _LineReader(text)
    reader.document()
    return reader.lines


class _LineReader:
    def __init__(self, text: str) -> None:
        self.lines: dict[Path, int] = {}
        self._text = text
        self._place = 0
        self._line, self._counted = 1, 0  # the line of the character at `_counted`
        self._tables: dict[Path, int] = {}  # how many tables a [[list of tables]] holds so far

    def document(self) -> None:
        table: Path = ()
        self._skip()
        while self._place < len(self._text):
            if self._at("["):
                table = self._header()
            else:
                self._pair(table)
            self._skip()

    def _header(self) -> Path:
        """[a.b] or [[a.b]], where a name that is a list of tables means its last entry."""
        line = self._here()
        is_list = self._at("[[")
        self._place += 1 + is_list
        keys = self._keys()
        self._skip()
        self._place += 1 + is_list
        path: Path = ()
        for key in keys[:-1]:
            path = self._last((*path, key))
            self.lines.setdefault(path, line)
        path = (*path, keys[-1])
        if is_list:
            self.lines.setdefault(path, line)
            self._tables[path] = self._tables.get(path, 0) + 1
            path = self._last(path)
        self.lines[path] = line
        return path

    def _last(self, path: Path) -> Path:
        return (*path, self._tables[path] - 1) if path in self._tables else path

    def _pair(self, table: Path) -> None:
        """key = value, where a dotted key brings tables of its own."""
        line = self._here()
        path = table
        for key in self._keys():
            path = (*path, key)
            self.lines.setdefault(path, line)
        self._skip()
        self._place += 1  # the equals sign
        self._skip()
        self._value(path)

    def _keys(self) -> list[str]:
        keys = [self._key()]
        self._skip()
        while self._at("."):
            self._place += 1
            keys.append(self._key())
            self._skip()
        return keys

    def _key(self) -> str:
        self._skip()
        if self._at('"'):
            return str(tomllib.loads("key = " + self._take(_STRING))["key"])
        return self._take(_STRING)[1:-1] if self._at("'") else self._take(_BARE_KEY)

    def _value(self, path: Path) -> None:
        if self._at("["):
            self._list(path)
        elif self._at("{"):
            self._inline_table(path)
        else:
            self._take(_STRING if self._at('"') or self._at("'") else _BARE_VALUE)

    def _list(self, path: Path) -> None:
        self._place += 1
        self._skip()
        count = 0
        while not self._at("]"):
            entry = (*path, count)
            self.lines[entry] = self._here()
            self._value(entry)
            count += 1
            self._comma()
        self._place += 1

    def _inline_table(self, path: Path) -> None:
        self._place += 1
        self._skip()
        while not self._at("}"):
            self._pair(path)
            self._comma()
        self._place += 1

    def _comma(self) -> None:
        self._skip()
        self._place += self._at(",")
        self._skip()

    def _at(self, mark: str) -> bool:
        return self._text.startswith(mark, self._place)

    def _skip(self) -> None:
        self._take(_BLANK)

    def _take(self, pattern: re.Pattern[str]) -> str:
        match = pattern.match(self._text, self._place)
        if match is None:
            raise ValueError(f"not TOML at character {self._place}")
        self._place = match.end()
        return match[0]

    def _here(self) -> int:
        self._line += self._text.count("\n", self._counted, self._place)
        self._counted = self._place
        return self._line
