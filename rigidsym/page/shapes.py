"""Bodies that turn in the live page, as polyhedra, in units of the unit vectors.

Each shape is made of closed pieces whose faces, seen from outside, run counterclockwise.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import cache, lru_cache
from itertools import pairwise
from math import cos, pi, sin
from typing import Any

from rigidsym.notes.figure.body_mesh import BLUE, GREY, RED, Color, Face, Shape
from rigidsym.notes.figure.camera import Vector

WHITE, PAGES, NAVY = (246, 244, 238), (236, 228, 206), (36, 70, 130)


@cache
def book() -> Shape:
    """A book: cover up, spine to the left."""
    x, y, z = 0.62, 0.86, 0.13
    block = _prism([(-x, -y), (x, -y), (x, y), (-x, y)], -z, z, PAGES)
    _, back, near, right, far, spine = block
    columns, rows = (-x, -0.4, 0.4, x), (-y, 0.2, 0.62, y)
    cover = (
        Face(
            ((x0, y0, z), (x1, y0, z), (x1, y1, z), (x0, y1, z)),
            WHITE if (x0, y0) == (-0.4, 0.2) else BLUE,
        )
        for x0, x1 in pairwise(columns)
        for y0, y1 in pairwise(rows)
    )
    return (Face(back.corners, NAVY), near, right, far, Face(spine.corners, BLUE), *cover)


@cache
def top() -> Shape:
    """A spinning top about z′, with coloured sectors that show the spin."""

    def color(row: int, sector: int) -> Color:
        return GREY if row > 6 else (RED, WHITE)[sector // 4 % 2]

    cone = [(0.0, -0.8), (0.06, -0.74), (0.44, -0.2), (0.54, -0.06), (0.58, 0.04), (0.53, 0.11)]
    return _revolved([*cone, (0.3, 0.15), (0.07, 0.17), (0.06, 0.62), (0.0, 0.64)], 32, color)


def on_its_tip(shape: Shape) -> Shape:
    """The shape moved along z′ until its lowest point is the origin."""
    lowest = min(z for face in shape for _, _, z in face.corners)
    return tuple(
        Face(tuple((x, y, z - lowest) for x, y, z in face.corners), face.color) for face in shape
    )


@cache
def aircraft() -> Shape:
    """An aeroplane: nose along x′, left wing along y′, fin along z′."""
    profile = [(0.0, -0.95), (0.05, -0.9), (0.13, -0.2), (0.13, 0.6), (0.06, 0.9), (0.0, 0.97)]
    hull = _revolved(profile, 12, lambda row, _: NAVY if row == 4 else WHITE)
    fuselage = tuple(Face(tuple((z, x, y) for x, y, z in f.corners), f.color) for f in hull)
    wing = ((0.3, 0.1), (-0.1, 0.1), (-0.3, 0.95), (-0.13, 0.95))
    tail = ((-0.68, 0.04), (-0.88, 0.04), (-0.92, 0.36), (-0.8, 0.36))
    flat = [
        _prism([(x, side * y) for x, y in outline], -0.025, 0.025, color)
        for outline, color in ((wing, BLUE), (tail, BLUE))
        for side in (1, -1)
    ]
    fin = _prism([(-0.62, 0.08), (-0.9, 0.08), (-0.95, 0.42), (-0.8, 0.42)], -0.02, 0.02, RED)
    upright = tuple(Face(tuple((x, -z, y) for x, y, z in f.corners), f.color) for f in fin)
    return (*fuselage, *(face for part in flat for face in part), *upright)


SHAPES: Mapping[str, Callable[[], Shape]] = {
    "book": book,
    "top": top,
    "aircraft": aircraft,
}


@lru_cache(maxsize=16)
def as_data(shape: Shape) -> dict[str, Any]:
    """The shape by indices: points, colours, and faces as [colour, corner, corner, ...]."""
    points: dict[Vector, int] = {}
    colors: dict[Color, int] = {}
    faces = [
        [
            colors.setdefault(face.color, len(colors)),
            *(points.setdefault(_rounded(p), len(points)) for p in face.corners),
        ]
        for face in shape
    ]
    return {"points": [*points], "colors": [*colors], "faces": faces}


def _rounded(point: Vector) -> Vector:
    x, y, z = (round(part, 3) + 0.0 for part in point)
    return (x, y, z)


def _revolved(
    profile: Sequence[tuple[float, float]], sectors: int, color: Callable[[int, int], Color]
) -> Shape:
    """The surface of a profile (radius, z), from bottom to top, revolved about z."""
    angles = [2 * pi * k / sectors for k in range(sectors + 1)]
    faces = []
    for row, ((r0, z0), (r1, z1)) in enumerate(pairwise(profile)):
        for sector, (a, b) in enumerate(pairwise(angles)):
            ring = [(r0, a, z0), (r0, b, z0), (r1, b, z1), (r1, a, z1)]
            corners = [_rounded((r * cos(t), r * sin(t), z)) for r, t, z in ring]
            faces.append(Face(tuple(dict.fromkeys(corners)), color(row, sector)))
    return tuple(faces)


def _prism(outline: Sequence[tuple[float, float]], low: float, high: float, color: Color) -> Shape:
    """A convex outline in the plane of x and y, between two heights."""
    area = sum(x0 * y1 - x1 * y0 for (x0, y0), (x1, y1) in pairwise([*outline, outline[0]]))
    around = outline if area > 0 else outline[::-1]
    sides = (
        Face(((x0, y0, low), (x1, y1, low), (x1, y1, high), (x0, y0, high)), color)
        for (x0, y0), (x1, y1) in pairwise([*around, around[0]])
    )
    upper = tuple((x, y, high) for x, y in around)
    lower = tuple((x, y, low) for x, y in reversed(around))
    return (Face(upper, color), Face(lower, color), *sides)
