"""Your own rotation, given entry by entry."""

from __future__ import annotations

from collections.abc import Sequence

import sympy as sp
from sympy.core.function import AppliedUndef

from rigidsym.errors import ModelError
from rigidsym.models.rotation import Citation, RotationModel
from rigidsym.models.so3 import symbolic

GIVEN = "given by the user"  # the source of a rotation without another


def given(
    matrix: sp.MatrixBase,
    *,
    name: str,
    title: str = "",
    coordinates: Sequence[sp.Expr] = (),
    constraints: Sequence[sp.Expr] = (),
    source: str = GIVEN,
    passive: bool = False,
) -> RotationModel:
    """Your own R(q), 3x3, in functions of time; it is proved to be a rotation when derived.

    Without `coordinates` they are the functions of time in the matrix, in alphabetical order.
    Raises ModelError for a matrix that is not 3x3 or has no coordinate.
    """
    try:
        entries = [symbolic(entry, f"{name}: an entry") for entry in sp.flatten(matrix)]
        matrix = sp.Matrix(*(matrix.shape if hasattr(matrix, "shape") else (3, 3)), entries)
    except (TypeError, ValueError):
        raise ModelError(f"{name}: expected a 3x3 matrix, got {matrix!r}") from None
    found = tuple(sp.ordered(sp.Matrix(matrix).atoms(AppliedUndef)))
    used = tuple(coordinates) or found
    return RotationModel(
        name=name,
        title=title or name,
        convention=("The rotation is given entry by entry.",),
        coordinates=used,
        matrix=sp.ImmutableMatrix(matrix),
        constraints=tuple(constraints),
        units=("",) * len(used),
        source=Citation(text=source),
        passive=passive,
    )
