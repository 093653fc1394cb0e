"""What the figure of a rotation shows, in space: axes with their names, and an arc for each turn.

A product of turns is read from left to right; each turn is about an axis that the turns before it
have moved. Directions are given by their components in the frame after a number of turns, so one
scene serves all angles: a note draws it at those of its view, the live page at those of its
sliders. Vectors are plain floats, since a figure has a dozen of them: importing NumPy would take
longer than deriving the rotation.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cached_property, lru_cache
from itertools import combinations, pairwise
from math import cos, hypot, radians, sin
from typing import Literal

import sympy as sp

from rigidsym.formula.letters import Letters
from rigidsym.formula.reader import formula
from rigidsym.formula.scalars import formula_of
from rigidsym.formula.tree import Formula, Numeral, Symbol
from rigidsym.models.rotation import AXES, RotationModel, Turn
from rigidsym.notes.letters import VECTOR, length_of
from rigidsym.system.records import NamedTuple, Record

Vector = tuple[float, float, float]
Point = tuple[float, float]
Frame = tuple[Vector, Vector, Vector]  # three orthonormal axes

STANDARD: Frame = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
Kind = Literal["space", "body", "node", "vector", "turn", "guide"]

MOST_TURNS = 5  # more would be a tangle
MANY_TURNS, _NEARER = 3, 1.2  # the scale of the figure of more than these
BODY = tuple(Symbol(axis, prime="′") for axis in AXES)
RADII = (0.6, 0.78, 0.46, 0.7, 0.38)  # of the arcs; those of consecutive turns differ

_SPACE = tuple(map(Symbol, AXES))
_VIEWS = (  # angles of the turns, azimuth and elevation in degrees; the clearest one is taken
    ((50, 40, 40, 40, 65), 28, 22),
    ((60, 45, 60, 65, 40), 73, 18),
    ((60, 35, 60, 45, 35), 28, 24),
    ((60, 60, 60, 55, 45), 34, 18),
    ((30, 65, 50, 65, 65), 61, 26),
    ((30, 60, 30, 50, 55), 16, 30),
    ((65, 40, 45, 40, 35), 55, 30),
    ((35, 30, 35, 30, 50), 28, 18),
)
_VIEWS_DOWN = (((40, 25, 35, 40, 40), -100, 24),)  # from the left wing's side, above the ground


def dot(a: Vector, b: Vector) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Vector, b: Vector) -> Vector:
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def combined(factors: Sequence[float], vectors: Sequence[Sequence[float]]) -> Vector:
    """The linear combination Σ c_k v_k; of the axes of a frame, a vector from its components."""
    x = y = z = 0.0
    for c, (a, b, d) in zip(factors, vectors, strict=True):
        x, y, z = x + c * a, y + c * b, z + c * d
    return (x, y, z)


def unit(a: Sequence[float]) -> Vector:
    return combined((1 / hypot(*a),), (a,))


def turned(a: Vector, axis: Vector, angle: float) -> Vector:
    """The vector rotated right-handedly about a unit axis, by an angle in radians (Rodrigues)."""
    # a cos α + (n × a) sin α + n (n·a)(1 − cos α)
    along = (1 - cos(angle)) * dot(axis, a)
    return combined((cos(angle), sin(angle), along), (a, cross(axis, a), axis))


def frames(axes: Sequence[Vector], angles: Sequence[float]) -> Iterator[Frame]:
    """The frame of space, and the frame after each turn; axes have components before the turn."""
    frame = STANDARD
    yield frame
    for axis, angle in zip(axes, angles, strict=True):
        about = combined(axis, frame)
        x, y, z = (turned(a, about, angle) for a in frame)
        frame = (x, y, z)
        yield frame


def is_same(a: Vector, b: Vector) -> bool:
    return abs(a[0] - b[0]) < 1e-6 and abs(a[1] - b[1]) < 1e-6 and abs(a[2] - b[2]) < 1e-6


class Camera(NamedTuple):
    """Parallel projection; the third axis of space is vertical in the picture, up or down."""

    right: Vector
    up: Vector
    toward: Vector  # from the origin to the viewer

    def project(self, a: Vector) -> Point:
        return (dot(self.right, a), dot(self.up, a))

    def depth(self, a: Vector) -> float:
        """Distance from the picture plane toward the viewer; negative behind the origin."""
        return dot(self.toward, a)


def camera(azimuth: float, elevation: float, *, z_down: bool = False, scale: float = 1.0) -> Camera:
    """The camera of a viewer at this azimuth and elevation, in degrees.

    Where z points down, the viewer is above the ground all the same, at a negative z.
    """
    a, e, up = radians(azimuth), radians(elevation), -1 if z_down else 1
    toward = (cos(e) * cos(a), cos(e) * sin(a), up * sin(e))
    # toward × right has the vertical component ±cos e with the sign of `up`: the side of the ground
    # from which the viewer looks is up in the picture.
    right = (-up * sin(a) * scale, up * cos(a) * scale, 0.0)
    return Camera(right, cross(toward, right), toward)


class Ray(NamedTuple):
    """A named direction, fixed in the frame after `frame` turns."""

    kind: Kind
    name: Formula
    frame: int
    direction: Vector


class Rotary(NamedTuple):
    """A turn: its axis and a line that it carries along, in components before the turn."""

    axis: Vector
    start: Vector
    radius: float  # of its arc
    name: Formula  # of its angle
    start_name: Formula | str  # of the line that is carried along


class Arc(NamedTuple):
    """A turn in space: the point centre + cos t·start + sin t·side, for t from 0 to the angle."""

    turn: Rotary
    axis: Vector
    angle: float  # radians
    before: Vector  # the line that is carried along, before and after the turn
    after: Vector

    @property
    def centre(self) -> Vector:
        """The foot of the perpendicular from the end of the line to the axis."""
        return combined((dot(self.before, self.axis),), (self.axis,))

    @property
    def start(self) -> Vector:
        return combined((1.0, -1.0), (self.before, self.centre))

    @property
    def side(self) -> Vector:
        return cross(self.axis, self.before)


class View(NamedTuple):
    """Angles of the turns in radians, and the direction of the viewer in degrees."""

    angles: tuple[float, ...]
    azimuth: int
    elevation: int
    camera: Camera


class Posed(NamedTuple):
    """A scene at given angles: all directions have space components."""

    rays: tuple[Ray, ...]
    arcs: tuple[Arc, ...]

    @property
    def line_of_nodes(self) -> Ray | None:
        """The only axis of turns that is drawn in both directions; several would be a tangle."""
        nodes = [ray for ray in self.rays if ray.kind == "node"]
        return nodes[0] if len(nodes) == 1 else None

    def named(self, direction: Vector) -> Ray | None:
        return next((ray for ray in self.rays if is_same(ray.direction, direction)), None)


class Scene(Record, kw_only=True):
    """The axes of space and of the body, the axes of the turns between them, and the turns."""

    rays: tuple[Ray, ...]
    turns: tuple[Rotary, ...]
    fixed: tuple[float | None, ...]  # the angles of turns that are constant, in radians
    z_down: bool = False

    def posed(self, angles: Sequence[float]) -> Posed:
        """The scene at these angles, in radians."""
        bases = list(frames([turn.axis for turn in self.turns], angles))
        rays = (r._replace(direction=combined(r.direction, bases[r.frame])) for r in self.rays)
        arcs = []
        for turn, angle, (before, after) in zip(self.turns, angles, pairwise(bases), strict=True):
            line = (combined(turn.start, before), combined(turn.start, after))
            arcs.append(Arc(turn, combined(turn.axis, before), angle, *line))
        return Posed(rays=tuple(_merged(rays)), arcs=tuple(arcs))

    @cached_property
    def view(self) -> View:
        """The clearest of the standard views."""
        views, scale = [], _NEARER if len(self.turns) > MANY_TURNS else 1.0
        for acute, azimuth, elevation in _VIEWS_DOWN if self.z_down else _VIEWS:
            pairs = zip(acute, self.fixed, strict=False)
            angles = tuple(radians(angle) if f is None else f for angle, f in pairs)
            seen = camera(azimuth, elevation, z_down=self.z_down, scale=scale)
            views.append(View(angles, azimuth, elevation, seen))
        return max(views, key=self._clarity)

    @cached_property
    def shown(self) -> Posed:
        """The scene as it is drawn."""
        return self.posed(self.view.angles)

    def _clarity(self, view: View) -> tuple[int, float]:
        """How many axes do not coincide, how far apart they end, and how open the arcs are."""
        posed, seen = self.posed(view.angles), view.camera
        ends = [seen.project(ray.direction) for ray in posed.rays]
        if posed.line_of_nodes:
            x, y = seen.project(posed.line_of_nodes.direction)
            ends.append((-x, -y))
        # An arc looks closed if its angle is near 0 or 180°, and if its plane is seen edge on.
        openings = [1.5 * abs(sin(arc.angle) * seen.depth(arc.axis)) for arc in posed.arcs]
        lengths = [hypot(*end) for end in ends]
        apart = min(*openings, *lengths, *(_separation(*pair) for pair in combinations(ends, 2)))
        return len(posed.rays), apart


def _separation(one: Point, other: Point) -> float:
    """The distance of two ends, or twice the sine of an acute angle between them if it is less."""
    (a, b), (x, y) = one, other
    distance = hypot(a - x, b - y)
    if a * x + b * y < 0:
        return distance
    return min(distance, 2 * abs(a * y - b * x) / (hypot(a, b) * hypot(x, y) + 1e-9))


def _merged(rays: Iterator[Ray]) -> Iterator[Ray]:
    """Each direction once, with all its names: z = z′; an axis of a turn adds none."""
    merged: list[Ray] = []
    for ray in rays:
        place = next((k for k, r in enumerate(merged) if is_same(r.direction, ray.direction)), None)
        if place is None:
            merged.append(ray)
        elif ray.kind == "body":
            both = formula("#1 = #2", merged[place].name, ray.name)
            merged[place] = merged[place]._replace(name=both)
    yield from merged


@lru_cache(maxsize=16)
def scene_of(model: RotationModel, letters: Letters) -> Scene | None:
    """The scene of a product of turns, or of the one turn about the axis of a vector.

    None for any other model, for more than MOST_TURNS, and for axes that are not numbers.
    """
    turns = turns_of(model)
    are_numbers = all(part.is_number for turn in turns for part in turn.direction)
    if not (1 <= len(turns) <= MOST_TURNS and are_numbers):
        return None
    axes = [unit([float(part) for part in turn.direction]) for turn in turns]
    drawn = []
    for k, (turn, axis, radius) in enumerate(zip(turns, axes, RADII, strict=False)):
        # the line that is carried along: the axis of the next turn, or of the one before
        lines = [*(axes[k + 1 : k + 2] or axes[:k][-1:]), *STANDARD]
        # A line at less than about 41° to the axis would sweep a cone too narrow to read an angle
        # from.
        start = next((line for line in lines if abs(dot(line, axis)) < 0.75), STANDARD[0])
        names = (n for n, other in zip(_SPACE, STANDARD, strict=True) if is_same(start, other))
        name = formula_of(turn.angle, letters)
        drawn.append(Rotary(axis, start, radius, name, next(names, "axis")))
    return Scene(
        rays=tuple(_rays(axes, model, letters)),
        turns=tuple(drawn),
        fixed=tuple(float(turn.angle) if turn.angle.is_number else None for turn in turns),
        z_down=model.z_down,
    )


def turns_of(model: RotationModel) -> tuple[Turn, ...]:
    """The turns that are drawn: those of the product, or one about the vector, drawn somewhere."""
    if model.turns or not model.vector:
        return model.turns
    axis = tuple(sp.Rational(part, 3) for part in (1, 2, 2))
    units = dict(zip(model.coordinates, model.coordinate_units, strict=True))
    angles = [q for q, unit in units.items() if unit == "rad" and q not in model.vector]
    length = length_of(model)
    # The angle is a coordinate, the length of the vector, or has a letter that no other has.
    if not angles and length is not None and units[model.vector[0]] == "rad":
        angles = [length.symbol]
    angle = angles[0] if angles else sp.Symbol(free_angle(model))
    return (Turn(axis=VECTOR.text, angle=angle, components=axis),)


def free_angle(model: RotationModel) -> str:
    """The letter of an angle that has none: alpha, or gamma where α is in the convention."""
    return "gamma" if "α" in model.convention[0] else "alpha"


def _rays(axes: Sequence[Vector], model: RotationModel, letters: Letters) -> Iterator[Ray]:
    """The axes of space, those of the body, and the axes of turns that are neither."""
    *of_body, vector = [letters.notation.applied(name) for name in (*BODY, VECTOR)]
    for name, direction in zip(_SPACE, STANDARD, strict=True):
        yield Ray(kind="space", name=name, frame=0, direction=direction)
    for primed, direction in zip(of_body, STANDARD, strict=True):
        yield Ray(kind="body", name=primed, frame=len(axes), direction=direction)
    between = [k for k in range(len(axes)) if not _is_drawn(axes, k)]
    kind: Kind = "node" if model.turns else "vector"
    for number, k in enumerate(between, start=1):
        node = Symbol("N", index=Numeral(str(number))) if between[1:] else Symbol("N")
        yield Ray(kind, node if model.turns else vector, k, axes[k])


def _is_drawn(axes: Sequence[Vector], k: int) -> bool:
    """Whether the axis of turn k is, at any angles, an axis of space or of the body.

    The turns before it, or those after it, are then all about this axis.
    """
    is_coordinate_axis = any(is_same(axes[k], axis) for axis in STANDARD)
    ends = (axes[:k], axes[k + 1 :])
    return is_coordinate_axis and any(all(is_same(a, axes[k]) for a in end) for end in ends)
