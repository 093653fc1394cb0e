"""A posed scene as a drawing for any pen: strokes and labels in a plane.

The unit is the length of the unit vectors of space; labels are set in letters of TYPE_SIZE.
"""

from __future__ import annotations

from bisect import bisect
from collections.abc import Iterable, Iterator, Sequence
from itertools import pairwise, tee
from math import acos, atan2, ceil, cos, hypot, pi, radians, sin, tau

from rigidsym.formula.latex_pen import LatexPen
from rigidsym.formula.tree import Formula
from rigidsym.formula.unicode_pen import UnicodePen
from rigidsym.notes.figure.scene import (
    MANY_TURNS,
    Arc,
    Camera,
    Kind,
    Point,
    Posed,
    Vector,
    combined,
    dot,
    is_same,
)
from rigidsym.system.records import NamedTuple

Color = tuple[int, int, int]  # red, green, blue, of 255
RED = (204, 72, 58)
TYPE_SIZE = 0.15  # one em, in units of the drawing
AXIS = 1.35  # lengths of the axes drawn
NODE = 1.2

_HALF_HEIGHT = 0.5 * TYPE_SIZE  # of a label: 1 em from the foot of ψ to the head of a prime
_STEP = radians(7.5)  # between the points of an arc
_MARGIN = 0.025  # between a label and anything else
_GAPS = (0.05, 0.09, 0.14, 0.2, 0.26, 0.34, 0.42)  # between a label and what it names
_BENDS = (0, 25, -25, 50, -50, 80, -80, 110, -110)  # degrees off the direction of an axis
_BESIDE = (0, 180, 40, -40, 140, -140, 75, -75, 105, -105)  # outside an arc or inside
_ALONG = (0.5, 0.4, 0.6, 0.3, 0.7, 0.2, 0.8)  # fraction of the way along an arc


class Stroke(NamedTuple):
    """A line through points."""

    kind: Kind
    points: tuple[Point, ...]
    centre: Point | None = None  # of the tinted sector that the line bounds
    is_thin: bool = False
    is_hidden: bool = False  # behind the origin: dashed
    has_arrow: bool = False  # at its end


class Box(NamedTuple):
    """A rectangle, by its centre and half its width and height."""

    centre: Point
    half_width: float
    half_height: float

    def meets(self, other: Box) -> bool:
        (x, y), (a, b) = self.centre, other.centre
        is_beside = abs(x - a) >= self.half_width + other.half_width
        return not is_beside and abs(y - b) < self.half_height + other.half_height


class Label(NamedTuple):
    """A symbol, centred on a point."""

    kind: Kind
    symbol: Formula
    place: Point


def half_widths(symbols: Sequence[Formula]) -> list[float]:
    """Half of the width of each, in LaTeX or in Unicode, whichever is wider."""
    latex, unicode = LatexPen(), UnicodePen()
    wide, narrow = list(map(latex.write, symbols)), list(map(unicode.write, symbols))
    both = zip(wide, narrow, strict=True)
    return [TYPE_SIZE * max(one.width, 0.6 * other.width) / 2 for one, other in both]


def boxes(labels: Sequence[Label]) -> list[Box]:
    """The space that each label needs."""
    widths = half_widths([label.symbol for label in labels])
    return [Box(x.place, w, _HALF_HEIGHT) for x, w in zip(labels, widths, strict=True)]


class Facet(NamedTuple):
    """A face of a body as it is seen."""

    points: tuple[Point, ...]
    color: Color


class Drawing(NamedTuple):
    """What the pens draw: a body, the sectors of turns, then strokes, then labels."""

    strokes: tuple[Stroke, ...]
    labels: tuple[Label, ...]
    body: tuple[Facet | Stroke, ...] = ()  # the farthest first

    @property
    def bounds(self) -> tuple[Point, Point]:
        """The lower left and the upper right corner of all that is drawn."""
        points = [point for shape in (*self.strokes, *self.body) for point in shape.points]
        for box in boxes(self.labels):
            (x, y), dx, dy = box
            points += [(x - dx, y - dy), (x + dx, y + dy)]
        xs, ys = zip(*points, strict=True)
        return (min(xs), min(ys)), (max(xs), max(ys))


def drawn(scene: Posed, seen: Camera) -> Drawing:
    """The drawing of a scene, with labels that touch no line and no other label if they can."""
    axes, arcs, circles = list[Stroke](), list[Stroke](), list[Stroke]()
    named: list[Named] = []
    for arc in scene.arcs:
        points = _points(arc, seen, arc.turn.radius, 0.0, arc.angle)
        centre = seen.project(arc.centre)
        arcs.append(Stroke(kind="turn", points=points, centre=centre, has_arrow=True))
        named.append(("turn", arc.turn.name, beside(points)))
    for ray in scene.rays:
        length = AXIS if ray.kind in ("space", "body") else NODE
        end = seen.project(combined((length,), (ray.direction,)))
        is_line = ray is scene.line_of_nodes
        points = ((-end[0], -end[1]) if is_line else (0.0, 0.0), end)
        axes.append(Stroke(kind=ray.kind, points=points, has_arrow=not is_line))
        named.append((ray.kind, ray.name, beyond(points)))
    if len(scene.arcs) <= MANY_TURNS:
        first, last = scene.arcs[0], scene.arcs[-1]
        circles += _circle("space", first, seen)
        circles += () if is_same(first.axis, last.axis) else _circle("body", last, seen)
    strokes = (*circles, *_guides(scene, seen), *axes, *arcs)
    return Drawing(strokes=strokes, labels=labelled(named, strokes))


def _points(arc: Arc, seen: Camera, radius: float, start: float, end: float) -> tuple[Point, ...]:
    """Part of the circle that a point of the line describes, which is seen as an ellipse."""
    (u, v), (x, y) = (seen.project(combined((radius,), (s,))) for s in (arc.start, arc.side))
    a, b = seen.project(arc.centre)
    steps = max(2, ceil(abs(end - start) / _STEP - 1e-9))
    angles = (start + (end - start) / steps * step for step in range(steps + 1))
    return tuple((a + cos(t) * u + sin(t) * x, b + cos(t) * v + sin(t) * y) for t in angles)


def _circle(kind: Kind, arc: Arc, seen: Camera) -> Iterator[Stroke]:
    """The circle about the axis of a turn, dashed behind the plane of the picture.

    Its depth is d + s cos(t − t₀), which changes its sign at t = t₀ ± arccos(−d/s).
    """
    across, along, depth = map(seen.depth, (arc.start, arc.side, arc.centre))
    nearest, swing = atan2(along, across), hypot(across, along)
    # Circles entirely in front of the plane of the picture, or behind it, have no point of depth 0.
    half = pi if depth >= swing else 0.0 if depth <= -swing else acos(-depth / swing)
    for is_hidden, start, end in (
        (False, nearest - half, nearest + half),
        (True, nearest + half, nearest - half + tau),
    ):
        if end - start > 1e-9:
            points = _points(arc, seen, 1.0, start, end)
            yield Stroke(kind=kind, points=points, is_thin=True, is_hidden=is_hidden)


def _guides(scene: Posed, seen: Camera) -> Iterator[Stroke]:
    """Lines to the ends of arcs where there is no axis, from the centre of the arc."""
    drawn: list[Vector] = []
    for arc in scene.arcs:
        for end in (arc.before, arc.after):
            is_known = scene.named(end) is not None and abs(dot(arc.axis, end)) < 1e-6
            if not is_known and not any(is_same(end, other) for other in drawn):
                drawn.append(end)
                line = (seen.project(arc.centre), seen.project(end))
                yield Stroke(kind="guide", points=line, is_thin=True)


Place = tuple[Point, float]  # a point, and the direction in radians in which its label is seen


def beyond(line: Sequence[Point]) -> list[Place]:
    """Where the label of an axis goes: beyond its end."""
    (x0, y0), (x1, y1) = line[0], line[-1]
    return [((x1, y1), atan2(y1 - y0, x1 - x0) + radians(bend)) for bend in _BENDS]


def beside(line: Sequence[Point]) -> list[Place]:
    """Where the label of an arc goes: outside its middle, or else near it."""
    points = [line[round(share * (len(line) - 1))] for share in _ALONG]
    return [((x, y), atan2(y, x) + radians(bend)) for x, y in points for bend in _BESIDE]


Named = tuple[Kind, Formula, Sequence[Place]]  # a label, and where it may go


def labelled(named: Iterable[Named], strokes: Sequence[Stroke]) -> tuple[Label, ...]:
    """Labels at their first free places, the nearest first; else where they touch the least."""
    # Labels are placed one by one and never moved again; the first ones have the widest choice.
    named, points = tuple(named), sorted(_sampled(strokes))
    taken: list[Box] = []

    def touched(box: Box) -> Iterator[bool]:
        grown = Box(box.centre, box.half_width + _MARGIN, box.half_height + _MARGIN)
        # few of the points, which are in order from left to right, are above or below the box
        (x, y), wide, high = grown
        near = points[bisect(points, (x - wide - _MARGIN,)) : bisect(points, (x + wide + _MARGIN,))]
        yield from (True for a, b in near if abs(b - y) < high and abs(a - x) < wide)
        yield from map(grown.meets, taken)

    widths = half_widths([symbol for _, symbol, _ in named])
    for (_, _, places), half_width in zip(named, widths, strict=True):
        ways = ((gap, start, direction) for gap in _GAPS for start, direction in places)
        where, other = tee(
            Box(_shifted(half_width, start, direction, gap), half_width, _HALF_HEIGHT)
            for gap, start, direction in ways
        )
        free = next((box for box in where if not any(touched(box))), None)
        taken.append(free or min(other, key=lambda box: sum(touched(box))))
    pairs = zip(named, taken, strict=True)
    return tuple(Label(kind, symbol, box.centre) for (kind, symbol, _), box in pairs)


def _sampled(strokes: Iterable[Stroke]) -> Iterator[Point]:
    """Points along all lines, so near to each other that no label fits between them."""
    for stroke in strokes:
        for (x, y), (a, b) in pairwise(stroke.points):
            count = ceil(hypot(a - x, b - y) / _MARGIN)
            yield from ((x + (a - x) * k / count, y + (b - y) * k / count) for k in range(count))
        yield stroke.points[-1]


def _shifted(half_width: float, start: Point, direction: float, gap: float) -> Point:
    """The centre of a label whose box is `gap` away from a point, in a direction."""
    dx, dy = cos(direction), sin(direction)
    # the distance from the centre of the box to its edge in this direction
    edge = min(
        half_width / abs(dx) if abs(dx) > 1e-9 else float("inf"),
        _HALF_HEIGHT / abs(dy) if abs(dy) > 1e-9 else float("inf"),
    )
    distance = min(edge, hypot(half_width, _HALF_HEIGHT)) + gap
    return (start[0] + distance * dx, start[1] + distance * dy)
