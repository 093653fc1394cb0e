"""How an equation is set so that it fits: on one line, on two, in shorthand, or entry by entry.

The choice is by estimated width, in this order. A reader who has to know of it is told.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Literal

import sympy as sp

from rigidsym.mechanics.derivation import Markup
from rigidsym.notes.document.document import Equation
from rigidsym.notes.formula.formula import latex
from rigidsym.notes.formula.notation import Notation
from rigidsym.notes.layout.breaking import Line, break_lines
from rigidsym.notes.layout.text_width import ems, matrix_ems

PAGE = 39.2  # ems of a display on a page, beside a number such as (13)
BOX = 0.65  # ems that the box around a result takes

Entries = Sequence[Sequence[str]]
Done = Literal["", "abbreviated", "listed"]

_EQUAL = ems("=")
_QUAD = ems(r"\quad")
_MOST_INDENTS = 5
_ROW = r" \\[2pt]" + "\n"  # dots above the letters want some air
_HIGH_ROW = r" \\[7pt]" + "\n"  # so do fractions
_BELOW_FRACTIONS = r" \\[10pt]" + "\n"  # in a matrix, where a row's depth is part of this
_BELOW_ROOTS = r" \\[13pt]" + "\n"  # roots in fractions are deeper


@dataclass(frozen=True, slots=True)
class Rows:
    """Lines below one another, between which a page may end where they are many."""

    environment: Literal["aligned", "gathered"]
    joint: str
    lines: tuple[str, ...]

    @property
    def inside(self) -> str:
        return self.joint.join(self.lines)

    @property
    def height(self) -> float:
        """In lines of text."""
        return sum(2.4 if r"\frac" in line else 1.3 for line in self.lines)


@dataclass(frozen=True, slots=True)
class Display:
    """The inside of a display, how wide it is, and what was done that the reader must know."""

    latex: str
    width: float  # ems; it may be more than was asked for, where there is no place to break
    done: Done = ""
    rows: Rows | None = None

    @property
    def lines(self) -> int:
        """Of a listing."""
        return len(self.rows.lines) if self.rows else 1


def display(equation: Equation, notation: Notation, width: float) -> Display:
    """The equation in the first form that fits into `width` ems; a listing where none does.

    A result is in a box, which is part of its width.
    """
    if not equation.is_result:
        return _display(equation, notation, width)
    inside = _display(equation, notation, width - BOX)
    return replace(inside, latex=rf"\boxed{{{inside.latex}}}", width=inside.width + BOX)


def _display(equation: Equation, notation: Notation, width: float) -> Display:
    if equation.scalar is not None:
        return _scalar(equation, latex(equation.scalar, notation), width)
    if equation.matrix is None:
        return _chain(equation, width)
    full = _rows(equation.matrix, notation, shorthand=False)
    if not equation.sides:
        return _definitions(equation, full, width)
    for form, needed in _forms(equation, full):
        if needed <= width:
            return Display(form, needed)
    if equation.matrix.shape[1] > 1:
        for form, needed in _forms(equation, _rows(equation.matrix, notation, shorthand=True)):
            if needed <= width:
                return Display(form, needed, "abbreviated")
    lines, widest = _listing(equation, full, width)
    return _below(Rows("aligned", _ROW, tuple(lines)), widest, "listed")


def _below(rows: Rows, width: float, done: Done = "") -> Display:
    return Display(_environment(rows.environment, rows.inside), width, done, rows)


def height(equation: Equation, notation: Notation) -> float:
    """About how many lines of text an equation takes, with the air around it."""
    if equation.matrix is None:
        line = 2.4 if any(r"\frac" in side.latex for side in equation.sides) else 1.3
        return 0.7 + line * display(equation, notation, PAGE).lines
    rows = _rows(equation.matrix, notation, shorthand=False)
    return 1.2 + sum(2.4 if any(r"\frac" in entry for entry in row) else 1.2 for row in rows)


def pack(equations: Sequence[Equation], notation: Notation, width: float) -> str:
    """Short equations, as many on a line as fit into `width` ems."""
    lines: list[str] = []
    room = 0.0
    for equation in equations:
        shown = display(equation, notation, width)
        form, needed = shown.latex, shown.width
        if lines and needed + 2 * _QUAD <= room:
            lines[-1] += rf" \qquad {form}"
            room -= needed + 2 * _QUAD
        else:
            lines.append(form)
            room = width - needed
    return lines[0] if len(lines) == 1 else _environment("gathered", _HIGH_ROW.join(lines))


@lru_cache(maxsize=256)
def _rows(matrix: sp.ImmutableMatrix, notation: Notation, *, shorthand: bool) -> Entries:
    return [[latex(e, notation, shorthand=shorthand) for e in row] for row in matrix.tolist()]


def _forms(equation: Equation, rows: Entries) -> Iterator[tuple[str, float]]:
    """The equation on one line, and broken before its last equals sign; with their widths."""
    yield _one_line(equation, rows)
    if len(equation.sides) > 1:
        first, *others = (side.latex for side in equation.sides)
        above = " = ".join(others)
        lines = f"{first} &= {above}{_HIGH_ROW}&= {_matrix(rows)}"
        widest = max(ems(above), matrix_ems(rows))
        yield _environment("aligned", lines), ems(first) + _EQUAL + widest


def _one_line(equation: Equation, rows: Entries) -> tuple[str, float]:
    sides = [side.latex for side in equation.sides]
    needed = sum(map(ems, sides)) + _EQUAL * len(sides) + matrix_ems(rows)
    return " = ".join([*sides, _matrix(rows)]), needed


def _matrix(rows: Entries) -> str:
    first, *others = (" & ".join(map(_tall, row)) for row in rows)
    text, above = first, first
    for line in others:
        text += _between(above, line) + line
        above = line
    return _environment("pmatrix", text)


def _between(above: str, below: str) -> str:
    """The end of the upper of two rows: what is high wants air."""
    if r"\frac" in above:
        return _BELOW_ROOTS if r"\sqrt" in above + below else _BELOW_FRACTIONS
    return _HIGH_ROW if r"\frac" in below else _ROW


def _tall(entry: str) -> str:
    """The entry with its fractions in their full height, but for those within others."""
    return rf"\displaystyle {entry}" if r"\frac" in entry else entry


def _definitions(equation: Equation, rows: Entries, width: float) -> Display:
    """Short ones side by side, as many as fit on a line; long ones broken, below one another."""
    lines: list[str] = []
    room = widest = 0.0
    for name, (value,) in zip(equation.entries, rows, strict=True):
        needed = ems(name.latex) + _EQUAL + ems(value)
        if needed + 2 * _QUAD <= room:
            lines[-1] += rf" \qquad {name.latex} = {value}"
            room -= needed + 2 * _QUAD
            continue
        broken, own = _listing(_one(name), [[value]], width)
        lines += [line.replace("&=", "=", 1).replace("&", "", 1) for line in broken]
        room = width - own if len(broken) == 1 else 0.0
        widest = max(widest, own)
    return _below(Rows("gathered", _ROW, tuple(lines)), widest)


def _one(name: Markup) -> Equation:
    return Equation(sides=(), entries=(name,))


def broken(formula: str, width: float) -> list[Line]:
    """The lines of a formula in LaTeX; no line can end between \\left and \\right."""
    lines = break_lines(formula, width, ems, _QUAD)
    if _widest(lines) <= width:
        return lines
    loose = formula.replace(r"\left(", r"\Bigl(").replace(r"\right)", r"\Bigr)")
    return min(lines, break_lines(loose, width, ems, _QUAD), key=_widest)


def broken_ems(formula: str, width: float) -> float:
    """The width of the widest line of a formula that is broken to fit into `width` ems."""
    return _widest(broken(formula, width))


def _widest(lines: Sequence[Line]) -> float:
    """The width of the widest line; those after the first are indented."""
    first, *others = lines
    return max(ems(first.text), *(_QUAD * (1 + o.depth) + ems(o.text) for o in others), 0.0)


def _hung(formula: str, room: float) -> list[Line]:
    """The lines of a formula that fit with their indents, as far as they can be broken."""
    for indents in range(1, _MOST_INDENTS):
        lines = broken(formula, room - indents * _QUAD)
        if _widest(lines) <= room:
            break
    return lines


def _listing(equation: Equation, rows: Entries, width: float) -> tuple[list[str], float]:
    """One entry after the other, long ones broken at + and −; with its width."""
    entries = [entry for row in rows for entry in row]
    head = max(ems(name.latex) for name in equation.entries) + _EQUAL
    widest = 0.0
    lines: list[str] = []
    for name, entry in zip(equation.entries, entries, strict=True):
        (first, *others), own = _hanging("=", [entry], width - head)
        lines += [name.latex + first, *others]
        widest = max(widest, own)
    return lines, head + widest


def _scalar(equation: Equation, value: str, width: float) -> Display:
    """A value on one line with its sides, or below them and broken at + and −."""
    *sides, last = (side.latex for side in equation.sides)
    whole = " = ".join([*sides, last, value])
    if ems(whole) <= width:
        return Display(whole, ems(whole))
    first = sides[0] if sides else last
    above = [" = ".join([*sides[1:], last])] if sides else []
    head = ems(first) + _EQUAL
    lines, widest = _hanging("=", [*above, value], width - head)
    lines[0] = first + lines[0]
    return _below(Rows("aligned", _HIGH_ROW, tuple(lines)), head + widest)


def _chain(equation: Equation, width: float) -> Display:
    """Sides that are equal: on one line, or each on its own."""
    sides = [side.latex for side in equation.sides]
    whole = " = ".join(sides)
    if ems(whole) <= width:
        return Display(whole, ems(whole))
    first, *others = sides
    if not others:
        return Display(whole, ems(whole))
    head = ems(first) + _EQUAL
    lines, widest = _hanging("=", others, width - head)
    lines[0] = first + lines[0]
    return _below(Rows("aligned", _HIGH_ROW, tuple(lines)), head + widest)


def _hanging(sign: str, formulas: Sequence[str], room: float) -> tuple[list[str], float]:
    """Each formula behind a sign, long ones broken at + and −; with the width of the widest."""
    lines: list[str] = []
    widest = 0.0
    for formula in formulas:
        first, *others = hung = _hung(formula, room)
        lines.append(f" &{sign} {first.text}")
        lines += ["&" + r"\quad" * (1 + line.depth) + f" {{}}{line.text}" for line in others]
        widest = max(widest, _widest(hung))
    return lines, widest


def _environment(name: str, inside: str) -> str:
    return f"\\begin{{{name}}}\n{inside}\n\\end{{{name}}}"
