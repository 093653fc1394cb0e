"""Charts of numbers as drawings: curves over an axis, curves on an ellipsoid, drawings in a row."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import cycle, pairwise
from math import cos, floor, log10, pi, sin
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from rigidsym.formula.reader import decimal
from rigidsym.formula.tree import Formula
from rigidsym.notes.figure.body_mesh import Vector, unit
from rigidsym.notes.figure.camera import Point, camera
from rigidsym.notes.figure.drawing import (
    TYPE_SIZE,
    Drawing,
    Label,
    Named,
    Stroke,
    beyond,
    half_widths,
    labelled,
)
from rigidsym.notes.figure.scene import Kind

_KINDS: tuple[Kind, ...] = ("body", "node", "turn", "vector")  # of the curves of a chart
_TICK = 0.05  # its length
_GAP = 0.3  # between drawings in a row
_DOT = 0.035  # half the width of a mark
_FINEST = 0.012  # between the points of a curve
_RIGHT, _UP, _TOWARD = np.array(camera(azimuth=55, elevation=26))
_RADIUS = 0.88  # of the largest semi-axis of an ellipsoid
_REACH = 1.35  # of its axes
_SIDES = 72  # of the polygon that a circle is

Curve = NDArray[Any]  # points (n, 2)


class Range(NamedTuple):
    """An axis of a chart: its ends, and the numbers written beside it."""

    low: float
    high: float
    ticks: tuple[float, ...]

    @classmethod
    def of(cls, values: Any, most: int = 5) -> Range:
        """The whole values, with at most so many ticks at 1, 2 or 5 times a power of ten."""
        low, high = float(np.min(values)), float(np.max(values))
        if high - low < 1e-9 * (1 + abs(high)):
            low, high = low - 1, high + 1
        power = 10.0 ** floor(log10((high - low) / most))
        step = next(f * power for f in (1, 2, 5, 10) if (high - low) <= most * f * power)
        # The 1e-6 keeps ticks at the ends that rounding has moved outside.
        first, last = -floor(-low / step + 1e-6), floor(high / step + 1e-6)
        return cls(low, high, tuple(float(f"{k * step:.9g}") for k in range(first, last + 1)))


def chart(
    curves: Sequence[Curve], size: Point, along: Formula, names: Sequence[Formula]
) -> Drawing:
    """Curves over one axis that `along` names.

    `names` are those of the curves, behind their ends; that of a single curve names its axis.
    """
    across, up = (Range.of(np.concatenate(curves)[:, k]) for k in (0, 1))
    origin, scale = (across.low, up.low), np.divide(size, np.ptp([across[:2], up[:2]], axis=1))
    width, height = size
    strokes = [
        Stroke("space", ((0.0, 0.0), (width, 0.0)), is_thin=True),
        Stroke("space", ((0.0, 0.0), (0.0, height)), is_thin=True),
    ]
    labels = [Label("space", along, (width / 2, -_TICK - 1.9 * TYPE_SIZE))]
    for value in across.ticks:
        x = float((value - across.low) * scale[0])
        strokes.append(Stroke("space", ((x, 0.0), (x, -_TICK)), is_thin=True))
        labels.append(Label("space", decimal(value), (x, -_TICK - 0.6 * TYPE_SIZE)))
    for value in up.ticks:
        y, number = float((value - up.low) * scale[1]), decimal(value)
        (half_width,) = half_widths([number])
        strokes.append(Stroke("space", ((0.0, y), (-_TICK, y)), is_thin=True))
        labels.append(Label("space", number, (-1.5 * _TICK - half_width, y)))
    lines = [
        Stroke(kind, thinned((curve - origin) * scale))
        for kind, curve in zip(cycle(_KINDS), curves, strict=False)
    ]
    if len(names) == 1:
        labels.append(Label("space", names[0], (0.0, height + 0.8 * TYPE_SIZE)))
    else:
        named: list[Named] = [
            (line.kind, name, beyond(((0.0, line.points[-1][1]), line.points[-1])))
            for name, line in zip(names, lines, strict=True)
        ]
        labels += labelled(named, lines)
    return Drawing((*strokes, *lines), tuple(labels))


def on_ellipsoid(
    paths: Sequence[Vector],
    circles: Iterable[Vector],
    size: Vector,
    axes: Sequence[tuple[Formula, int]],
) -> Drawing:
    """Curves and circles on an ellipsoid, as points (n, 3) of the unit sphere; dashed behind.

    `size` holds the semi-axes, the largest being 1; `axes` names those that are drawn.
    """
    surface = _Surface(size)
    edge = circle(surface.toward, 0.0)
    strokes = [Stroke("guide", thinned(surface.at(edge)), is_thin=True)]
    strokes += [part for line in circles for part in surface.parts("guide", line)]
    labels = []
    for name, k in axes:
        foot, tip, beyond_it = (surface.at(r * np.eye(3)[k]) for r in (1.0, _REACH, _REACH + 0.16))
        strokes.append(Stroke("space", (_point(foot), _point(tip)), has_arrow=True))
        labels.append(Label("space", name, _point(beyond_it)))
    for path in paths:
        strokes += surface.parts("body", path)
        if len(paths) == 1 and surface.toward @ path[0] > 0:
            strokes.append(_mark(*surface.at(path[0])))
    return Drawing(tuple(strokes), tuple(labels))


class _Surface(NamedTuple):
    """An ellipsoid as the camera sees it; its points are named by those of the unit sphere."""

    size: Vector

    def at(self, points: Vector) -> Curve:
        """Points (..., 3) in the picture."""
        return (_RADIUS * self.size * points) @ np.array([_RIGHT, _UP]).T

    @property
    def toward(self) -> Vector:
        """The normal of the plane, in the unit sphere, of what is seen edge on."""
        # A point S u of the ellipsoid has the normal S⁻¹ u. It is seen edge on if toward·S⁻¹ u = 0,
        # that is, if u lies in the plane with the normal S⁻¹ toward.
        return unit(_TOWARD / self.size)

    def parts(self, kind: Kind, path: Vector) -> Iterator[Stroke]:
        """The path in pieces, each in front or behind; they share their ends."""
        seen, is_front = self.at(path), path[:-1] @ self.toward > -1e-9
        cuts = [0, *(np.flatnonzero(np.diff(is_front)) + 1), len(is_front)]
        for start, end in pairwise(cuts):
            is_hidden = not is_front[start]
            yield Stroke(
                kind,
                thinned(seen[start : end + 1]),
                is_thin=kind == "guide" or is_hidden,
                is_hidden=is_hidden,
            )


def circle(normal: Vector, height: float) -> Vector:
    """The circle (n, 3) of the unit sphere at this height along a normal."""
    # The axis with the smallest component of the normal is the farthest from parallel to it.
    across = unit(np.cross(normal, np.eye(3)[np.abs(normal).argmin()]))
    frame = np.array([normal, across, np.cross(normal, across)])
    radius = max(0.0, 1 - height * height) ** 0.5
    turns = (2 * pi * k / _SIDES for k in range(_SIDES + 1))
    return np.array([(height, radius * cos(turn), radius * sin(turn)) for turn in turns]) @ frame


def _mark(x: float, y: float) -> Stroke:
    """A small diamond."""
    corners = ((x - _DOT, y), (x, y + _DOT), (x + _DOT, y), (x, y - _DOT), (x - _DOT, y))
    return Stroke("vector", tuple((float(x), float(y)) for x, y in corners))


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


def _point(row: Curve) -> Point:
    x, y = row.tolist()
    return (x, y)


def thinned(curve: Curve) -> tuple[Point, ...]:
    """Without points that no eye could tell from their neighbours; the ends stay."""
    kept = [0]
    for k in range(1, len(curve)):
        if np.hypot(*(curve[k] - curve[kept[-1]])) >= _FINEST:
            kept.append(k)
    kept += [len(curve) - 1] * (kept[-1] != len(curve) - 1)
    return tuple(map(_point, curve[kept]))
