"""How coordinates follow from a rotation: the 24 Euler conventions and the parametrisations.

A model is recognised by its turns, or by its matrix and its constraints, not by its name: your own
R(q) that is a rotation vector converts as one. The sentences are in
templates/notes/en/conversions.toml.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
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
from rigidsym.models.parametrisations import parametrised
from rigidsym.models.rotation import AXES, RotationModel, hat, rotation_of

Claim = tuple[tuple[sp.Expr, ...], Formula]  # what vanishes, and how it is written
Back = Callable[[NamedValues, Vector], Vector]  # coordinates, from a scaled quaternion or from R
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
class InverseRule:
    """How the coordinates follow from a quaternion of any length but zero, or from R."""

    model: RotationModel
    rule: str  # "euler", or the name of a parametrisation: "quaternion", "rotation_vector", ...
    order: tuple[int, ...]  # place, among the model's coordinates, of each that the rule gives
    claims: tuple[Claim, ...]  # what the ring of the model has to decide
    of_quaternion: Back  # scaled, scalar first
    of_matrix: Back  # R, row by row
    quaternion: Vector = ()  # in closed form, scalar first, of length one
    quarters: int = 0  # of Euler angles: the quarter turns from the middle angle 0 to a pole

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
        if self.rule != "euler":
            return sentence(self.words["choice"])
        names = [named(q.func.__name__) for q in self.model.coordinates]
        first, middle, third = (names[place] for place in self.order)
        interval = "[−π/2, π/2]" if self.quarters else "[0, π]"
        typed = self.words["choice"].replace("INTERVAL", interval)
        return sentence(typed, *(first, third, middle, first, third, names[2]))

    @cached_property
    def proofs(self) -> tuple[Proof, ...]:
        return vanishing(self.model, self.claims)

    def from_quaternion(self, values: NamedValues, quaternion: Vector) -> Vector:
        """The coordinates of a quaternion that is scaled, scalar first."""
        return self._in_order(self.of_quaternion(values, quaternion))

    def from_matrix(self, values: NamedValues, matrix: sp.Matrix) -> Vector:
        """The coordinates of a rotation matrix R, (3, 3)."""
        return self._in_order(self.of_matrix(values, tuple(matrix)))

    def _in_order(self, values: Vector) -> Vector:
        """What the rule gives, in the order of the model's coordinates."""
        placed = dict(zip(self.order, values, strict=True))
        return tuple(placed[place] for place in range(len(values)))


def inverse_rule(model: RotationModel) -> InverseRule | None:
    """The rule of a model; None if its coordinates do not follow in closed form."""
    count = len(model.coordinates)
    orders = [tuple(range(count)), *([(3, 0, 1, 2)] if count == 4 else [])]  # w may stand last
    for rule, (size, form) in _FORMS.items():
        for order in orders if count == size else ():
            q = tuple(model.coordinates[place] for place in order)
            known = parametrised(rule, [part.func.__name__ for part in q])
            if known.matrix == model.matrix and known.constraints == model.constraints:
                return _in_coordinates(model, rule, order, form(q))
    return _euler_rule(model)


# Three turns about coordinate axes. With e₁, e₂ the first two axes and C the fixed turn about e₂
# that takes e₁ to the third axis (none for ZXZ, a quarter turn for ZYX), R C = R₁(α) R₂(β') R₁(γ):
# two turns about one axis with a turn across between them. In the frame e₁, e₂, e₁ × e₂ its
# quaternion is cos(β'/2) (cos σ, sin σ) and sin(β'/2) (cos δ, sin δ), with σ = (α + γ)/2 and
# δ = (α − γ)/2. So nothing cancels where β' is near 0 or π, which are the poles.


def _euler_rule(model: RotationModel) -> InverseRule | None:
    """The rule of three turns by the coordinates about axes, neighbours about different ones."""
    angles = [turn.angle for turn in model.turns]
    letters = [turn.axis for turn in model.turns]
    if len(angles) != 3 or len(set(angles)) != 3 or set(angles) != set(model.coordinates):
        return None
    if not set(letters) <= set(AXES) or letters[1] in (letters[0], letters[2]):
        return None
    order = tuple(map(model.coordinates.index, angles))
    first, second, third = (sp.Matrix(turn.direction) for turn in model.turns)
    quarters = -int(first.cross(third).dot(second))
    sign = -1 if quarters > 0 else 1  # of the middle angle and of e₂, so that β' is in [0, π]
    second *= sign
    frame = sp.Matrix.hstack(first, second, first.cross(second))
    along, across = 1, abs(quarters)  # parallel to (cos λ/2, sin λ/2) for the angle λ of C

    def in_frame(quaternion: Sequence[sp.Expr]) -> sp.Matrix:
        """The components of p (1 + C) in the frame, (4, 1)."""
        whole = product(tuple(quaternion), (sp.Integer(along), *(across * second)))
        return sp.diag(1, frame.T) * sp.Matrix(whole)

    def angles_of(values: NamedValues, parts: Vector) -> Vector:
        """The angles from the quaternion in the frame."""
        far, near = values.length("far", parts[:2]), values.length("near", parts[2:])
        total = values.let("half_sum", sp.atan2(parts[1], parts[0]))
        difference = values.let("half_difference", sp.atan2(parts[3], parts[2]))
        # Where a half of the quaternion vanishes, its angle is taken to be the other's, or minus
        # it, so that the last coordinate is zero, whether it is the first turn's or the third's.
        is_low, is_high = near <= values.tiny * far, far <= values.tiny * near
        other = -1 if order[0] == 2 else 1
        chosen = values.let("half_difference", Where(is_low, other * total, difference))
        total = values.let("half_sum", Where(is_high, other * difference, total))
        first_angle = values.wrapped("first", total + chosen)
        last_angle = values.wrapped("last", total - chosen)
        offset = sp.Float(float(sp.pi / 2)) if quarters else sp.S.Zero
        return first_angle, sign * (2 * sp.atan2(near, far) - offset), last_angle

    def of_quaternion(values: NamedValues, quaternion: Vector) -> Vector:
        parts = map(sp.expand, in_frame(quaternion))
        return angles_of(values, values.each(("a0", "a1", "a2", "a3"), parts))

    def of_matrix(values: NamedValues, matrix: Vector) -> Vector:
        """From the matrix of R C in the frame."""
        skew = hat(second)
        fixed = sp.eye(3) + skew + skew**2 if quarters else sp.eye(3)
        turned = (frame.T * sp.Matrix(3, 3, matrix) * fixed * frame).applyfunc(sp.expand)
        return angles_of(values, shepperd(values, turned))

    alpha, beta, gamma = angles
    half, sigma, delta = sign * beta / 2, (alpha + gamma) / 2, (alpha - gamma) / 2
    cosine = along * sp.cos(half) - across * sp.sin(half)
    sine = along * sp.sin(half) + across * sp.cos(half)
    expected = (
        (cosine * sp.cos(sigma), r"\cos#\,\cos\sigma"),
        (cosine * sp.sin(sigma), r"\cos#\,\sin\sigma"),
        (sine * sp.cos(delta), r"\sin#\,\cos\delta"),
        (sine * sp.sin(delta), r"\sin#\,\sin\delta"),
    )
    components = in_frame(reduce(product, (half_turn(t.direction, t.angle) for t in model.turns)))
    claims = (
        claim(rf"a_{k} = \kappa\," + text.replace("#", r"\frac{\beta'}{2}"), here - there)
        for k, (here, (there, text)) in enumerate(zip(components, expected, strict=True))
    )
    return InverseRule(
        model=model,
        rule="euler",
        order=order,
        claims=tuple(claims),
        of_quaternion=of_quaternion,
        of_matrix=of_matrix,
        quarters=quarters,
    )


# Parametrisations whose quaternion has a closed form. Nothing cancels on the way back.


def _in_coordinates(
    model: RotationModel, rule: str, order: tuple[int, ...], form: Form
) -> InverseRule:
    quaternion, claims, back = form

    def of_matrix(values: NamedValues, matrix: Vector) -> Vector:
        if rule == "direction_cosines":
            return matrix
        parts = shepperd(values, sp.Matrix(3, 3, matrix))
        return back(values, short_way(values, parts) if rule in BOTH_SIGNS else parts)

    return InverseRule(
        model=model,
        rule=rule,
        order=order,
        claims=claims,
        of_quaternion=back,
        of_matrix=of_matrix,
        quaternion=quaternion,
    )


Form = tuple[Vector, tuple[Claim, ...], Back]  # the unit quaternion, what is claimed, and back


def _along(factor: sp.Expr, vector: Sequence[sp.Expr]) -> Vector:
    return tuple(factor * part for part in vector)


def _equal(first: Sequence[sp.Expr], second: Sequence[sp.Expr], text: str) -> Claim:
    return claim(text, *(a - b for a, b in zip(first, second, strict=True)))


def _length_of_vector(values: NamedValues, vector: Vector) -> tuple[sp.Basic, sp.Expr]:
    """Whether a vector vanishes, and its length, or one: a root of zero has no derivative."""
    size = values.let("square", square(vector))
    none = sp.Eq(size, 0)
    return none, values.let("length", sp.sqrt(Where(none, sp.S.One, size)))


def _quaternion(q: Vector) -> Form:
    length = sp.sqrt(square(q))
    parts = _along(1 / length, q)
    return parts, (_equal(_along(length, parts), q, r"|\q|\,\p = \q"),), unit


def _unit_quaternion(q: Vector) -> Form:
    return q, (_equal([square(q)], [sp.S.One], r"\q\cdot\q = 1"),), unit


def _axis_angle(q: Vector) -> Form:
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


def _rotation_vector(q: Vector) -> Form:
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


def _gibbs_vector(q: Vector) -> Form:
    length = sp.sqrt(1 + square(q))
    parts = _along(1 / length, (sp.S.One, *q))

    def back(_: NamedValues, quaternion: Vector) -> Vector:
        w, *vector = quaternion
        return tuple(
            part / Where(sp.Eq(w, 0), Where(sp.Eq(part, 0), sp.S.One, w), w) for part in vector
        )

    return parts, (_equal(_along(parts[0], q), parts[1:], r"p_0\,\g = \p_v"),), back


def _modified_rodrigues(q: Vector) -> Form:
    size = square(q)
    scalar, vector = (1 - size) / (1 + size), _along(2 / (1 + size), q)

    def back(values: NamedValues, quaternion: Vector) -> Vector:
        parts = short_way(values, quaternion)
        divisor = values.let("divisor", values.length("length", parts) + parts[0])
        return tuple(part / divisor for part in parts[1:])

    claims = (_equal(_along(1 + scalar, q), vector, r"(1 + p_0)\,\s = \p_v"),)
    return (scalar, *vector), claims, back


def _direction_cosines(_: Vector) -> Form:
    def back(values: NamedValues, quaternion: Vector) -> Vector:
        size = values.let("square", square(quaternion))
        return tuple(sp.expand(entry) / size for entry in rotation_of(quaternion))

    return (), (), back


BOTH_SIGNS = ("quaternion", "unit_quaternion")  # rules in which p and −p differ
_FORMS: dict[str, tuple[int, Callable[[Vector], Form]]] = {
    "quaternion": (4, _quaternion),
    "unit_quaternion": (4, _unit_quaternion),
    "axis_angle": (4, _axis_angle),
    "rotation_vector": (3, _rotation_vector),
    "gibbs_vector": (3, _gibbs_vector),
    "modified_rodrigues": (3, _modified_rodrigues),
    "direction_cosines": (9, _direction_cosines),
}  # by rule: the number of coordinates, and the form
