"""How an equation is set so that it fits: on one line, on two, or entry by entry.

The choice is by estimated width, in this order. Where entries are listed, the note says so.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import field
from functools import lru_cache
from typing import Literal

import sympy as sp

from rigidsym.formula.latex_pen import EQUAL, QUAD, WIDE_GAP, LatexPen, environment
from rigidsym.formula.letters import Letters
from rigidsym.formula.pen import Segment, break_lines
from rigidsym.formula.scalars import factored, formula_of, listed_entries, matrix_of
from rigidsym.formula.tree import NOTHING, Formula, equal, indexed, row
from rigidsym.system.records import NamedTuple, Record

PAGE = 39.2  # ems of a display on a page, beside a number such as (13)
BOX = 0.96  # ems that the box around a result takes

INDENT = r"\quad"  # of a line that goes on; the next bracket adds another
_MOST_INDENTS = 5


class Equation(Record, kw_only=True):
    """One display: sides that are equal, the last of them a matrix or a scalar that is given.

    Equations are equal if they look alike.
    """

    sides: tuple[Formula, ...]
    matrix: sp.ImmutableMatrix | None = None
    scalar: sp.Expr | None = None
    entries: tuple[Formula, ...] = ()  # a name an entry, if these are not those of the first side
    number: int | None = None
    label: str = field(default="", compare=False)
    function: str = field(default="", compare=False)  # of the kernel module, as it is called
    proved: tuple[Formula, ...] = field(default=(), compare=False)
    unproved: tuple[Formula, ...] = field(default=(), compare=False)
    is_result: bool = False  # what a reader looks up stands in a box

    @property
    def names(self) -> tuple[Formula, ...]:
        """A name for each entry of the matrix, row by row, for a listing."""
        assert self.matrix is not None
        rows, columns = self.matrix.shape
        shape = (rows,) if columns == 1 else (rows, columns)
        return self.entries or indexed(self.sides[0], shape)


class Display(NamedTuple):
    """The inside of a display, and how wide it is."""

    inside: str
    width: float  # ems; it may be more than was asked for, where there is no place to break
    environment: Literal["", "aligned", "gathered"] = ""  # of lines below one another
    is_listed: bool = False  # entry by entry, in place of a matrix
    lines: int = 1  # of a listing
    is_broken: bool = False  # whether a value of the equation, or an entry, fits on no line
    is_boxed: bool = False

    @property
    def text(self) -> str:
        text = environment(self.environment, self.inside) if self.environment else self.inside
        return rf"\boxed{{{text}}}" if self.is_boxed else text


@lru_cache(maxsize=512)  # what was fitted is printed, often in several formats
def display(equation: Equation, letters: Letters, width: float, pen: LatexPen) -> Display:
    """The equation in the first form that fits into `width` ems; a listing where none does.

    A result is in a box, which is part of its width.
    """
    box = BOX if equation.is_result else 0.0
    forms = _matrix_forms if equation.matrix is not None and equation.sides else _forms
    for layout in forms(equation, letters, width - box, pen):
        if layout.width <= width - box:
            break  # or else the last one, which is a listing
    is_value = equation.matrix is not None or equation.scalar is not None
    is_broken = is_value and (layout.is_broken or layout.width > width - box)
    return layout._replace(
        width=layout.width + box, is_broken=is_broken, is_boxed=equation.is_result
    )


def _forms(equation: Equation, letters: Letters, width: float, pen: LatexPen) -> Iterator[Display]:
    """Of an equation without a matrix, and of definitions."""
    # in another notation a rate may be its own definition
    sides = tuple(dict.fromkeys(map(letters.notation.applied, equation.sides)))
    if equation.matrix is not None:
        values = [formula_of(value, letters) for value in equation.matrix]
        yield _definitions(equation.entries, values, width, pen)
        return
    if equation.scalar is not None:
        # the value follows its sides on one line, or on lines below them
        definition = [equal(*sides[1:])] if sides[1:] else []
        sides = (sides[0], *definition, formula_of(equation.scalar, letters))
    whole = pen.write(equal(*sides))
    yield Display(whole.text, whole.width)
    head, *values = sides
    if values:
        yield _listing([head, *[NOTHING] * (len(values) - 1)], values, width, pen, is_high=True)


def _matrix_forms(
    equation: Equation, letters: Letters, width: float, pen: LatexPen
) -> Iterator[Display]:
    """On one line; broken before its last equals sign, then farther left; listed."""
    matrix = equation.matrix
    assert matrix is not None
    sides = tuple(dict.fromkeys(map(letters.notation.applied, equation.sides)))
    factor, rest = factored(matrix)  # a fraction that all entries hold
    full: Formula = matrix_of(rest, letters)
    full = full if factor == 1 else row(formula_of(factor, letters), full)
    whole = pen.write(equal(*sides, full))
    yield Display(whole.text, whole.width)
    if len(sides) > 1:
        first, above, last = map(pen.write, (sides[0], equal(*sides[1:]), full))
        needed = first.width + EQUAL + max(above.width, last.width)
        lines = (f"{first.text} &= {above.text}", f"&= {last.text}")
        yield Display(pen.joined(lines, True), needed, "aligned")
        needed = EQUAL + max(first.width + above.width, QUAD + last.width)
        lines = (f"&{first.text} = {above.text}", rf"&{INDENT} {{}} = {last.text}")
        yield Display(pen.joined(lines, True), needed, "aligned")
    names, entries = zip(*listed_entries(equation.names, matrix), strict=True)
    values = [formula_of(entry, letters) for entry in entries]
    yield _listing(names, values, width, pen)._replace(is_listed=True)


def pack(equations: Sequence[Equation], letters: Letters, width: float, pen: LatexPen) -> str:
    """Short equations, as many on a line as fit into `width` ems."""
    displays = [display(equation, letters, width, pen) for equation in equations]
    lines = _packed((([layout.text], layout.width) for layout in displays), width)
    return lines[0] if len(lines) == 1 else environment("gathered", pen.joined(lines, True))


def _packed(blocks: Iterable[tuple[list[str], float]], width: float) -> list[str]:
    """Blocks of lines below one another, given with their widths; short ones side by side."""
    lines: list[str] = []
    room = 0.0
    for block, own in blocks:
        if len(block) == 1 and own + 2 * QUAD <= room:
            lines[-1] += f" {WIDE_GAP}{block[0]}"
            room -= own + 2 * QUAD
        else:
            lines += block
            room = width - own if len(block) == 1 else 0.0
    return lines


def _listing(
    names: Sequence[Formula],
    values: Sequence[Formula],
    width: float,
    pen: LatexPen,
    *,
    is_high: bool = False,
) -> Display:
    """Each value behind its name and a sign, long ones broken at + and −."""
    heads = [pen.write(name) for name in names]
    head = max(piece.width for piece in heads) + EQUAL
    hung = [broken(value, width - head, pen) for value in values]
    lines: list[str] = []
    for name, (first, *others) in zip(heads, hung, strict=True):
        lines.append(f"{name.text} &= {first.text}".strip())
        lines += [f"&{_indented(line)}" for line in others]
    is_broken = len(lines) > len(hung)
    needed = head + max(map(widest, hung))
    inside = pen.joined(lines, is_high)
    return Display(inside, needed, "aligned", lines=len(lines), is_broken=is_broken)


def _definitions(
    names: Sequence[Formula], values: Sequence[Formula], width: float, pen: LatexPen
) -> Display:
    """Short ones side by side, as many as fit on a line; long ones broken."""
    blocks: list[tuple[list[str], float]] = []
    for name, value in zip(names, values, strict=True):
        head = pen.write(name)
        room = head.width + EQUAL
        hung = broken(value, width - room, pen)
        lines = [f"{head.text} = {hung[0].text}", *map(_indented, hung[1:])]
        blocks.append((lines, room + widest(hung)))
    needed = max(own for _, own in blocks)
    lines = _packed(blocks, width)
    return Display(pen.joined(lines, False), needed, "gathered", lines=len(lines))


def _indented(line: Segment) -> str:
    return rf"{INDENT * (1 + line.level)} {{}}{line.text}"


def broken(formula: Formula, width: float, pen: LatexPen) -> list[Segment]:
    """The lines of a formula; those after the first are indented, see `widest`."""
    for indents in range(1, _MOST_INDENTS):  # its lines are to fit with their indents
        lines = break_lines(pen.write(formula), width - indents * QUAD, QUAD)
        if widest(lines) <= width:
            break
    return lines


def widest(lines: Sequence[Segment]) -> float:
    """The width of the widest line; those after the first are indented."""
    first, *others = lines
    return max(first.width, *(QUAD * (1 + line.level) + line.width for line in others), 0.0)
