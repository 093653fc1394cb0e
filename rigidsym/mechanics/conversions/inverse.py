"""How coordinates follow from a rotation: the 24 Euler conventions and the parametrisations.

A model is recognised by its turns, or by its matrix and its constraints, not by its name: your own
R(q) that is a rotation vector converts as one.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial, reduce

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
from rigidsym.mechanics.derivation import Proof
from rigidsym.mechanics.prove import Prover
from rigidsym.models import parametrisations
from rigidsym.models.rotation import AXES, RotationModel, hat, rotation_of

Claim = tuple[tuple[sp.Expr, ...], Formula]  # what vanishes, and how it is written


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

    @cached_property
    def proofs(self) -> tuple[Proof, ...]:
        return vanishing(self.model, self.claims())

    @abstractmethod
    def from_quaternion(self, values: NamedValues, quaternion: Vector) -> Vector:
        """The coordinates of a quaternion that is scaled, scalar first."""

    @abstractmethod
    def from_matrix(self, values: NamedValues, matrix: sp.Matrix) -> Vector:
        """The coordinates of a rotation matrix R, (3, 3)."""


def inverse_rule(model: RotationModel) -> InverseRule | None:
    """The rule of a model; None if its coordinates do not follow in closed form."""
    return closed_form(model) or _euler_rule(model)


# Three turns about coordinate axes. With e₁, e₂ the first two axes and C the fixed turn about e₂
# that takes e₁ to the third axis (none for ZXZ, a quarter turn for ZYX), R C = R₁(α) R₂(β') R₁(γ):
# two turns about one axis with a turn across between them. In the frame e₁, e₂, e₁ × e₂ its
# quaternion is cos(β'/2) (cos σ, sin σ) and sin(β'/2) (cos δ, sin δ), with σ = (α + γ)/2 and
# δ = (α − γ)/2. So nothing cancels where β' is near 0 or π, which are the poles.

_HALF = r"\frac{\beta'}{2}"
_COMPONENTS = (
    rf"\cos{_HALF}\,\cos\sigma",
    rf"\cos{_HALF}\,\sin\sigma",
    rf"\sin{_HALF}\,\cos\delta",
    rf"\sin{_HALF}\,\sin\delta",
)
_OF_TURNS = sentence(
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
class EulerRule(InverseRule):
    """Three turns by the coordinates about coordinate axes, neighbours about different ones."""

    frame: sp.ImmutableMatrix  # columns e₁, ±e₂, e₁ × ±e₂; (3, 3)
    quarters: int  # ±1 if C is a quarter turn about ∓e₂, 0 if there is none
    places: tuple[int, int, int]  # of α, β, γ among the coordinates

    @property
    def _sign(self) -> int:
        """Of the middle angle: −1 where the frame holds −e₂, so that β' is in [0, π]."""
        return -1 if self.quarters > 0 else 1

    @property
    def _lean(self) -> tuple[int, int]:
        """Parallel to (cos λ/2, sin λ/2) for the angle λ of C."""
        return 1, abs(self.quarters)

    @property
    def because(self) -> Sentence:
        return _OF_TURNS

    @property
    def branch(self) -> Sentence:
        names = [named(q.func.__name__) for q in self.model.coordinates]
        first, middle, third = (names[place] for place in self.places)
        interval = "[−π/2, π/2]" if self.quarters else "[0, π]"
        return sentence(
            f"{{}} and {{}} are in (−π, π], {{}} is in {interval}. At a pole, "
            "the ends of that interval, only the sum or the difference of {} and {} is determined: "
            "there {} is 0. Orientations within 8 eps (radians) of a pole count as poles.",
            *(first, third, middle, first, third, names[2]),
        )

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
            cosine * sp.cos(total),
            cosine * sp.sin(total),
            sine * sp.cos(difference),
            sine * sp.sin(difference),
        )
        components = self._in_frame(reduce(product, turns))
        return [
            claim(rf"a_{place} = \kappa\,{text}", here - there)
            for place, (here, there, text) in enumerate(
                zip(components, expected, _COMPONENTS, strict=True)
            )
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
        sign = -1 if self.places[0] == 2 else 1
        chosen = values.let("half_difference", Where(is_low, sign * total, difference))
        total = values.let("half_sum", Where(is_high, sign * difference, total))
        first = values.wrapped("first", total + chosen)
        last = values.wrapped("last", total - chosen)
        offset = sp.Float(float(sp.pi / 2)) if self.quarters else sp.S.Zero
        middle = self._sign * (2 * sp.atan2(near, far) - offset)
        return in_order((first, middle, last), self.places)


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
    a, b, c = (model.coordinates.index(angle) for angle in angles)
    return EulerRule(
        model=model,
        frame=sp.ImmutableMatrix(sp.Matrix.hstack(first, second, first.cross(second))),
        quarters=quarters,
        places=(a, b, c),
    )


def in_order(values: Sequence[sp.Expr], order: Sequence[int]) -> Vector:
    """What a rule gives, in the order of the model's coordinates."""
    placed = dict(zip(order, values, strict=True))
    return tuple(placed[place] for place in range(len(values)))


# Parametrisations whose quaternion has a closed form. Nothing cancels on the way back.


@dataclass(frozen=True, kw_only=True)
class ClosedForm(InverseRule):
    """One parametrisation in given coordinates."""

    rule: str  # its name: "quaternion", "rotation_vector", ...
    quaternion: Vector  # scalar first, of length one; empty where it is read off from R
    forward: str  # how the quaternion follows, with formulas between dollar signs
    back: Callable[[NamedValues, Vector], Vector]  # the coordinates of a scaled quaternion
    backward: str  # how they follow
    choice: str  # which of the possible coordinates are given
    residuals: tuple[Claim, ...] = ()
    has_both_signs: bool = False  # whether p and −p differ
    continuity: str = ""  # a sentence; empty where the coordinates are unique
    order: tuple[int, ...]  # place, among the model's coordinates, of each that `back` gives

    @property
    def is_scalar_last(self) -> bool:
        return self.rule == "quaternion" and self.order[0] == 3

    @property
    def because(self) -> Sentence:
        return sentence(self.backward)

    @property
    def branch(self) -> Sentence:
        return sentence(self.choice)

    def claims(self) -> Sequence[Claim]:
        return self.residuals

    def from_quaternion(self, values: NamedValues, quaternion: Vector) -> Vector:
        return in_order(self.back(values, quaternion), self.order)

    def from_matrix(self, values: NamedValues, matrix: sp.Matrix) -> Vector:
        if self.rule == "direction_cosines":
            return in_order(tuple(matrix), self.order)
        quaternion = shepperd(values, matrix)
        if self.has_both_signs:
            quaternion = short_way(values, quaternion)
        return self.from_quaternion(values, quaternion)


Make = Callable[..., ClosedForm]  # for one model, whose coordinates are in one order


def closed_form(model: RotationModel) -> ClosedForm | None:
    """The form of a model that is one of the parametrisations; None where it is none."""
    for build, count, form in _FORMS:
        for order in _orders(len(model.coordinates)):
            q = tuple(model.coordinates[place] for place in order)
            if len(q) != count:
                continue
            known = build([part.func.__name__ for part in q])
            if known.matrix == model.matrix and known.constraints == model.constraints:
                return form(partial(ClosedForm, model=model, order=order), q)
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


_KEPT = "The sign of the quaternion is kept; from a matrix, the scalar is at least 0."
_SHORT = "The quaternion and its negative give the same coordinates, those of a turn by at most π."
_NEARER = "to the sample before: exact, since only signs change."
_OF_TWO_SIGNS = f"Of p and −p the one nearer {_NEARER}"


def _quaternion(make: Make, q: Vector) -> ClosedForm:
    length = sp.sqrt(square(q))
    parts = _along(1 / length, q)
    return make(
        rule="quaternion",
        quaternion=parts,
        forward="The quaternion is divided by its length.",
        back=unit,
        backward="The unit quaternion is one of its multiples.",
        choice=f"The length is 1. {_KEPT}",
        residuals=(_equal(_along(length, parts), q, r"|\mathbf{q}|\,\mathbf{p} = \mathbf{q}"),),
        has_both_signs=True,
        continuity=_OF_TWO_SIGNS,
    )


def _unit(make: Make, q: Vector) -> ClosedForm:
    because = "The coordinates are the unit quaternion."
    return replace(
        _quaternion(make, q),
        quaternion=q,
        forward=because,
        backward=because,
        residuals=(_equal([square(q)], [sp.S.One], r"\mathbf{q}\cdot\mathbf{q} = 1"),),
    )


def _cayley_klein(make: Make, q: Vector) -> ClosedForm:
    a, b, c, d = q
    because = (
        r"$\alpha = w + i z$ and $\beta = y + i x$ are the entries of the matrix of the "
        "quaternion."
    )

    def back(values: NamedValues, quaternion: Vector) -> Vector:
        w, x, y, z = unit(values, quaternion)
        return w, z, y, x

    return make(
        rule="cayley_klein",
        quaternion=(a, d, c, b),
        forward=because,
        back=back,
        backward=because,
        choice=rf"$|\alpha|^2 + |\beta|^2 = 1$. {_KEPT}",
        residuals=(_equal([square(q)], [sp.S.One], r"|\alpha|^2 + |\beta|^2 = 1"),),
        has_both_signs=True,
        continuity=f"Of the parameters and their negatives those nearer {_NEARER}",
    )


def _axis_angle(make: Make, q: Vector) -> ClosedForm:
    *axis, angle = q
    half = sp.sin(angle / 2)
    vector = _along(half, axis)

    def back(values: NamedValues, quaternion: Vector) -> Vector:
        w, x, y, z = short_way(values, quaternion)
        none, length = _length_of_vector(values, (x, y, z))
        first = values.let("axis_x", Where(none, sp.S.One, x / length))
        return first, y / length, z / length, 2 * sp.atan2(Where(none, sp.S.Zero, length), w)

    return make(
        rule="axis_angle",
        quaternion=(sp.cos(angle / 2), *vector),
        forward=r"A turn by $\varphi$ about $\mathbf{e}$ is the quaternion "
        r"$\cos\frac{\varphi}{2} + \mathbf{e}\sin\frac{\varphi}{2}$.",
        back=back,
        backward="The vector part points along the axis, and its length is "
        r"$\sin\frac{\varphi}{2}$.",
        choice="The angle is in [0, π]; without a turn, the axis is $x$.",
        residuals=(
            _equal(vector, vector, r"\mathbf{p}_v = \sin\tfrac{\varphi}{2}\,\mathbf{e}"),
            _equal([square(vector)], [half**2], r"|\mathbf{p}_v|^2 = \sin^2\tfrac{\varphi}{2}"),
        ),
        continuity="The axis turns by at most π/2 from one sample to the next, and the angle "
        "changes by at most π. Where there is no turn, the axis is that of the sample before.",
    )


def _rotation_vector(make: Make, q: Vector) -> ClosedForm:
    angle = sp.sqrt(square(q))
    half = sp.sin(angle / 2)
    vector = _along(half / angle, q)

    def back(values: NamedValues, quaternion: Vector) -> Vector:
        w, *found = short_way(values, quaternion)
        none, length = _length_of_vector(values, tuple(found))
        limit = 2 / Where(sp.Eq(w, 0), sp.S.One, w)
        factor = values.let("factor", Where(none, limit, 2 * sp.atan2(length, w) / length))
        return _along(factor, found)

    return make(
        rule="rotation_vector",
        quaternion=(sp.cos(angle / 2), *vector),
        forward=r"With $n = |\mathbf{v}|$, a turn by $n$ about $\mathbf{v}/n$ is the quaternion "
        r"$\cos\frac{n}{2} + \frac{\mathbf{v}}{n}\sin\frac{n}{2}$.",
        back=back,
        backward=r"The vector part points along $\mathbf{v}$, and its length is "
        r"$\sin\frac{n}{2}$.",
        choice=f"The length is in [0, π]. {_SHORT}",
        residuals=(
            _equal(
                _along(angle, vector),
                _along(half, q),
                r"n\,\mathbf{p}_v = \sin\tfrac{n}{2}\,\mathbf{v}",
            ),
            _equal([square(vector)], [half**2], r"|\mathbf{p}_v|^2 = \sin^2\tfrac{n}{2}"),
        ),
        continuity="The axis turns by at most π/2 from one sample to the next, and the length "
        "goes on beyond π, also through whole turns.",
    )


def _gibbs(make: Make, q: Vector) -> ClosedForm:
    length = sp.sqrt(1 + square(q))
    parts = _along(1 / length, (sp.S.One, *q))

    def back(values: NamedValues, quaternion: Vector) -> Vector:  # noqa: ARG001  (as the others)
        w, *vector = quaternion
        return tuple(
            part / Where(sp.Eq(w, 0), Where(sp.Eq(part, 0), sp.S.One, w), w) for part in vector
        )

    return make(
        rule="gibbs_vector",
        quaternion=parts,
        forward=r"The quaternion $1 + \mathbf{g}$ is divided by its length.",
        back=back,
        backward="The vector part is divided by the scalar.",
        choice="Every rotation has one vector. A half turn gives inf, and 0 where its axis has 0.",
        residuals=(_equal(_along(parts[0], q), parts[1:], r"p_0\,\mathbf{g} = \mathbf{p}_v"),),
    )


def _modified(make: Make, q: Vector) -> ClosedForm:
    size = square(q)
    scalar, vector = (1 - size) / (1 + size), _along(2 / (1 + size), q)

    def back(values: NamedValues, quaternion: Vector) -> Vector:
        parts = short_way(values, quaternion)
        divisor = values.let("divisor", values.length("length", parts) + parts[0])
        return tuple(part / divisor for part in parts[1:])

    return make(
        rule="modified_rodrigues",
        quaternion=(scalar, *vector),
        forward=r"$\cos\frac{n}{2}$ and $\sin\frac{n}{2}$ are rational functions of "
        r"$\mathbf{s} = \tan\frac{n}{4}\,\mathbf{e}$.",
        back=back,
        backward="The vector part is divided by one plus the scalar.",
        choice=r"Of the two sets, the one with $\mathbf{s}\cdot\mathbf{s} \le 1$, a turn by at "
        "most π.",
        residuals=(_equal(_along(1 + scalar, q), vector, r"(1 + p_0)\,\mathbf{s} = \mathbf{p}_v"),),
        continuity="Of the two sets the one whose quaternion is nearer to that of the sample "
        "before; at a whole turn it is infinite.",
    )


def _cosines(make: Make, q: Vector) -> ClosedForm:  # noqa: ARG001  (as the others)
    def back(values: NamedValues, quaternion: Vector) -> Vector:
        size = values.let("square", square(quaternion))
        return tuple(sp.expand(entry) / size for entry in rotation_of(quaternion))

    return make(
        rule="direction_cosines",
        quaternion=(),
        forward=r"The quaternion is read off from $\mathbf{R}$.",
        back=back,
        backward=r"The coordinates are the entries of $\mathbf{R}$.",
        choice="Every rotation has one matrix.",
    )


_FORMS: tuple[
    tuple[Callable[..., RotationModel], int, Callable[[Make, Vector], ClosedForm]], ...
] = (
    (parametrisations.Quaternion, 4, _quaternion),
    (parametrisations.UnitQuaternion, 4, _unit),
    (parametrisations.CayleyKlein, 4, _cayley_klein),
    (parametrisations.AxisAngle, 4, _axis_angle),
    (parametrisations.RotationVector, 3, _rotation_vector),
    (parametrisations.GibbsVector, 3, _gibbs),
    (parametrisations.ModifiedRodrigues, 3, _modified),
    (parametrisations.DirectionCosines, 9, _cosines),
)
