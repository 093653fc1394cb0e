"""Charts of numbers as drawings: curves over an axis, curves on an ellipsoid, drawings in a row."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import cycle, groupby, pairwise
from math import cos, floor, hypot, log10, pi, sin
from typing import NamedTuple

from rigidsym.formula.reader import decimal
from rigidsym.formula.tree import Formula
from rigidsym.notes.figure.camera import (
    STANDARD,
    Point,
    Vector,
    camera,
    combined,
    cross,
    dot,
    unit,
)
from rigidsym.notes.figure.drawing import TYPE_SIZE, Drawing, Label, Stroke, half_widths
from rigidsym.notes.figure.scene import Kind

_KINDS: tuple[Kind, ...] = ("body", "node", "turn", "vector")  # of the curves of a chart
_TICK = 0.05  # its length
_LINE = 1.3 * TYPE_SIZE  # between labels one above the other
_GAP = 0.3  # between drawings in a row
_DOT = 0.035  # half the width of a mark
_FINEST = 0.012  # between the points of a curve
_EYE = camera(azimuth=55, elevation=26)
_RADIUS = 0.88  # of the largest semi-axis of an ellipsoid
_REACH = 1.35  # of its axes
_SIDES = 72  # of the polygon that a circle is


class Range(NamedTuple):
    """An axis of a chart: its ends, and the numbers written beside it."""

    low: float
    high: float
    ticks: tuple[float, ...]

    @classmethod
    def of(cls, values: Iterable[float], most: int = 5) -> Range:
        """The whole values, with at most so many ticks at 1, 2 or 5 times a power of ten."""
        found = list(values)
        low, high = min(found), max(found)
        if high - low < 1e-9 * (1 + abs(high)):
            low, high = low - 1, high + 1
        power = 10.0 ** floor(log10((high - low) / most))
        step = next(f * power for f in (1, 2, 5, 10) if (high - low) <= most * f * power)
        first, last = -floor(-low / step + 1e-6), floor(high / step + 1e-6)
        return cls(low, high, tuple(float(f"{k * step:.9g}") for k in range(first, last + 1)))


def chart(
    across: Range, curves: Sequence[tuple[Formula, Sequence[Point]]], size: Point, along: Formula
) -> Drawing:
    """Curves over one axis, which `along` names, each with its name behind its last point."""
    up = Range.of(y for _, points in curves for _, y in points)
    width, height = size
    strokes, labels = [], []

    def at(x: float, y: float) -> Point:
        return (
            width * (x - across.low) / (across.high - across.low),
            height * (y - up.low) / (up.high - up.low),
        )

    strokes.append(Stroke("space", ((0.0, 0.0), (width, 0.0)), is_thin=True))
    strokes.append(Stroke("space", ((0.0, 0.0), (0.0, height)), is_thin=True))
    for value in across.ticks:
        x, _ = at(value, up.low)
        strokes.append(Stroke("space", ((x, 0.0), (x, -_TICK)), is_thin=True))
        labels.append(Label("space", decimal(value), (x, -_TICK - 0.6 * TYPE_SIZE)))
    for value in up.ticks:
        _, y = at(across.low, value)
        strokes.append(Stroke("space", ((0.0, y), (-_TICK, y)), is_thin=True))
        number = decimal(value)
        (half_width,) = half_widths([number])
        labels.append(Label("space", number, (-1.5 * _TICK - half_width, y)))
    labels.append(Label("space", along, (width / 2, -_TICK - 1.9 * TYPE_SIZE)))
    if len(curves) == 1:
        ((name, _),) = curves
        labels.append(Label("body", name, (0.0, height + 0.8 * TYPE_SIZE)))
    for kind, (_, points) in zip(cycle(_KINDS), curves, strict=False):
        strokes.append(Stroke(kind, tuple(_thinned(at(*point) for point in points))))
    if len(curves) > 1:
        ends = [at(*points[-1])[1] for _, points in curves]
        names = [name for name, _ in curves]
        shown = zip(cycle(_KINDS), names, half_widths(names), _apart(ends), strict=False)
        labels += [Label(kind, name, (width + _TICK + w, y)) for kind, name, w, y in shown]
    return Drawing(tuple(strokes), tuple(labels))


def _apart(heights: Sequence[float]) -> list[float]:
    """The heights moved up and down so that their labels do not touch."""
    order = sorted(range(len(heights)), key=heights.__getitem__)
    found = list(heights)
    for low, high in pairwise(order):
        found[high] = max(found[high], found[low] + _LINE)
    shift = sum(a - b for a, b in zip(found, heights, strict=True)) / len(found)
    return [height - shift for height in found]


def on_ellipsoid(
    paths: Sequence[Sequence[Vector]],
    circles: Iterable[Sequence[Vector]],
    size: Vector,
    axes: Sequence[tuple[Formula, int]],
) -> Drawing:
    """Curves and circles on an ellipsoid, given on the unit sphere, dashed where they are behind.

    `size` holds the semi-axes, the largest being 1; `axes` names those that are drawn.
    """
    surface = _Surface(size)
    strokes = [Stroke("guide", surface.outline, is_thin=True)]
    strokes += [part for circle in circles for part in surface.parts("guide", circle)]
    labels = []
    for name, k in axes:
        stem = (surface.at(STANDARD[k]), surface.at(STANDARD[k], _REACH))
        strokes.append(Stroke("space", stem, has_arrow=True))
        labels.append(Label("space", name, surface.at(STANDARD[k], _REACH + 0.16)))
    for path in paths:
        strokes += surface.parts("body", path)
        if len(paths) == 1 and surface.is_front(path[0]):
            strokes.append(mark(surface.at(path[0])))
    return Drawing(tuple(strokes), tuple(labels))


class _Surface(NamedTuple):
    """An ellipsoid as the camera sees it; its points are named by those of the unit sphere."""

    size: Vector

    def at(self, point: Vector, reach: float = 1.0) -> Point:
        x, y, z = (_RADIUS * reach * s * p for s, p in zip(self.size, point, strict=True))
        return _EYE.project((x, y, z))

    @property
    def _toward(self) -> Vector:
        """The normal of the plane, in the unit sphere, of what is seen edge on."""
        x, y, z = (t / s for t, s in zip(_EYE.toward, self.size, strict=True))
        return unit((x, y, z))

    def is_front(self, point: Vector) -> bool:
        return dot(self._toward, point) > -1e-9

    @property
    def outline(self) -> tuple[Point, ...]:
        return tuple(map(self.at, circle(self._toward, 0.0)))

    def parts(self, kind: Kind, path: Sequence[Vector]) -> Iterator[Stroke]:
        """The path in pieces, each in front or behind; they share their ends."""
        is_thin = kind == "guide"
        steps = list(pairwise(path))
        for is_front, group in groupby(steps, lambda step: self.is_front(step[0])):
            held = list(group)
            points = [self.at(held[0][0]), *(self.at(end) for _, end in held)]
            yield Stroke(
                kind,
                tuple(_thinned(points)),
                is_thin=is_thin or not is_front,
                is_hidden=not is_front,
            )


def circle(normal: Vector, height: float) -> list[Vector]:
    """The circle of the unit sphere at this height along a normal."""
    least = min(STANDARD, key=lambda axis: abs(dot(axis, normal)))
    across = unit(cross(normal, least))
    frame = (normal, across, cross(normal, across))
    radius = max(0.0, 1 - height * height) ** 0.5
    turns = (2 * pi * k / _SIDES for k in range(_SIDES + 1))
    return [combined((height, radius * cos(turn), radius * sin(turn)), frame) for turn in turns]


def mark(point: Point) -> Stroke:
    """A small diamond."""
    x, y = point
    corners = ((x - _DOT, y), (x, y + _DOT), (x + _DOT, y), (x, y - _DOT), (x - _DOT, y))
    return Stroke("vector", corners)


def in_a_row(drawings: Sequence[Drawing]) -> Drawing:
    """Side by side, their middles at the same height."""
    strokes: list[Stroke] = []
    labels: list[Label] = []
    right = 0.0
    for drawing in drawings:
        (left, low), (end, high) = drawing.bounds
        dx, dy = right - left, -(low + high) / 2
        strokes += [
            stroke._replace(points=tuple((x + dx, y + dy) for x, y in stroke.points))
            for stroke in drawing.strokes
        ]
        labels += [
            label._replace(place=(label.place[0] + dx, label.place[1] + dy))
            for label in drawing.labels
        ]
        right += end - left + _GAP
    return Drawing(tuple(strokes), tuple(labels))


def _thinned(points: Iterable[Point]) -> Iterator[Point]:
    """Without points that no eye could tell from their neighbours; the ends stay."""
    kept: Point | None = None
    last: Point | None = None
    for last in points:
        if kept is None or hypot(last[0] - kept[0], last[1] - kept[1]) >= _FINEST:
            kept = last
            yield last
    if last is not None and last != kept:
        yield last
