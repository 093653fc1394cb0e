"""Tables in parts that a page has room for."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from math import ceil

from rigidsym.formula.latex_pen import LatexPen
from rigidsym.formula.tree import Formula
from rigidsym.notes.document.document import NoteTable, Text, plain

_ROWS = 40  # on a page, beside a heading
_WORDS = 44  # letters of a column of words

Row = tuple[Text, ...]


def paged(table: NoteTable) -> Iterator[NoteTable]:
    """The table, or its parts; those after the first say in the caption that they go on."""
    heights = [max(map(_lines, row)) for row in table.rows]
    room = sum(heights) / max(1, ceil(sum(heights) / _ROWS))  # parts of about one height
    part: list[Row] = []
    used, caption = 0, table.caption
    for row, height in zip(table.rows, heights, strict=True):
        if part and used >= room:
            yield replace(table, caption=caption, rows=tuple(part))
            part, used, caption = [], 0, f"{table.caption}, continued"
        part.append(row)
        used += height
    yield replace(table, caption=caption, rows=tuple(part))


def _lines(cell: Text) -> int:
    """How high a cell stands: a fraction is as high as two lines."""
    if any(isinstance(span, Formula) and LatexPen().write(span).height for span in cell):
        return 2
    words = any(isinstance(span, str) and " " in span for span in cell)
    return ceil(len(plain(cell)) / _WORDS) or 1 if words else 1
