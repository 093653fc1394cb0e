"""From a scaled quaternion to the coordinates of the closed forms, without cancellation."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import sympy as sp

from rigidsym.mechanics.conversions.conversions import rotation_of
from rigidsym.mechanics.conversions.values import NamedValues, Vector, Where, short_way, square


def unit(values: NamedValues, quaternion: Vector) -> Vector:
    length = values.length("length", quaternion)
    return tuple(part / length for part in quaternion)


def _cayley_klein(values: NamedValues, quaternion: Vector) -> Vector:
    w, x, y, z = unit(values, quaternion)
    return w, z, y, x


def _axis_angle(values: NamedValues, quaternion: Vector) -> Vector:
    w, x, y, z = short_way(values, quaternion)
    none, length = _length_of_vector(values, (x, y, z))
    axis = values.let("axis_x", Where(none, sp.S.One, x / length))
    return axis, y / length, z / length, 2 * sp.atan2(Where(none, sp.S.Zero, length), w)


def _length_of_vector(values: NamedValues, vector: Vector) -> tuple[sp.Basic, sp.Expr]:
    """Whether a vector vanishes, and its length, or one: a root of zero has no derivative."""
    size = values.let("square", square(vector))
    none = sp.Eq(size, 0)
    return none, values.let("length", sp.sqrt(Where(none, sp.S.One, size)))


def _rotation_vector(values: NamedValues, quaternion: Vector) -> Vector:
    w, *vector = short_way(values, quaternion)
    none, length = _length_of_vector(values, tuple(vector))
    limit = 2 / Where(sp.Eq(w, 0), sp.S.One, w)
    factor = values.let("factor", Where(none, limit, 2 * sp.atan2(length, w) / length))
    return tuple(factor * part for part in vector)


def _gibbs_vector(values: NamedValues, quaternion: Vector) -> Vector:  # noqa: ARG001  (as the others)
    w, *vector = quaternion
    return tuple(
        part / Where(sp.Eq(w, 0), Where(sp.Eq(part, 0), sp.S.One, w), w) for part in vector
    )


def _modified_rodrigues(values: NamedValues, quaternion: Vector) -> Vector:
    parts = short_way(values, quaternion)
    divisor = values.let("divisor", values.length("length", parts) + parts[0])
    return tuple(part / divisor for part in parts[1:])


def _direction_cosines(values: NamedValues, quaternion: Vector) -> Vector:
    size = values.let("square", square(quaternion))
    return tuple(sp.expand(entry) / size for entry in rotation_of(quaternion))


RULES: Mapping[str, Callable[[NamedValues, Vector], Vector]] = {
    "quaternion": unit,
    "cayley_klein": _cayley_klein,
    "axis_angle": _axis_angle,
    "rotation_vector": _rotation_vector,
    "gibbs_vector": _gibbs_vector,
    "modified_rodrigues": _modified_rodrigues,
    "direction_cosines": _direction_cosines,
}
BOTH_SIGNS = frozenset({"quaternion", "cayley_klein"})  # these distinguish p and −p
