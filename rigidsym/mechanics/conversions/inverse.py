"""What every rule says of how coordinates follow from a rotation."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import ClassVar

import sympy as sp

from rigidsym.formula.reader import formula
from rigidsym.formula.sentence import Sentence
from rigidsym.formula.tree import Formula
from rigidsym.mechanics.conversions.function import NamedValues, Vector
from rigidsym.mechanics.conversions.unit_quaternions import shepperd
from rigidsym.models.rotation import Citation, RotationModel

Claim = tuple[tuple[sp.Expr, ...], Formula]  # what vanishes, and how it is written


def claim(text: str, *residuals: sp.Expr) -> Claim:
    """That the residuals vanish, as a formula says it."""
    return residuals, formula(text)


class InverseRule(ABC):
    """How the coordinates follow from a quaternion of any length but zero, or from R."""

    source: ClassVar[Citation | None] = None
    kept: tuple[int, ...] = ()  # places of the coordinates that the rotation does not determine

    @property
    def is_scalar_last(self) -> bool:
        """Whether quaternions are (x, y, z, w), as the coordinates are."""
        return False

    @abstractmethod
    def sentences(self, model: RotationModel) -> tuple[Sentence, Sentence]:
        """How they follow, and which of the possible coordinates are given."""

    @abstractmethod
    def claims(self, model: RotationModel) -> Sequence[Claim]:
        """What the ring of the model has to decide."""

    @abstractmethod
    def from_quaternion(
        self, values: NamedValues, model: RotationModel, quaternion: Vector
    ) -> Vector:
        """The coordinates of a quaternion that is scaled, scalar first."""

    def from_matrix(self, values: NamedValues, model: RotationModel, matrix: sp.Matrix) -> Vector:
        """The coordinates of a rotation matrix R, (3, 3)."""
        return self.from_quaternion(values, model, shepperd(values, matrix))


def in_order(found: Sequence[sp.Expr], order: Sequence[int]) -> Vector:
    """What a rule gives, in the order of the model's coordinates."""
    placed = dict(zip(order, found, strict=True))
    return tuple(placed[place] for place in range(len(found)))
