"""How a part lies in its body: any rotation, at rest."""

from __future__ import annotations

from collections.abc import Sequence

import sympy as sp

from rigidsym.errors import BodyError, ExpressionError
from rigidsym.models.chain import axis_turn, direction
from rigidsym.models.rotation import Turn
from rigidsym.models.rotation_text import rotation_from
from rigidsym.models.so3 import AXES
from rigidsym.text.expression import names_in, parse_expression, parse_turns
from rigidsym.text.names import check_name

Placed = tuple[sp.ImmutableMatrix, tuple[sp.Expr, ...]]


def turned_by(text: str, values: Sequence[sp.Expr] | None = None) -> Placed:
    """The matrix R (3, 3) of a rotation that stays as it is, and what its symbols are bound by.

    The text is one of turns, "z(pi/4) x(alpha)", or names any rotation, whose coordinates take the
    `values`, or are constants of their names. Raises ModelError or ExpressionError for a text that
    names no rotation, BodyError where the number of values is wrong or they break a condition.
    """
    if values is None and "(" in text:
        return _product(text), ()
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


def _product(text: str) -> sp.ImmutableMatrix:
    """The product of the turns, left to right, all their names constants."""
    matrix = sp.eye(3)
    for axis, angle in parse_turns(text):
        matrix = matrix * _turn(axis, _expression(angle)).matrix
    return sp.ImmutableMatrix(matrix)


def _turn(axis: str, angle: sp.Expr) -> Turn:
    if axis in AXES:
        return Turn(axis=axis, angle=angle)
    parts = [_expression(part) for part in axis[1:-1].split(",")]
    if len(parts) != 3 or any(part.free_symbols for part in parts):
        raise ExpressionError(f"the axis {axis} is expected to have three components, in numbers")
    return axis_turn(direction(parts), angle)


def _expression(text: str) -> sp.Expr:
    return parse_expression(text, {name: sp.Symbol(check_name(name)) for name in names_in(text)})
