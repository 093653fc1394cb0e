"""How an equation is set so that it fits: on one line, on two, in shorthand, or entry by entry.

The choice is by estimated width, in this order. A reader who has to know of it is told. Any pen
that typesets can write the result.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Literal, NamedTuple

import sympy as sp

from rigidsym.formula.latex_pen import LatexPen
from rigidsym.formula.letters import Letters
from rigidsym.formula.pen import Segment, break_lines
from rigidsym.formula.scalars import factored, formula_of, listed_entries, matrix_of
from rigidsym.formula.sheet_pen import EQUAL, QUAD, Aligned, SheetPen
from rigidsym.formula.tree import EQUALS, Formula, Matrix, equal, indexed, row
from rigidsym.formula.unicode_pen import UnicodePen

PAGE = 39.2  # ems of a display on a page, beside a number such as (13)
BOX = 0.96  # ems that the box around a result takes

Done = Literal["", "abbreviated", "listed"]

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

    text: str
    width: float  # ems; it may be more than was asked for, where there is no place to break
    done: Done = ""
    rows: tuple[Aligned, ...] = ()  # between which a page may end where they are many
    are_aligned: bool = True  # at their signs; else each is in the middle
    is_high: bool = False
    is_broken: bool = False  # whether a value of the equation, or an entry, fits on no line

    @property
    def lines(self) -> int:
        """Of a listing."""
        return len(self.rows) or 1

    @property
    def height(self) -> float:
        """Of a listing, in lines of text."""
        return sum(2.4 if line.height else 1.3 for line in self.rows)

    def joined(self, pen: LatexPen) -> str:
        """The rows without their environment."""
        lines = (pen.line(r) if self.are_aligned else pen.body(r) for r in self.rows)
        return pen.joined(lines, self.is_high)


def display(
    equation: Equation, letters: Letters, width: float, pen: SheetPen | None = None
) -> Display:
    """The equation in the first form that fits into `width` ems; a listing where none does.

    A result is in a box, which is part of its width. `pen` is that of LaTeX by default, in the
    notation of the letters.
    """
    inside = replace(equation, number=None, label="", function="", proved=(), unproved=())
    return _displayed(inside, letters, width, pen or LatexPen(letters.notation))


@lru_cache(maxsize=512)  # what was fitted is printed, often in several formats
def _displayed(equation: Equation, letters: Letters, width: float, pen: SheetPen) -> Display:
    setter = _Setter(letters, pen)
    if not equation.is_result:
        shown = setter.display(equation, width)
    else:
        inside = setter.display(equation, width - BOX)
        shown = inside._replace(text=pen.boxed(inside.text), width=inside.width + BOX)
    is_broken = shown.width > width
    if equation.matrix is None and equation.scalar is None:
        is_broken = False
    elif shown.lines > 1 and not is_broken:
        usual = min(len(equation.sides), 2)
        if equation.matrix is not None:
            usual = len(listed_entries(equation.names, equation.matrix))
        is_broken = shown.lines > usual
    return shown._replace(is_broken=is_broken)


@lru_cache(maxsize=512)
def spoken(equation: Equation, letters: Letters) -> str:
    """The equation on one line of Unicode; a matrix row by row."""
    value: list[Formula] = []
    if equation.scalar is not None:
        value = [formula_of(equation.scalar, letters)]
    elif equation.matrix is not None:
        value = [Matrix(tuple(map(tuple, matrix_of(equation.matrix, letters))))]
    return UnicodePen(letters.notation).write(equal(*equation.sides, *value)).text


def pack(equations: Sequence[Equation], letters: Letters, width: float, pen: SheetPen) -> str:
    """Short equations, as many on a line as fit into `width` ems."""
    lines: list[str] = []
    room = 0.0
    for equation in equations:
        shown = display(equation, letters, width, pen)
        if lines and shown.width + 2 * QUAD <= room:
            lines[-1] += f" {pen.wide_gap}{shown.text}"
            room -= shown.width + 2 * QUAD
        else:
            lines.append(shown.text)
            room = width - shown.width
    return lines[0] if len(lines) == 1 else pen.gathered(lines, True)


def broken(formula: Formula, width: float, pen: SheetPen) -> list[Segment]:
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

    def __init__(self, letters: Letters, pen: SheetPen) -> None:
        self.letters = letters
        self.pen = pen

    def display(self, equation: Equation, width: float) -> Display:
        # in another notation a rate may be its own definition
        sides = tuple(dict.fromkeys(map(self.letters.notation.applied, equation.sides)))
        if equation.scalar is not None:
            # a value stands on one line with its sides, or below them
            given = [sides[0], *([equal(*sides[1:])] if sides[1:] else [])]
            return self._lines([*given, formula_of(equation.scalar, self.letters)], width)
        if equation.matrix is None:
            return self._lines(sides, width)
        rows = matrix_of(equation.matrix, self.letters)
        if not sides:
            return self._definitions(equation.entries, [value for (value,) in rows], width)
        factor, rest = factored(equation.matrix)  # a fraction that all entries hold
        full: Formula = Matrix(tuple(map(tuple, matrix_of(rest, self.letters))))
        full = full if factor == 1 else row(formula_of(factor, self.letters), full)
        for form in self._forms(sides, full, self.pen):
            if form.width <= width:
                return form
        if equation.matrix.shape[1] > 1:
            for form in self._forms(sides, full, replace(self.pen, short=True)):
                if form.width <= width:
                    return form._replace(done="abbreviated")
        listed = listed_entries(equation.names, equation.matrix)
        values = [formula_of(value, self.letters) for _, value in listed]
        lines, needed = self._listing([name for name, _ in listed], values, width)
        return Display(self.pen.aligned(lines, False), needed, "listed", tuple(lines))

    def _forms(self, sides: Sequence[Formula], matrix: Formula, pen: SheetPen) -> Iterator[Display]:
        """The equation on one line; broken before its last equals sign; and then farther left."""
        whole = pen.write(equal(*sides, matrix))
        yield Display(whole.text, whole.width)
        if len(sides) > 1:
            first, above, last = map(pen.write, (sides[0], equal(*sides[1:]), matrix))
            lines = (Aligned(first.text, above.text, "="), Aligned("", last.text, "="))
            needed = first.width + EQUAL + max(above.width, last.width)
            yield Display(pen.aligned(lines, True), needed)
            lines = (
                Aligned("", self._headed(sides[0], above.text)),
                Aligned("", self._headed(row(), last.text), indent=1),
            )
            needed = EQUAL + max(first.width + above.width, QUAD + last.width)
            yield Display(pen.aligned(lines, True), needed)

    def _definitions(
        self, names: Sequence[Formula], values: Sequence[Formula], width: float
    ) -> Display:
        """Short ones side by side, as many as fit on a line; long ones broken."""
        lines: list[Aligned] = []
        room = needed = 0.0
        for name, value in zip(names, values, strict=True):
            whole = self.pen.write(equal(name, value))
            if whole.width + 2 * QUAD <= room:
                body = f"{lines[-1].body} {self.pen.wide_gap}{whole.text}"
                lines[-1] = lines[-1]._replace(
                    body=body, height=max(lines[-1].height, whole.height)
                )
                room -= whole.width + 2 * QUAD
                continue
            cut, own = self._listing([name], [value], width)
            first = cut[0]._replace(head="", sign="", body=self._headed(name, cut[0].body))
            lines += [first, *cut[1:]]
            room = width - own if len(cut) == 1 else 0.0
            needed = max(needed, own)
        text = self.pen.gathered(list(map(self.pen.body, lines)), False)
        return Display(text, needed, rows=tuple(lines), are_aligned=False)

    def _headed(self, name: Formula, body: str) -> str:
        """The first line of a definition, without a place to align it."""
        head = self.pen.write(name).text
        return f"{head} {self.pen.sign(EQUALS, is_binary=True).text.strip()} {body}"

    def _listing(
        self, names: Sequence[Formula], entries: Sequence[Formula], width: float
    ) -> tuple[list[Aligned], float]:
        """One entry after the other, long ones broken at + and −; with its width."""
        heads = [self.pen.write(name) for name in names]
        head = max(piece.width for piece in heads) + EQUAL
        needed = 0.0
        lines: list[Aligned] = []
        for name, entry in zip(heads, entries, strict=True):
            (first, *others), own = self._hanging([entry], width - head)
            lines += [first._replace(head=name.text), *others]
            needed = max(needed, own)
        return lines, head + needed

    def _lines(self, sides: Sequence[Formula], width: float) -> Display:
        """Sides that are equal: on one line, or each on its own and broken at + and −."""
        whole = self.pen.write(equal(*sides))
        if whole.width <= width or len(sides) == 1:
            return Display(whole.text, whole.width)
        first, *others = sides
        head = self.pen.write(first)
        room = head.width + EQUAL
        lines, needed = self._hanging(others, width - room)
        lines[0] = lines[0]._replace(head=head.text)
        text = self.pen.aligned(lines, True)
        return Display(text, room + needed, rows=tuple(lines), is_high=True)

    def _hanging(self, formulas: Sequence[Formula], room: float) -> tuple[list[Aligned], float]:
        """Each formula behind its sign, long ones broken at + and −; with the greatest width."""
        lines: list[Aligned] = []
        needed = 0.0
        for formula in formulas:
            for indents in range(1, _MOST_INDENTS):  # its lines are to fit with their indents
                hung = broken(formula, room - indents * QUAD, self.pen)
                if widest(hung) <= room:
                    break
            first, *others = hung
            tall = self.pen.write(formula).height
            lines.append(Aligned("", first.text, "=", height=tall))
            lines += [Aligned("", line.text, indent=1 + line.level, height=tall) for line in others]
            needed = max(needed, widest(hung))
        return lines, needed
