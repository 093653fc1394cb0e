"""Rotations given entry by entry: direction cosines, and matrices of your own."""

from __future__ import annotations

from collections.abc import Sequence

import sympy as sp
from sympy.core.function import AppliedUndef

from rigidsym.errors import ModelError
from rigidsym.models.quaternions import UnitQuaternion
from rigidsym.models.rotation import Citation, Pullback, RotationModel, lecture
from rigidsym.models.so3 import symbolic, time_function
from rigidsym.models.vectors import distinct_names

GIVEN = "given by the user"  # the source of a rotation without another

_NAMES = tuple(f"r{row}{column}" for row in (1, 2, 3) for column in (1, 2, 3))


def DirectionCosines(names: Sequence[str] = _NAMES, *, passive: bool = False) -> RotationModel:
    """The nine entries of R, row by row; dR/dt = C(Ω) R are Poisson's equations.

    Every rotation is that of a unit quaternion, so that claims are proved after R is written as
    one; the forms that are shown stay in the entries. Raises ModelError for bad names.
    """
    entries = tuple(time_function(name) for name in distinct_names(names, 9))
    quaternion = UnitQuaternion(names=[f"{names[0]}_quaternion_{k}" for k in "wxyz"])
    return RotationModel(
        name="direction_cosines" + ("_passive" if passive else ""),
        title="Direction cosines" + (", passive" if passive else ""),
        convention=("The coordinates are the nine entries of R, row by row.",),
        coordinates=entries,
        matrix=sp.ImmutableMatrix(3, 3, entries),
        pullback=Pullback(coordinates=tuple(quaternion.matrix), constraints=quaternion.constraints),
        source=lecture("15", "section 3.2"),
        units=("",) * 9,
        passive=passive,
    )


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
