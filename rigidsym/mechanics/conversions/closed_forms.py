"""Parametrisations whose quaternion has a closed form, and how they follow from one.

A model is known by its matrix and its constraints, not by its name: your own R(q) that is a
rotation vector converts as one.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import sympy as sp

from rigidsym.formula.reader import formula
from rigidsym.formula.sentence import Sentence, sentence
from rigidsym.formula.tree import Formula
from rigidsym.models.parametrisations import (
    AxisAngle,
    CayleyKlein,
    DirectionCosines,
    GibbsVector,
    ModifiedRodrigues,
    Quaternion,
    RotationVector,
    UnitQuaternion,
)
from rigidsym.models.rotation import RotationModel

Claim = tuple[tuple[sp.Expr, ...], Formula]  # what vanishes, and how it is written
Parts = tuple[sp.Expr, ...]


@dataclass(frozen=True, kw_only=True, slots=True)
class ClosedForm:
    """One parametrisation in given coordinates."""

    rule: str  # how the coordinates follow, by name: "quaternion", "rotation_vector", ...
    quaternion: Parts  # scalar first, of length one; empty where it is read off from R
    order: tuple[int, ...]  # place, among the model's coordinates, of each that the rule gives
    because: Sentence  # how the quaternion follows from the coordinates
    back_because: Sentence
    branch: Sentence  # which of the possible coordinates are given
    claims: tuple[Claim, ...]

    @property
    def is_scalar_last(self) -> bool:
        """Whether the coordinates are a quaternion (x, y, z, w)."""
        return self.rule == "quaternion" and self.order[0] == 3


def closed_form(model: RotationModel) -> ClosedForm | None:
    """The form of a model that is one of the parametrisations; None where it is none."""
    for build, form in _FORMS:
        for order in _orders(len(model.coordinates)):
            names = [model.coordinates[place].func.__name__ for place in order]
            if _matches(model, build, names):
                return form([model.coordinates[place] for place in order], order)
    return None


def _orders(count: int) -> Iterator[tuple[int, ...]]:
    """The coordinates as they stand, and with the last of four first."""
    yield tuple(range(count))
    if count == 4:
        yield (3, 0, 1, 2)


def _matches(
    model: RotationModel, build: Callable[..., RotationModel], names: Sequence[str]
) -> bool:
    if len(names) != _COUNTS[build]:
        return False
    candidate = build(names)
    return candidate.matrix == model.matrix and candidate.constraints == model.constraints


def _square(vector: Sequence[sp.Expr]) -> sp.Expr:
    return sp.Add(*(part**2 for part in vector))


def _along(factor: sp.Expr, vector: Sequence[sp.Expr]) -> Parts:
    return tuple(factor * part for part in vector)


def _differences(first: Sequence[sp.Expr], second: Sequence[sp.Expr]) -> Parts:
    return tuple(a - b for a, b in zip(first, second, strict=True))


_KEPT = "The sign of the quaternion is kept; from a matrix, the scalar is at least 0."
_ENTRIES = sentence(
    r"$\alpha = w + i z$ and $\beta = y + i x$ are the entries of the matrix of the quaternion."
)
_SHORT = "The quaternion and its negative give the same coordinates, those of a turn by at most π."


def _quaternion(q: Sequence[sp.Expr], order: tuple[int, ...]) -> ClosedForm:
    length = sp.sqrt(_square(q))
    parts = _along(1 / length, q)
    return ClosedForm(
        rule="quaternion",
        quaternion=parts,
        order=order,
        because=("The quaternion is divided by its length.",),
        back_because=("The unit quaternion is one of its multiples.",),
        branch=(f"The length is 1. {_KEPT}",),
        claims=(
            (
                _differences(_along(length, parts), q),
                formula(r"|\mathbf{q}|\,\mathbf{p} = \mathbf{q}"),
            ),
        ),
    )


def _unit(q: Sequence[sp.Expr], order: tuple[int, ...]) -> ClosedForm:
    return ClosedForm(
        rule="quaternion",
        quaternion=tuple(q),
        order=order,
        because=("The coordinates are the unit quaternion.",),
        back_because=("The coordinates are the unit quaternion.",),
        branch=(f"The length is 1. {_KEPT}",),
        claims=(((_square(q) - 1,), formula(r"\mathbf{q}\cdot\mathbf{q} = 1")),),
    )


def _cayley_klein(q: Sequence[sp.Expr], order: tuple[int, ...]) -> ClosedForm:
    a, b, c, d = q
    return ClosedForm(
        rule="cayley_klein",
        quaternion=(a, d, c, b),
        order=order,
        because=_ENTRIES,
        back_because=_ENTRIES,
        branch=sentence(r"$|\alpha|^2 + |\beta|^2 = 1$. " + _KEPT),
        claims=(((_square(q) - 1,), formula(r"|\alpha|^2 + |\beta|^2 = 1")),),
    )


def _axis_angle(q: Sequence[sp.Expr], order: tuple[int, ...]) -> ClosedForm:
    *axis, angle = q
    half = sp.sin(angle / 2)
    parts = (sp.cos(angle / 2), *_along(half, axis))
    return ClosedForm(
        rule="axis_angle",
        quaternion=parts,
        order=order,
        because=sentence(
            r"A turn by $\varphi$ about $\mathbf{e}$ is the quaternion "
            r"$\cos\frac{\varphi}{2} + \mathbf{e}\sin\frac{\varphi}{2}$."
        ),
        back_because=sentence(
            r"The vector part points along the axis, and its length is $\sin\frac{\varphi}{2}$."
        ),
        branch=sentence("The angle is in [0, π]; without a turn, the axis is $x$."),
        claims=(
            (
                _differences(parts[1:], _along(half, axis)),
                formula(r"\mathbf{p}_v = \sin\tfrac{\varphi}{2}\,\mathbf{e}"),
            ),
            (
                (_square(parts[1:]) - half**2,),
                formula(r"|\mathbf{p}_v|^2 = \sin^2\tfrac{\varphi}{2}"),
            ),
        ),
    )


def _rotation_vector(q: Sequence[sp.Expr], order: tuple[int, ...]) -> ClosedForm:
    angle = sp.sqrt(_square(q))
    half = sp.sin(angle / 2)
    parts = (sp.cos(angle / 2), *_along(half / angle, q))
    return ClosedForm(
        rule="rotation_vector",
        quaternion=parts,
        order=order,
        because=sentence(
            r"With $n = |\mathbf{v}|$, a turn by $n$ about $\mathbf{v}/n$ is the quaternion "
            r"$\cos\frac{n}{2} + \frac{\mathbf{v}}{n}\sin\frac{n}{2}$."
        ),
        back_because=sentence(
            r"The vector part points along $\mathbf{v}$, and its length is $\sin\frac{n}{2}$."
        ),
        branch=(f"The length is in [0, π]. {_SHORT}",),
        claims=(
            (
                _differences(_along(angle, parts[1:]), _along(half, q)),
                formula(r"n\,\mathbf{p}_v = \sin\tfrac{n}{2}\,\mathbf{v}"),
            ),
            (
                (_square(parts[1:]) - half**2,),
                formula(r"|\mathbf{p}_v|^2 = \sin^2\tfrac{n}{2}"),
            ),
        ),
    )


def _gibbs(q: Sequence[sp.Expr], order: tuple[int, ...]) -> ClosedForm:
    length = sp.sqrt(1 + _square(q))
    parts = (1 / length, *_along(1 / length, q))
    return ClosedForm(
        rule="gibbs_vector",
        quaternion=parts,
        order=order,
        because=sentence(r"The quaternion $1 + \mathbf{g}$ is divided by its length."),
        back_because=("The vector part is divided by the scalar.",),
        branch=(
            "Every rotation has one vector. A half turn gives inf, and 0 where its axis has 0.",
        ),
        claims=(
            (
                _differences(_along(parts[0], q), parts[1:]),
                formula(r"p_w\,\mathbf{g} = \mathbf{p}_v"),
            ),
        ),
    )


def _modified(q: Sequence[sp.Expr], order: tuple[int, ...]) -> ClosedForm:
    square = _square(q)
    parts = ((1 - square) / (1 + square), *_along(2 / (1 + square), q))
    return ClosedForm(
        rule="modified_rodrigues",
        quaternion=parts,
        order=order,
        because=sentence(
            r"$\cos\frac{n}{2}$ and $\sin\frac{n}{2}$ are rational functions of "
            r"$\mathbf{s} = \tan\frac{n}{4}\,\mathbf{e}$."
        ),
        back_because=("The vector part is divided by one plus the scalar.",),
        branch=sentence(
            r"Of the two sets, the one with $\mathbf{s}\cdot\mathbf{s} \le 1$, a turn by at most π."
        ),
        claims=(
            (
                _differences(_along(1 + parts[0], q), parts[1:]),
                formula(r"(1 + p_w)\,\mathbf{s} = \mathbf{p}_v"),
            ),
        ),
    )


# Every closed form is made from the coordinates; this one needs none of them.
def _cosines(q: Sequence[sp.Expr], order: tuple[int, ...]) -> ClosedForm:  # noqa: ARG001
    return ClosedForm(
        rule="direction_cosines",
        quaternion=(),
        order=order,
        because=sentence(r"The quaternion is read off from $\mathbf{R}$."),
        back_because=sentence(r"The coordinates are the entries of $\mathbf{R}$."),
        branch=("Every rotation has one matrix.",),
        claims=(),
    )


_FORMS = (
    (Quaternion, _quaternion),
    (UnitQuaternion, _unit),
    (CayleyKlein, _cayley_klein),
    (AxisAngle, _axis_angle),
    (RotationVector, _rotation_vector),
    (GibbsVector, _gibbs),
    (ModifiedRodrigues, _modified),
    (DirectionCosines, _cosines),
)
_COUNTS = {
    Quaternion: 4,
    UnitQuaternion: 4,
    CayleyKlein: 4,
    AxisAngle: 4,
    RotationVector: 3,
    GibbsVector: 3,
    ModifiedRodrigues: 3,
    DirectionCosines: 9,
}
