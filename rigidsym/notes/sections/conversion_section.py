"""The section of a note that goes from the coordinates to the unit quaternion and back."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import sympy as sp

from rigidsym.formula.entries import indexed
from rigidsym.formula.reader import formula
from rigidsym.mechanics.conversions.conversions import SHEPPERD, Conversions, outer_product
from rigidsym.mechanics.derivation import Derivation
from rigidsym.notes.document.document import (
    Cited,
    Code,
    Document,
    Equation,
    EquationRow,
    NoteBlock,
    Paragraph,
    Section,
    Strong,
    words,
)
from rigidsym.notes.prose.words import with_source
from rigidsym.notes.sections.compose import IDENTITIES, SYMBOLS, equation_of

TITLE = "Conversions"
_BEFORE = (IDENTITIES, SYMBOLS)  # the sections that follow
_FUNCTIONS = ("from_quaternion(quaternion{})", "from_rotation_matrix(matrix{})")


def with_conversions(
    document: Document,
    derivation: Derivation,
    conversions: Conversions,
    *,
    has_functions: bool,
) -> Document:
    """The note with a section on conversions, before the one that lists the proofs."""
    blocks = tuple(_blocks(derivation, conversions, has_functions=has_functions))
    own = Section(TITLE, blocks)
    titles = [section.title for section in document.sections]
    place = next((k for k, title in enumerate(titles) if title in _BEFORE), len(titles))
    before, after = document.sections[:place], document.sections[place:]
    return replace(document, sections=(*before, own, *after))


def _blocks(
    derivation: Derivation, found: Conversions, *, has_functions: bool
) -> Iterator[NoteBlock]:
    if found.quaternion is not None:
        step = replace(found.quaternion, number=len(derivation.steps) + 1)
        yield Paragraph(with_source(found.because, step.quantity.source))
        call = f"quaternion({', '.join(step.quantity.inputs)})" if has_functions else ""
        yield replace(equation_of(step, derivation.arguments), function=call, is_result=True)
    yield from _matrix(found)
    if found.inverse is None:
        yield Paragraph((found.without,))
    else:
        yield Paragraph(with_source(found.inverse.because, found.inverse.source))
        yield from (Equation(sides=(proof.claim,)) for proof in found.inverse.proofs)
        yield Paragraph(found.inverse.branch)
        if has_functions:
            given = "".join(f", {name}" for name in found.inverse.given)
            names = (Code(name.format(given)) for name in _FUNCTIONS)
            yield Paragraph(words("These are the functions {} and {}.", *names))
    if found.is_proved:
        yield Paragraph(("The claims of this section were decided exactly, like the others.",))
    else:
        yield Paragraph((Strong("Unproved:"), " not all of these claims could be decided."))


def _matrix(found: Conversions) -> Iterator[NoteBlock]:
    """The columns of K(R) = 4 p pᵀ, from which the quaternion of a matrix is read."""
    text = (
        "The columns of {} are multiples of the unit quaternion. To keep all digits, take the "
        "column of the largest component and divide it by its length\u00a0{}; the sign is free:"
    )
    yield Paragraph(words(text, found.from_matrix.claim, Cited(SHEPPERD)))
    entries = sp.Matrix(3, 3, lambda i, j: sp.Symbol(f"R_{i + 1}{j + 1}"))
    matrix = sp.ImmutableMatrix(outer_product(entries))
    sides = (formula(rf"4\,p_{name}\,\mathbf{{p}}") for name in "wxyz")
    columns = (
        Equation(sides=(side,), matrix=matrix[:, k], entries=indexed(side, (4,)))
        for k, side in enumerate(sides)
    )
    yield EquationRow(tuple(columns))
