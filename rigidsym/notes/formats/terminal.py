"""Derivation -> text for a terminal: convention, quantities, singular orientations, proofs."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Sequence
from dataclasses import replace
from itertools import product
from typing import TYPE_CHECKING, Any

import sympy as sp

from rigidsym.formula.display import display
from rigidsym.formula.latex_pen import LatexPen
from rigidsym.formula.letters import Letters
from rigidsym.formula.notation import DEFAULT, Notation
from rigidsym.formula.pen import break_lines
from rigidsym.formula.scalars import formula_of, listed_entries, matrix_of
from rigidsym.formula.tree import Formula, equal
from rigidsym.formula.unicode_pen import UnicodePen, columns
from rigidsym.mechanics.derivation import Argument, Derivation, Step, phrases, remark
from rigidsym.mechanics.quantities.kinematics import BODY, ROTATION, SPACE
from rigidsym.notes.document import Equation, EquationRow, Listing, NoteBlock, NoteTable, Paragraph
from rigidsym.notes.equations import equation_of, in_parts, sum_of_vectors
from rigidsym.notes.facts.rotation import facts_of_rotation, product_of, title_of
from rigidsym.notes.facts.singular import singular_facts
from rigidsym.notes.fitting import as_vectors
from rigidsym.notes.letters import RESIDUAL, letters_of
from rigidsym.notes.template import blocks_of, sections_of
from rigidsym.notes.words import is_body_alone, unit_in_words, with_symbols

if TYPE_CHECKING:
    from rigidsym.mechanics.conversions.conversions import Conversions

_WIDTH = 88  # columns
_EMS = 44.0  # of an equation by itself in LaTeX
_OMEGA = {"Ω": SPACE.omega, "Ω′": BODY.omega}
_INDENT = "  "
_NO_BREAK = "\u00a0"

Spans = Iterable[Any]  # words, formulas, and what else has a text


def show(
    derivation: Derivation,
    *,
    width: int = _WIDTH,
    notation: Notation = DEFAULT,
    conversions: Conversions | None = None,
) -> str:
    """The derivation as plain text, at most `width` columns wide where formulas allow.

    `conversions` adds a section on the unit quaternion and the matrix, and its proofs.
    """
    screen = _Screen(letters_of(derivation.arguments, notation, derivation.model), width)
    screen.derivation(derivation, conversions)
    return screen.whole


def printed_step(step: Step, form: str, derivation: Derivation, notation: Notation) -> str:
    """One step of a derivation: "latex", its equation without a number, or "text"."""
    arguments = derivation.arguments
    letters = letters_of(arguments, notation, derivation.model)
    if form == "text":
        screen = _Screen(letters, _WIDTH)
        screen.step(step, arguments)
        return screen.whole
    equation = as_vectors(equation_of(step, arguments), step, letters)
    return display(equation, letters, _EMS, LatexPen(notation)).text


class _Screen:
    """Lines of Unicode in one width, written from top to bottom."""

    def __init__(self, letters: Letters, width: int) -> None:
        self.letters = letters
        self.width = width
        self.pen = UnicodePen(letters.notation)
        self.lines: list[str] = []
        self.defined: set[sp.Basic] = set()

    @property
    def whole(self) -> str:
        return "\n".join(self.lines).replace(_NO_BREAK, " ")

    def text(self, spans: Spans) -> str:
        """Words and formulas on one line; no line may end at the blanks of a formula."""
        return "".join(
            self.pen.write(span).text.replace(" ", _NO_BREAK)
            if isinstance(span, Formula)
            else (span if isinstance(span, str) else span.text)
            for span in spans
        )

    def line(self, *spans: Any) -> None:
        """Words and formulas on one line, however long."""
        self.lines.append(self.text(spans))

    def heading(self, *spans: Any, aside: str = "") -> None:
        """A heading, with an aside at the right margin, on its own line if there is no room."""
        heading = self.text(spans)
        room = self.width - columns(heading)
        if aside and room - columns(aside) < len(_INDENT):
            self.lines += [heading, aside.rjust(self.width)]
        else:
            self.lines.append(heading + (aside and aside.rjust(room)))

    def section(self, heading: str) -> None:
        self.line()
        self.heading(heading)

    def sentence(self, spans: Spans) -> None:
        """A sentence on as many lines as it needs."""
        self.lines += textwrap.wrap(
            self.text(spans),
            self.width,
            initial_indent=_INDENT,
            subsequent_indent=2 * _INDENT,
            break_long_words=False,
            break_on_hyphens=False,
        )

    def block(self, block: NoteBlock) -> None:
        """A block of a template; only notes have figures."""
        match block:
            case Paragraph(text):
                self.sentence(text)
            case Listing(items, marks):
                for mark, item in zip(marks, items, strict=True):
                    self.sentence((f"{mark} ", *item))
            case Equation():
                self.equation(block)
            case EquationRow(equations):
                for equation in equations:
                    self.equation(equation)
            case NoteTable(_, head, rows):
                for row in (head, *rows):
                    self.line(_INDENT, " | ".join(map(self.text, row)))

    def template(self, name: str, facts: dict[str, Any]) -> None:
        for section in sections_of(name, self.letters, **facts):
            if section.title:
                self.section(section.title)
            for block in section.blocks:
                self.block(block)

    def equation(self, equation: Equation) -> None:
        """The sides with their value: beside them, or below, or else a line an entry."""
        matrix, sides = equation.matrix, list(equation.sides)
        if equation.scalar is not None:
            sides.append(formula_of(equation.scalar, self.letters))
        value = sides.pop() if matrix is None else None
        names = [*filter(None, dict.fromkeys(self.text([side]) for side in sides))][:2]
        whole = f"{_INDENT}{' = '.join(names)} = "
        head = f"{_INDENT}{names[0]} = " if names else ""
        if value is not None:
            if len(names) == 2 and columns(whole + self.text([value])) > self.width:
                self.lines.append(whole.removesuffix(" = "))
                whole = " " * columns(head.removesuffix("= ")) + "= "
            self.hang(whole, value)
            return
        assert matrix is not None
        if sides:
            rows = [[self.text([e]) for e in row] for row in matrix_of(matrix, self.letters).rows]
            below = 2 * _INDENT
            for start, is_tight in product((whole, head, below), (False, True)):
                above = [whole.rstrip()] if start == below else []
                lines = [*above, *grid(start, rows, is_tight=is_tight)]
                if max(map(columns, lines)) <= self.width:
                    self.lines += lines
                    return
        for name, entry in listed_entries(equation.names, matrix):
            self.hang(f"{_INDENT}{self.text([name])} = ", formula_of(entry, self.letters))

    def hang(self, head: str, value: Formula) -> None:
        """A value behind a head; where it is long, its other lines hang below its start."""
        start = columns(head)
        room = self.width - start
        first, *others = break_lines(self.pen.write(value), room, len(_INDENT), self.pen.blank)
        self.lines.append(head + first.text)
        self.lines += [" " * start + _INDENT * line.level + line.text for line in others]

    def step(self, step: Step, arguments: Sequence[Argument]) -> None:
        """(4) angular velocity, space components         angular_velocity_space, rad/s"""
        quantity = step.quantity
        unit = f", {unit_in_words(quantity.unit)}" if quantity.unit else ""
        about = with_symbols(quantity.about, _OMEGA)
        self.heading(f"({step.number}) ", *about, aside=quantity.name + unit)
        self.equation(equation_of(step, arguments))
        for proof in step.proofs:
            if proof.status != "exact":
                self.line(f"{_INDENT}✗ unproved: ", proof.claim)
        if step.vector_form is not None:  # Ω = v̇ + ...
            self.sentence([equal(quantity.symbol, sum_of_vectors(step.vector_form, self.letters))])

    def abbreviations(self, expression: sp.Basic, derivation: Derivation) -> None:
        """The definitions that an expression rests on, which are printed once."""
        if parts := derivation.definitions_in(expression, self.defined):
            self.sentence(phrases("equations")["here"])
            self.equation(in_parts(parts, self.letters))
            self.defined |= {part.symbol for part in parts}

    def derivation(self, derivation: Derivation, conversions: Conversions | None) -> None:
        model, steps, letters = derivation.model, derivation.steps, self.letters
        facts = facts_of_rotation(derivation, letters)
        facts |= {"angles": None, "has_dots": letters.notation.rates == "dot"}
        # templates of the user's own may refer to equations and sources
        facts["reference"] = lambda name: f"({derivation.step(name).number})"
        facts["equation"] = lambda name: equation_of(derivation.step(name), derivation.arguments)
        facts["cite"] = lambda source: f"[{source}]"
        self.heading(*title_of(derivation, letters))
        if not is_body_alone(derivation):
            self.line()
            self.template("en/convention", facts)
            if model.turns:
                self.line(_INDENT, equal(ROTATION, product_of(model.turns, letters)))
        for step in steps:
            self.line()
            self.step(step, derivation.arguments)
            if not step.recursion:
                self.abbreviations(step.expression, derivation)
        if integrals := derivation.first_integrals:
            self.section(remark("first_integrals"))
            for integral in integrals:
                value = integral.expression
                if value.is_Symbol and (own := [s for s in steps if value in s.expression]):
                    self.line(_INDENT, integral.symbol, f", see ({own[0].number})")
                    continue
                self.equation(Equation(sides=(integral.symbol,), scalar=value))
                self.abbreviations(value, derivation)

        singular = singular_facts(derivation)
        if singular is not None:
            facts["singular"] = singular
            gimbal_lock = " (gimbal lock)" if singular.is_gimbal_lock else ""
            self.section(f"Singular orientations{gimbal_lock}")
            if singular.result.determinant is not None:
                for block in blocks_of("en/singular_measure", letters, **facts):
                    # or Σ₁ would have no meaning
                    if not isinstance(block, Paragraph) or singular.result.measure == "minors":
                        self.block(block)
            self.template("en/singular", facts)

        if derivation.body is not None:
            from rigidsym.notes.facts.mass import MassFacts

            lines = list(MassFacts(derivation, derivation.body, letters).lines())
            if lines:
                self.section("In numbers")
                self.lines += [_INDENT + line for line in lines]

        back = conversions and conversions.inverse
        if conversions:  # to the unit quaternion and back, or why there is no way back
            self.section("Conversions")
            if conversions.quaternion:  # its number is the next one, as in the note
                quaternion = replace(conversions.quaternion, number=len(steps) + 1)
                steps = (*steps, quaternion)
                self.step(quaternion, derivation.arguments)
            for text in (back.because, back.branch) if back else ((conversions.without,),):
                self.sentence(text)

        self.section("Identities verified")
        proofs = [(stated.number, proof) for stated in derivation.theory for proof in stated.proofs]
        proofs += [(step.number, proof) for step in steps for proof in step.proofs]
        proofs += [(0, proof) for proof in (back.proofs if back else ())]
        proofs += [(0, conversions.from_matrix)] if conversions else []
        for number, proof in proofs:
            mark, label = "✓" if proof.is_exact else "✗", f"({number})" if number else ""
            self.line(f"{_INDENT}{mark} {label:<5}{proof.status:<10}", proof.claim)
            if proof.residual is not None:
                self.line(f"{2 * _INDENT}left over:")
                self.equation(Equation(sides=(RESIDUAL,), matrix=proof.residual))


def grid(prefix: str, rows: Sequence[Sequence[str]], *, is_tight: bool) -> list[str]:
    """The lines of `prefix` followed by a matrix in brackets; the prefix stands half-way down.

    A single column is set flush left, several columns are centred.
    """
    gap, margin = ("  ", "") if is_tight else ("   ", " ")
    widths = [max(map(columns, column)) for column in zip(*rows, strict=True)]
    inside: list[str] = []
    for row in rows:
        rooms = [width - columns(text) for text, width in zip(row, widths, strict=True)]
        before = [room // 2 if len(widths) > 1 else 0 for room in rooms]
        cells = zip(row, before, rooms, strict=True)
        inside.append(gap.join(" " * b + text + " " * (room - b) for text, b, room in cells))
    last = len(rows) - 1
    lefts, rights = (f"⎡{'⎢' * (last - 1)}⎣", f"⎤{'⎥' * (last - 1)}⎦") if last else ("[", "]")
    blank = " " * columns(prefix)
    return [
        f"{prefix if place == last // 2 else blank}{left}{margin}{line}{margin}{right}"
        for place, (left, line, right) in enumerate(zip(lefts, inside, rights, strict=True))
    ]
