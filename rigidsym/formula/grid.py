"""Vectors and matrices in Unicode, in brackets that span the lines."""

from __future__ import annotations

from collections.abc import Sequence

from rigidsym.formula.unicode_pen import columns


def grid(prefix: str, rows: Sequence[Sequence[str]], *, tight: bool = False) -> list[str]:
    """The lines of `prefix` followed by a matrix in brackets; the prefix stands half-way down.

    A single column is set flush left, several columns are centred.
    """
    gap, margin = ("  ", "") if tight else ("   ", " ")
    widths = [max(map(columns, column)) for column in zip(*rows, strict=True)]
    place = _left if len(widths) == 1 else _centred
    inside = [margin + gap.join(map(place, row, widths)) + margin for row in rows]
    brackets = _brackets(len(rows))
    middle = (len(rows) - 1) // 2
    blank = " " * columns(prefix)
    return [
        f"{prefix if place == middle else blank}{left}{line}{right}"
        for place, (line, (left, right)) in enumerate(zip(inside, brackets, strict=True))
    ]


def _brackets(height: int) -> list[tuple[str, str]]:
    if height == 1:
        return [("[", "]")]
    return [("⎡", "⎤"), *[("⎢", "⎥")] * (height - 2), ("⎣", "⎦")]


def _left(text: str, width: int) -> str:
    return text + " " * (width - columns(text))


def _centred(text: str, width: int) -> str:
    before = (width - columns(text)) // 2
    return _left(" " * before + text, width)
