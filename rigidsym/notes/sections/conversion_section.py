"""The section of a note that goes from the coordinates to the unit quaternion and back."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import sympy as sp

from rigidsym.formula.entries import indexed
from rigidsym.formula.reader import formula
from rigidsym.mechanics.conversions.conversions import SHEPPERD, Conversions, outer_product
from rigidsym.mechanics.derivation import Derivation, Step
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
from rigidsym.notes.prose.conversion_words import HOW, WHICH
from rigidsym.notes.prose.words import symbols_of, with_symbols
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
    derivation: Derivation, conversions: Conversions, *, has_functions: bool
) -> Iterator[NoteBlock]:
    if conversions.quaternion is not None:
        yield from _quaternion(derivation, conversions.quaternion, has_functions=has_functions)
    yield from _matrix(conversions)
    yield from _coordinates(derivation, conversions, has_functions=has_functions)
    if not all(proof.is_exact for proof in conversions.proofs):
        yield Paragraph((Strong("Unproved:"), " not all of these claims could be decided."))
    else:
        yield Paragraph(("The claims of this section were decided exactly, like the others.",))


def _quaternion(derivation: Derivation, step: Step, *, has_functions: bool) -> Iterator[NoteBlock]:
    """The unit quaternion as a formula, with the number after that of the last step."""
    sentence = with_symbols(step.because.removesuffix("."), symbols_of(derivation) | HOW)
    source = step.quantity.source
    yield Paragraph((*sentence, *(("\u00a0", Cited(source)) if source else ()), "."))
    numbered = replace(step, number=len(derivation.steps) + 1)
    call = f"quaternion({', '.join(step.quantity.inputs)})" if has_functions else ""
    yield replace(equation_of(numbered, derivation.arguments), function=call, is_result=True)


def _matrix(conversions: Conversions) -> Iterator[NoteBlock]:
    """The columns of K(R) = 4 p pᵀ, from which the quaternion of a matrix is read."""
    yield Paragraph(
        words(
            "The unit quaternion of a matrix, but for its sign, is a column of {} over its "
            "length; that of the largest component loses no digits\u00a0{}:",
            conversions.from_matrix.claim,
            Cited(SHEPPERD),
        )
    )
    entries = sp.Matrix(3, 3, lambda i, j: sp.Symbol(f"R_{i + 1}{j + 1}"))
    matrix = sp.ImmutableMatrix(outer_product(entries))
    yield EquationRow(tuple(_column(name, matrix[:, k]) for k, name in enumerate("wxyz")))


def _column(name: str, column: sp.ImmutableMatrix) -> Equation:
    side = formula(rf"4\,p_{name}\,\mathbf{{p}}")
    return Equation(sides=(side,), matrix=column, entries=indexed(side, (4,)))


def _coordinates(
    derivation: Derivation, conversions: Conversions, *, has_functions: bool
) -> Iterator[NoteBlock]:
    inverse = conversions.inverse
    if inverse is None:
        yield Paragraph((conversions.without,))
        return
    symbols = symbols_of(derivation)
    source = (" ", Cited(inverse.source)) if inverse.source else ()
    yield Paragraph((*with_symbols(inverse.because, symbols | HOW), *source))
    yield from (Equation(sides=(proof.claim,)) for proof in inverse.proofs)
    yield Paragraph(with_symbols(inverse.branch, symbols | WHICH))
    if has_functions:
        given = "".join(f", {name}" for name in inverse.given)
        yield Paragraph(_called([name.format(given) for name in _FUNCTIONS]))


def _called(functions: Sequence[str]) -> tuple[str | Code, ...]:
    first, second = map(Code, functions)
    return ("These are the functions ", first, " and ", second, ".")
