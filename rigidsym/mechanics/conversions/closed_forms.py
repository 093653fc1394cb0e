"""Parametrisations whose quaternion has a closed form, and how they follow from one.

A model is known by its matrix and its constraints, not by its name: your own R(q) that is a
rotation vector converts as one. Nothing cancels on the way back.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial

import sympy as sp

from rigidsym.formula.reader import Sentence, sentence
from rigidsym.mechanics.conversions.function import NamedValues, Vector, Where, square
from rigidsym.mechanics.conversions.inverse import Claim, InverseRule, claim, in_order
from rigidsym.mechanics.conversions.unit_quaternions import shepperd, short_way, unit
from rigidsym.models import parametrisations
from rigidsym.models.rotation import RotationModel, rotation_of


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
