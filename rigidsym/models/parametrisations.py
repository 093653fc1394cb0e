"""Rotations by quaternions, by axis and angle, by vectors along the axis, and by nine cosines.

With n the angle of a turn about the unit axis e, a quaternion w + v with v = (x, y, z) is
cos(n/2) + sin(n/2) e, scalar first unless `scalar_last` is set. Three parameters are the
components of one vector: n e (rotation vector), tan(n/2) e (Gibbs) or tan(n/4) e (modified
Rodrigues parameters).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import sympy as sp

from rigidsym.models.rotation import (
    SOURCES,
    Citation,
    Pullback,
    RotationModel,
    hat,
    rodrigues,
    rotation_of,
    time_functions,
)
from rigidsym.text.names import lettered

SHUSTER = Citation(
    text="M. Shuster, A Survey of Attitude Representations, Journal of the Astronautical "
    "Sciences 41 (1993)"
)
_SCHAUB = Citation(
    text="H. Schaub, J. Junkins, Stereographic Orientation Parameters for Attitude Dynamics, "
    "Journal of the Astronautical Sciences 44 (1996)"
)
_GOLDSTEIN = Citation(text="H. Goldstein, Classical Mechanics (1950)", section="section 4-5")
_SCALAR = {False: "scalar first", True: "scalar last"}
_QUATERNION = "unit_quaternion({0}, {1}, {2}, {3})"
_SQUARE = "{0}**2 + {1}**2 + {2}**2"
_COSINES = ("r11", "r12", "r13", "r21", "r22", "r23", "r31", "r32", "r33")


def Quaternion(
    names: Sequence[str] = ("w", "x", "y", "z"),
    *,
    scalar_last: bool = False,
    passive: bool = False,
) -> RotationModel:
    """Any quaternion but zero; its length does not matter, R = (...)/(w² + v·v).

    `names` are (w, x, y, z) in this order; `scalar_last` makes the coordinates (x, y, z, w).
    Raises ModelError for bad names.
    """
    model = UnitQuaternion(names, scalar_last=scalar_last, passive=passive)
    (condition,) = model.constraints
    return replace(
        model,
        name=model.name.removeprefix("unit_"),
        title=model.title.removeprefix("Unit ").capitalize(),
        convention=(
            f"The quaternion is {_in_parts(_coordinates(names, 4))}, {_SCALAR[scalar_last]}, of "
            "any length but zero; every multiple of it is the same rotation.",
        ),
        matrix=model.matrix / (condition + 1),
        definition=model.definition.removeprefix("unit_"),
        constraints=(),
    )


def UnitQuaternion(
    names: Sequence[str] = ("w", "x", "y", "z"),
    *,
    scalar_last: bool = False,
    passive: bool = False,
) -> RotationModel:
    """A unit quaternion, w² + v·v = 1: w = cos(n/2), v = sin(n/2) e.

    `names` are (w, x, y, z) in this order; `scalar_last` makes the coordinates (x, y, z, w).
    Raises ModelError for bad names.
    """
    w, *vector = _coordinates(names, 4)
    return _model(
        "unit_quaternion" + ("_xyzw" if scalar_last else ""),
        f"Unit quaternion, {_SCALAR[scalar_last]}",
        f"The quaternion is {_in_parts((w, *vector))}, {_SCALAR[scalar_last]}, of length one: the "
        "cosine of half the angle and the axis times the sine of half the angle.",
        (*vector, w) if scalar_last else (w, *vector),
        rotation_of((w, *vector)),
        SHUSTER,
        passive=passive,
        constraints=(w**2 + _square(vector) - 1,),
        definition="unit_quaternion({3}, {0}, {1}, {2})" if scalar_last else _QUATERNION,
        vector=tuple(vector),
    )


def CayleyKlein(
    names: Sequence[str] = ("a", "b", "c", "d"), *, passive: bool = False
) -> RotationModel:
    """The Cayley-Klein parameters α = a + i b and β = c + i d with |α|² + |β|² = 1.

    With the Pauli matrices, Q = ((α, β), (−β*, α*)) = w 1 + i (x σ₁ + y σ₂ + z σ₃) belongs to the
    unit quaternion w = a, z = b, y = c, x = d. Raises ModelError for bad names.
    """
    a, b, c, d = coordinates = _coordinates(names, 4)
    shown = [lettered(q.func.__name__) for q in coordinates]
    return _model(
        "cayley_klein",
        "Cayley-Klein parameters",
        "The parameters are α = {} + i {} and β = {} + i {}, with |α|² + |β|² = 1; the unit "
        "quaternion is ".format(*shown)
        + f"{_in_parts((a, d, c, b))}, scalar first.",
        (a, b, c, d),
        rotation_of((a, d, c, b)),
        _GOLDSTEIN,
        passive=passive,
        constraints=(_square((a, b, c, d)) - 1,),
        definition="unit_quaternion({0}, {3}, {2}, {1})",
        vector=(d, c, b),
    )


def AxisAngle(
    names: Sequence[str] = ("e1", "e2", "e3", "phi"), *, passive: bool = False
) -> RotationModel:
    """A turn by an angle (radians) about a unit axis, both functions of time.

    `names` are the three components of the axis and the angle. Raises ModelError for bad names.
    """
    *axis, angle = _coordinates(names, 4)
    return _model(
        "axis_angle",
        "Axis and angle",
        "The axis is a unit vector, about which the body is turned by the angle.",
        (*axis, angle),
        rodrigues(tuple(axis), angle),
        SHUSTER,
        passive=passive,
        constraints=(_square(axis) - 1,),
        definition="axis_angle({0}, {1}, {2}, {3})",
        units=("", "", "", "rad"),
        vector=tuple(axis),
    )


def RotationVector(
    names: Sequence[str] = ("v1", "v2", "v3"), *, passive: bool = False
) -> RotationModel:
    """R = exp C(v): the turn by |v| radians about v.

    R = 1 + sin n/n C(v) + (1 − cos n)/n² C(v)², n = |v|. Raises ModelError for bad names.
    """
    vector = _coordinates(names, 3)
    square, skew = _square(vector), hat(sp.Matrix(vector))
    angle = sp.sqrt(square)
    return _model(
        "rotation_vector",
        "Rotation vector",
        "The vector v points along the axis of the turn, and its length n is the angle.",
        vector,
        sp.eye(3) + sp.sin(angle) / angle * skew + (1 - sp.cos(angle)) / square * skew * skew,
        SHUSTER,
        passive=passive,
        definition="axis_angle({0}/N, {1}/N, {2}/N, N)".replace("N", f"sqrt({_SQUARE})"),
        units=("rad",) * 3,
        vector=vector,
    )


def GibbsVector(
    names: Sequence[str] = ("g1", "g2", "g3"), *, passive: bool = False
) -> RotationModel:
    """Rodrigues' parameters g = tan(n/2) e; every rotation but the half turns.

    R = 1 + 2/(1 + g·g) (C(g) + C(g)²). Raises ModelError for bad names.
    """
    vector = _coordinates(names, 3)
    skew = hat(sp.Matrix(vector))
    return _model(
        "gibbs_vector",
        "Gibbs vector",
        "The vector points along the axis of the turn, and its length is the tangent of half the "
        "angle; half turns lie at infinity.",
        vector,
        sp.eye(3) + 2 / (1 + _square(vector)) * (skew + skew * skew),
        SHUSTER,
        passive=passive,
        definition="quaternion(1, {0}, {1}, {2})",
        vector=vector,
    )


def ModifiedRodrigues(
    names: Sequence[str] = ("s1", "s2", "s3"), *, passive: bool = False
) -> RotationModel:
    """Modified Rodrigues parameters s = tan(n/4) e; every rotation but whole turns.

    R = 1 + (8 C(s)² + 4 (1 − s·s) C(s))/(1 + s·s)². The shadow set −s/(s·s) is the same rotation;
    one of the two has a length of at most 1. Raises ModelError for bad names.
    """
    vector = _coordinates(names, 3)
    square, skew = _square(vector), hat(sp.Matrix(vector))
    return _model(
        "modified_rodrigues",
        "Modified Rodrigues parameters",
        "The vector points along the axis of the turn, and its length is the tangent of a quarter "
        "of the angle; the shadow set, minus the vector over the square of its length, is the "
        "same rotation.",
        vector,
        sp.eye(3) + (8 * skew * skew + 4 * (1 - square) * skew) / (1 + square) ** 2,
        _SCHAUB,
        passive=passive,
        definition="modified_rodrigues(1, {0}, {1}, {2})",
        vector=vector,
    )


def DirectionCosines(names: Sequence[str] = _COSINES, *, passive: bool = False) -> RotationModel:
    """The nine entries of R, row by row; dR/dt = C(Ω) R are Poisson's equations.

    Results are written in the entries; claims are proved with the entries as functions of a unit
    quaternion, which represents every rotation. Raises ModelError for bad names.
    """
    entries = _coordinates(names, 9)
    quaternion = UnitQuaternion(names=[f"{names[0]}_quaternion_{k}" for k in "wxyz"])
    return _model(
        "direction_cosines",
        "Direction cosines",
        "The coordinates are the nine entries of R, row by row.",
        entries,
        sp.Matrix(3, 3, entries),
        SOURCES["Goldstein 4.2"],
        passive=passive,
        pullback=Pullback(coordinates=tuple(quaternion.matrix), constraints=quaternion.constraints),
    )


def _coordinates(names: Sequence[str], count: int) -> tuple[sp.Expr, ...]:
    return time_functions(names, count, f"expected {count} different names")


def _in_parts(coordinates: Sequence[sp.Expr]) -> str:
    """A quaternion by the names of its parts, the scalar first: w + (x, y, z)."""
    scalar, *vector = (lettered(q.func.__name__) for q in coordinates)
    return f"{scalar} + ({', '.join(vector)})"


def _square(parts: Sequence[sp.Expr]) -> sp.Expr:
    return sum(part**2 for part in parts)


def _model(
    name: str,
    title: str,
    convention: str,
    coordinates: tuple[sp.Expr, ...],
    matrix: sp.MatrixBase,
    source: Citation,
    *,
    passive: bool,
    units: tuple[str, ...] = (),
    definition: str = "",
    **options: Any,
) -> RotationModel:
    """`definition` is a text with {0}, {1}, ... in place of the names of the coordinates."""
    return RotationModel(
        name=name + ("_passive" if passive else ""),
        title=title + (", passive" if passive else ""),
        convention=(convention,),
        coordinates=coordinates,
        matrix=sp.ImmutableMatrix(matrix),
        source=source,
        definition=definition.format(*(q.func.__name__ for q in coordinates)),
        units=units or ("",) * len(coordinates),
        passive=passive,
        **options,
    )
