"""Three turns, the second axis at right angles to its neighbours, from a quaternion or a matrix.

With e₁, e₂ the first two axes and C the fixed turn about e₂ that takes e₁ to the third axis,
R C = R₁(α) R₂(β + λ) R₁(γ): two turns about one axis with a turn across between them. In the frame
e₁, e₂, e₁ × e₂ its quaternion has the components cos(β′/2) (cos σ, sin σ) and sin(β′/2) (cos δ,
sin δ), with β′ = β + λ, σ = (α + γ)/2, δ = (α − γ)/2. Nothing cancels where β′ is near 0 or π.
"""

from __future__ import annotations

from dataclasses import dataclass

import sympy as sp

from rigidsym.formula.reader import formula
from rigidsym.formula.sentence import Sentence, sentence
from rigidsym.formula.symbol_names import named
from rigidsym.formula.tree import Formula
from rigidsym.models.rotation import RotationModel
from rigidsym.models.so3 import hat

Claim = tuple[tuple[sp.Expr, ...], Formula]  # what vanishes, and how it is written


@dataclass(frozen=True, kw_only=True, slots=True)
class DavenportAngles:
    """The geometry of three turns about constant axes, the middle one across the others."""

    frame: sp.ImmutableMatrix  # columns e₁, ±e₂, e₁ × ±e₂; (3, 3)
    lean: tuple[sp.Expr, sp.Expr]  # parallel to (cos λ/2, sin λ/2), λ in [0, π]
    sign: int  # of the middle angle: −1 where the frame holds −e₂
    places: tuple[int, int, int]  # of α, β, γ among the coordinates
    angle_names: tuple[str, str, str]  # of the coordinates, in their order

    @property
    def offset(self) -> sp.Expr:
        """λ in radians, in [0, π]."""
        across, along = self.lean[1], self.lean[0]
        return 2 * sp.atan2(across, along)

    @property
    def range(self) -> tuple[sp.Expr, sp.Expr]:
        """The interval in which the middle angle is given."""
        low, high = -self.offset, sp.pi - self.offset
        return (low, high) if self.sign > 0 else (-high, -low)

    @property
    def last_is_first_turn(self) -> bool:
        """Whether the last coordinate is the angle of the leftmost turn, as it is for `zxz`."""
        return self.places[0] == 2

    @property
    def forms(self) -> sp.ImmutableMatrix:
        """The components in the frame of p (1 + C), as coefficients of (w, x, y, z); (4, 4)."""
        scalar, part = self.lean
        w, x, y, z = (part * e for e in (0, *self.frame[:, 1]))
        right = sp.Matrix([[w, -x, -y, -z], [x, w, z, -y], [y, -z, w, x], [z, y, -x, w]])
        into_frame = sp.diag(1, self.frame.T)
        return sp.ImmutableMatrix(into_frame * (scalar * sp.eye(4) + right))

    @property
    def turned(self) -> tuple[sp.ImmutableMatrix, sp.ImmutableMatrix]:
        """A and B with A R B the matrix of the two turns about e₁, in the frame."""
        along, across = self.lean
        square = along**2 + across**2
        skew = hat(self.frame[:, 1])
        lean = sp.eye(3) + (2 * along * across * skew + 2 * across**2 * skew**2) / square
        return self.frame.T, sp.ImmutableMatrix((lean * self.frame).applyfunc(sp.expand))

    @property
    def branch(self) -> Sentence:
        """Which of the possible angles are given."""
        first, middle, third = (named(self.angle_names[place]) for place in self.places)
        low, high = map(_text, self.range)
        return sentence(
            f"{{}} and {{}} are in (−π, π], {{}} is in [{low}, {high}]. At a pole, the ends of "
            "that interval, only the sum or the difference of {} and {} is determined: there {} "
            "is 0. Orientations within 8 eps (radians) of a pole count as poles.",
            *(first, third, middle, first, third, named(self.angle_names[2])),
        )


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
    return _geometry(model, first, second, third)


def _geometry(
    model: RotationModel, first: sp.Matrix, second: sp.Matrix, third: sp.Matrix
) -> DavenportAngles:
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
    angles = [turn.angle for turn in model.turns]
    first_place, middle_place, last_place = (model.coordinates.index(angle) for angle in angles)
    a, b, c = (coordinate.func.__name__ for coordinate in model.coordinates)
    return DavenportAngles(
        frame=sp.ImmutableMatrix(frame),
        lean=lean,
        sign=sign,
        places=(first_place, middle_place, last_place),
        angle_names=(a, b, c),
    )


def davenport_claims(model: RotationModel, rule: DavenportAngles) -> list[Claim]:
    """The four components of p (1 + C) in the frame, for p the product of the three turns."""
    parts = sp.Matrix([1, 0, 0, 0])
    for turn in model.turns:
        parts = _times(parts, (sp.cos(turn.angle / 2), *_scaled(turn.direction, turn.angle)))
    found = rule.forms * parts
    first, middle, third = (turn.angle for turn in model.turns)
    half, (along, across) = rule.sign * middle / 2, rule.lean
    cosine = along * sp.cos(half) - across * sp.sin(half)
    sine = along * sp.sin(half) + across * sp.cos(half)
    total, difference = (first + third) / 2, (first - third) / 2
    expected = (
        cosine * sp.cos(total),
        cosine * sp.sin(total),
        sine * sp.cos(difference),
        sine * sp.sin(difference),
    )
    return [
        ((here - there,), _component(place))
        for place, (here, there) in enumerate(zip(found, expected, strict=True))
    ]


def _component(place: int) -> Formula:
    outer, inner = ("cos", "cos", "sin", "sin")[place], ("cos", "sin", "cos", "sin")[place]
    angle = (r"\sigma", r"\delta")[place // 2]
    half = r"\frac{\beta'}{2}"
    return formula(rf"a_{place} = \kappa\,\{outer}{half}\,\{inner}{angle}")


def _scaled(direction: tuple[sp.Expr, ...], angle: sp.Expr) -> tuple[sp.Expr, ...]:
    return tuple(sp.sin(angle / 2) * part for part in direction)


def _times(first: sp.Matrix, second: tuple[sp.Expr, ...]) -> sp.Matrix:
    """The product of two quaternions, scalar first."""
    w, x, y, z = first
    left = sp.Matrix([[w, -x, -y, -z], [x, w, -z, y], [y, z, w, -x], [z, -y, x, w]])
    return left * sp.Matrix(second)


def _text(angle: sp.Expr) -> str:
    """π/2 for a multiple of π, digits for anything else."""
    ratio = angle / sp.pi
    if ratio.is_Rational:
        return str(angle).replace("pi", "π").replace("-", "−")
    return f"{float(angle):.4f}".replace("-", "−")
