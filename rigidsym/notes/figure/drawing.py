"""A drawing as data, for any pen: strokes, areas and labels in a plane.

The unit is the length of the unit vectors of space; a label is set in letters of TYPE_SIZE.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from itertools import chain, pairwise
from typing import Literal

from rigidsym.mechanics.derivation import Markup
from rigidsym.notes.figure.camera import Point
from rigidsym.notes.layout.text_width import columns, ems

Kind = Literal["space", "body", "node", "vector", "turn", "guide"]
Segment = tuple[Point, Point]

TYPE_SIZE = 0.15  # one em, in units of the drawing
_HEIGHT = 1.0  # of a label, in ems: from the foot of ψ to the head of a prime


@dataclass(frozen=True, kw_only=True, slots=True)
class Stroke:
    """A line through points."""

    kind: Kind
    points: tuple[Point, ...]
    is_thin: bool = False
    is_hidden: bool = False  # behind what is in front of it: dashed
    has_arrow: bool = False  # at its end

    @property
    def segments(self) -> Iterator[Segment]:
        return pairwise(self.points)


@dataclass(frozen=True, kw_only=True, slots=True)
class Area:
    """A tinted area within a closed line."""

    kind: Kind
    points: tuple[Point, ...]


@dataclass(frozen=True, slots=True)
class Box:
    """A rectangle, by its centre and the halves of its sides."""

    centre: Point
    half_width: float
    half_height: float

    def grown(self, margin: float) -> Box:
        return Box(self.centre, self.half_width + margin, self.half_height + margin)

    def meets(self, other: Box) -> bool:
        dx, dy = (abs(a - b) for a, b in zip(self.centre, other.centre, strict=True))
        return dx < self.half_width + other.half_width and dy < self.half_height + other.half_height

    def is_crossed_by(self, segment: Segment) -> bool:
        """Whether any point of the segment lies inside (the test of Liang and Barsky)."""
        (x0, y0), (x1, y1) = segment
        (x, y), start, end = self.centre, 0.0, 1.0
        if min(x0, x1) > x + self.half_width or max(x0, x1) < x - self.half_width:
            return False
        if min(y0, y1) > y + self.half_height or max(y0, y1) < y - self.half_height:
            return False
        for position, change, half in (
            (x0 - x, x1 - x0, self.half_width),
            (y0 - y, y1 - y0, self.half_height),
        ):
            if change == 0:
                continue
            ends = sorted(((-half - position) / change, (half - position) / change))
            start, end = max(start, ends[0]), min(end, ends[1])
        return start <= end


@dataclass(frozen=True, kw_only=True, slots=True)
class Label:
    """A symbol, centred on a place."""

    kind: Kind
    symbol: Markup
    place: Point

    @property
    def box(self) -> Box:
        return box_of(self.symbol, self.place)


def box_of(symbol: Markup, place: Point) -> Box:
    """The room that a symbol takes around a place, in the wider of its two writings."""
    return Box(place, _half_width(symbol), TYPE_SIZE * _HEIGHT / 2)


@lru_cache(maxsize=256)
def _half_width(symbol: Markup) -> float:
    return TYPE_SIZE * max(ems(symbol.latex), 0.6 * columns(symbol.text)) / 2


@dataclass(frozen=True, kw_only=True, slots=True)
class Drawing:
    """What the pens draw: areas first, then strokes, then labels."""

    areas: tuple[Area, ...]
    strokes: tuple[Stroke, ...]
    labels: tuple[Label, ...]

    @property
    def bounds(self) -> tuple[Point, Point]:
        """The lower left and the upper right corner of all that is drawn."""
        points = list(chain.from_iterable(stroke.points for stroke in self.strokes))
        for box in (label.box for label in self.labels):
            x, y = box.centre
            points += [
                (x - box.half_width, y - box.half_height),
                (x + box.half_width, y + box.half_height),
            ]
        xs, ys = zip(*points, strict=True)
        return (min(xs), min(ys)), (max(xs), max(ys))
