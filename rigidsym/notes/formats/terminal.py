"""Derivation -> text for a terminal: convention, quantities, what fails, what was proved."""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Literal

import sympy as sp

from rigidsym.mechanics.derivation import Argument, Derivation, Markup, Proof, Step
from rigidsym.mechanics.quantities.kinematics import ROTATION
from rigidsym.models.rotation import RotationModel
from rigidsym.notes.document.document import Text
from rigidsym.notes.formula.formula import text
from rigidsym.notes.formula.manner import DEFAULT, Manner
from rigidsym.notes.formula.notation import Notation, notation_of
from rigidsym.notes.layout.breaking import break_lines
from rigidsym.notes.layout.entries import RESIDUAL, entry_names, indexed
from rigidsym.notes.layout.grid import grid
from rigidsym.notes.layout.text_width import columns
from rigidsym.notes.prose.prose import product, turn
from rigidsym.notes.prose.singular_words import failures, measured
from rigidsym.notes.prose.vector_words import sum_of_vectors
from rigidsym.notes.prose.words import (
    convention,
    equal,
    plain,
    symbols_of,
    unit_in_words,
    with_symbols,
)

if TYPE_CHECKING:
    from rigidsym.mechanics.conversions.conversions import Conversions

Style = Callable[[str, Literal["heading", "dim"]], str]

_INDENT = "  "
_DEEPER = "    "
_NO_BREAK = "\u00a0"


def unstyled(words: str, _: str) -> str:
    """The style of a terminal without any."""
    return words


def show(
    derivation: Derivation,
    *,
    width: int = 88,
    style: Style = unstyled,
    manner: Manner = DEFAULT,
    conversions: Conversions | None = None,
) -> str:
    """The derivation as plain text, at most `width` columns wide where formulas allow.

    `style` is given each heading and each aside, and returns it with the codes of the terminal;
    `conversions` adds a section on the unit quaternion and the matrix, and its proofs.
    """
    screen = _Screen(derivation, width, style, manner, conversions)
    return "\n".join(screen.lines())


def show_step(
    step: Step,
    arguments: Sequence[Argument],
    *,
    width: int = 88,
    manner: Manner = DEFAULT,
    model: RotationModel | None = None,
) -> str:
    """One step of a derivation as plain text."""
    notation = notation_of(arguments, manner, model)
    return "\n".join(_Steps(arguments, width, unstyled, notation).step(step))


class _Steps:
    """The lines of single steps."""

    def __init__(
        self, arguments: Sequence[Argument], width: int, style: Style, notation: Notation
    ) -> None:
        self.arguments = arguments
        self.width = width
        self.style = style
        self.notation = notation
        self.written = notation.manner.text  # formulas that were composed elsewhere

    def step(self, step: Step) -> Iterator[str]:
        yield from self._headline(step)
        yield from self._value(step)
        yield from self._as_vectors(step)

    def _as_vectors(self, step: Step) -> Iterator[str]:
        """Ω = v̇ + ..., where the coordinates hold a vector."""
        form = step.vector_form
        if form is not None:
            total = equal(step.quantity.symbol, sum_of_vectors(form, self.notation))
            yield from self._wrapped((total,))

    def _wrapped(self, sentence: Text) -> list[str]:
        whole = (_unbroken(span) if isinstance(span, Markup) else span for span in sentence)
        lines = textwrap.wrap(
            self.written(plain(tuple(whole))),
            self.width,
            initial_indent=_INDENT,
            subsequent_indent=_DEEPER,
            break_long_words=False,
            break_on_hyphens=False,
        )
        return [line.replace(_NO_BREAK, " ") for line in lines]

    def _headline(self, step: Step) -> Iterator[str]:
        """(5) angular velocity, body components           angular_velocity_body, rad/s"""
        quantity = step.quantity
        left = f"({step.number}) {self.written(quantity.about)}"
        unit = f", {unit_in_words(quantity.unit)}" if quantity.unit else ""
        right = quantity.name + unit
        room = self.width - columns(left)
        if room - columns(right) < len(_INDENT):
            yield self.style(left, "heading")
            yield self.style(right.rjust(self.width), "dim")
        else:
            yield self.style(left, "heading") + self.style(right.rjust(room), "dim")

    def _value(self, step: Step) -> Iterator[str]:
        names = entry_names(step, self.arguments)
        prefixes = [self.written(prefix) for prefix in _prefixes(step)]
        if step.quantity.is_scalar:
            yield from self._scalar(prefixes, text(step.expression[0], self.notation))
        else:
            yield from self._matrix(prefixes, step.expression, names)
        for proof in step.proofs:
            if not proof.is_exact:
                yield f"{_INDENT}✗ unproved: {self.written(proof.claim.text)}"

    def _scalar(self, prefixes: Sequence[str], value: str) -> Iterator[str]:
        """The value behind its sides, or below them, where a long one is broken."""
        whole = f"{_INDENT}{prefixes[0]}{value}"
        if columns(whole) <= self.width:
            yield whole
            return
        head = f"{_INDENT}{prefixes[-1]}".removesuffix("= ")
        if len(prefixes) > 1:
            yield f"{_INDENT}{prefixes[0].removesuffix(' = ')}"
            head = " " * columns(head)
        room = self.width - columns(head) - len("= ")
        first, *others = break_lines(value, room, columns, len(_INDENT))
        yield f"{head}= {first.text}"
        hang = " " * (columns(head) + len("= "))
        for line in others:
            yield hang + _INDENT * line.depth + line.text

    def _matrix(
        self, prefixes: Sequence[str], matrix: sp.ImmutableMatrix, names: Sequence[Markup]
    ) -> list[str]:
        """The matrix in brackets, in the first form that fits, or else entry by entry."""
        rows = [[text(entry, self.notation) for entry in row] for row in matrix.tolist()]
        for lines in _forms(prefixes, rows):
            if max(map(columns, lines)) <= self.width:
                return lines
        return self._listing(names, [entry for row in rows for entry in row])

    def _listing(self, names: Iterable[Markup], entries: Iterable[str]) -> list[str]:
        """A line an entry; long ones are broken, and hang below their equals sign."""
        lines: list[str] = []
        for name, entry in zip(names, entries, strict=True):
            head = f"{_INDENT}{self.written(name.text)} = "
            room = self.width - columns(head)
            first, *others = break_lines(entry, room, columns, len(_INDENT))
            hang = " " * columns(head)
            lines.append(head + first.text)
            lines += [hang + _INDENT * line.depth + line.text for line in others]
        return lines


class _Screen(_Steps):
    """The lines of one derivation."""

    def __init__(
        self,
        derivation: Derivation,
        width: int,
        style: Style,
        manner: Manner,
        conversions: Conversions | None,
    ) -> None:
        notation = notation_of(derivation.arguments, manner, derivation.model)
        super().__init__(derivation.arguments, width, style, notation)
        self.derivation = derivation
        self.conversions = conversions
        self.steps = derivation.steps
        if conversions and conversions.quaternion:  # its number is the next one, as in the note
            numbered = replace(conversions.quaternion, number=len(derivation.steps) + 1)
            self.steps = (*self.steps, numbered)

    def lines(self) -> Iterator[str]:
        yield self.style(self.derivation.title, "heading")
        yield ""
        yield from self._theory()
        yield from self._convention()
        for step in self.derivation.steps:
            yield ""
            yield from self.step(step)
        yield from self._singularities()
        yield from self._numbers()
        yield from self._conversions()
        yield from self._proofs()

    def _theory(self) -> Iterator[str]:
        """The equations for every body and rotation, under their headings."""
        if not self.derivation.theory:
            return
        from rigidsym.notes.formula.summands import sums

        section = ""
        for statement in self.derivation.theory:
            if statement.section != section:
                section = statement.section
                yield self.style(section, "heading")
            yield from self._wrapped(statement.because)
            number = f"({statement.number})" if statement.number else ""
            head = f"{_DEEPER}{number:<6}{self.written(equal(*statement.sides).text)}"
            rows = [[entry.text for entry in row] for row in sums(statement, self.notation)]
            yield from grid(f"{head} = ", rows) if rows else [head]
            yield ""

    def _convention(self) -> Iterator[str]:
        for sentence in convention(self.derivation, self.notation.manner):
            yield from self._wrapped(sentence)
        turns = self.derivation.model.turns
        if turns:
            factors = [turn(t, self.notation) for t in turns]
            yield _INDENT + equal(ROTATION, product(factors)).text

    def _numbers(self) -> Iterator[str]:
        """The parameters of the body that have values, and its principal axes."""
        if self.derivation.body is None:
            return
        from rigidsym.notes.document.body_sections import lines_of_body

        lines = list(lines_of_body(self.derivation, self.notation))
        if lines:
            yield ""
            yield self.style("In numbers", "heading")
        yield from (_INDENT + line for line in lines)

    def _singularities(self) -> Iterator[str]:
        found = self.derivation.singularities
        if found is None:
            return
        yield ""
        yield self.style("Where the rates fail", "heading")
        if found.determinant is not None:
            yield from self._listing(
                [equal(*measured(found))], [text(found.determinant, self.notation)]
            )
        for sentence in failures(self.derivation, found):
            yield from self._wrapped(sentence)

    def _conversions(self) -> Iterator[str]:
        """To the unit quaternion and back, or why there is no way back."""
        found = self.conversions
        if found is None:
            return
        yield ""
        yield self.style("Conversions", "heading")
        for step in self.steps[len(self.derivation.steps) :]:
            yield from self.step(step)
        back = found.inverse
        for sentence in (back.because, back.branch) if back else (found.without,):
            yield from self._wrapped(with_symbols(sentence, symbols_of(self.derivation)))

    def _proofs(self) -> Iterator[str]:
        yield ""
        yield self.style("What was proved", "heading")
        numbered = [(s.number, s.proofs) for s in self.derivation.theory]
        numbered += [(step.number, step.proofs) for step in self.steps]
        for number, proofs in numbered:
            for proof in proofs:
                yield from self._proof(f"({number})" if number else "", proof)
        back = self.conversions and self.conversions.inverse
        for proof in back.proofs if back else ():
            yield from self._proof("", proof)
        if self.conversions:
            yield from self._proof("", self.conversions.from_matrix)

    def _proof(self, label: str, proof: Proof) -> Iterator[str]:
        mark, status = ("✓", "exact") if proof.is_exact else ("✗", "unproved")
        yield f"{_INDENT}{mark} {label:<5}{status:<10}{self.written(proof.claim.text)}"
        if proof.residual is not None:
            yield f"{_DEEPER}left over:"
            names = indexed(RESIDUAL, proof.residual.shape)
            yield from self._matrix([f"{RESIDUAL.text} = "], proof.residual, names)


def _unbroken(formula: Markup) -> str:
    return formula.text.replace(" ", _NO_BREAK)


def _forms(prefixes: Sequence[str], rows: Sequence[Sequence[str]]) -> Iterator[list[str]]:
    """The matrix beside each prefix, or below the first one; with wide gaps or with narrow ones."""
    for prefix in prefixes:
        yield grid(_INDENT + prefix, rows)
        yield grid(_INDENT + prefix, rows, tight=True)
    below = [_INDENT + prefixes[0].rstrip()]
    yield [*below, *grid(_DEEPER, rows)]
    yield [*below, *grid(_DEEPER, rows, tight=True)]


def _prefixes(step: Step) -> list[str]:
    """ "Ω′ = Rᵀ Ω = " and, where that is too long, "Ω′ = "."""
    symbol, definition = step.quantity.symbol.text, step.quantity.definition.text
    if definition in ("", symbol):
        return [f"{symbol} = "]
    return [f"{symbol} = {definition} = ", f"{symbol} = "]
