"""Bodies that turn in the live page, as polyhedra; lengths are those of the unit vectors.

Each shape is made of closed pieces whose faces, seen from outside, run counterclockwise.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import cos, pi, sin
from typing import Any

Point = tuple[float, float, float]
Color = tuple[int, int, int]

WHITE, PAGES = (246, 244, 238), (236, 228, 206)
BLUE, NAVY = (58, 110, 190), (36, 70, 130)
GOLD, BRONZE = (226, 182, 74), (196, 146, 56)
RED, GREY = (204, 72, 58), (176, 182, 190)
HOLE = (52, 54, 60)


@dataclass(frozen=True, slots=True)
class Face:
    """A flat polygon, counterclockwise as seen from outside."""

    corners: tuple[Point, ...]
    color: Color


Shape = tuple[Face, ...]


def book() -> Shape:
    """A cuboid with three different moments of inertia: cover up, spine to the left."""
    half = (0.62, 0.86, 0.13)
    left, bottom, top = BLUE, NAVY, BLUE
    plain = _cuboid(half, (PAGES, left, PAGES, PAGES, top, bottom))
    cover = [face for face in plain if face.corners[0][2] == face.corners[2][2] > 0]
    rest = [face for face in plain if face not in cover]
    columns, rows = (-0.62, -0.4, 0.4, 0.62), (-0.86, 0.2, 0.62, 0.86)
    tiles = (
        Face(
            ((x0, y0, half[2]), (x1, y0, half[2]), (x1, y1, half[2]), (x0, y1, half[2])),
            WHITE if (x0, y0) == (-0.4, 0.2) else BLUE,
        )
        for x0, x1 in pairwise(columns)
        for y0, y1 in pairwise(rows)
    )
    return (*rest, *tiles)


def coin() -> Shape:
    """A thin disc with a mark on its head, about z′."""

    def color(row: int, sector: int) -> Color:
        is_mark = row == 4 and sector in (0, 1, 34, 35)
        return NAVY if is_mark else GOLD if row > 2 else BRONZE

    profile = [(0.0, -0.05), (0.7, -0.05), (0.7, 0.05), (0.55, 0.05), (0.25, 0.05), (0.0, 0.05)]
    return _revolved(profile, 36, color)


def top() -> Shape:
    """A spinning top about z′, with coloured sectors that show the spin."""

    def color(row: int, sector: int) -> Color:
        return GREY if row > 6 else (RED, WHITE)[sector // 4 % 2]

    cone = [(0.0, -0.8), (0.06, -0.74), (0.44, -0.2), (0.54, -0.06), (0.58, 0.04), (0.53, 0.11)]
    return _revolved([*cone, (0.3, 0.15), (0.07, 0.17), (0.06, 0.62), (0.0, 0.64)], 32, color)


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
    "coin": coin,
    "top": top,
    "aircraft": aircraft,
}


def as_data(shape: Shape) -> dict[str, Any]:
    """The shape by indices: points, colours, and faces as [colour, corner, corner, ...]."""
    points: dict[Point, int] = {}
    colors: dict[Color, int] = {}
    faces = [
        [
            colors.setdefault(face.color, len(colors)),
            *(points.setdefault(_rounded(p), len(points)) for p in face.corners),
        ]
        for face in shape
    ]
    return {"points": [*points], "colors": [*colors], "faces": faces}


def _rounded(point: Point) -> Point:
    x, y, z = (round(part, 3) + 0.0 for part in point)
    return (x, y, z)


def _cuboid(half: Point, colors: Sequence[Color]) -> Shape:
    """A cuboid about the origin; colours of its faces at x > 0, x < 0, y > 0, and so on."""
    a, b, c = half
    signs = (-1, 1)
    corners = {(i, j, k): (i * a, j * b, k * c) for i in signs for j in signs for k in signs}
    around = ((-1, -1), (1, -1), (1, 1), (-1, 1))
    faces = []
    for place, color in enumerate(colors):
        axis, side = divmod(place, 2)
        sign = 1 - 2 * side
        ring = [_inserted(axis, sign, p, q) for p, q in around]
        faces.append(Face(tuple(corners[key] for key in (ring if sign > 0 else ring[::-1])), color))
    return tuple(faces)


def _inserted(axis: int, sign: int, p: int, q: int) -> tuple[int, int, int]:
    """The signs of a corner: along the axis, and along the two that follow it cyclically."""
    key = [0, 0, 0]
    key[axis], key[(axis + 1) % 3], key[(axis + 2) % 3] = sign, p, q
    return (key[0], key[1], key[2])


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
