"""What every rule says of how coordinates follow from a rotation."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import sympy as sp

from rigidsym.algebra.codec import codec_for
from rigidsym.formula.reader import Sentence, formula
from rigidsym.formula.tree import Formula
from rigidsym.mechanics.conversions.function import NamedValues, Vector
from rigidsym.mechanics.conversions.unit_quaternions import shepperd
from rigidsym.mechanics.derivation import Proof
from rigidsym.mechanics.prove import Prover
from rigidsym.models.rotation import Citation, RotationModel

Claim = tuple[tuple[sp.Expr, ...], Formula]  # what vanishes, and how it is written


def claim(text: str, *residuals: sp.Expr) -> Claim:
    """That the residuals vanish, as a formula says it."""
    return residuals, formula(text)


def vanishing(model: RotationModel, claims: Sequence[Claim]) -> tuple[Proof, ...]:
    """Proofs that the residuals of each claim reduce to zero in the ring of the model."""
    if not claims:
        return ()
    residuals = [residual for found, _ in claims for residual in found]
    codec = codec_for([*model.matrix, *residuals], constraints=model.constraints, order=0)
    prove = Prover(model, codec)
    return tuple(prove.vanishes(codec.column(found), text) for found, text in claims)


@dataclass(frozen=True, kw_only=True)
class InverseRule(ABC):
    """How the coordinates follow from a quaternion of any length but zero, or from R."""

    model: RotationModel
    source: ClassVar[Citation | None] = None
    kept: tuple[int, ...] = ()  # places of the coordinates that the rotation does not determine

    @property
    def is_scalar_last(self) -> bool:
        """Whether quaternions are (x, y, z, w), as the coordinates are."""
        return False

    @property
    @abstractmethod
    def because(self) -> Sentence:
        """How they follow."""

    @property
    @abstractmethod
    def branch(self) -> Sentence:
        """Which of the possible coordinates are given."""

    @abstractmethod
    def claims(self) -> Sequence[Claim]:
        """What the ring of the model has to decide."""

    @property
    def given(self) -> tuple[str, ...]:
        """Arguments that the functions take besides: "parameters", "kept"."""
        return (*["parameters"] * bool(self.model.constants), *["kept"] * bool(self.kept))

    @cached_property
    def proofs(self) -> tuple[Proof, ...]:
        return vanishing(self.model, self.claims())

    @abstractmethod
    def from_quaternion(self, values: NamedValues, quaternion: Vector) -> Vector:
        """The coordinates of a quaternion that is scaled, scalar first."""

    def from_matrix(self, values: NamedValues, matrix: sp.Matrix) -> Vector:
        """The coordinates of a rotation matrix R, (3, 3)."""
        return self.from_quaternion(values, shepperd(values, matrix))


def in_order(found: Sequence[sp.Expr], order: Sequence[int]) -> Vector:
    """What a rule gives, in the order of the model's coordinates."""
    placed = dict(zip(order, found, strict=True))
    return tuple(placed[place] for place in range(len(found)))
