"""Rotations by three parameters that are components of one vector along the axis of the turn.

With n the angle of the turn about the unit axis e, the vector is n e (rotation vector),
tan(n/2) e (Gibbs) or tan(n/4) e (modified Rodrigues parameters).
"""

from __future__ import annotations

from collections.abc import Sequence

import sympy as sp

from rigidsym.errors import ModelError
from rigidsym.models.rotation import Citation, RotationModel
from rigidsym.models.so3 import hat, time_function
from rigidsym.text.names import check_name

_SHUSTER = Citation(
    text="M. Shuster, A Survey of Attitude Representations, Journal of the Astronautical "
    "Sciences 41 (1993)"
)
_SCHAUB = Citation(
    text="H. Schaub, J. Junkins, Stereographic Orientation Parameters for Attitude Dynamics, "
    "Journal of the Astronautical Sciences 44 (1996)"
)


def RotationVector(
    names: Sequence[str] = ("v1", "v2", "v3"), *, passive: bool = False
) -> RotationModel:
    """R = exp C(v): the turn by |v| radians about v.

    R = 1 + sin n/n C(v) + (1 − cos n)/n² C(v)², n = |v|. Raises ModelError for bad names.
    """
    components, vector, square = _vector(names)
    angle, skew = sp.sqrt(square), hat(vector)
    return _model(
        "rotation_vector",
        "Rotation vector",
        "The vector v points along the axis of the turn, and its length n is the angle.",
        components,
        sp.eye(3) + sp.sin(angle) / angle * skew + (1 - sp.cos(angle)) / square * skew * skew,
        _SHUSTER,
        unit="rad",
        passive=passive,
    )


def GibbsVector(
    names: Sequence[str] = ("g1", "g2", "g3"), *, passive: bool = False
) -> RotationModel:
    """Rodrigues' parameters g = tan(n/2) e; every rotation but the half turns.

    R = 1 + 2/(1 + g·g) (C(g) + C(g)²). Raises ModelError for bad names.
    """
    components, vector, square = _vector(names)
    skew = hat(vector)
    return _model(
        "gibbs_vector",
        "Gibbs vector",
        "The vector points along the axis of the turn, and its length is the tangent of half the "
        "angle; half turns lie at infinity.",
        components,
        sp.eye(3) + 2 / (1 + square) * (skew + skew * skew),
        _SHUSTER,
        passive=passive,
    )


def ModifiedRodrigues(
    names: Sequence[str] = ("s1", "s2", "s3"), *, passive: bool = False
) -> RotationModel:
    """Modified Rodrigues parameters s = tan(n/4) e; every rotation but whole turns.

    R = 1 + (8 C(s)² + 4 (1 − s·s) C(s))/(1 + s·s)². The shadow set −s/(s·s) is the same rotation;
    one of the two has a length of at most 1. Raises ModelError for bad names.
    """
    components, vector, square = _vector(names)
    skew = hat(vector)
    return _model(
        "modified_rodrigues",
        "Modified Rodrigues parameters",
        "The vector points along the axis of the turn, and its length is the tangent of a quarter "
        "of the angle; the shadow set, minus the vector over the square of its length, is the "
        "same rotation.",
        components,
        sp.eye(3) + (8 * skew * skew + 4 * (1 - square) * skew) / (1 + square) ** 2,
        _SCHAUB,
        passive=passive,
    )


def _vector(names: Sequence[str]) -> tuple[tuple[sp.Expr, ...], sp.Matrix, sp.Expr]:
    components = tuple(time_function(name) for name in distinct_names(names, 3))
    vector = sp.Matrix(components)
    return components, vector, vector.dot(vector)


def distinct_names(names: Sequence[str], count: int) -> tuple[str, ...]:
    """Plain names of coordinates; raises ModelError unless they are `count` different ones."""
    if not isinstance(names, Sequence):
        raise ModelError(f"expected {count} different names, got {names!r}")
    plain = tuple(check_name(name) for name in names)
    if len(plain) != count or len(set(plain)) != count:
        raise ModelError(f"expected {count} different names, got {', '.join(plain)}")
    return plain


def _model(
    name: str,
    title: str,
    convention: str,
    components: tuple[sp.Expr, ...],
    matrix: sp.MatrixBase,
    source: Citation,
    *,
    unit: str = "",
    passive: bool,
) -> RotationModel:
    return RotationModel(
        name=name + ("_passive" if passive else ""),
        title=title + (", passive" if passive else ""),
        convention=(convention,),
        coordinates=components,
        matrix=sp.ImmutableMatrix(matrix),
        source=source,
        units=(unit,) * 3,
        vector=components,
        passive=passive,
    )
