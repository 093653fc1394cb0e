"""Where labels go so that they touch no line and no other label."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from math import atan2, cos, hypot, radians, sin

from rigidsym.mechanics.derivation import Markup
from rigidsym.notes.figure.camera import Point
from rigidsym.notes.figure.drawing import Box, Kind, Label, Segment, Stroke, box_of

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
        room = _Room(wish, segments, labels, reach)
        place = room.free()
        if place is None:
            place, met = room.least_bad()
            total += met
        labels.append(Label(kind=wish.kind, symbol=wish.symbol, place=place))
    return tuple(labels), total


def placed_freely(
    wishes: Sequence[Wish], strokes: Iterable[Stroke], reach: float
) -> tuple[Label, ...] | None:
    """The same where all places are free; None where one label would have to touch something."""
    segments = [segment for stroke in strokes for segment in stroke.segments]
    labels: list[Label] = []
    for wish in wishes:
        place = _Room(wish, segments, labels, reach).free()
        if place is None:
            return None
        labels.append(Label(kind=wish.kind, symbol=wish.symbol, place=place))
    return tuple(labels)


class _Room:
    """The places for one label, and what is near enough to be in its way."""

    def __init__(
        self, wish: Wish, segments: Sequence[Segment], labels: Sequence[Label], reach: float
    ) -> None:
        self.boxes = {
            place: box_of(wish.symbol, place).grown(_MARGIN) for place in wish.places(reach)
        }
        around = _around(self.boxes.values())
        self.segments = [segment for segment in segments if around.is_crossed_by(segment)]
        self.taken = [label.box for label in labels if around.meets(label.box)]

    def free(self) -> Point | None:
        """The first place where nothing is in the way."""
        for place, box in self.boxes.items():
            if not any(map(box.is_crossed_by, self.segments)) and not any(
                map(box.meets, self.taken)
            ):
                return place
        return None

    def least_bad(self) -> tuple[Point, int]:
        """The place where the fewest things are in the way, and how many."""
        met = {place: self._met(box) for place, box in self.boxes.items()}
        best = min(met, key=met.__getitem__)
        return best, met[best]

    def _met(self, box: Box) -> int:
        return sum(map(box.is_crossed_by, self.segments)) + sum(map(box.meets, self.taken))


def _around(boxes: Iterable[Box]) -> Box:
    """One box that holds them all."""
    sides = [
        (x - box.half_width, y - box.half_height, x + box.half_width, y + box.half_height)
        for box in boxes
        for x, y in (box.centre,)
    ]
    left, low, right, high = zip(*sides, strict=True)
    x0, y0, x1, y1 = min(left), min(low), max(right), max(high)
    return Box(((x0 + x1) / 2, (y0 + y1) / 2), (x1 - x0) / 2 + 1e-9, (y1 - y0) / 2 + 1e-9)


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
