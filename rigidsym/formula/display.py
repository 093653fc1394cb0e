"""How an equation is set so that it fits: on one line, on two, in shorthand, or entry by entry.

The choice is by estimated width, in this order. Where entries are abbreviated or listed, the note
says so.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Literal, NamedTuple

import sympy as sp

from rigidsym.formula.latex_pen import EQUAL, QUAD, WIDE_GAP, LatexPen, environment
from rigidsym.formula.letters import Letters
from rigidsym.formula.pen import Segment, break_lines
from rigidsym.formula.scalars import factored, formula_of, listed_entries, matrix_of
from rigidsym.formula.tree import NOTHING, Formula, equal, indexed, row

PAGE = 39.2  # ems of a display on a page, beside a number such as (13)
BOX = 0.96  # ems that the box around a result takes

Done = Literal["", "abbreviated", "listed"]

INDENT = r"\quad"  # of a line that goes on; the next bracket adds another
_MOST_INDENTS = 5


@dataclass(frozen=True, kw_only=True, slots=True)
class Equation:
    """One display: sides that are equal, the last of them a matrix or a scalar that is given."""

    sides: tuple[Formula, ...]
    matrix: sp.ImmutableMatrix | None = None
    scalar: sp.Expr | None = None
    entries: tuple[Formula, ...] = ()  # a name an entry, if these are not those of the first side
    number: int | None = None
    label: str = ""
    function: str = ""  # of the kernel module, as it is called
    proved: tuple[Formula, ...] = ()
    unproved: tuple[Formula, ...] = ()
    is_result: bool = False  # what a reader looks up stands in a box

    @property
    def names(self) -> tuple[Formula, ...]:
        """A name for each entry of the matrix, row by row, for a listing."""
        assert self.matrix is not None
        rows, columns = self.matrix.shape
        shape = (rows,) if columns == 1 else (rows, columns)
        return self.entries or indexed(self.sides[0], shape)


class Display(NamedTuple):
    """The inside of a display, how wide it is, and what was done that the reader must know."""

    inside: str
    width: float  # ems; it may be more than was asked for, where there is no place to break
    environment: Literal["", "aligned", "gathered"] = ""  # of lines below one another
    done: Done = ""
    lines: int = 1  # of a listing
    height: float = 0.0  # of a listing, in lines of text
    is_broken: bool = False  # whether a value of the equation, or an entry, fits on no line
    is_boxed: bool = False

    @property
    def text(self) -> str:
        text = environment(self.environment, self.inside) if self.environment else self.inside
        return rf"\boxed{{{text}}}" if self.is_boxed else text


class _Row(NamedTuple):
    text: str
    is_high: bool = False


def display(
    equation: Equation, letters: Letters, width: float, pen: LatexPen | None = None
) -> Display:
    """The equation in the first form that fits into `width` ems; a listing where none does.

    A result is in a box, which is part of its width. `pen` is that of LaTeX by default, in the
    notation of the letters.
    """
    inside = replace(equation, number=None, label="", function="", proved=(), unproved=())
    return _displayed(inside, letters, width, pen or LatexPen(letters.notation))


@lru_cache(maxsize=512)  # what was fitted is printed, often in several formats
def _displayed(equation: Equation, letters: Letters, width: float, pen: LatexPen) -> Display:
    box = BOX if equation.is_result else 0.0
    inside = _Setter(letters, pen).display(equation, width - box)
    shown = inside._replace(width=inside.width + box, is_boxed=equation.is_result)
    is_broken = shown.width > width
    if equation.matrix is None and equation.scalar is None:
        is_broken = False
    elif shown.lines > 1 and not is_broken:
        usual = min(len(equation.sides), 2)
        if equation.matrix is not None:
            usual = len(listed_entries(equation.names, equation.matrix))
        is_broken = shown.lines > usual
    return shown._replace(is_broken=is_broken)


def pack(equations: Sequence[Equation], letters: Letters, width: float, pen: LatexPen) -> str:
    """Short equations, as many on a line as fit into `width` ems."""
    displays = [display(equation, letters, width, pen) for equation in equations]
    rows = _packed((((_Row(shown.text),), shown.width) for shown in displays), width)
    texts = [text for text, _ in rows]
    return texts[0] if len(texts) == 1 else environment("gathered", pen.joined(texts, True))


def _packed(blocks: Iterable[tuple[Sequence[_Row], float]], width: float) -> list[_Row]:
    """Blocks below one another, given with their widths; short ones side by side."""
    rows: list[_Row] = []
    room = 0.0
    for block, own in blocks:
        if len(block) == 1 and own + 2 * QUAD <= room:
            last, first = rows[-1], block[0]
            is_high = last.is_high or first.is_high
            rows[-1] = _Row(f"{last.text} {WIDE_GAP}{first.text}", is_high)
            room -= own + 2 * QUAD
        else:
            rows += block
            room = width - own if len(block) == 1 else 0.0
    return rows


def broken(formula: Formula, width: float, pen: LatexPen) -> list[Segment]:
    """The lines of a formula; within high brackets it is broken only if nothing else will do."""
    lines = break_lines(pen.write(formula), width, QUAD)
    if widest(lines) <= width:
        return lines
    loose = break_lines(replace(pen, loose=True).write(formula), width, QUAD)
    return min(lines, loose, key=widest)


def widest(lines: Sequence[Segment]) -> float:
    """The width of the widest line; those after the first are indented."""
    first, *others = lines
    return max(first.width, *(QUAD * (1 + line.level) + line.width for line in others), 0.0)


class _Setter:
    """Sets equations with one pen."""

    def __init__(self, letters: Letters, pen: LatexPen) -> None:
        self.letters = letters
        self.pen = pen

    def display(self, equation: Equation, width: float) -> Display:
        # in another notation a rate may be its own definition
        sides = tuple(dict.fromkeys(map(self.letters.notation.applied, equation.sides)))
        matrix = equation.matrix
        if equation.scalar is not None:
            # a value stands on one line with its sides, or below them
            definition = [equal(*sides[1:])] if sides[1:] else []
            sides = (sides[0], *definition, formula_of(equation.scalar, self.letters))
        if equation.scalar is not None or matrix is None:
            whole = self.pen.write(equal(*sides))
            if whole.width <= width or len(sides) == 1:
                return Display(whole.text, whole.width)
            first, *others = sides
            heads = [first, *[NOTHING] * (len(others) - 1)]
            return self._listing(heads, others, width, is_high=True)
        if not sides:
            return self._definitions(equation.entries, matrix, width)
        factor, rest = factored(matrix)  # a fraction that all entries hold
        full: Formula = matrix_of(rest, self.letters)
        full = full if factor == 1 else row(formula_of(factor, self.letters), full)
        for form in self._forms(sides, full, self.pen):
            if form.width <= width:
                return form
        if matrix.shape[1] > 1:
            for form in self._forms(sides, full, replace(self.pen, short=True)):
                if form.width <= width:
                    return form._replace(done="abbreviated")
        names, entries = zip(*listed_entries(equation.names, matrix), strict=True)
        values = [formula_of(entry, self.letters) for entry in entries]
        return self._listing(names, values, width)._replace(done="listed")

    def _forms(self, sides: Sequence[Formula], matrix: Formula, pen: LatexPen) -> Iterator[Display]:
        """The equation on one line; broken before its last equals sign; and then farther left."""
        whole = pen.write(equal(*sides, matrix))
        yield Display(whole.text, whole.width)
        if len(sides) > 1:
            first, above, last = map(pen.write, (sides[0], equal(*sides[1:]), matrix))
            needed = first.width + EQUAL + max(above.width, last.width)
            lines = (f"{first.text} &= {above.text}", f"&= {last.text}")
            yield Display(pen.joined(lines, True), needed, "aligned")
            needed = EQUAL + max(first.width + above.width, QUAD + last.width)
            lines = (f"&{first.text} = {above.text}", rf"&{INDENT} {{}} = {last.text}")
            yield Display(pen.joined(lines, True), needed, "aligned")

    def _listing(
        self,
        names: Sequence[Formula],
        values: Sequence[Formula],
        width: float,
        *,
        is_high: bool = False,
    ) -> Display:
        """Each value behind its name and a sign, long ones broken at + and −."""
        heads = [self.pen.write(name) for name in names]
        head = max(piece.width for piece in heads) + EQUAL
        rows: list[_Row] = []
        needed = 0.0
        for name, value in zip(heads, values, strict=True):
            (first, *others), own = self._hanging(value, width - head)
            rows.append(first._replace(text=f"{name.text} &= {first.text}".strip()))
            rows += [row._replace(text=f"&{row.text}") for row in others]
            needed = max(needed, own)
        return self._below_one_another("aligned", rows, head + needed, is_high)

    def _definitions(
        self, names: Sequence[Formula], matrix: sp.ImmutableMatrix, width: float
    ) -> Display:
        """Short ones side by side, as many as fit on a line; long ones broken."""
        blocks: list[tuple[Sequence[_Row], float]] = []
        for name, value in zip(names, matrix, strict=True):
            head = self.pen.write(name)
            room = head.width + EQUAL
            value_rows, own = self._hanging(formula_of(value, self.letters), width - room)
            first = value_rows[0]._replace(text=f"{head.text} = {value_rows[0].text}")
            blocks.append(((first, *value_rows[1:]), room + own))
        needed = max(own for _, own in blocks)
        return self._below_one_another("gathered", _packed(blocks, width), needed)

    def _below_one_another(
        self,
        kind: Literal["aligned", "gathered"],
        rows: Sequence[_Row],
        width: float,
        is_high: bool = False,
    ) -> Display:
        inside = self.pen.joined((row.text for row in rows), is_high)
        height = sum(2.4 if row.is_high else 1.3 for row in rows)
        return Display(inside, width, kind, lines=len(rows), height=height)

    def _hanging(self, formula: Formula, room: float) -> tuple[list[_Row], float]:
        """A formula, broken at + and − where it is long; with the greatest width."""
        for indents in range(1, _MOST_INDENTS):  # its lines are to fit with their indents
            lines = broken(formula, room - indents * QUAD, self.pen)
            if widest(lines) <= room:
                break
        first, *others = lines
        is_high = bool(self.pen.write(formula).height)
        indented = [rf"{INDENT * (1 + line.level)} {{}}{line.text}" for line in others]
        return [_Row(text, is_high) for text in (first.text, *indented)], widest(lines)
