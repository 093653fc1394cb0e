"""A body with its principal axes, drawn from its faces."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from rigidsym.data.mass import principal_axes_of
from rigidsym.formula.reader import formula
from rigidsym.formula.tree import with_names
from rigidsym.mechanics.derivation import Derivation
from rigidsym.mechanics.quantities.table import own_letters
from rigidsym.notes.figure.body_mesh import Vector, area_of, numbers_of, own_shape, unit
from rigidsym.notes.figure.drawing import Color, Drawing, Facet, Named, Stroke, beyond, labelled
from rigidsym.notes.figure.scene import BODY, Point, camera
from rigidsym.system.records import NamedTuple

_RIGHT, _UP, _TOWARD = np.array(camera(35, 24))
_LIGHT = unit(-0.36 * _RIGHT + 0.48 * _UP + 0.8 * _TOWARD)
_FLAT = 1e-6  # a length off a plane that does not count
_REACH = 1.3  # of an axis from the centre of mass
_MOMENTS = tuple(formula(f"I_{k}") for k in (1, 2, 3))


class _Part(NamedTuple):
    """A face or a piece of one, counterclockwise as seen from outside; or a piece of an axis."""

    corners: Vector
    color: Color | None  # None for an axis
    normal: Vector


def body_drawing(derivation: Derivation) -> tuple[Drawing, bool] | None:
    """The drawing, and whether the axes of the body are its principal axes; None without a shape.

    The axes are named x′, y′, z′ if they are principal axes; other principal axes bear the names
    of their moments.
    """
    body = derivation.body
    shape = own_shape(body)
    if body is None or not shape:
        return None
    is_principal = body.inertia.is_diagonal()
    names, axes = BODY, np.eye(3)
    if not is_principal:
        letters = own_letters(derivation.arguments, body, derivation.forces)
        names, axes = with_names(_MOMENTS, letters), _principal_axes(derivation)
    ends = [np.array([0 * axis, _REACH * axis]) for axis in axes]
    # The whole axes are dashed lines on top, on which the pieces that the body does not hide are
    # solid lines.
    lines = [Stroke("space", _projected(line), is_hidden=True) for line in ends]
    named: list[Named] = [
        ("space", name, beyond(line.points)) for name, line in zip(names, lines, strict=True)
    ]
    parts = [_Part(face.corners, face.color, unit(area_of(face.corners))) for face in shape]
    parts += [_Part(line, None, line[0]) for line in ends]
    return Drawing(tuple(lines), labelled(named, lines), body=tuple(_seen(parts))), is_principal


def _principal_axes(derivation: Derivation) -> Vector:
    """As rows, in the order of the note: its formula, or else the least moment first."""
    body = derivation.body
    assert body is not None
    expressions = {step.quantity.name: step.expression for step in derivation.steps}
    exact = expressions.get("principal_axes", body.inertia).xreplace(numbers_of(body))
    matrix = np.array(exact.tolist(), float)
    return (matrix if "principal_axes" in expressions else principal_axes_of(matrix).axes).T


def _projected(points: Vector) -> tuple[Point, ...]:
    return tuple((float(_RIGHT @ point), float(_UP @ point)) for point in points)


def _seen(parts: Sequence[_Part]) -> Iterator[Facet | Stroke]:
    """What is seen, the farthest first; the light comes from the upper left."""
    for corners, color, normal in _from_the_back(parts):
        if color is None:
            has_arrow = bool(np.linalg.norm(corners[-1]) > _REACH - _FLAT)
            yield Stroke("space", _projected(corners), has_arrow=has_arrow)
        elif _TOWARD @ normal > _FLAT:
            # Lambert's law for 38 % of the light; the rest is ambient, so that no face is black.
            bright = 0.62 + 0.38 * max(0.0, float(normal @ _LIGHT))
            red, green, blue = (round(part * bright) for part in color)
            yield Facet(_projected(corners), (red, green, blue))


def _from_the_back(parts: Sequence[_Part]) -> Iterator[_Part]:
    """The parts in an order in which later ones may hide earlier ones.

    The plane of one face divides the others, which are split where they cross it: what lies on the
    far side of the plane comes first (binary space partition).
    """
    waiting = [(parts, False)]  # the farthest last, each with whether its order is settled
    while waiting:
        group, is_settled = waiting.pop()
        faces = [part for part in group if part.color is not None]
        if is_settled or not faces or len(group) < 2:
            yield from group
            continue
        plane = faces[len(faces) // 2]
        here, front, back = [plane], list[_Part](), list[_Part]()
        # Signed distances of all corners from the plane, in one product: a sphere has 400,000 pairs
        # of a part and a plane. Few parts cross the plane; they are cut, one half each side.
        starts = np.cumsum([0, *(len(part.corners) for part in group)])[:-1]
        corners = np.concatenate([part.corners for part in group])
        heights = (corners - plane.corners[0]) @ plane.normal
        extremes = (end.reduceat(heights, starts).tolist() for end in (np.minimum, np.maximum))
        for part, start, low, high in zip(group, starts, *extremes, strict=True):
            if part is plane:
                continue
            if max(-low, high) <= _FLAT:
                here.append(part)
            for side, place, top, bottom in ((1, front, high, low), (-1, back, -low, -high)):
                if top > _FLAT and bottom >= -_FLAT:
                    place.append(part)
                elif top > _FLAT:
                    own = side * heights[start : start + len(part.corners)]
                    place.append(part._replace(corners=np.array([*_cut(part.corners, own)])))
        near, far = (front, back) if _TOWARD @ plane.normal > 0 else (back, front)
        waiting += [(near, False), (here, True), (far, False)]


def _cut(corners: Vector, heights: Vector) -> Iterator[Vector]:
    """The corners of the part of a polygon, or of a line, that is above a plane."""
    count = len(corners) if len(corners) > 2 else 1  # of edges; only a polygon is closed
    ends = (np.roll(corners, -1, axis=0), np.roll(heights, -1))
    for k, (corner, height, following, level) in enumerate(
        zip(corners, heights, *ends, strict=True)
    ):
        if height >= -_FLAT:
            yield corner
        if k < count and height * level < 0 and min(abs(height), abs(level)) > _FLAT:
            # The edge crosses the plane where its height, linear along it, is zero.
            share = height / (height - level)
            yield (1 - share) * corner + share * following
