"""Three turns, the second axis at right angles to its neighbours, from a quaternion or a matrix.

With e₁, e₂ the first two axes and C the fixed turn about e₂ that takes e₁ to the third axis,
R C = R₁(α) R₂(β + λ) R₁(γ): two turns about one axis with a turn across between them. In the frame
e₁, e₂, e₁ × e₂ its quaternion has the components cos(β′/2) (cos σ, sin σ) and sin(β′/2) (cos δ,
sin δ), with β′ = β + λ, σ = (α + γ)/2, δ = (α − γ)/2. Nothing cancels where β′ is near 0 or π.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import reduce
from typing import ClassVar

import sympy as sp

from rigidsym.formula.reader import Sentence, named, sentence
from rigidsym.mechanics.conversions.function import NamedValues, Vector, nearest, rounded
from rigidsym.mechanics.conversions.inverse import Claim, InverseRule, claim, in_order
from rigidsym.mechanics.conversions.three_turns import ACROSS, at_poles, outer_angles
from rigidsym.mechanics.conversions.unit_quaternions import half_turn, product, shepperd
from rigidsym.models.rotation import RotationModel, hat

_HALF = r"\frac{\beta'}{2}"
_COMPONENTS = (
    rf"\cos{_HALF}\,\cos\sigma",
    rf"\cos{_HALF}\,\sin\sigma",
    rf"\sin{_HALF}\,\cos\delta",
    rf"\sin{_HALF}\,\sin\delta",
)

_BECAUSE = sentence(
    r"$\mathbf{C}$ is the fixed turn about the second axis that takes the first to the third. In "
    "the frame of the first two axes and their cross product, the quaternion of "
    r"$\mathbf{R}\,\mathbf{C}$ is $(a_0, a_1, a_2, a_3) = \kappa$ "
    r"($\cos\frac{\beta'}{2}\cos\sigma$, "
    r"$\cos\frac{\beta'}{2}\sin\sigma$, $\sin\frac{\beta'}{2}\cos\delta$, "
    r"$\sin\frac{\beta'}{2}\sin\delta$), of length $\kappa$: $\beta'$ is the middle angle plus "
    "the angle of "
    r"$\mathbf{C}$, $\sigma$ half the sum and $\delta$ half the difference of the outer angles. "
    r"So $\sigma = \operatorname{atan2}(a_1, a_0)$, $\delta = \operatorname{atan2}(a_3, a_2)$, and "
    r"$\tan\frac{\beta'}{2}$ is the quotient of the lengths of $(a_2, a_3)$ and $(a_0, a_1)$."
)


@dataclass(frozen=True, kw_only=True)
class DavenportAngles(InverseRule):
    """The geometry of three turns about constant axes, the middle one across the others."""

    frame: sp.ImmutableMatrix  # columns e₁, ±e₂, e₁ × ±e₂; (3, 3)
    lean: tuple[sp.Expr, sp.Expr]  # parallel to (cos λ/2, sin λ/2), λ in [0, π]
    sign: int  # of the middle angle: −1 where the frame holds −e₂
    places: tuple[int, int, int]  # of α, β, γ among the coordinates

    # The coordinates are the angles themselves.
    inverse: ClassVar[sp.ImmutableMatrix] = sp.ImmutableMatrix(sp.eye(3))
    offsets: ClassVar[Vector] = (sp.S.Zero, sp.S.Zero, sp.S.Zero)

    @property
    def offset(self) -> sp.Expr:
        """λ in radians, in [0, π]."""
        along, across = self.lean
        return 2 * sp.atan2(across, along)

    @property
    def because(self) -> Sentence:
        return _BECAUSE

    @property
    def branch(self) -> Sentence:
        names = [named(q.func.__name__) for q in self.model.coordinates]
        first, middle, third = (names[place] for place in self.places)
        low, high = -self.offset, sp.pi - self.offset
        if self.sign < 0:
            low, high = -high, -low
        return sentence(
            f"{{}} and {{}} are in (−π, π], {{}} is in [{_text(low)}, {_text(high)}]. At a pole, "
            "the ends of that interval, only the sum or the difference of {} and {} is determined: "
            "there {} is 0. Orientations within 8 eps (radians) of a pole count as poles.",
            *(first, third, middle, first, third, names[2]),
        )

    def _in_frame(self, quaternion: Sequence[sp.Expr]) -> sp.Matrix:
        """The components of p (1 + C) in the frame, (4, 1)."""
        scalar, part = self.lean
        whole = product(tuple(quaternion), (scalar, *(part * self.frame[:, 1])))
        return sp.diag(1, self.frame.T) * sp.Matrix(whole)

    def claims(self) -> list[Claim]:
        """The four components of p (1 + C) in the frame, for p the product of the three turns."""
        turns = (half_turn(turn.direction, turn.angle) for turn in self.model.turns)
        first, middle, third = (turn.angle for turn in self.model.turns)
        half, (along, across) = self.sign * middle / 2, self.lean
        cosine = along * sp.cos(half) - across * sp.sin(half)
        sine = along * sp.sin(half) + across * sp.cos(half)
        total, difference = (first + third) / 2, (first - third) / 2
        expected = (
            cosine * sp.cos(total),
            cosine * sp.sin(total),
            sine * sp.cos(difference),
            sine * sp.sin(difference),
        )
        found = self._in_frame(reduce(product, turns))
        return [
            claim(rf"a_{place} = \kappa\,{text}", here - there)
            for place, (here, there, text) in enumerate(
                zip(found, expected, _COMPONENTS, strict=True)
            )
        ]

    def from_quaternion(self, values: NamedValues, quaternion: Vector) -> Vector:
        parts = map(rounded, self._in_frame(quaternion))
        return self._angles(values, values.each(("a0", "a1", "a2", "a3"), parts))

    def from_matrix(self, values: NamedValues, matrix: sp.Matrix) -> Vector:
        """From the matrix of the two turns about e₁, in the frame."""
        along, across = self.lean
        skew = hat(self.frame[:, 1])
        lean = 2 * along * across * skew + 2 * across**2 * skew**2
        right = ((sp.eye(3) + lean / (along**2 + across**2)) * self.frame).applyfunc(sp.expand)
        turned = (self.frame.T * matrix * right).applyfunc(rounded)
        return self._angles(values, shepperd(values, turned))

    def _angles(self, values: NamedValues, parts: Vector) -> Vector:
        """The angles from the quaternion in the frame of the turns."""
        far, near = values.length("far", parts[:2]), values.length("near", parts[2:])
        total = values.let("half_sum", sp.atan2(parts[1], parts[0]))
        difference = values.let("half_difference", sp.atan2(parts[3], parts[2]))
        sign = -1 if self.places[0] == 2 else 1  # the last coordinate is 0 at poles
        total, difference = at_poles(values, (near, far), (total, difference), sign)
        middle = self.sign * (2 * sp.atan2(near, far) - nearest(self.offset))
        first, last = outer_angles(values, total, difference)
        return in_order((first, middle, last), self.places)

    def turn_angles(self) -> Vector:
        return tuple(self.model.coordinates[place] for place in self.places)

    def relation(self, values: NamedValues) -> Vector:  # noqa: ARG002
        """What relates two sets of angles; see `TurnChain.relation`."""
        return (-self.sign * nearest(self.offset), sp.S.Zero, sp.pi, *ACROSS)


def davenport_angles(model: RotationModel) -> DavenportAngles | None:
    """The geometry; None for turns of another kind."""
    angles = [turn.angle for turn in model.turns]
    if len(angles) != 3 or len(set(angles)) != 3 or set(angles) != set(model.coordinates):
        return None
    if any(part.free_symbols for turn in model.turns for part in turn.direction):
        return None
    first, second, third = (sp.Matrix(turn.direction) for turn in model.turns)
    if sp.expand(first.dot(second)) != 0 or sp.expand(second.dot(third)) != 0:
        return None
    cosine = sp.expand(first.dot(third))
    sine = sp.expand(first.cross(third).dot(second))
    sign = -1 if sine.is_negative else 1
    second = sign * second
    lean = (sp.S.Zero, sp.S.One) if cosine == -1 else (1 + cosine, sign * sine)
    if cosine == 0:
        lean = (sp.S.One, sp.S.One)
    elif cosine == 1:
        lean = (sp.S.One, sp.S.Zero)
    frame = sp.Matrix.hstack(first, second, first.cross(second)).applyfunc(sp.expand)
    first_place, middle_place, last_place = (model.coordinates.index(angle) for angle in angles)
    return DavenportAngles(
        model=model,
        frame=sp.ImmutableMatrix(frame),
        lean=lean,
        sign=sign,
        places=(first_place, middle_place, last_place),
    )


def _text(angle: sp.Expr) -> str:
    """π/2 for a multiple of π, digits for anything else."""
    ratio = angle / sp.pi
    if ratio.is_Rational:
        return str(angle).replace("pi", "π").replace("-", "−")
    return f"{float(angle):.4f}".replace("-", "−")
