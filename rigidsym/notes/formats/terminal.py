"""Derivation -> text for a terminal: convention, quantities, what fails, what was proved."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from rigidsym.formula.console import INDENT, Block, Headline, Line, Style, lines_of, unstyled
from rigidsym.formula.display import display
from rigidsym.formula.letters import Letters
from rigidsym.formula.notation import DEFAULT, Notation
from rigidsym.formula.reader import formula, sentence
from rigidsym.formula.tree import equal
from rigidsym.mechanics.derivation import Argument, Derivation, Step
from rigidsym.mechanics.quantities.kinematics import BODY, ROTATION, SPACE
from rigidsym.notes.document import Equation, Paragraph
from rigidsym.notes.equations import columns_of_matrix, equation_of
from rigidsym.notes.facts.rotation import facts_of_rotation, product_of
from rigidsym.notes.facts.singular import singular_facts
from rigidsym.notes.fitting import as_vectors
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

_WIDTH = 88  # columns
_EMS = 44.0  # of an equation by itself in LaTeX
_COLUMNS = formula(r"\mathbf{K}")
_OMEGA = {"Ω": SPACE.omega, "Ω′": BODY.omega}


def show(
    derivation: Derivation,
    *,
    width: int = _WIDTH,
    style: Style = unstyled,
    notation: Notation = DEFAULT,
    conversions: Conversions | None = None,
) -> str:
    """The derivation as plain text, at most `width` columns wide where formulas allow.

    `style` is given each heading and each aside, and returns it with the codes of the terminal;
    `conversions` adds a section on the unit quaternion and the matrix, and its proofs.
    """
    letters = letters_of(derivation.arguments, notation, derivation.model)
    blocks = list(_screen(derivation, letters, conversions))
    return "\n".join(lines_of(blocks, letters, width, style))


def printed_step(step: Step, form: str, derivation: Derivation, notation: Notation) -> str:
    """One step of a derivation: "latex", its equation without a number, or "text"."""
    arguments = derivation.arguments
    letters = letters_of(arguments, notation, derivation.model)
    if form == "text":
        return "\n".join(lines_of(list(_blocks_of(step, arguments, letters)), letters, _WIDTH))
    equation = as_vectors(equation_of(step, arguments), step, letters)
    return display(equation, letters, _EMS).text


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


def _screen(
    derivation: Derivation, letters: Letters, conversions: Conversions | None
) -> Iterator[Block]:
    """The blocks of a derivation from top to bottom."""
    model, steps = derivation.model, derivation.steps
    facts = facts_of_rotation(derivation, letters)
    facts |= {"angles": None, "has_dots": letters.notation.rates == "dot"}
    yield Headline((derivation.title,))
    if not is_body_alone(derivation):
        yield ""
        yield from texts_of("en/convention", letters, **facts)
        if model.turns:
            yield Line((INDENT, equal(ROTATION, product_of(model.turns, letters))))
    for step in steps:
        yield ""
        yield from _blocks_of(step, derivation.arguments, letters)
    if integrals := derivation.first_integrals:
        yield from _under("Constant along every motion (first integrals)")
        yield from (Equation(sides=(i.symbol,), scalar=i.expression) for i in integrals)

    singular = singular_facts(derivation)
    if singular is not None:
        facts["singular"] = singular
        gimbal_lock = " (gimbal lock)" if singular.is_gimbal_lock else ""
        yield from _under(f"Singular orientations{gimbal_lock}")
        if singular.found.determinant is not None:
            for block in blocks_of("en/singular_measure", letters, **facts):
                if isinstance(block, Equation):
                    yield block
                elif isinstance(block, Paragraph) and singular.found.measure == "minors":
                    yield block.text  # or Σ₁ would have no meaning
        yield from texts_of("en/singular", letters, **facts)

    if derivation.body is not None:
        from rigidsym.notes.facts.mass import MassFacts

        lines = list(MassFacts(derivation, derivation.body, letters).lines())
        yield from _under("In numbers") if lines else ()
        yield from (INDENT + line for line in lines)

    back = conversions and conversions.inverse
    if conversions:  # to the unit quaternion and back, or why there is no way back
        yield from _under("Conversions")
        if conversions.quaternion:  # its number is the next one, as in the note
            quaternion = replace(conversions.quaternion, number=len(steps) + 1)
            steps = (*steps, quaternion)
            yield from _blocks_of(quaternion, derivation.arguments, letters)
        yield sentence("Each column of {} is a multiple of the quaternion.", _COLUMNS)
        yield Equation(sides=(_COLUMNS,), matrix=columns_of_matrix())
        yield from (back.because, back.branch) if back else ((conversions.without,),)

    yield from _under("Identities verified")
    proofs = [(stated.number, proof) for stated in derivation.theory for proof in stated.proofs]
    proofs += [(step.number, proof) for step in steps for proof in step.proofs]
    proofs += [(0, proof) for proof in (back.proofs if back else ())]
    proofs += [(0, conversions.from_matrix)] if conversions else []
    for number, proof in proofs:
        mark, label = "✓" if proof.is_exact else "✗", f"({number})" if number else ""
        yield Line((f"{INDENT}{mark} {label:<5}{proof.status:<10}", proof.claim))
        if proof.residual is not None:
            yield f"{2 * INDENT}left over:"
            yield Equation(sides=(RESIDUAL,), matrix=proof.residual)


def _under(heading: str) -> Iterator[Block]:
    yield from ("", Headline((heading,)))
