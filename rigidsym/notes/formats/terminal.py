"""Derivation -> text for a terminal: convention, quantities, what fails, what was proved."""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Literal

import sympy as sp

from rigidsym.formula.letters import Letters
from rigidsym.formula.notation import DEFAULT, Notation
from rigidsym.formula.pen import break_lines
from rigidsym.formula.scalars import formula_of, matrix_of
from rigidsym.formula.tree import Formula, equal, indexed, row
from rigidsym.formula.unicode_pen import UnicodePen, columns, grid
from rigidsym.mechanics.derivation import Argument, Derivation, Proof, Step
from rigidsym.mechanics.quantities.kinematics import BODY, ROTATION, SPACE
from rigidsym.models.rotation import RotationModel
from rigidsym.notes.document.document import Span, Text, plain
from rigidsym.notes.formula.derivation_letters import RESIDUAL, entry_names, letters_of
from rigidsym.notes.prose.prose import turn
from rigidsym.notes.prose.singular_words import failures, geometry, measured, singular_title
from rigidsym.notes.prose.vector_words import sum_of_vectors
from rigidsym.notes.prose.words import convention, unit_in_words, with_symbols

if TYPE_CHECKING:
    from rigidsym.mechanics.conversions.conversions import Conversions

Style = Callable[[str, Literal["heading", "dim"]], str]

_INDENT = "  "
_DEEPER = "    "
_NO_BREAK = "\u00a0"
_OMEGA = {frame.omega.text: frame.omega for frame in (SPACE, BODY)}


def unstyled(words: str, _: str) -> str:
    """The style of a terminal without any."""
    return words


def show(
    derivation: Derivation,
    *,
    width: int = 88,
    style: Style = unstyled,
    notation: Notation = DEFAULT,
    conversions: Conversions | None = None,
) -> str:
    """The derivation as plain text, at most `width` columns wide where formulas allow.

    `style` is given each heading and each aside, and returns it with the codes of the terminal;
    `conversions` adds a section on the unit quaternion and the matrix, and its proofs.
    """
    screen = _Screen(derivation, width, style, notation, conversions)
    return "\n".join(screen.lines())


def show_step(
    step: Step,
    arguments: Sequence[Argument],
    *,
    width: int = 88,
    notation: Notation = DEFAULT,
    model: RotationModel | None = None,
) -> str:
    """One step of a derivation as plain text."""
    letters = letters_of(arguments, notation, model)
    return "\n".join(_Steps(arguments, width, unstyled, letters).step(step))


class _Steps:
    """The lines of single steps."""

    def __init__(
        self, arguments: Sequence[Argument], width: int, style: Style, letters: Letters
    ) -> None:
        self.arguments = arguments
        self.width = width
        self.style = style
        self.letters = letters
        self.pen = UnicodePen(letters.notation)

    def step(self, step: Step) -> Iterator[str]:
        yield from self._headline(step)
        yield from self._value(step)
        yield from self._as_vectors(step)

    def _as_vectors(self, step: Step) -> Iterator[str]:
        """Ω = v̇ + ..., where the coordinates hold a vector."""
        form = step.vector_form
        if form is not None:
            total = equal(step.quantity.symbol, sum_of_vectors(form, self.letters))
            yield from self._wrapped((total,))

    def _wrapped(self, sentence: Text) -> list[str]:
        lines = textwrap.wrap(
            self._words(sentence),
            self.width,
            initial_indent=_INDENT,
            subsequent_indent=_DEEPER,
            break_long_words=False,
            break_on_hyphens=False,
        )
        return [line.replace(_NO_BREAK, " ") for line in lines]

    def _words(self, sentence: Text) -> str:
        return "".join(map(self._span, sentence))

    def _span(self, span: Span) -> str:
        """A span of a sentence; formulas are not broken at their blanks."""
        if isinstance(span, Formula):
            return self.pen.write(span).text.replace(" ", _NO_BREAK)
        return self.pen.notation.words(plain((span,)))

    def _headline(self, step: Step) -> Iterator[str]:
        """(5) angular velocity, body components           angular_velocity_body, rad/s"""
        quantity = step.quantity
        left = f"({step.number}) {self._words(with_symbols(quantity.about, _OMEGA))}"
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
        prefixes = self._prefixes(step)
        if step.recursion is not None:
            yield from self._scalar(prefixes[-1:], step.recursion)
        elif step.quantity.is_scalar:
            yield from self._scalar(prefixes, formula_of(step.expression[0], self.letters))
        else:
            yield from self._matrix(prefixes, step.expression, names)
        for proof in step.proofs:
            if not proof.is_exact:
                yield f"{_INDENT}✗ unproved: {self.pen.write(proof.claim).text}"

    def _scalar(self, prefixes: Sequence[str], value: Formula) -> Iterator[str]:
        """The value behind its sides, or below them, where a long one is broken."""
        whole = f"{_INDENT}{prefixes[0]}{self.pen.write(value).text}"
        if columns(whole) <= self.width:
            yield whole
            return
        head = f"{_INDENT}{prefixes[-1]}".removesuffix("= ")
        if len(prefixes) > 1:
            yield f"{_INDENT}{prefixes[0].removesuffix(' = ')}"
            head = " " * columns(head)
        yield from self._hung(f"{head}= ", value)

    def _hung(self, head: str, value: Formula) -> Iterator[str]:
        """A value behind a head; where it is long, its other lines hang below its start."""
        room = self.width - columns(head)
        first, *others = break_lines(self.pen.write(value), room, len(_INDENT), self.pen.blank)
        yield head + first.text
        for line in others:
            yield " " * columns(head) + _INDENT * line.depth + line.text

    def _matrix(
        self, prefixes: Sequence[str], matrix: sp.ImmutableMatrix, names: Sequence[Formula]
    ) -> list[str]:
        """The matrix in brackets, in the first form that fits, or else entry by entry."""
        rows = matrix_of(matrix, self.letters)
        for lines in _forms(prefixes, [[self.pen.write(e).text for e in line] for line in rows]):
            if max(map(columns, lines)) <= self.width:
                return lines
        return list(self._listing(names, [entry for line in rows for entry in line]))

    def _listing(self, names: Iterable[Formula], entries: Iterable[Formula]) -> Iterator[str]:
        """A line an entry; long ones are broken."""
        for name, entry in zip(names, entries, strict=True):
            yield from self._hung(f"{_INDENT}{self.pen.write(name).text} = ", entry)

    def _prefixes(self, step: Step) -> list[str]:
        """ "Ω′ = Rᵀ Ω = " and, where that is too long, "Ω′ = "."""
        quantity = step.quantity
        sides = (self.pen.write(side).text for side in (quantity.symbol, quantity.definition))
        symbol, *definition = filter(None, dict.fromkeys(sides))
        short = f"{symbol} = "
        return [f"{short}{definition[0]} = ", short] if definition else [short]


class _Screen(_Steps):
    """The lines of one derivation."""

    def __init__(
        self,
        derivation: Derivation,
        width: int,
        style: Style,
        notation: Notation,
        conversions: Conversions | None,
    ) -> None:
        letters = letters_of(derivation.arguments, notation, derivation.model)
        super().__init__(derivation.arguments, width, style, letters)
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
        yield from self._first_integrals()
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
            head = f"{_DEEPER}{number:<6}{self.pen.write(equal(*statement.sides)).text}"
            matrix = sums(statement, self.letters)
            rows = (
                [[self.pen.write(e).text for e in line] for line in matrix.rows] if matrix else []
            )
            yield from grid(f"{head} = ", rows) if rows else [head]
            yield ""

    def _convention(self) -> Iterator[str]:
        for sentence in convention(self.derivation, self.letters.notation):
            yield from self._wrapped(sentence)
        turns = self.derivation.model.turns
        if turns:
            factors = [turn(t, self.letters) for t in turns]
            yield _INDENT + self.pen.write(equal(ROTATION, row(*factors))).text

    def _numbers(self) -> Iterator[str]:
        """The parameters of the body that have values, and its principal axes."""
        if self.derivation.body is None:
            return
        from rigidsym.notes.sections.body_sections import lines_of_body

        lines = list(lines_of_body(self.derivation, self.letters))
        if lines:
            yield ""
            yield self.style("In numbers", "heading")
        yield from (_INDENT + line for line in lines)

    def _first_integrals(self) -> Iterator[str]:
        """What is constant along every motion, if equations of motion were asked for."""
        found = self.derivation.first_integrals
        if found:
            yield ""
            yield self.style("Constant along every motion (first integrals)", "heading")
        for integral in found:
            prefix = f"{self.pen.write(integral.symbol).text} = "
            yield from self._scalar([prefix], formula_of(integral.expression, self.letters))

    def _singularities(self) -> Iterator[str]:
        found = self.derivation.singularities
        if found is None:
            return
        yield ""
        yield self.style(singular_title(self.derivation), "heading")
        if found.determinant is not None:
            yield from self._listing(
                [equal(*measured(found))], [formula_of(found.determinant, self.letters)]
            )
        zeros, *points = failures(self.derivation, found)
        for sentence in (zeros, *geometry(self.derivation), *points):
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
        for sentence in (back.because, back.branch) if back else ((found.without,),):
            yield from self._wrapped(sentence)

    def _proofs(self) -> Iterator[str]:
        yield ""
        yield self.style("Identities verified", "heading")
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
        yield f"{_INDENT}{mark} {label:<5}{status:<10}{self.pen.write(proof.claim).text}"
        if proof.residual is not None:
            yield f"{_DEEPER}left over:"
            names = indexed(RESIDUAL, proof.residual.shape)
            yield from self._matrix([f"{RESIDUAL.text} = "], proof.residual, names)


def _forms(prefixes: Sequence[str], rows: Sequence[Sequence[str]]) -> Iterator[list[str]]:
    """The matrix beside each prefix, or below the first one; with wide gaps or with narrow ones."""
    for prefix in prefixes:
        yield grid(_INDENT + prefix, rows)
        yield grid(_INDENT + prefix, rows, tight=True)
    below = [_INDENT + prefixes[0].rstrip()]
    yield [*below, *grid(_DEEPER, rows)]
    yield [*below, *grid(_DEEPER, rows, tight=True)]
