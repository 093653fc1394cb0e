"""A body with its principal axes, drawn from its faces."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
import sympy as sp

from rigidsym.formula.reader import formula
from rigidsym.mechanics.derivation import Derivation
from rigidsym.mechanics.mass.bodies import in_numbers
from rigidsym.notes.figure.body_mesh import (
    Color,
    Shape,
    Vector,
    area_of,
    lengths_of,
    own_shape,
    unit,
)
from rigidsym.notes.figure.camera import Point, camera
from rigidsym.notes.figure.drawing import Drawing, Facet, Named, Stroke, beyond, labelled
from rigidsym.notes.figure.scene import BODY

_RIGHT, _UP, _TOWARD = np.array(camera(35, 24))
_LIGHT = unit(-0.36 * _RIGHT + 0.48 * _UP + 0.8 * _TOWARD)
_FLAT = 1e-6  # a length off a plane that does not count
_REACH = 1.3  # of an axis from the centre of mass
_BEYOND = 0.3  # at least this is seen of it
_MOMENTS = tuple(formula(f"I_{k}") for k in (1, 2, 3))


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
    names, axes = (BODY, np.eye(3)) if is_principal else (_MOMENTS, _principal_axes(derivation))
    exits = [_exit(shape, axis) for axis in axes]
    inner = [
        _stroke(0 * axis, at * axis, is_hidden=True) for at, axis in zip(exits, axes, strict=True)
    ]
    outer = [
        _stroke(at * axis, max(_REACH, at + _BEYOND) * axis, is_hidden=False)
        for at, axis in zip(exits, axes, strict=True)
    ]
    named: list[Named] = [
        ("space", name, beyond(((0.0, 0.0), stroke.points[-1])))
        for name, stroke in zip(names, outer, strict=False)
    ]
    behind = [s for s, axis in zip(outer, axes, strict=True) if _TOWARD @ axis < 0]
    drawing = Drawing(
        strokes=(*inner, *(stroke for stroke in outer if stroke not in behind)),
        labels=labelled(named, (*inner, *outer)),
        behind=tuple(behind),
        facets=tuple(_facets(shape)),
    )
    return drawing, is_principal


def _principal_axes(derivation: Derivation) -> Sequence[Vector]:
    """In the order of the note: its formula, or else the axes in numbers, least moment first."""
    body = derivation.body
    assert body is not None
    expressions = {step.quantity.name: step.expression for step in derivation.steps}
    if "principal_axes" in expressions:
        values = {p.symbol: p.value for p in body.parameters}
        known = {symbol: sp.Float(x) for symbol, x in values.items() if x is not None}
        chosen = lengths_of(body.distribution, values) if body.distribution else None
        numbers = known if chosen is None else chosen
        # Parameters that are no lengths, such as densities, do not change the shape; 1 will do.
        others = {p.symbol: sp.Float(1) for p in body.parameters if p.symbol not in numbers}
        matrix = expressions["principal_axes"].xreplace({**numbers, **others})
        if not matrix.free_symbols:
            return [*np.array(matrix.tolist(), float).T]
    measured = in_numbers(body)
    return () if measured is None else [*measured.principal.axes.T]


def _stroke(start: Vector, end: Vector, *, is_hidden: bool) -> Stroke:
    points = (_projected(start), _projected(end))
    return Stroke(kind="space", points=points, is_hidden=is_hidden, has_arrow=not is_hidden)


def _projected(a: Vector) -> Point:
    return (float(_RIGHT @ a), float(_UP @ a))


def _exit(shape: Shape, axis: Vector) -> float:
    """How far from the origin the ray along an axis leaves the body for the last time."""
    triangles = np.array(
        [(face.corners[0], *pair) for face in shape for pair in pairwise(face.corners[1:])]
    )
    first, edges = triangles[:, 0], triangles[:, :1] - triangles[:, 1:]
    # t·axis is the point of a triangle with the shares u and v of its edges
    systems = np.stack([np.broadcast_to(axis, first.shape), *edges.swapaxes(0, 1)], axis=-1)
    meets = np.abs(np.linalg.det(systems)) > 1e-12
    t, u, v = np.linalg.solve(systems[meets], first[meets][..., None])[..., 0].T
    is_inside = np.minimum(np.minimum(u, v), 1 - u - v) > -1e-9
    return float(t[is_inside & (t > 0)].max(initial=0.0))


class _Part(NamedTuple):
    """A face, or a part of one, with the normal of the whole."""

    corners: Vector
    normal: Vector
    color: Color


def _facets(shape: Shape) -> Iterator[Facet]:
    """The faces that are seen, the farthest first, shaded by the light from the upper left."""
    parts = [_Part(face.corners, unit(area_of(face.corners)), face.color) for face in shape]
    for corners, normal, color in _from_the_back(parts):
        if _TOWARD @ normal > _FLAT:
            # Lambert's law for 38 % of the light; the rest is ambient, so that no face is black.
            bright = 0.62 + 0.38 * max(0.0, float(normal @ _LIGHT))
            red, green, blue = (round(part * bright) for part in color)
            yield Facet(points=tuple(map(_projected, corners)), color=(red, green, blue))


def _from_the_back(parts: Sequence[_Part]) -> Iterator[_Part]:
    """The faces in an order in which later ones may hide earlier ones.

    The plane of one face parts the others, which are split where they cross it: what lies on the
    far side of the plane comes first (binary space partition).
    """
    waiting = [(parts, False)]  # the farthest last, each with whether its order is settled
    while waiting:
        group, is_settled = waiting.pop()
        if is_settled or len(group) < 2:
            yield from group
            continue
        plane = group[len(group) // 2]
        here, front, back = [plane], list[_Part](), list[_Part]()
        for part in group:
            if part is plane:
                continue
            # Signed distances of the corners from the plane. A part that crosses it is cut, one
            # half each side.
            heights = (part.corners - plane.corners[0]) @ plane.normal
            if np.abs(heights).max() <= _FLAT:
                here.append(part)
            for side, place in ((1, front), (-1, back)):
                if (side * heights).max() > _FLAT:
                    corners = np.array([*_cut(part.corners, side * heights)])
                    if len(corners) > 2:
                        place.append(part._replace(corners=corners))
        near, far = (front, back) if _TOWARD @ plane.normal > 0 else (back, front)
        waiting += [(near, False), (here, True), (far, False)]


def _cut(corners: Vector, heights: Vector) -> Iterator[Vector]:
    """The corners of the part of a polygon that is above a plane."""
    after = (np.roll(corners, -1, axis=0), np.roll(heights, -1))
    for corner, height, following, level in zip(corners, heights, *after, strict=True):
        if height >= -_FLAT:
            yield corner
        if height * level < 0 and min(abs(height), abs(level)) > _FLAT:
            # The edge crosses the plane where its height, linear along it, is zero.
            share = height / (height - level)
            yield (1 - share) * corner + share * following
