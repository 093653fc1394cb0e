"""Quaternions, Cayley-Klein parameters, axis and angle: rotations by half the angle or all of it.

A quaternion is w + v with v = (x, y, z); scalar first unless the last is asked for.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import sympy as sp

from rigidsym.models.rotation import Citation, RotationModel
from rigidsym.models.so3 import hat, rodrigues, time_function
from rigidsym.models.vectors import distinct_names

_SHUSTER = Citation(
    text="M. Shuster, A Survey of Attitude Representations, Journal of the Astronautical "
    "Sciences 41 (1993)"
)
_GOLDSTEIN = Citation(text="H. Goldstein, Classical Mechanics (1950), section 4-5")
_SCALAR = {False: "scalar first", True: "scalar last"}


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
            f"The quaternion is w + (x, y, z), {_SCALAR[scalar_last]}, of any length but zero; "
            "every multiple of it is the same rotation.",
        ),
        matrix=model.matrix / (condition + 1),
        constraints=(),
    )


def UnitQuaternion(
    names: Sequence[str] = ("w", "x", "y", "z"),
    *,
    scalar_last: bool = False,
    passive: bool = False,
) -> RotationModel:
    """A quaternion with w² + v·v = 1, a relation of the ring: cos(n/2) + sin(n/2) e.

    `names` are (w, x, y, z) in this order; `scalar_last` makes the coordinates (x, y, z, w).
    Raises ModelError for bad names.
    """
    w, *parts = (time_function(name) for name in distinct_names(names, 4))
    vector = sp.Matrix(parts)
    return RotationModel(
        name="unit_quaternion" + ("_xyzw" if scalar_last else "") + ("_passive" if passive else ""),
        title=f"Unit quaternion, {_SCALAR[scalar_last]}" + (", passive" if passive else ""),
        convention=(
            f"The quaternion is w + (x, y, z), {_SCALAR[scalar_last]}, of length one: the cosine "
            "of half the angle and the axis times the sine of half the angle.",
        ),
        coordinates=(*parts, w) if scalar_last else (w, *parts),
        matrix=sp.ImmutableMatrix(_homogeneous(w, vector)),
        constraints=(w**2 + vector.dot(vector) - 1,),
        source=_SHUSTER,
        units=("",) * 4,
        vector=tuple(vector),
        passive=passive,
    )


def CayleyKlein(
    names: Sequence[str] = ("a", "b", "c", "d"), *, passive: bool = False
) -> RotationModel:
    """α = a + i b and β = c + i d with |α|² + |β|² = 1, of the matrix ((α, β), (−β*, α*)).

    The rotation is that of the unit quaternion w = a, z = b, y = c, x = d, by the Pauli matrices:
    Q = w 1 + i (x σ₁ + y σ₂ + z σ₃). Raises ModelError for bad names.
    """
    a, b, c, d = (time_function(name) for name in distinct_names(names, 4))
    return RotationModel(
        name="cayley_klein" + ("_passive" if passive else ""),
        title="Cayley-Klein parameters" + (", passive" if passive else ""),
        convention=(
            "The parameters are α = a + i b and β = c + i d, with |α|² + |β|² = 1; the unit "
            "quaternion is (w, x, y, z) = (a, d, c, b).",
        ),
        coordinates=(a, b, c, d),
        matrix=sp.ImmutableMatrix(_homogeneous(a, sp.Matrix([d, c, b]))),
        constraints=(a**2 + b**2 + c**2 + d**2 - 1,),
        source=_GOLDSTEIN,
        units=("",) * 4,
        vector=(d, c, b),
        passive=passive,
    )


def AxisAngle(
    names: Sequence[str] = ("e1", "e2", "e3", "phi"), *, passive: bool = False
) -> RotationModel:
    """The turn by an angle (radians) about a unit axis, both free to move.

    `names` are the three components of the axis and the angle. Raises ModelError for bad names.
    """
    *axis, angle = (time_function(name) for name in distinct_names(names, 4))
    return RotationModel(
        name="axis_angle" + ("_passive" if passive else ""),
        title="Axis and angle" + (", passive" if passive else ""),
        convention=("The axis is a unit vector, about which the body is turned by the angle.",),
        coordinates=(*axis, angle),
        matrix=rodrigues(axis, angle),
        constraints=(sum(part**2 for part in axis) - 1,),
        source=_SHUSTER,
        units=("", "", "", "rad"),
        vector=tuple(axis),
        passive=passive,
    )


def _homogeneous(w: sp.Expr, vector: sp.Matrix) -> sp.Matrix:
    """(w² − v·v) 1 + 2 v vᵀ + 2 w C(v): the rotation times the square of the length."""
    square = vector.dot(vector)
    return (w**2 - square) * sp.eye(3) + 2 * vector * vector.T + 2 * w * hat(vector)
