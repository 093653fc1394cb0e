"""How coordinates follow from a rotation: the 24 Euler conventions and the parametrisations.

A model is recognised by its turns, or by its matrix and its constraints, not by its name: your own
R(q) that is a rotation vector converts as one. The sentences are in
templates/notes/en/conversions.toml.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, reduce

import sympy as sp

from rigidsym.algebra.codec import codec_for
from rigidsym.formula.reader import Sentence, formula, named, sentence
from rigidsym.formula.tree import Formula
from rigidsym.mechanics.conversions.function import (
    NamedValues,
    Vector,
    Where,
    half_turn,
    product,
    shepperd,
    short_way,
    square,
    unit,
)
from rigidsym.mechanics.derivation import Proof, phrases
from rigidsym.mechanics.prove import Prover
from rigidsym.models import parametrisations
from rigidsym.models.rotation import AXES, RotationModel, hat, rotation_of

Claim = tuple[tuple[sp.Expr, ...], Formula]  # what vanishes, and how it is written
WORDS = phrases("conversions")


def claim(text: str, *residuals: sp.Expr) -> Claim:
    """That the residuals vanish, as a formula says it."""
    return residuals, formula(text)


def vanishing(model: RotationModel, claims: Sequence[Claim]) -> tuple[Proof, ...]:
    """Proofs that the residuals of each claim reduce to zero in the ring of the model."""
    if not claims:
        return ()
    residuals = [residual for parts, _ in claims for residual in parts]
    codec = codec_for([*model.matrix, *residuals], constraints=model.constraints, order=0)
    prove = Prover(model, codec)
    return tuple(prove.vanishes(codec.column(parts), text) for parts, text in claims)


@dataclass(frozen=True, kw_only=True)
class InverseRule(ABC):
    """How the coordinates follow from a quaternion of any length but zero, or from R."""

    model: RotationModel
    rule: str  # "euler", or the name of a parametrisation: "quaternion", "rotation_vector", ...
    order: tuple[int, ...]  # place, among the model's coordinates, of each that the rule gives

    @property
    def is_scalar_last(self) -> bool:
        """Whether quaternions are (x, y, z, w), as the coordinates are."""
        return self.rule in ("quaternion", "unit_quaternion") and self.order[0] == 3

    @property
    def words(self) -> Mapping[str, str]:
        words: Mapping[str, str] = WORDS[self.rule]
        return words

    @property
    def because(self) -> Sentence:
        """How they follow."""
        return sentence(self.words["backward"])

    @property
    def branch(self) -> Sentence:
        """Which of the possible coordinates are given."""
        return sentence(self.words["choice"])

    @abstractmethod
    def claims(self) -> Sequence[Claim]:
        """What the ring of the model has to decide."""

    @cached_property
    def proofs(self) -> tuple[Proof, ...]:
        return vanishing(self.model, self.claims())

    @abstractmethod
    def from_quaternion(self, values: NamedValues, quaternion: Vector) -> Vector:
        """The coordinates of a quaternion that is scaled, scalar first."""

    @abstractmethod
    def from_matrix(self, values: NamedValues, matrix: sp.Matrix) -> Vector:
        """The coordinates of a rotation matrix R, (3, 3)."""

    def in_order(self, values: Sequence[sp.Expr]) -> Vector:
        """What the rule gives, in the order of the model's coordinates."""
        placed = dict(zip(self.order, values, strict=True))
        return tuple(placed[place] for place in range(len(values)))


def inverse_rule(model: RotationModel) -> InverseRule | None:
    """The rule of a model; None if its coordinates do not follow in closed form."""
    return _closed_form(model) or _euler_rule(model)


# Three turns about coordinate axes. With e₁, e₂ the first two axes and C the fixed turn about e₂
# that takes e₁ to the third axis (none for ZXZ, a quarter turn for ZYX), R C = R₁(α) R₂(β') R₁(γ):
# two turns about one axis with a turn across between them. In the frame e₁, e₂, e₁ × e₂ its
# quaternion is cos(β'/2) (cos σ, sin σ) and sin(β'/2) (cos δ, sin δ), with σ = (α + γ)/2 and
# δ = (α − γ)/2. So nothing cancels where β' is near 0 or π, which are the poles.


@dataclass(frozen=True, kw_only=True)
class EulerRule(InverseRule):
    """Three turns by the coordinates about coordinate axes, neighbours about different ones.

    `order` has the places of α, β, γ.
    """

    frame: sp.ImmutableMatrix  # columns e₁, ±e₂, e₁ × ±e₂; (3, 3)
    quarters: int  # ±1 if C is a quarter turn about ∓e₂, 0 if there is none

    @property
    def _sign(self) -> int:
        """Of the middle angle: −1 where the frame holds −e₂, so that β' is in [0, π]."""
        return -1 if self.quarters > 0 else 1

    @property
    def _lean(self) -> tuple[int, int]:
        """Parallel to (cos λ/2, sin λ/2) for the angle λ of C."""
        return 1, abs(self.quarters)

    @property
    def branch(self) -> Sentence:
        names = [named(q.func.__name__) for q in self.model.coordinates]
        first, middle, third = (names[place] for place in self.order)
        interval = "[−π/2, π/2]" if self.quarters else "[0, π]"
        typed = self.words["choice"].replace("INTERVAL", interval)
        return sentence(typed, *(first, third, middle, first, third, names[2]))

    def _in_frame(self, quaternion: Sequence[sp.Expr]) -> sp.Matrix:
        """The components of p (1 + C) in the frame, (4, 1)."""
        scalar, part = self._lean
        whole = product(tuple(quaternion), (sp.Integer(scalar), *(part * self.frame[:, 1])))
        return sp.diag(1, self.frame.T) * sp.Matrix(whole)

    def claims(self) -> list[Claim]:
        """The four components of p (1 + C) in the frame, for p the product of the three turns."""
        turns = (half_turn(turn.direction, turn.angle) for turn in self.model.turns)
        first, middle, third = (turn.angle for turn in self.model.turns)
        half, (along, across) = self._sign * middle / 2, self._lean
        cosine = along * sp.cos(half) - across * sp.sin(half)
        sine = along * sp.sin(half) + across * sp.cos(half)
        total, difference = (first + third) / 2, (first - third) / 2
        expected = (
            (cosine * sp.cos(total), r"\cos#\,\cos\sigma"),
            (cosine * sp.sin(total), r"\cos#\,\sin\sigma"),
            (sine * sp.cos(difference), r"\sin#\,\cos\delta"),
            (sine * sp.sin(difference), r"\sin#\,\sin\delta"),
        )
        components = self._in_frame(reduce(product, turns))
        return [
            claim(rf"a_{k} = \kappa\," + text.replace("#", r"\frac{\beta'}{2}"), here - there)
            for k, (here, (there, text)) in enumerate(zip(components, expected, strict=True))
        ]

    def from_quaternion(self, values: NamedValues, quaternion: Vector) -> Vector:
        parts = map(sp.expand, self._in_frame(quaternion))
        return self._angles(values, values.each(("a0", "a1", "a2", "a3"), parts))

    def from_matrix(self, values: NamedValues, matrix: sp.Matrix) -> Vector:
        """From the matrix of R C in the frame."""
        skew = hat(self.frame[:, 1])
        fixed = sp.eye(3) + skew + skew**2 if self.quarters else sp.eye(3)
        turned = (self.frame.T * matrix * fixed * self.frame).applyfunc(sp.expand)
        return self._angles(values, shepperd(values, turned))

    def _angles(self, values: NamedValues, parts: Vector) -> Vector:
        """The angles from the quaternion in the frame of the turns."""
        far, near = values.length("far", parts[:2]), values.length("near", parts[2:])
        total = values.let("half_sum", sp.atan2(parts[1], parts[0]))
        difference = values.let("half_difference", sp.atan2(parts[3], parts[2]))
        # Where a half of the quaternion vanishes, its angle is taken to be the other's, or minus
        # it, so that the last coordinate is zero, whether it is the first turn's or the third's.
        is_low, is_high = near <= values.tiny * far, far <= values.tiny * near
        sign = -1 if self.order[0] == 2 else 1
        chosen = values.let("half_difference", Where(is_low, sign * total, difference))
        total = values.let("half_sum", Where(is_high, sign * difference, total))
        first = values.wrapped("first", total + chosen)
        last = values.wrapped("last", total - chosen)
        offset = sp.Float(float(sp.pi / 2)) if self.quarters else sp.S.Zero
        middle = self._sign * (2 * sp.atan2(near, far) - offset)
        return self.in_order((first, middle, last))


def _euler_rule(model: RotationModel) -> EulerRule | None:
    angles = [turn.angle for turn in model.turns]
    letters = [turn.axis for turn in model.turns]
    if len(angles) != 3 or len(set(angles)) != 3 or set(angles) != set(model.coordinates):
        return None
    if not set(letters) <= set(AXES) or letters[1] in (letters[0], letters[2]):
        return None
    first, second, third = (sp.Matrix(turn.direction) for turn in model.turns)
    quarters = -int(first.cross(third).dot(second))
    second *= -1 if quarters > 0 else 1
    return EulerRule(
        model=model,
        rule="euler",
        order=tuple(map(model.coordinates.index, angles)),
        frame=sp.ImmutableMatrix(sp.Matrix.hstack(first, second, first.cross(second))),
        quarters=quarters,
    )


# Parametrisations whose quaternion has a closed form. Nothing cancels on the way back.

Back = Callable[[NamedValues, Vector], Vector]  # the coordinates of a scaled quaternion
Parts = tuple[Vector, tuple[Claim, ...], Back]  # the unit quaternion, what is claimed, and back


Build = Callable[..., RotationModel]
PartsOf = Callable[[Vector], Parts]
_FORMS: dict[str, tuple[Build, int, PartsOf]] = {}  # by rule


def _form_of(build: Build, count: int) -> Callable[[PartsOf], PartsOf]:
    """Registers the form of a parametrisation with so many coordinates, by its name."""

    def register(parts_of: PartsOf) -> PartsOf:
        _FORMS[parts_of.__name__] = build, count, parts_of
        return parts_of

    return register


@dataclass(frozen=True, kw_only=True)
class ClosedForm(InverseRule):
    """One parametrisation in given coordinates."""

    parts: Parts

    @property
    def quaternion(self) -> Vector:
        """Scalar first, of length one; empty where it is read off from R."""
        return self.parts[0]

    @property
    def has_both_signs(self) -> bool:
        """Whether p and −p differ."""
        return self.rule in ("quaternion", "unit_quaternion", "cayley_klein")

    def claims(self) -> Sequence[Claim]:
        return self.parts[1]

    def from_quaternion(self, values: NamedValues, quaternion: Vector) -> Vector:
        return self.in_order(self.parts[2](values, quaternion))

    def from_matrix(self, values: NamedValues, matrix: sp.Matrix) -> Vector:
        if self.rule == "direction_cosines":
            return self.in_order(tuple(matrix))
        quaternion = shepperd(values, matrix)
        if self.has_both_signs:
            quaternion = short_way(values, quaternion)
        return self.from_quaternion(values, quaternion)


def _closed_form(model: RotationModel) -> ClosedForm | None:
    """The form of a model that is one of the parametrisations; None where it is none."""
    for rule, (build, count, parts_of) in _FORMS.items():
        for order in _orders(count) if len(model.coordinates) == count else ():
            q = tuple(model.coordinates[place] for place in order)
            known = build([part.func.__name__ for part in q])
            if known.matrix == model.matrix and known.constraints == model.constraints:
                return ClosedForm(model=model, rule=rule, order=order, parts=parts_of(q))
    return None


def _orders(count: int) -> Iterator[tuple[int, ...]]:
    """The coordinates as they stand, and with the last of four first."""
    yield tuple(range(count))
    if count == 4:
        yield (3, 0, 1, 2)


def _along(factor: sp.Expr, vector: Sequence[sp.Expr]) -> Vector:
    return tuple(factor * part for part in vector)


def _equal(first: Sequence[sp.Expr], second: Sequence[sp.Expr], text: str) -> Claim:
    return claim(text, *(a - b for a, b in zip(first, second, strict=True)))


def _length_of_vector(values: NamedValues, vector: Vector) -> tuple[sp.Basic, sp.Expr]:
    """Whether a vector vanishes, and its length, or one: a root of zero has no derivative."""
    size = values.let("square", square(vector))
    none = sp.Eq(size, 0)
    return none, values.let("length", sp.sqrt(Where(none, sp.S.One, size)))


@_form_of(parametrisations.Quaternion, 4)
def quaternion(q: Vector) -> Parts:
    length = sp.sqrt(square(q))
    parts = _along(1 / length, q)
    return parts, (_equal(_along(length, parts), q, r"|\q|\,\p = \q"),), unit


@_form_of(parametrisations.UnitQuaternion, 4)
def unit_quaternion(q: Vector) -> Parts:
    return q, (_equal([square(q)], [sp.S.One], r"\q\cdot\q = 1"),), unit


@_form_of(parametrisations.CayleyKlein, 4)
def cayley_klein(q: Vector) -> Parts:
    a, b, c, d = q

    def back(values: NamedValues, quaternion: Vector) -> Vector:
        w, x, y, z = unit(values, quaternion)
        return w, z, y, x

    is_unit = _equal([square(q)], [sp.S.One], r"|\alpha|^2 + |\beta|^2 = 1")
    return (a, d, c, b), (is_unit,), back


@_form_of(parametrisations.AxisAngle, 4)
def axis_angle(q: Vector) -> Parts:
    *axis, angle = q
    half = sp.sin(angle / 2)
    vector = _along(half, axis)

    def back(values: NamedValues, quaternion: Vector) -> Vector:
        w, x, y, z = short_way(values, quaternion)
        none, length = _length_of_vector(values, (x, y, z))
        first = values.let("axis_x", Where(none, sp.S.One, x / length))
        return first, y / length, z / length, 2 * sp.atan2(Where(none, sp.S.Zero, length), w)

    claims = (
        _equal(vector, vector, r"\p_v = \sin\tfrac{\varphi}{2}\,\mathbf{e}"),
        _equal([square(vector)], [half**2], r"|\p_v|^2 = \sin^2\tfrac{\varphi}{2}"),
    )
    return (sp.cos(angle / 2), *vector), claims, back


@_form_of(parametrisations.RotationVector, 3)
def rotation_vector(q: Vector) -> Parts:
    angle = sp.sqrt(square(q))
    half = sp.sin(angle / 2)
    vector = _along(half / angle, q)

    def back(values: NamedValues, quaternion: Vector) -> Vector:
        w, *parts = short_way(values, quaternion)
        none, length = _length_of_vector(values, tuple(parts))
        limit = 2 / Where(sp.Eq(w, 0), sp.S.One, w)
        factor = values.let("factor", Where(none, limit, 2 * sp.atan2(length, w) / length))
        return _along(factor, parts)

    claims = (
        _equal(_along(angle, vector), _along(half, q), r"n\,\p_v = \sin\tfrac{n}{2}\,\v"),
        _equal([square(vector)], [half**2], r"|\p_v|^2 = \sin^2\tfrac{n}{2}"),
    )
    return (sp.cos(angle / 2), *vector), claims, back


@_form_of(parametrisations.GibbsVector, 3)
def gibbs_vector(q: Vector) -> Parts:
    length = sp.sqrt(1 + square(q))
    parts = _along(1 / length, (sp.S.One, *q))

    def back(_: NamedValues, quaternion: Vector) -> Vector:
        w, *vector = quaternion
        return tuple(
            part / Where(sp.Eq(w, 0), Where(sp.Eq(part, 0), sp.S.One, w), w) for part in vector
        )

    return parts, (_equal(_along(parts[0], q), parts[1:], r"p_0\,\g = \p_v"),), back


@_form_of(parametrisations.ModifiedRodrigues, 3)
def modified_rodrigues(q: Vector) -> Parts:
    size = square(q)
    scalar, vector = (1 - size) / (1 + size), _along(2 / (1 + size), q)

    def back(values: NamedValues, quaternion: Vector) -> Vector:
        parts = short_way(values, quaternion)
        divisor = values.let("divisor", values.length("length", parts) + parts[0])
        return tuple(part / divisor for part in parts[1:])

    claims = (_equal(_along(1 + scalar, q), vector, r"(1 + p_0)\,\s = \p_v"),)
    return (scalar, *vector), claims, back


@_form_of(parametrisations.DirectionCosines, 9)
def direction_cosines(_: Vector) -> Parts:
    def back(values: NamedValues, quaternion: Vector) -> Vector:
        size = values.let("square", square(quaternion))
        return tuple(sp.expand(entry) / size for entry in rotation_of(quaternion))

    return (), (), back
