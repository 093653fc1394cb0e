"""Constant rotations between the frames of the turns and the frames of the data; without NumPy."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import permutations, product
from math import acos, degrees, prod, sqrt

Matrix = tuple[tuple[float, ...], ...]  # (3, 3), a rotation

IDENTITY: Matrix = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
_HALF_TURN: Matrix = ((1.0, 0.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.0, -1.0))
_SWAPPED: Matrix = ((0.0, 1.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, -1.0))
_SPACE_NAMES = {_SWAPPED: "NED and ENU", _HALF_TURN: "NED and NWU"}
_BODY_NAMES = {_HALF_TURN: "FRD and FLU", _SWAPPED: "FRD and RFU"}


def transposed(matrix: Matrix) -> Matrix:
    """The inverse of a rotation."""
    return tuple(zip(*matrix, strict=True))


def multiplied(first: Matrix, second: Matrix) -> Matrix:
    """The product of two rotations; no entry is −0."""
    columns = transposed(second)
    return tuple(
        tuple(sum(a * b for a, b in zip(row, column, strict=True)) + 0.0 for column in columns)
        for row in first
    )


_EVEN = ((0, 1, 2), (1, 2, 0), (2, 0, 1))
PERMUTATIONS: tuple[Matrix, ...] = tuple(
    tuple(
        tuple(sign if column == place else 0.0 for column in range(3))
        for place, sign in zip(order, signs, strict=True)
    )
    for order, signs in product(permutations(range(3)), product((1.0, -1.0), repeat=3))
    if prod(signs) == (1 if order in _EVEN else -1)
)


@dataclass(frozen=True, kw_only=True, slots=True)
class Frames:
    """The rotation of the data is S R B, that of the turns is R.

    S takes space components in the frame of the turns to those in the frame of the data, B body
    components in the frame of the data to those in the frame of the turns.
    """

    space: Matrix = IDENTITY
    body: Matrix = IDENTITY

    @property
    def inverse(self) -> Frames:
        """The frames of Rᵀ, whose data are Bᵀ Rᵀ Sᵀ."""
        return Frames(space=transposed(self.body), body=transposed(self.space))

    def cost(self) -> int:
        """Sorts frames: those of the turns, then those that have names, then any others."""
        sides = (self.space, _SPACE_NAMES), (self.body, _BODY_NAMES)
        return sum(_cost(matrix, names) for matrix, names in sides)

    def words(self) -> list[str]:
        """ "space axes (y, x, −z) as between NED and ENU", and of the body."""
        sides = ("space", self.space, _SPACE_NAMES), ("body", transposed(self.body), _BODY_NAMES)
        return [_words(*side) for side in sides if side[1] != IDENTITY]


def _cost(matrix: Matrix, names: dict[Matrix, str]) -> int:
    if matrix == IDENTITY:
        return 0
    return 1 + list(names).index(matrix) if matrix in names else 3


def _words(side: str, matrix: Matrix, names: dict[Matrix, str]) -> str:
    if matrix not in PERMUTATIONS:
        return f"{side} frame misaligned by {_turn(transposed(matrix))}"
    axes = [
        ("−" if entry < 0 else "") + axis
        for row in matrix
        for entry, axis in zip(row, "xyz", strict=True)
        if entry
    ]
    name = f" as between {names[matrix]}" if matrix in names else ""
    return f"{side} axes ({axes[0]} {axes[1]} {axes[2]}){name}"


def _turn(m: Matrix) -> str:
    """A rotation by its angle and axis: 3.2° about (0.1 0.2 0.97)."""
    angle = acos(max(-1.0, min(1.0, (m[0][0] + m[1][1] + m[2][2] - 1) / 2)))
    axis = (m[2][1] - m[1][2], m[0][2] - m[2][0], m[1][0] - m[0][1])
    length = sqrt(sum(entry * entry for entry in axis)) or 1.0
    shown = " ".join(f"{round(entry / length, 3) + 0.0:.2g}" for entry in axis)
    return f"{degrees(angle):.3g}° about ({shown})"
