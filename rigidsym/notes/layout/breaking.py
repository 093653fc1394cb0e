"""Where a long formula breaks: before a + or −, in as shallow a bracket as will do.

The pens write ` + ` and ` - ` between the terms of a sum and nowhere else, so that the places are
seen in the text of the formula, whichever pen wrote it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

Measure = Callable[[str], float]

_SIGNS = (" + ", " - ", " − ")
_LAST = 50  # a divisor's brackets are as deep as so many others: 1/(1 + n²) is broken last
_NEVER = 1000  # inside braces and between \left and \right no line can break


@dataclass(frozen=True, slots=True)
class Line:
    """One line of a formula, and in how many open brackets it starts."""

    text: str
    depth: int = 0


def break_lines(formula: str, width: float, measure: Measure, indent: float) -> list[Line]:
    """The lines of a formula; each after the first starts with its sign.

    `width` and `indent`, which a line loses for each open bracket, are in the units of `measure`.
    What has no place to break stays whole, so that a line may still be too wide.
    """
    lines: list[Line] = []
    for text in _lines(formula, width, measure, indent):
        lines.append(Line(text, _open_brackets(lines)))
    return lines


def _lines(formula: str, width: float, measure: Measure, indent: float) -> list[str]:
    level = min((level for _, level in _signs(formula)), default=_NEVER)
    if measure(formula) <= width or level >= _NEVER // 2:  # a part may close more than it opens
        return [formula]
    lines = [""]
    for chunk in _chunks(formula, level):
        longer = f"{lines[-1]} {chunk}".lstrip()
        if measure(longer) <= width:
            lines[-1] = longer
        else:
            # only a term that is too wide for a line of its own is broken inside its brackets
            lines += _lines(chunk, width - indent * (level % _LAST), measure, indent)
    return [line for line in lines if line]


def _open_brackets(lines: list[Line]) -> int:
    return sum(line.text.count("(") - line.text.count(")") for line in lines)


def _chunks(formula: str, level: int) -> list[str]:
    """The formula cut before each sign that stands `level` brackets deep."""
    cuts = [place for place, depth in _signs(formula) if depth == level]
    ends = [*cuts, len(formula)]
    return [formula[a:b].strip() for a, b in zip([0, *cuts], ends, strict=True)]


def _signs(formula: str) -> Iterator[tuple[int, int]]:
    """Each sign between two terms: its place, and how many brackets are open there."""
    level = 0
    opened: list[int] = []
    for place, character in enumerate(formula):
        if character in "({":
            opened.append(_weight(formula, place, r"\left"))
            level += opened[-1]
        elif character in ")}":  # a part may close what it did not open
            level -= opened.pop() if opened else _weight(formula, place, r"\right")
        elif formula.startswith(_SIGNS, place):
            yield place, level


def _weight(formula: str, place: int, command: str) -> int:
    if formula[place] in "{}" or formula.endswith(command, 0, place):
        return _NEVER
    return _LAST if formula.endswith("/", 0, place) else 1
