"""A body as flat faces, meshed from its description, for the figure of a note and the live page.

A solid is a map of a box of coordinates; its surface is the image of the sides of the box, without
those that shrink to lines and those that meet, as at the angles 0 and 2π.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import islice, pairwise, permutations, product
from math import hypot, isfinite
from typing import Any

import sympy as sp

from rigidsym.algebra.evaluate import function_of
from rigidsym.models.body import (
    Composite,
    Distribution,
    Known,
    Part,
    Particles,
    Polyhedron,
    RigidBody,
    Solid,
)
from rigidsym.notes.figure.camera import Vector, combined, cross, dot, scaled, unit

Color = tuple[int, int, int]
BLUE, GOLD, GREY = (58, 110, 190), (226, 182, 74), (176, 182, 190)
RED, BRONZE, HOLE = (204, 72, 58), (196, 146, 56), (52, 54, 60)


@dataclass(frozen=True, slots=True)
class Face:
    """A flat polygon, counterclockwise as seen from outside."""

    corners: tuple[Vector, ...]
    color: Color


Shape = tuple[Face, ...]
Numbers = Mapping[sp.Symbol, sp.Float]
Map = Callable[..., Vector]

PALETTE = (BLUE, GOLD, GREY, RED, BRONZE)
_SIZE = 0.95  # of the body drawn, from its centre of mass
_LENGTHS = (1.0, 0.22, 0.3, 1.4, 0.6, 0.15, 0.8)  # of parameters without a value
_FEW_LENGTHS = {2: (0.6, 1.0), 3: (1.0, 0.55, 0.8)}
_MOST_TRIES = 500
# the functions that Python's math has not, or names otherwise
_ROUND, _CURVED = 24, 8  # divisions of a full circle, and of any other coordinate that bends
SWELL = "1.01"  # of a hole, so that its rim is seen on the surface
_THICK = 0.03  # half the width of a line
_PARTICLE = 0.09  # radius


def own_shape(body: RigidBody | None) -> Shape:
    """The faces of a body, its centre of mass at the origin; none if only its moments are known."""
    what = None if body is None else body.distribution or body.drawn
    if body is None or what is None:
        return ()
    values = {p.symbol: p.value for p in (*body.declared, *body.parameters)}
    numbers = lengths_of(what, values)
    size = 0.0 if numbers is None else _size(what, numbers)
    if numbers is None or not size:
        return ()
    return _fitted(meshed(what, numbers, size), body, numbers, size)


def lengths_in(body: RigidBody | None) -> set[sp.Basic]:
    """The constants that the shape of a body is made of; none if only its moments are known."""
    what = None if body is None else body.distribution or body.drawn
    return {s for e in _geometry(what) for s in e.free_symbols} if what else set()


def lengths_of(
    what: Distribution, values: Mapping[sp.Symbol, float | None]
) -> dict[sp.Symbol, sp.Float] | None:
    """The parameters with their values, or a suitable length if they have none."""
    known = {symbol: value for symbol, value in values.items() if value is not None}
    inner = {variable for solid in _solids(what) for variable in solid.coordinates}
    held = {s for expression in _geometry(what) for s in expression.free_symbols}
    missing = sorted(held - inner - {*known}, key=str)
    lengths = _FEW_LENGTHS.get(len(missing), _LENGTHS[: len(missing)])
    if len(missing) > len(lengths):
        return None
    for chosen in islice(permutations(lengths), _MOST_TRIES):
        given = {**known, **dict(zip(missing, chosen, strict=True))}
        numbers = {symbol: sp.Float(value) for symbol, value in given.items()}
        if all(_is_proper(solid, numbers) for solid in _solids(what)):
            return numbers
    return None


def meshed(what: Distribution, numbers: Numbers, unit: float = 1.0) -> Shape:
    """The faces of what has mass, in its own axes; `unit` is their unit of length, in metres."""
    return tuple(_faces(what, Scale(numbers, unit), BLUE))


@dataclass(frozen=True, slots=True)
class Scale:
    """The parameters in numbers, and the unit of length in metres."""

    numbers: Numbers
    unit: float = 1.0

    def point(self, column: sp.MatrixBase) -> Vector:
        return scaled(1 / self.unit, vector_of(column.xreplace(self.numbers)))


def _size(what: Distribution, numbers: Numbers) -> float:
    """The distance of the farthest point from the first, in metres, without any thickness."""
    points = [*_points(what, Scale(numbers))]
    far = max((hypot(*combined((1, -1), (p, points[0]))) for p in points), default=0.0)
    return far or float(bool(points))


def _points(what: Distribution, scale: Scale) -> Iterator[Vector]:
    """Enough points to tell the size of a body."""
    match what:
        case Particles():
            yield from (scale.point(particle.position) for particle in what.particles)
        case Polyhedron():
            yield from map(scale.point, what.vertices)
        case Solid():
            at = _map(what, scale)
            yield from (at(*s) for s in product((0.0, 0.5, 1.0), repeat=len(what.coordinates)))
        case Composite():
            for part in what.parts:
                moved = _mover(part, scale)
                yield from map(moved, _points(part.what, scale))
        case Known():
            yield from (scaled(1 / scale.unit, corner) for corner in what.outline.corners)


def _geometry(what: Distribution) -> Iterator[sp.Basic]:
    """Everything in a description that holds lengths."""
    match what:
        case Particles():
            yield from (particle.position for particle in what.particles)
        case Solid():
            yield what.place
            yield from (bound for pair in what.bounds for bound in pair)
        case Polyhedron():
            yield from what.vertices
        case Composite():
            for part in what.parts:
                yield from (part.at, part.turned, *_geometry(part.what))


def _solids(what: Distribution) -> Iterator[Solid]:
    if isinstance(what, Composite):
        for part in what.parts:
            yield from _solids(part.what)
    elif isinstance(what, Solid):
        yield what


def _map(solid: Solid, scale: Scale) -> Map:
    """The point of a solid for coordinates that run from 0 to 1."""
    numbers = scale.numbers
    places = [function_of(part.xreplace(numbers), solid.coordinates) for part in solid.place]
    bounds = [
        [function_of(sp.S(bound).xreplace(numbers), solid.coordinates) for bound in pair]
        for pair in solid.bounds
    ]

    def point(*shares: float) -> Vector:
        values: list[float] = []
        for share, pair in zip(shares, bounds, strict=True):
            low, high = (bound(values) for bound in pair)
            values.append(low + share * (high - low))
        x, y, z = (place(values) / scale.unit for place in places)
        return (x, y, z)

    return point


def _is_proper(solid: Solid, numbers: Numbers) -> bool:
    """Whether bounds are in order, and the map never turns inside out."""
    point, count = _map(solid, Scale(numbers)), len(solid.coordinates)
    lengths = (sp.S(high - low).xreplace(numbers) for low, high in solid.bounds)
    ordered = all(float(length) >= 0 for length in lengths if length.is_number)
    shares = product((0.1, 0.5, 0.9), repeat=count)
    return ordered and (count < 3 or len({_orientation(point, s) > 0 for s in shares}) == 1)


def _orientation(point: Map, shares: Sequence[float]) -> float:
    """The determinant of the map."""
    here = point(*shares)
    steps = (
        combined((1, -1), (point(*(s + 1e-4 * (j == k) for j, s in enumerate(shares))), here))
        for k in range(3)
    )
    a, b, c = steps
    return dot(cross(a, b), c)


def _faces(what: Distribution, scale: Scale, color: Color) -> Iterator[Face]:
    match what:
        case Particles():
            for particle in what.particles:
                yield from octahedron(scale.point(particle.position), color)
        case Polyhedron():
            corners = [scale.point(vertex) for vertex in what.vertices]
            yield from (Face(tuple(corners[k] for k in face), color) for face in what.faces)
        case Solid():
            yield from of_solid(what, scale, color)
        case Composite():
            for part, tint in zip(what.parts, PALETTE * len(what.parts), strict=False):
                yield from _placed(part, scale, HOLE if part.hole else tint)
        case Known():
            corners = [scaled(1 / scale.unit, corner) for corner in what.outline.corners]
            yield from (Face(tuple(corners[k] for k in f), color) for f in what.outline.faces)


def vector_of(column: Iterable[Any]) -> Vector:
    """Three numbers as floats."""
    x, y, z = map(float, column)
    return (x, y, z)


def _placed(part: Part, scale: Scale, color: Color) -> Iterator[Face]:
    moved = _mover(part, scale)
    for face in _faces(part.what, scale, color):
        yield Face(tuple(map(moved, face.corners)), HOLE if part.hole else face.color)


def _mover(part: Part, scale: Scale) -> Callable[[Vector], Vector]:
    """From the axes of a part to those of the body."""
    at, swell = scale.point(part.at), float(SWELL) if part.hole else 1.0
    axes = [vector_of(part.turned[:, k].xreplace(scale.numbers)) for k in range(3)]
    return lambda point: combined((1, swell), (at, combined(point, axes)))


def octahedron(centre: Vector, color: Color) -> Iterator[Face]:
    for i, j, k in product((1, -1), repeat=3):
        signs = ((i, 0, 0), (0, j, 0), (0, 0, k))
        corners = tuple(combined((1, _PARTICLE), (centre, sign)) for sign in signs)
        yield Face(corners if i * j * k > 0 else corners[::-1], color)


def of_solid(
    solid: Solid,
    scale: Scale,
    color: Color,
    seen: dict[Vector, tuple[float, ...]] | None = None,
) -> Iterator[Face]:
    """The faces of a solid; `seen` is told the coordinates, from 0 to 1, of every point.

    On the tube of a line, the offset from the line follows: (u, 0, 0, x, y, z).
    """
    mapped, known = _map(solid, scale), {} if seen is None else seen

    def point(*shares: float) -> Vector:
        found = mapped(*shares)
        known.setdefault(near(found), shares)
        return found

    counts = [_divisions(solid, symbol) for symbol in solid.coordinates]
    if len(counts) == 1:
        count = 2 * _ROUND if counts[0] > 1 else 1
        yield from _tube(point, [k / count for k in range(count + 1)], color, known)
    elif len(counts) == 2:
        grid = _grid(point, counts)
        yield from _tiles(grid, color)
        yield from _tiles([row[::-1] for row in grid], color)
    else:
        yield from _surface(point, counts, color)


def _divisions(solid: Solid, symbol: sp.Symbol) -> int:
    waves = solid.place.atoms(sp.sin, sp.cos)
    if any(wave.has(symbol) for wave in waves):
        low, high = solid.bounds[solid.coordinates.index(symbol)]
        turns = (high - low) / (2 * sp.pi)
        return int(sp.ceiling(_ROUND * turns)) if turns.is_number else _ROUND
    later = [bound for pair in solid.bounds for bound in pair if bound.has(symbol)]
    slope = solid.place.diff(symbol)
    if later or slope.has(symbol):
        return _CURVED
    return 1


def _surface(point: Map, counts: Sequence[int], color: Color) -> Iterator[Face]:
    outward = _orientation(point, (0.5, 0.5, 0.5)) > 0
    for axis in range(3):
        j, k = (axis + 1) % 3, (axis + 2) % 3

        def side(end: float, axis: int = axis, j: int = j) -> Map:
            def at(s: float, t: float) -> Vector:
                shares = {axis: end, j: s}
                return point(*(shares.get(n, t) for n in range(3)))

            return at

        low, high = (_grid(side(end), (counts[j], counts[k])) for end in (0.0, 1.0))
        gaps = (
            hypot(*combined((1, -1), pair))
            for rows in zip(low, high, strict=True)
            for pair in zip(*rows, strict=True)
        )
        if max(gaps) > 1e-9:
            for grid, is_out in ((high, outward), (low, not outward)):
                yield from _tiles(grid if is_out else [row[::-1] for row in grid], color)


def _grid(at: Map, counts: Sequence[int]) -> list[list[Vector]]:
    rows, columns = counts
    return [[at(i / rows, k / columns) for k in range(columns + 1)] for i in range(rows + 1)]


def _tiles(grid: Sequence[Sequence[Vector]], color: Color) -> Iterator[Face]:
    """The tiles of a grid, counterclockwise as seen along (row) × (column); none without area."""
    for lower, upper in pairwise(grid):
        for (a, b), (d, c) in zip(pairwise(lower), pairwise(upper), strict=True):
            corners = tuple(dict.fromkeys(near(p) for p in (a, d, c, b)))
            if len(corners) > 2 and _area(corners) > 1e-9:
                yield Face(corners, color)


def near(point: Vector) -> Vector:
    """Without the rounding errors that would part one corner into two."""
    x, y, z = (round(part, 9) + 0.0 for part in point)
    return (x, y, z)


def _area(corners: Sequence[Vector]) -> float:
    first, *others = corners
    edges = [combined((1, -1), (corner, first)) for corner in others]
    return hypot(*combined((1,) * (len(edges) - 1), [cross(a, b) for a, b in pairwise(edges)]))


def _tube(
    line: Map, shares: Sequence[float], color: Color, known: dict[Vector, tuple[float, ...]]
) -> Iterator[Face]:
    """A thin square tube along a line; `known` is told where its points are."""
    is_open = near(line(0.0)) != near(line(1.0))
    for ends in pairwise(shares):
        start, end = map(line, ends)
        along = unit(combined((1, -1), (end, start)))
        axis: Vector = (1.0, 0.0, 0.0) if abs(along[0]) < 0.8 else (0.0, 1.0, 0.0)
        u = unit(cross(along, axis))
        v = cross(along, u)
        around = [combined((p, q), (u, v)) for p, q in ((1, 1), (-1, 1), (-1, -1), (1, -1))]
        offsets = [scaled(_THICK, side) for side in (*around, around[0])]
        grid = [[combined((1, 1), (c, off)) for off in offsets] for c in (start, end)]
        for share, row in zip(ends, grid, strict=True):
            known.update(
                {near(p): (share, 0.0, 0.0, *off) for p, off in zip(row, offsets, strict=True)}
            )
        yield from _tiles([row[::-1] for row in grid], color)
        first, last = (tuple(map(near, row[:-1])) for row in grid)
        yield from (Face(first[::-1], color) for _ in range(ends[0] == 0.0 and is_open))
        yield from (Face(last, color) for _ in range(ends[1] == 1.0 and is_open))


def _fitted(faces: Sequence[Face], body: RigidBody, numbers: Numbers, size: float) -> Shape:
    """About the centre of mass, in the size of the figure; lengths are in units of `size`."""
    middle = [part.xreplace(numbers) for part in body.centre]
    is_known = all(part.is_number for part in middle)
    x, y, z = (float(part) / size if is_known else 0.0 for part in middle)  # else its origin
    moved = [
        Face(tuple(combined((1, -1), (p, (x, y, z))) for p in face.corners), face.color)
        for face in faces
    ]
    reach = max((hypot(*p) for face in moved for p in face.corners), default=0.0)
    if not reach or not isfinite(reach):
        return ()
    return tuple(
        Face(tuple(scaled(_SIZE / reach, p) for p in face.corners), face.color) for face in moved
    )
