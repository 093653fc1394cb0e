"""Derivation -> text for a terminal: convention, quantities, what fails, what was proved."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Literal

from rigidsym.formula.console import INDENT, Console
from rigidsym.formula.letters import Letters
from rigidsym.formula.notation import DEFAULT, Notation
from rigidsym.formula.tree import Formula, equal, indexed, row
from rigidsym.formula.unicode_pen import columns
from rigidsym.mechanics.derivation import Argument, Derivation, Proof, Step
from rigidsym.mechanics.quantities.kinematics import BODY, ROTATION, SPACE
from rigidsym.models.rotation import RotationModel
from rigidsym.notes.document.document import Text, plain, words
from rigidsym.notes.formula.derivation_letters import RESIDUAL, entry_names, letters_of
from rigidsym.notes.prose.prose import turn
from rigidsym.notes.prose.singular_words import (
    failures,
    geometry,
    meaning,
    measured,
    singular_title,
)
from rigidsym.notes.prose.vector_words import sum_of_vectors
from rigidsym.notes.prose.words import convention, is_body_alone, unit_in_words, with_symbols

if TYPE_CHECKING:
    from rigidsym.mechanics.conversions.conversions import Conversions

Style = Callable[[str, Literal["heading", "dim"]], str]

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
        self.style = style
        self.letters = letters
        self.console = Console(letters, width)

    def step(self, step: Step) -> Iterator[str]:
        quantity = step.quantity
        yield from self._headline(step)
        sides = (quantity.symbol, quantity.definition)
        if step.recursion is not None:
            yield from self.console.scalar(sides[:1], step.recursion)
        elif quantity.shape == "scalar":
            yield from self.console.scalar(sides, step.expression[0])
        else:
            names = entry_names(step, self.arguments)
            yield from self.console.matrix(sides, step.expression, names)
        for proof in step.proofs:
            if proof.status != "exact":
                yield f"{INDENT}✗ unproved: {self.console.text(proof.claim)}"
        if step.vector_form is not None:  # Ω = v̇ + ...
            yield from self._said(
                (equal(quantity.symbol, sum_of_vectors(step.vector_form, self.letters)),)
            )

    def _said(self, sentence: Text) -> list[str]:
        return self.console.sentence(_spoken(sentence))

    def _headline(self, step: Step) -> Iterator[str]:
        """(5) angular velocity, body components           angular_velocity_body, rad/s"""
        quantity, width = step.quantity, self.console.width
        about = self.console.words(_spoken(with_symbols(quantity.about, _OMEGA)))
        left = f"({step.number}) {about}"
        unit = f", {unit_in_words(quantity.unit)}" if quantity.unit else ""
        right = quantity.name + unit
        room = width - columns(left)
        if room - columns(right) < len(INDENT):
            yield self.style(left, "heading")
            yield self.style(right.rjust(width), "dim")
        else:
            yield self.style(left, "heading") + self.style(right.rjust(room), "dim")


def _spoken(text: Text) -> list[str | Formula]:
    return [span if isinstance(span, Formula) else plain((span,)) for span in text]


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
        if not is_body_alone(self.derivation):
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
            yield from self._said(statement.because)
            number = f"({statement.number})" if statement.number else ""
            matrix = sums(statement, self.letters)
            yield from self.console.numbered(number, statement.sides, matrix)
            yield ""

    def _convention(self) -> Iterator[str]:
        for sentence in convention(self.derivation, self.letters.notation):
            yield from self._said(sentence)
        turns = self.derivation.model.turns
        if turns:
            factors = [turn(t, self.letters) for t in turns]
            yield INDENT + self.console.text(ROTATION, row(*factors))

    def _numbers(self) -> Iterator[str]:
        """The parameters of the body that have values, and its principal axes."""
        if self.derivation.body is None:
            return
        from rigidsym.notes.sections.body_sections import lines_of_body

        lines = list(lines_of_body(self.derivation, self.letters))
        if lines:
            yield ""
            yield self.style("In numbers", "heading")
        yield from (INDENT + line for line in lines)

    def _first_integrals(self) -> Iterator[str]:
        """What is constant along every motion, if equations of motion were asked for."""
        found = self.derivation.first_integrals
        if found:
            yield ""
            yield self.style("Constant along every motion (first integrals)", "heading")
        for integral in found:
            yield from self.console.scalar([integral.symbol], integral.expression)

    def _singularities(self) -> Iterator[str]:
        found = self.derivation.singularities
        if found is None:
            return
        yield ""
        yield self.style(singular_title(self.derivation), "heading")
        if found.measure == "minors":
            yield from self._said(meaning(found))  # else Σ₁ would have no meaning
        if found.determinant is not None:
            yield from self.console.listing([equal(*measured(found))], [found.determinant])
        zeros, *points = failures(self.derivation, found)
        for sentence in (zeros, *geometry(self.derivation), *points):
            yield from self._said(sentence)

    def _conversions(self) -> Iterator[str]:
        """To the unit quaternion and back, or why there is no way back."""
        found = self.conversions
        if found is None:
            return
        yield ""
        yield self.style("Conversions", "heading")
        for step in self.steps[len(self.derivation.steps) :]:
            yield from self.step(step)
        from rigidsym.notes.sections.conversion_section import COLUMNS, columns_of_matrix

        matrix = columns_of_matrix()
        yield from self._said(words("Each column of {} is a multiple of the quaternion.", COLUMNS))
        yield from self.console.matrix((COLUMNS,), matrix, indexed(COLUMNS, matrix.shape))
        back = found.inverse
        for sentence in (back.because, back.branch) if back else ((found.without,),):
            yield from self._said(sentence)

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
        mark = "✓" if proof.status == "exact" else "✗"
        yield f"{INDENT}{mark} {label:<5}{proof.status:<10}{self.console.text(proof.claim)}"
        if proof.residual is not None:
            yield f"{2 * INDENT}left over:"
            names = indexed(RESIDUAL, proof.residual.shape)
            yield from self.console.matrix([RESIDUAL], proof.residual, names)
