"""The rate matrix in the frame in which it is shortest, for the study of its rank.

Rank, kernel and minors of W are the same in every frame. Of a product of turns the frame between
the middle ones is taken, where each axis has been moved by few turns.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache, reduce

import sympy as sp

from rigidsym.algebra.codec import Codec
from rigidsym.algebra.matrix import RingMatrix
from rigidsym.mechanics.kinematics.workspace import Values, encoded
from rigidsym.models.rotation import Turn


@dataclass(frozen=True, slots=True, eq=False)
class RateMap:
    """The rates of n coordinates -> an angular velocity in some frame, over the ring."""

    matrix: RingMatrix  # (3, n)
    bound: RingMatrix | None  # (m, n): J of the conditions J q̇ = 0
    to_space: tuple[RingMatrix, ...]  # from this frame to that of space, one after the other
    to_body: tuple[RingMatrix, ...]  # from this frame to that of the body

    @property
    def whole(self) -> RingMatrix:
        """The rows of W, and below them those of the conditions; (3 + m, n)."""
        below = self.bound.rows if self.bound is not None else ()
        return RingMatrix(self.matrix.ring, (*self.matrix.rows, *below))


def rate_map_of(values: Values) -> RateMap:
    """W of a model in its shortest frame, with the conditions on the rates."""
    turns = values.model.turns
    if not turns:
        return RateMap(values.rate_matrix_space, values.bound, (), (values.R.T,))
    encoded = [_encoded(values.codec, turn) for turn in turns]
    matrices, transposes, directions = zip(*encoded, strict=True)
    middle = len(turns) // 2
    axes = [_moved(axis, place, matrices, middle) for place, axis in enumerate(directions)]
    return RateMap(
        matrix=_columns(values, axes),
        bound=values.bound,
        to_space=tuple(reversed(matrices[:middle])),
        to_body=transposes[middle:],
    )


@lru_cache(maxsize=64)
def _encoded(codec: Codec, turn: Turn) -> tuple[RingMatrix, RingMatrix, RingMatrix]:
    """The matrix of a turn over the ring, its transpose, and the axis."""
    matrix = encoded(codec, turn.matrix)
    return matrix, matrix.T, RingMatrix.column(codec.ring, map(codec.encode, turn.direction))


def _moved(axis: RingMatrix, place: int, matrices: Sequence[RingMatrix], middle: int) -> RingMatrix:
    """The axis of one turn in the frame before the turn `middle`."""
    if place < middle:
        return reduce(lambda v, turn: turn.T @ v, matrices[place + 1 : middle], axis)
    return reduce(lambda v, turn: turn @ v, reversed(matrices[middle:place]), axis)


def _columns(values: Values, axes: Sequence[RingMatrix]) -> RingMatrix:
    """What each coordinate turns about: the axes of its turns, as far as it moves them."""
    ring = values.ring
    columns = []
    for coordinate in values.arguments["q"].symbols:
        column = RingMatrix(ring, ((ring.zero,),) * 3)
        for turn, axis in zip(values.model.turns, axes, strict=True):
            if turn.angle is coordinate or turn.angle == coordinate:
                column = column + axis
            elif not turn.angle.is_Function and turn.angle.has(coordinate):
                column = column + axis.scale(values.codec.encode(sp.diff(turn.angle, coordinate)))
        columns.append(column.entries)
    return RingMatrix(ring, tuple(columns)).T
