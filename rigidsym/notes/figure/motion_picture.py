"""The pictures of examples: polhodes on an ellipsoid, traces of the third body axis on spheres."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import count, pairwise
from math import cos, pi, sin
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from rigidsym.errors import ModelError
from rigidsym.formula.letters import Letters
from rigidsym.formula.reader import formula
from rigidsym.formula.tree import Formula
from rigidsym.mechanics.derivation import Derivation
from rigidsym.models.forces import Example
from rigidsym.notes.figure.body_mesh import Vector, unit
from rigidsym.notes.figure.drawing import Drawing, Label, Named, Stroke, beyond, labelled
from rigidsym.notes.figure.scene import BODY, Kind, Point, camera
from rigidsym.simulation.solver import simulate
from rigidsym.simulation.trajectory import Trajectory

Curve = NDArray[Any]  # points (n, 2) of the picture

_NEEDED = {"state_derivative", "angular_velocity_body"}
_SAMPLES = 401
_RTOL, _ATOL = 1e-6, 1e-9  # no eye sees a thousandth of the range
_MOST_STEPS = 5_000  # of the integrator: more oscillations would be one black stripe
_IN_A_ROW = 3  # spheres
_LOW = 0.02  # between the bounding circles of a trace
_GAP = 0.3  # between drawings in a row
_FINEST = 0.012  # between the points of a curve
_CAMERA = np.array(camera(azimuth=55, elevation=26))
_RADIUS = 0.88  # of the largest semi-axis of an ellipsoid
_REACH = 1.35  # of its axes
_SIDES = 72  # of the polygon that a circle is


class MotionPicture(NamedTuple):
    """A drawing, and what its caption says of it."""

    drawing: Drawing
    told: int  # of how many examples the caption needs the numbers
    polhodes: int
    is_still: bool  # whether the third body axis keeps its direction in each of them


def motion_picture(derivation: Derivation, letters: Letters) -> MotionPicture | None:
    """The pictures of all examples in a row; None without one, or without the equations.

    Raises ModelError if values are missing, and if the motion is too fast to follow.
    """
    forces = derivation.forces
    derived = {*(step.quantity.name for step in derivation.steps), *derivation.functions}
    if forces is None or not forces.examples or not derived >= _NEEDED:
        return None
    first = _motion(derivation, forces.examples[0])
    # polhodes are drawn along principal axes, and a body at rest has none
    has_polhodes = (
        forces.leave_free(derivation.model)
        and not np.any(first.inertia - np.diag(first.inertia.diagonal()))
        and bool(first.angular_velocity_body[0].any())
    )
    most = None if has_polhodes else _IN_A_ROW  # all polhodes are on one ellipsoid
    motions = [first, *(_motion(derivation, e) for e in forces.examples[1:most])]
    traced = motions[:1] if has_polhodes else motions
    is_still = all(np.ptp(m.rotation_matrix[:, :, 2], axis=0).max() < _RTOL for m in traced)
    if has_polhodes:
        # without forces no direction of space is vertical, unless the file measures θ from it
        trace = _trace(first, has_bounds="effective_potential" in derived)
        both = _in_a_row((_polhodes(motions, letters), trace))
        return MotionPicture(both, told=1, polhodes=len(motions), is_still=is_still)
    drawing = _in_a_row(map(_trace, motions))
    return MotionPicture(drawing, told=len(motions), polhodes=0, is_still=is_still)


def _motion(derivation: Derivation, example: Example) -> Trajectory:
    steps = count()
    refusal = ModelError(
        f"{derivation.name}: an example cannot be drawn; expected a motion that is slower, "
        "shorter, or farther from the poles of the coordinates"
    )

    def progress(_: float) -> None:
        if next(steps) > _MOST_STEPS:
            raise refusal

    motion = simulate(
        derivation,
        example.initial,
        example.parameters,
        example.time,
        samples=_SAMPLES,
        rtol=_RTOL,
        atol=_ATOL,
        progress=progress,
    )
    if motion.ended:
        raise refusal
    return motion


def _polhodes(motions: Sequence[Trajectory], letters: Letters) -> Drawing:
    """Each on the ellipsoid of its own energy, scaled to one size."""
    # With 2E = Σ I_k Ω′_k², the vector of √I_k Ω′_k has the length √(2E): its direction is a point
    # of the unit sphere, and the ellipsoid of energy has semi-axes in proportion to 1/√I_k.
    roots = np.sqrt(motions[0].inertia.diagonal())
    turning = (roots * motion.angular_velocity_body[0] for motion in motions)
    paths = [polhode(roots**2, unit(start)) for start in turning if start.any()]
    names = [letters.notation.applied(name) for name in BODY]
    return on_ellipsoid(paths, [circle(e, 0.0) for e in np.eye(3)], roots.min() / roots, names)


def polhode(moments: Vector, start: Vector) -> Vector:
    """The closed curve (n, 3) through a point of the unit sphere on which Σ I_k u_k² is constant.

    A permanent rotation stays at its point.
    """
    # The sum h = L²/2E is between the least and the greatest moment. If it exceeds the intermediate
    # one, the curve encircles the axis c of the greatest moment, and otherwise that of the least.
    # Since u_c² = 1 − u_a² − u_b², (I_a − I_c) u_a² + (I_b − I_c) u_b² = h − I_c: an ellipse.
    if np.abs(np.cross(moments * start, start)).max() < 1e-9 * moments.max():
        return np.array([start, start])
    c = moments.argmax() if moments @ start**2 > np.median(moments) else moments.argmin()
    gaps, axis = moments - moments[c], np.eye(3)[c]
    squares = np.divide(gaps @ start**2, gaps, where=gaps != 0, out=np.zeros(3))
    flat = np.sqrt(squares) * circle(axis, 0.0, _SAMPLES - 1)
    rest = np.sqrt(np.maximum(0.0, 1 - (flat**2).sum(axis=1)))
    return flat + np.outer(np.copysign(rest, start[c]), axis)


def _trace(motion: Trajectory, *, has_bounds: bool = True) -> Drawing:
    """The trace of the third axis of the body, with circles at its least and greatest height."""
    path = motion.rotation_matrix[:, :, 2]
    low, high = path[:, 2].min(), path[:, 2].max()
    bounds = [low] if high - low < _LOW else [low, high]
    circles = [circle(np.eye(3)[2], height) for height in (0.0, *(bounds if has_bounds else []))]
    return on_ellipsoid([path], circles, np.ones(3), [formula("z")])


def on_ellipsoid(
    paths: Iterable[Vector], circles: Iterable[Vector], size: Vector, names: Sequence[Formula]
) -> Drawing:
    """Curves and circles on an ellipsoid, as points (n, 3) of the unit sphere; dashed behind.

    `size` holds the semi-axes, the largest being 1; `names` are those of its last axes, which are
    drawn.
    """
    to_picture = _RADIUS * size[:, None] * _CAMERA[:2].T
    # A point S u of the ellipsoid has the normal S⁻¹ u. It is seen edge on if toward·S⁻¹ u = 0,
    # that is, if u lies in the plane with the normal S⁻¹ toward.
    toward = unit(_CAMERA[2] / size)

    def pieces(kind: Kind, path: Vector) -> Iterator[Stroke]:
        """The path in pieces, each in front or behind; they share their ends."""
        is_front = path[:-1] @ toward > -1e-9
        cuts = [0, *(np.flatnonzero(np.diff(is_front)) + 1), len(is_front)]
        for start, end in pairwise(cuts):
            points = _thinned(path[start : end + 1] @ to_picture)
            is_hidden = not is_front[start]
            yield Stroke(kind, points, is_thin=kind == "guide" or is_hidden, is_hidden=is_hidden)

    strokes = [piece for line in (circle(toward, 0.0), *circles) for piece in pieces("guide", line)]
    named: list[Named] = []
    for name, axis in zip(reversed(names), np.eye(3)[::-1], strict=False):
        line = tuple(_point(r * axis @ to_picture) for r in (1.0, _REACH))
        strokes.append(Stroke("space", line, has_arrow=True))
        named.append(("space", name, beyond(line)))
    strokes += [piece for path in paths for piece in pieces("body", path)]
    return Drawing(tuple(strokes), labelled(named, strokes))


def circle(normal: Vector, height: float, sides: int = _SIDES) -> Vector:
    """The circle (n, 3) of the unit sphere at this height along a normal."""
    # The axis with the smallest component of the normal is the farthest from parallel to it.
    across = unit(np.cross(normal, np.eye(3)[np.abs(normal).argmin()]))
    frame = np.array([normal, across, np.cross(normal, across)])
    radius = max(0.0, 1 - height * height) ** 0.5
    turns = (2 * pi * k / sides for k in range(sides + 1))
    return np.array([(height, radius * cos(turn), radius * sin(turn)) for turn in turns]) @ frame


def _thinned(curve: Curve) -> tuple[Point, ...]:
    """Without points that no eye could tell from their neighbours; the ends stay."""
    points = [_point(curve[0])]
    for row in curve[1:-1]:
        if np.hypot(*(row - points[-1])) >= _FINEST:
            points.append(_point(row))
    return (*points, _point(curve[-1]))


def _point(row: Curve) -> Point:
    x, y = row.tolist()
    return (x, y)


def _in_a_row(drawings: Iterable[Drawing]) -> Drawing:
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
        labels += [x._replace(place=(x.place[0] + dx, x.place[1] + dy)) for x in drawing.labels]
        right += end - left + _GAP
    return Drawing(tuple(strokes), tuple(labels))
