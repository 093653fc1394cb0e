"""A scene of turns as a drawing: seen from where it is clearest, with labels that touch nothing."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cache
from itertools import chain, combinations, groupby, pairwise, product
from math import hypot, radians, tau

from rigidsym.mechanics.derivation import Markup
from rigidsym.notes.figure.camera import Camera, Point, Vector, camera, is_same, scaled, sweep
from rigidsym.notes.figure.drawing import Area, Drawing, Kind, Stroke
from rigidsym.notes.figure.labels import Wish, placed, placed_freely
from rigidsym.notes.figure.scene import Arc, Names, Ray, Scene, scene_of

_AXIS = 1.35  # lengths
_NODE = 1.2
_SCALES = (1.0, 1.15, 0.85, 1.25, 0.7, 1.4, 1.55)  # of the radii of the arcs, tried in turn
_REACHES = (0.2, 0.34, 0.5)  # of labels: the farther, the harder to tell what they name
_CIRCLE_STEPS = 60
_AZIMUTHS = range(12, 82, 6)  # degrees: the first axis comes to the front, the second to the right
_ELEVATIONS = (16, 22, 28, 34)
_ANGLES = tuple(product((35, 50, 65), repeat=3))  # degrees, of turns 1, 2, 3, 1, 2, ...
_ORIGIN: Vector = (0.0, 0.0, 0.0)


@cache
def best_view(
    axes: tuple[Vector, ...], fixed: tuple[float | None, ...]
) -> tuple[tuple[float, ...], Camera]:
    """Angles for the turns that are not fixed, and a camera, that show all as clearly as may be."""
    nameless = Names(angles=(Markup("", ""),) * len(axes))
    coarse = [camera(a, e) for a in _AZIMUTHS[::3] for e in _ELEVATIONS[::2]]
    fine = [camera(a, e) for a in _AZIMUTHS for e in _ELEVATIONS]
    scenes = {angles: scene_of(axes, angles, nameless) for angles in _shown_angles(fixed)}
    angles, _ = max(product(scenes, coarse), key=lambda shot: _clarity(scenes[shot[0]], shot[1]))
    return angles, max(fine, key=lambda view: _clarity(scenes[angles], view))


def _shown_angles(fixed: Sequence[float | None]) -> Iterator[tuple[float, ...]]:
    """Angles to choose from: the fixed ones as they are, acute ones for all others."""
    for acute in _ANGLES:
        yield tuple(
            radians(acute[k % len(acute)]) if angle is None else angle
            for k, angle in enumerate(fixed)
        )


def _clarity(scene: Scene, view: Camera) -> float:
    """How far apart the ends of all lines appear, and how open the arcs: the worst case counts."""
    ends = [view.project(ray.direction) for ray in scene.rays]
    ends += [(-x, -y) for (x, y), ray in zip(ends, scene.rays, strict=True) if ray.kind == "node"]
    pairs = list(combinations(ends, 2))
    return min(
        min(hypot(a[0] - b[0], a[1] - b[1]) for a, b in pairs),
        min(hypot(*end) for end in ends),
        min(2 * _between(a, b) for a, b in pairs),
        min(1.5 * _openness(arc, view) for arc in scene.arcs),
    )


def _openness(arc: Arc, view: Camera) -> float:
    """Twice the area that the arc of a unit circle spans in the picture."""
    (x0, y0), (x1, y1) = view.project(arc.start), view.project(arc.end)
    return abs(x0 * y1 - x1 * y0)


def _between(a: Point, b: Point) -> float:
    """The sine of the angle between two directions, 1 where it is obtuse."""
    if a[0] * b[0] + a[1] * b[1] < 0:
        return 1.0
    return abs(a[0] * b[1] - a[1] * b[0]) / (hypot(*a) * hypot(*b) + 1e-9)


def drawn(scene: Scene, view: Camera) -> Drawing:
    """The drawing whose labels touch nothing; the arcs give way, by their radii."""
    tries = list(product(_REACHES, _SCALES))
    for reach, scale in tries:
        strokes, wishes, areas = _with_arcs(scene, view, scale)
        labels = placed_freely(wishes, strokes, reach)
        if labels is not None:
            return Drawing(areas=areas, strokes=strokes, labels=labels)
    crowded = [_crowded(scene, view, scale, reach) for reach, scale in tries]
    return min(crowded, key=lambda choice: choice[1])[0]


def _crowded(scene: Scene, view: Camera, scale: float, reach: float) -> tuple[Drawing, int]:
    """The drawing where no choice leaves all labels free, and how much they touch."""
    strokes, wishes, areas = _with_arcs(scene, view, scale)
    labels, met = placed(wishes, strokes, reach)
    return Drawing(areas=areas, strokes=strokes, labels=labels), met


def _with_arcs(
    scene: Scene, view: Camera, scale: float
) -> tuple[tuple[Stroke, ...], tuple[Wish, ...], tuple[Area, ...]]:
    """All but the labels, with arcs of larger or smaller radius; and the labels wished for."""
    axes = [_axis(ray, view) for ray in scene.rays]
    arcs = [_projected(arc.path(scale), view) for arc in scene.arcs]
    strokes = (
        *_circles(scene, view),
        *_guides(scene, view),
        *axes,
        *(Stroke(kind="turn", points=points, has_arrow=True) for points in arcs),
    )
    wishes = (
        *(
            Wish(kind="turn", symbol=arc.name, line=points, is_at_end=False)
            for arc, points in zip(scene.arcs, arcs, strict=True)
        ),
        *(
            Wish(kind=ray.kind, symbol=ray.name, line=stroke.points, is_at_end=True)
            for ray, stroke in zip(scene.rays, axes, strict=True)
        ),
    )
    areas = (Area(kind="turn", points=(view.project(_ORIGIN), *points)) for points in arcs)
    return strokes, wishes, tuple(areas)


def _projected(path: Iterator[Vector], view: Camera) -> tuple[Point, ...]:
    return tuple(map(view.project, path))


def _axis(ray: Ray, view: Camera) -> Stroke:
    if ray.kind == "node":
        ends = (scaled(-_NODE, ray.direction), scaled(_NODE, ray.direction))
        return Stroke(kind="node", points=tuple(map(view.project, ends)))
    ends = (_ORIGIN, scaled(_NODE if ray.kind == "vector" else _AXIS, ray.direction))
    return Stroke(kind=ray.kind, points=tuple(map(view.project, ends)), has_arrow=True)


def _circles(scene: Scene, view: Camera) -> Iterator[Stroke]:
    """The circles in which the first and the last turn take their axes, dashed at the back."""
    first, last = scene.arcs[0], scene.arcs[-1]
    yield from _circle("space", first, view)
    if not is_same(first.axis, last.axis):
        yield from _circle("body", last, view)


def _circle(kind: Kind, arc: Arc, view: Camera) -> Iterator[Stroke]:
    points = list(sweep(arc.start, arc.axis, tau, _CIRCLE_STEPS))
    pairs = list(pairwise(points))
    runs = groupby(pairs, key=lambda pair: view.depth(pair[0]) + view.depth(pair[1]) < 0)
    for is_hidden, run in runs:
        pieces = list(run)
        line = (*(a for a, _ in pieces), pieces[-1][1])
        yield Stroke(
            kind=kind,
            points=tuple(map(view.project, line)),
            is_thin=True,
            is_hidden=is_hidden,
        )


def _guides(scene: Scene, view: Camera) -> Iterator[Stroke]:
    """Lines to the ends of arcs that no axis leads to."""
    drawn: list[Vector] = []
    for end in chain.from_iterable((arc.start, arc.end) for arc in scene.arcs):
        if scene.named(end) is None and not any(is_same(end, other) for other in drawn):
            drawn.append(end)
            line = (view.project(_ORIGIN), view.project(end))
            yield Stroke(kind="guide", points=line, is_thin=True)
