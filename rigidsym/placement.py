"""How a part lies in its body: any rotation model, at rest."""

from __future__ import annotations

from collections.abc import Sequence

import sympy as sp

from rigidsym.errors import BodyError
from rigidsym.rotations import rotation_from

Placed = tuple[sp.ImmutableMatrix, tuple[sp.Expr, ...]]


def turned_by(text: str, values: Sequence[sp.Expr] | None = None) -> Placed:
    """The matrix R (3, 3) of a rotation that stays as it is, and what its symbols are bound by.

    The coordinates take the `values`; constants of their names where there are none. Raises
    ModelError or ExpressionError for a text that names no rotation, and BodyError where the number
    of values is wrong or they break a condition of the rotation.
    """
    model = rotation_from(text)
    if values is None:
        values = [sp.Symbol(q.func.__name__) for q in model.coordinates]
    if len(values) != len(model.coordinates):
        raise BodyError(
            f"{text} has {len(model.coordinates)} coordinates, got {len(values)} values"
        )
    fixed = dict(zip(model.coordinates, values, strict=True))
    bound = [sp.expand(condition.xreplace(fixed)) for condition in model.constraints]
    for condition in bound:
        if condition.is_number and condition != 0:
            raise BodyError(f"{text}: the values break its condition by {condition}")
    return sp.ImmutableMatrix(model.matrix.xreplace(fixed)), tuple(b for b in bound if b != 0)
