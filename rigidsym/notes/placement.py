"""Where labels go so that they touch no line and no other label."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from math import atan2, cos, hypot, radians, sin

from rigidsym.mechanics.derivation import Markup
from rigidsym.notes.drawing import Box, Kind, Label, Segment, Stroke, box_of
from rigidsym.notes.space import Point

_MARGIN = 0.025  # between a label and anything else
_GAPS = (0.05, 0.09, 0.14, 0.2, 0.26, 0.34, 0.42)  # between a label and what it names
_BENDS = (0, 25, -25, 50, -50, 80, -80, 110, -110)  # degrees off the direction that is wished for
_BESIDE = (0, 180, 40, -40, 140, -140)  # outside an arc or inside
_ALONG = (0.5, 0.4, 0.6, 0.3, 0.7, 0.2, 0.8)  # of the way along a line


@dataclass(frozen=True, kw_only=True, slots=True)
class Wish:
    """A label that wants a place: beyond the end of a line, or beside the middle of one."""

    kind: Kind
    symbol: Markup
    line: tuple[Point, ...]
    is_at_end: bool

    def places(self, reach: float) -> Iterator[Point]:
        """The places for it that are no farther than `reach`, the better before the worse."""
        for gap in (gap for gap in _GAPS if gap <= reach):
            for start, direction in self._stands():
                yield _beside(self.symbol, start, direction, gap)

    def _stands(self) -> Iterator[tuple[Point, float]]:
        """A point of the line and the direction, in radians, in which the label is seen from it."""
        if self.is_at_end:
            outward = _direction(self.line[0], self.line[-1])
            for bend in _BENDS:
                yield self.line[-1], outward + radians(bend)
            return
        for share in _ALONG:
            place = self.line[round(share * (len(self.line) - 1))]
            outward = _direction((0.0, 0.0), place)
            for bend in _BESIDE:
                yield place, outward + radians(bend)


def placed(
    wishes: Sequence[Wish], strokes: Iterable[Stroke], reach: float
) -> tuple[tuple[Label, ...], int]:
    """A label for each wish, in the order of the wishes: the first place that is free.

    Where none is free, the one that meets the fewest lines and labels. With the labels comes how
    many lines and labels they meet in all.
    """
    segments = [segment for stroke in strokes for segment in stroke.segments]
    labels: list[Label] = []
    total = 0
    for wish in wishes:
        taken = [label.box for label in labels]
        place, met = _best(wish, segments, taken, reach)
        labels.append(Label(kind=wish.kind, symbol=wish.symbol, place=place))
        total += met
    return tuple(labels), total


def _best(
    wish: Wish, segments: Sequence[Segment], taken: Sequence[Box], reach: float
) -> tuple[Point, int]:
    """The first place that is free, or the least bad, and how many things are in its way."""
    boxes = {place: box_of(wish.symbol, place).grown(_MARGIN) for place in wish.places(reach)}
    for place, box in boxes.items():
        if not any(map(box.is_crossed_by, segments)) and not any(map(box.meets, taken)):
            return place, 0
    met = {
        place: sum(map(box.is_crossed_by, segments)) + sum(map(box.meets, taken))
        for place, box in boxes.items()
    }
    best = min(met, key=met.__getitem__)
    return best, met[best]


def _beside(symbol: Markup, start: Point, direction: float, gap: float) -> Point:
    """The centre of a label whose box is `gap` away from a point, in a direction."""
    dx, dy = cos(direction), sin(direction)
    box = box_of(symbol, start)
    # as far as the edge of the box is from its centre in this direction
    reach = min(
        box.half_width / abs(dx) if abs(dx) > 1e-9 else float("inf"),
        box.half_height / abs(dy) if abs(dy) > 1e-9 else float("inf"),
    )
    distance = min(reach, hypot(box.half_width, box.half_height)) + gap
    return (start[0] + distance * dx, start[1] + distance * dy)


def _direction(start: Point, end: Point) -> float:
    return atan2(end[1] - start[1], end[0] - start[0])
