"""Python text in the layout that `ruff format` gives it, so that no formatter need run."""

from __future__ import annotations

import re
from collections.abc import Sequence
from functools import lru_cache
from textwrap import wrap

WIDTH = 88
_BEFORE_AN_OPERATOR = re.compile(r" (?=[-+*/] )")
_QUOTES = '"""'


def bracketed(indent: int, head: str, items: Sequence[str], tail: str) -> str:
    """Items between brackets: in one line, or in a line of their own, or each in one."""
    margin, inner = " " * indent, " " * (indent + 4)
    joined = ", ".join(items)
    if len(f"{margin}{head}{joined}{tail}") <= WIDTH:
        return f"{margin}{head}{joined}{tail}"
    if len(inner + joined) <= WIDTH:
        return f"{margin}{head}\n{inner}{joined}\n{margin}{tail}"
    return exploded(indent, head, items, tail)


def exploded(indent: int, head: str, items: Sequence[str], tail: str) -> str:
    """Items between brackets, each in a line of its own; an item may hold lines already."""
    margin, inner = " " * indent, " " * (indent + 4)
    lines = "".join(f"{inner}{item},\n" for item in items)
    return f"{margin}{head}\n{lines}{margin}{tail}"


def tuple_of(items: Sequence[str]) -> str:
    return f"({', '.join(items)}{',' if len(items) == 1 else ''})"


def assignment_lines(indent: int, name: str, value: str) -> str:
    """One assignment; a value without brackets that is too wide stands in brackets of its own."""
    margin, inner = " " * indent, " " * (indent + 4)
    line = f"{margin}{name} = {value}"
    if len(line) <= WIDTH or "(" in value:
        return line
    pieces = [value] if len(inner + value) <= WIDTH else _BEFORE_AN_OPERATOR.split(value)
    body = "\n".join(inner + piece for piece in pieces)
    return f"{margin}{name} = (\n{body}\n{margin})"


def docstring(paragraphs: Sequence[str | Sequence[str]], indent: int = 0) -> str:
    """The inside of a docstring: paragraphs are filled, sequences of lines kept."""
    room = WIDTH - indent
    first = filled(paragraphs[0], room - len(_QUOTES) * (2 if len(paragraphs) == 1 else 1))
    blocks = [first, *(filled(paragraph, room) for paragraph in paragraphs[1:])]
    margin = " " * indent
    text = "\n\n".join("\n".join(margin + line for line in block) for block in blocks)
    text = text.strip().replace("\\", "\\\\").replace(_QUOTES, r"\"\"\"")
    return f"{text}\n{margin}" if "\n" in text else text


def filled(paragraph: str | Sequence[str], width: int) -> list[str]:
    """The lines of a paragraph."""
    return list(_wrapped(paragraph, width) if isinstance(paragraph, str) else paragraph)


@lru_cache(maxsize=1024)  # modules of one kind have most paragraphs in common
def _wrapped(paragraph: str, width: int) -> list[str]:
    return wrap(paragraph, width, break_long_words=False, break_on_hyphens=False)
