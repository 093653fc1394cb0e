"""A body with its principal axes, drawn from its faces."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise

import sympy as sp

from rigidsym.formula.reader import formula
from rigidsym.formula.tree import Formula
from rigidsym.mechanics.derivation import Derivation
from rigidsym.mechanics.mass.numbers import in_numbers
from rigidsym.notes.figure.body_mesh import Face, Shape, lengths_of, own_shape, vector_of
from rigidsym.notes.figure.camera import (
    STANDARD,
    Vector,
    camera,
    combined,
    cross,
    dot,
    scaled,
    unit,
)
from rigidsym.notes.figure.drawing import Drawing, Facet, Named, Stroke, beyond, labelled
from rigidsym.notes.figure.scene import BODY

_VIEW = camera(35, 24)
_LIGHT = unit(combined((-0.36, 0.48, 0.8), (_VIEW.right, _VIEW.up, _VIEW.toward)))
_FLAT = 1e-6  # a length off a plane that does not count
_REACH = 1.3  # of an axis from the centre of mass
_BEYOND = 0.3  # at least this is seen of it
_MOMENTS = tuple(formula(f"I_{k}") for k in (1, 2, 3))


Faced = tuple[Face, Vector]  # with its normal


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
    names, axes = (BODY, STANDARD) if is_principal else (_MOMENTS, _principal_axes(derivation))
    starts = [_exit(shape, axis) for axis in axes]
    ends = [max(_REACH, start + _BEYOND) for start in starts]
    inner = [_stroke((0.0, 0.0, 0.0), scaled(d, a)) for d, a in zip(starts, axes, strict=True)]
    outer = [
        _stroke(scaled(start, axis), scaled(end, axis), name)
        for name, axis, start, end in zip(names, axes, starts, ends, strict=False)
    ]
    is_behind = [_VIEW.depth(axis) < 0 for axis in axes]
    named: list[Named] = [
        ("space", name, beyond(((0.0, 0.0), stroke.points[-1])))
        for name, stroke in zip(names, outer, strict=False)
    ]
    drawing = Drawing(
        strokes=(*inner, *(s for s, hidden in zip(outer, is_behind, strict=True) if not hidden)),
        labels=labelled(named, (*inner, *outer)),
        behind=tuple(s for s, hidden in zip(outer, is_behind, strict=True) if hidden),
        facets=tuple(_facets(shape)),
    )
    return drawing, is_principal


def _principal_axes(derivation: Derivation) -> Sequence[Vector]:
    """In the order of the note: its formula, or else the axes in numbers, least moment first."""
    body = derivation.body
    assert body is not None
    found = {step.quantity.name: step.expression for step in derivation.steps}
    if "principal_axes" in found:
        values = {p.symbol: p.value for p in body.parameters}
        known = {symbol: sp.Float(x) for symbol, x in values.items() if x is not None}
        chosen = lengths_of(body.distribution, values) if body.distribution else None
        numbers = known if chosen is None else chosen
        others = {p.symbol: sp.Float(1) for p in body.parameters if p.symbol not in numbers}
        matrix = found["principal_axes"].xreplace({**numbers, **others})
        if not matrix.free_symbols:
            return [vector_of(matrix[:, k]) for k in range(3)]
    measured = in_numbers(body)
    return () if measured is None else [vector_of(axis) for axis in measured.principal.axes.T]


def _stroke(start: Vector, end: Vector, name: Formula | None = None) -> Stroke:
    points = (_VIEW.project(start), _VIEW.project(end))
    inside = name is None
    return Stroke(kind="space", points=points, name=name, is_hidden=inside, has_arrow=not inside)


def _exit(shape: Shape, axis: Vector) -> float:
    """How far from the origin the ray along an axis leaves the body for the last time."""
    return max((_meeting(face, axis) for face in shape), default=0.0)


def _meeting(face: Face, axis: Vector) -> float:
    """Where the ray from the origin meets a face; 0 where it does not."""
    first, *others = face.corners
    for second, third in pairwise(others):
        normal = cross(combined((1, -1), (second, first)), combined((1, -1), (third, first)))
        slope = dot(normal, axis)
        if abs(slope) < 1e-12:
            continue
        distance = dot(normal, first) / slope
        place = scaled(distance, axis)
        corners = (first, second, third, first)
        sides = [
            dot(normal, cross(combined((1, -1), (b, a)), combined((1, -1), (place, a))))
            for a, b in pairwise(corners)
        ]
        if distance > 0 and min(sides) > -1e-9:
            return distance
    return 0.0


def _facets(shape: Shape) -> Iterator[Facet]:
    """The faces that are seen, the farthest first, shaded by the light from the upper left."""
    for face, normal in _from_the_back([(face, _normal(face)) for face in shape]):
        if _VIEW.depth(normal) > _FLAT:
            bright = 0.62 + 0.38 * max(0.0, dot(normal, _LIGHT))
            red, green, blue = (round(part * bright) for part in face.color)
            points = tuple(_VIEW.project(corner) for corner in face.corners)
            yield Facet(points=points, color=(red, green, blue))


def _from_the_back(faces: Sequence[Faced]) -> Iterator[Faced]:
    """The faces in an order in which later ones may hide earlier ones.

    The plane of one face parts the others, which are split where they cross it: what lies on the
    far side of the plane comes first (binary space partition).
    """
    waiting = [(faces, False)]  # the farthest last, each with whether its order is settled
    while waiting:
        group, is_settled = waiting.pop()
        if is_settled or len(group) < 2:
            yield from group
            continue
        face, normal = group[len(group) // 2]
        here, front, back = [(face, normal)], list[Faced](), list[Faced]()
        for other in group:
            if other[0] is not face:
                _part(other, face, normal, here, front, back)
        near, far = (front, back) if _VIEW.depth(normal) > 0 else (back, front)
        waiting += [(near, False), (here, True), (far, False)]


def _part(
    faced: Faced,
    plane: Face,
    across: Vector,
    here: list[Faced],
    front: list[Faced],
    back: list[Faced],
) -> None:
    """Put a face, or its two parts, on the side of a plane that it lies on."""
    face, normal = faced
    heights = [dot(across, combined((1, -1), (p, plane.corners[0]))) for p in face.corners]
    if max(map(abs, heights)) <= _FLAT:
        here.append(faced)
    for side, place in ((1, front), (-1, back)):
        if max(side * height for height in heights) > _FLAT:
            corners = tuple(_cut(face.corners, [side * height for height in heights]))
            if len(corners) > 2:
                place.append((Face(corners, face.color), normal))


def _cut(corners: Sequence[Vector], heights: Sequence[float]) -> Iterator[Vector]:
    """The corners of the part of a polygon that is above a plane."""
    after = zip((*corners[1:], corners[0]), (*heights[1:], heights[0]), strict=True)
    for (corner, height), (following, level) in zip(
        zip(corners, heights, strict=True), after, strict=True
    ):
        if height >= -_FLAT:
            yield corner
        if height * level < 0 and min(abs(height), abs(level)) > _FLAT:
            share = height / (height - level)
            yield combined((1 - share, share), (corner, following))


def _normal(face: Face) -> Vector:
    first, *others = face.corners
    edges = [combined((1, -1), (corner, first)) for corner in others]
    return unit(combined((1,) * (len(edges) - 1), [cross(a, b) for a, b in pairwise(edges)]))
