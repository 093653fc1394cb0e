"""Derivation -> text for a terminal: convention, quantities, what fails, what was proved."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from rigidsym.formula.console import INDENT, Block, Headline, Line, Style, lines_of, unstyled
from rigidsym.formula.letters import Letters
from rigidsym.formula.notation import DEFAULT, Notation
from rigidsym.formula.reader import formula, sentence
from rigidsym.formula.tree import equal
from rigidsym.mechanics.derivation import Argument, Derivation, Proof, Step
from rigidsym.mechanics.quantities.kinematics import BODY, ROTATION, SPACE
from rigidsym.models.rotation import RotationModel
from rigidsym.notes.compose import columns_of_matrix, equation_of
from rigidsym.notes.document import Equation, Paragraph
from rigidsym.notes.facts.mass import mass_facts
from rigidsym.notes.facts.rotation import facts_of_rotation, product_of
from rigidsym.notes.facts.singular import singular_facts
from rigidsym.notes.letters import RESIDUAL, letters_of
from rigidsym.notes.template import blocks_of, texts_of
from rigidsym.notes.vectors import sum_of_vectors
from rigidsym.notes.words import (
    is_body_alone,
    unit_in_words,
    with_symbols,
)

if TYPE_CHECKING:
    from rigidsym.mechanics.conversions.conversions import Conversions

_COLUMNS = formula(r"\mathbf{K}")
_OMEGA = {"Ω": SPACE.omega, "Ω′": BODY.omega}


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
    letters = letters_of(derivation.arguments, notation, derivation.model)
    blocks = list(_Screen(derivation, letters, conversions).blocks())
    return "\n".join(lines_of(blocks, letters, width, style))


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
    return "\n".join(lines_of(list(_blocks_of(step, arguments, letters)), letters, width))


def _blocks_of(step: Step, arguments: Sequence[Argument], letters: Letters) -> Iterator[Block]:
    """(5) angular velocity, body components           angular_velocity_body, rad/s"""
    quantity = step.quantity
    unit = f", {unit_in_words(quantity.unit)}" if quantity.unit else ""
    about = with_symbols(quantity.about, _OMEGA)
    yield Headline((f"({step.number}) ", *about), quantity.name + unit)
    yield equation_of(step, arguments)
    for proof in step.proofs:
        if proof.status != "exact":
            yield Line((f"{INDENT}✗ unproved: ", proof.claim))
    if step.vector_form is not None:  # Ω = v̇ + ...
        yield (equal(quantity.symbol, sum_of_vectors(step.vector_form, letters)),)


class _Screen:
    """The blocks of one derivation."""

    def __init__(
        self, derivation: Derivation, letters: Letters, conversions: Conversions | None
    ) -> None:
        self.derivation = derivation
        self.letters = letters
        self.conversions = conversions
        self.steps = derivation.steps
        if conversions and conversions.quaternion:  # its number is the next one, as in the note
            numbered = replace(conversions.quaternion, number=len(derivation.steps) + 1)
            self.steps = (*self.steps, numbered)

    def blocks(self) -> Iterator[Block]:
        yield Headline((self.derivation.title,))
        if not is_body_alone(self.derivation):
            yield ""
            yield from self._theory()
            yield from self._convention()
        for step in self.derivation.steps:
            yield ""
            yield from _blocks_of(step, self.derivation.arguments, self.letters)
        if integrals := self.derivation.first_integrals:
            yield from _under("Constant along every motion (first integrals)")
            yield from (Equation(sides=(i.symbol,), scalar=i.expression) for i in integrals)
        yield from self._singularities()
        yield from self._numbers()
        yield from self._conversions()
        yield from self._proofs()

    def _theory(self) -> Iterator[Block]:
        """The equations for every body and rotation, under their headings."""
        if not self.derivation.theory:
            return
        from rigidsym.notes.summands import sums

        section = ""
        for statement in self.derivation.theory:
            if statement.section != section:
                section = statement.section
                yield Headline((section,))
            yield statement.because
            number = f"({statement.number})" if statement.number else ""
            matrix = sums(statement, self.letters)
            head = (f"{2 * INDENT}{number:<6}", equal(*statement.sides))
            yield Line((*head, " = ") if matrix else head, matrix)
            yield ""

    def _convention(self) -> Iterator[Block]:
        facts = {**facts_of_rotation(self.derivation, self.letters), "angles": None}
        has_dots = self.letters.notation.rates == "dot"
        yield from texts_of("en/convention", self.letters, **facts, has_dots=has_dots)
        turns = self.derivation.model.turns
        if turns:
            yield Line((INDENT, equal(ROTATION, product_of(turns, self.letters))))

    def _numbers(self) -> Iterator[Block]:
        """The parameters of the body that have values, and its principal axes."""
        facts = mass_facts(self.derivation, self.letters)
        lines = list(facts.lines()) if facts else []
        yield from _under("In numbers") if lines else ()
        yield from (INDENT + line for line in lines)

    def _singularities(self) -> Iterator[Block]:
        facts = singular_facts(self.derivation)
        if facts is None:
            return
        gimbal_lock = " (gimbal lock)" if facts.is_gimbal_lock else ""
        yield from _under(f"Singular orientations{gimbal_lock}")
        given: dict[str, Any] = {"singular": facts, "model": self.derivation.model}
        if facts.found.determinant is not None:
            for block in blocks_of("en/singular_measure", self.letters, **given):
                if isinstance(block, Equation):
                    yield block
                elif isinstance(block, Paragraph) and facts.found.measure == "minors":
                    yield block.text  # or Σ₁ would have no meaning
        yield from texts_of("en/singular", self.letters, **given)

    def _conversions(self) -> Iterator[Block]:
        """To the unit quaternion and back, or why there is no way back."""
        found = self.conversions
        if found is None:
            return
        yield from _under("Conversions")
        for step in self.steps[len(self.derivation.steps) :]:
            yield from _blocks_of(step, self.derivation.arguments, self.letters)
        yield sentence("Each column of {} is a multiple of the quaternion.", _COLUMNS)
        yield Equation(sides=(_COLUMNS,), matrix=columns_of_matrix())
        back = found.inverse
        yield from (back.because, back.branch) if back else ((found.without,),)

    def _proofs(self) -> Iterator[Block]:
        yield from _under("Identities verified")
        numbered = [(s.number, s.proofs) for s in self.derivation.theory]
        numbered += [(step.number, step.proofs) for step in self.steps]
        for number, proofs in numbered:
            for proof in proofs:
                yield from _proof(f"({number})" if number else "", proof)
        back = self.conversions and self.conversions.inverse
        for proof in back.proofs if back else ():
            yield from _proof("", proof)
        if self.conversions:
            yield from _proof("", self.conversions.from_matrix)


def _under(heading: str) -> Iterator[Block]:
    yield from ("", Headline((heading,)))


def _proof(label: str, proof: Proof) -> Iterator[Block]:
    mark = "✓" if proof.status == "exact" else "✗"
    yield Line((f"{INDENT}{mark} {label:<5}{proof.status:<10}", proof.claim))
    if proof.residual is not None:
        yield f"{2 * INDENT}left over:"
        yield Equation(sides=(RESIDUAL,), matrix=proof.residual)
