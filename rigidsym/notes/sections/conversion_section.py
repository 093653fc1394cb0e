"""What a note says of the way back from a matrix or a quaternion to the coordinates."""

from __future__ import annotations

from collections.abc import Iterator

import sympy as sp

from rigidsym.formula.reader import formula
from rigidsym.mechanics.conversions.conversions import Conversions
from rigidsym.mechanics.conversions.unit_quaternions import SHEPPERD, outer_product
from rigidsym.notes.document.document import (
    Cited,
    Code,
    Equation,
    EquationRow,
    NoteBlock,
    Paragraph,
    Strong,
    said,
)
from rigidsym.notes.prose.words import with_source

COLUMNS = formula(r"\mathbf{K}")
_FUNCTIONS = ("from_quaternion(quaternion{})", "from_rotation_matrix(matrix{})")


def blocks_of_conversions(found: Conversions, *, has_functions: bool) -> Iterator[NoteBlock]:
    """How the quaternion follows from the matrix, and the coordinates from both."""
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
            yield said("These are the functions {} and {}.", *names)
    if found.is_proved:
        yield said("The claims of this section were decided exactly, like the others.")
    else:
        yield Paragraph((Strong("Unproved:"), " not all of these claims could be decided."))


def columns_of_matrix() -> sp.ImmutableMatrix:
    """K(R), (4, 4), in the entries of R."""
    entries = sp.Matrix(3, 3, lambda i, j: sp.Symbol(f"R_{i + 1}{j + 1}"))
    return sp.ImmutableMatrix(outer_product(entries))


def _matrix(found: Conversions) -> Iterator[NoteBlock]:
    """The columns of K(R) = 4 p pᵀ, from which the quaternion of a matrix is read."""
    text = (
        "The columns of {} are multiples of the unit quaternion. To keep all digits, take the "
        "column of the largest component and divide it by its length\u00a0{}; the sign is free:"
    )
    yield said(text, found.from_matrix.claim, Cited(SHEPPERD))
    matrix = columns_of_matrix()
    sides = (formula(rf"4\,p_{name}\,\mathbf{{p}}") for name in "0123")
    columns = (Equation(sides=(side,), matrix=matrix[:, k]) for k, side in enumerate(sides))
    yield EquationRow(tuple(columns))
