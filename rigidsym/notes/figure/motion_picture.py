"""The pictures of examples: coordinates in time, and a trace on a sphere or an ellipsoid."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import count
from typing import NamedTuple

import numpy as np

from rigidsym.errors import ModelError
from rigidsym.formula.letters import Letters
from rigidsym.formula.reader import formula
from rigidsym.formula.scalars import formula_of
from rigidsym.mechanics.derivation import Derivation
from rigidsym.models.forces import OMEGA_BODY, Example
from rigidsym.notes.figure.chart import chart, circle, in_a_row, on_ellipsoid
from rigidsym.notes.figure.drawing import Drawing
from rigidsym.notes.figure.scene import BODY
from rigidsym.simulation.solver import simulate
from rigidsym.simulation.trajectory import Trajectory

_NEEDED = {"state_derivative", "angular_velocity_body"}
_SAMPLES = 401
_RTOL, _ATOL = 1e-6, 1e-9  # no eye sees a thousandth of the range
_MOST_STEPS = 5_000  # of the integrator: more oscillations would be one black stripe
_TURN = 6.3  # rad: angles that go further are left out of the chart
_WIDE, _NARROW, _HEIGHT = 4.6, 2.5, 1.7  # of a chart
_IN_A_ROW = 3  # spheres
_LOW = 0.02  # between the bounding circles of a trace


class MotionPicture(NamedTuple):
    """A drawing, and what its caption says of it."""

    drawing: Drawing
    told: int  # of how many examples the caption needs the numbers
    traces: tuple[str, ...]  # "axis", "polhode", "polhodes"


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
    is_poinsot = (
        forces.leave_free(derivation.model)
        and not np.any(first.inertia - np.diag(first.inertia.diagonal()))
        and bool(first.angular_velocity_body[0].any())
    )
    most = None if is_poinsot else _IN_A_ROW  # all polhodes are on one ellipsoid
    motions = [first, *(_motion(derivation, e) for e in forces.examples[1:most])]
    traces: list[tuple[str, Drawing]] = []  # what is traced, with its drawing
    if is_poinsot:
        kind = "polhode" if len(motions) == 1 else "polhodes"
        traces.append((kind, _polhodes(motions, letters)))
    turns = derivation.model.turns
    if turns and turns[-1].axis == "z":
        traces += [("axis", _axis(motion)) for motion in motions[: 1 if is_poinsot else None]]
    drawings = [drawing for _, drawing in traces]
    if not drawings:
        width = _WIDE if len(motions) == 1 else _NARROW
        drawings = [_over_time(derivation, motion, letters, width) for motion in motions]
    elif len(drawings) == 1:
        drawings.insert(0, _over_time(derivation, first, letters, _NARROW))
    kinds = tuple(dict.fromkeys(kind for kind, _ in traces))
    return MotionPicture(in_a_row(drawings), 1 if is_poinsot else len(motions), kinds)


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


def _over_time(
    derivation: Derivation, motion: Trajectory, letters: Letters, width: float
) -> Drawing:
    """The angles that stay within a turn, or the components of Ω′ if there are no angles."""
    if motion.is_in_angles:
        pairs = [*zip(map(letters.name, derivation.model.coordinates), motion.q.T, strict=True)]
        pairs = [pair for pair in pairs if np.ptp(pair[1]) < _TURN] or pairs
    else:
        names = (formula_of(omega, letters) for omega in OMEGA_BODY)
        pairs = [*zip(names, motion.angular_velocity_body.T, strict=True)]
    curves = [np.stack([motion.t, column], axis=1) for _, column in pairs]
    names_of = [name for name, _ in pairs]
    return chart(curves, (width, _HEIGHT), formula(r"t / \mathrm{s}"), names=names_of)


def _polhodes(motions: Sequence[Trajectory], letters: Letters) -> Drawing:
    """Each on the ellipsoid of its own energy, scaled to one size."""
    # With 2E = Σ I_k Ω′_k², the vector of √I_k Ω′_k has the length √(2E): its direction is a point
    # of the unit sphere, and the ellipsoid of energy has semi-axes in proportion to 1/√I_k.
    roots = np.sqrt(motions[0].inertia.diagonal())
    turning = (roots * motion.angular_velocity_body for motion in motions)
    paths = [
        path / np.linalg.norm(path, axis=1, keepdims=True) for path in turning if path[0].any()
    ]
    circles = [circle(axis, 0.0) for axis in np.eye(3)]
    axes = [(letters.notation.applied(name), k) for k, name in enumerate(BODY)]
    return on_ellipsoid(paths, circles, roots.min() / roots, axes)


def _axis(motion: Trajectory) -> Drawing:
    """The trace of the third axis of the body, with the circles that bound its height."""
    path = motion.rotation_matrix[:, :, 2]
    low, high = path[:, 2].min(), path[:, 2].max()
    bounds = [low] if high - low < _LOW else [low, high]
    circles = [circle(np.eye(3)[2], height) for height in (0.0, *bounds)]
    return on_ellipsoid([path], circles, np.ones(3), [(formula("z"), 2)])
