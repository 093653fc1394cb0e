"""What the figure of a page shows, as data: the scene of the note, and the body."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from functools import cache
from itertools import pairwise
from math import cos, pi, sin
from typing import Any

import sympy as sp

from rigidsym.algebra import generators
from rigidsym.formula.letters import Letters
from rigidsym.formula.scalars import formula_of
from rigidsym.formula.tree import NOTHING, Formula, Numeral, Symbol
from rigidsym.mechanics.derivation import Derivation
from rigidsym.mechanics.quantities.kinematics import SPACE
from rigidsym.models.rotation import AXES, RotationModel
from rigidsym.notes.figure.drawing import RED, Color
from rigidsym.notes.figure.scene import BODY, RADII, STANDARD, Scene, Vector, scene_of, turns_of
from rigidsym.notes.formats.drawings import in_a_figure
from rigidsym.page.functions import Functions, has_turns, moments_of

_AZIMUTH, _ELEVATION = 35, 22  # degrees, if the note has no figure
_SLAB = [1.25, 0.8, 1.75]  # moments of the body of a page without one: three different edges
_WHITE = (246, 244, 238)
_SECTORS = 8  # of a top, red and white
_ROUND = 24  # corners of its circles
Faces = Sequence[tuple[Iterable[Iterable[float]], Color]]  # corners and color of each
_TOP = ((0, 0), (0.02, 0), (0.46, 0.66), (0.06, 0.86), (0.06, 1.22), (0, 1.22))  # radius, height


def shown_angles(model: RotationModel, letters: Letters) -> dict[sp.Expr, float]:
    """The coordinates that are angles of turns, as in the figure of the note; radians."""
    scene = scene_of(model, letters)
    angles = scene.view.angles if scene else ()
    pairs = zip(turns_of(model), angles, strict=False)
    return {turn.angle: angle for turn, angle in pairs if turn.angle in model.coordinates}


def stage_of(model: RotationModel, letters: Letters) -> dict[str, Any]:
    """What the script needs to draw: rays, turns, names as plain text, the viewer in degrees.

    A ray has a direction in the frame after `frame` turns, or is the axis of that turn. `vector`
    holds the positions of its components among the coordinates, and `angle` that of the angle.
    """
    scene = scene_of(model, letters)
    angles = {turn.angle for turn in turns_of(model)} if model.vector else set()
    return {
        "azimuth": scene.view.azimuth if scene else _AZIMUTH,
        "elevation": scene.view.elevation if scene else _ELEVATION,
        "up": -1 if model.z_down else 1,
        "rays": [*_rays(model, scene, letters)],
        "turns": [*_turns(model, scene, letters)],
        "letters": AXES,
        "vector": [*map(model.coordinates.index, model.vector)],
        "angle": next((k for k, q in enumerate(model.coordinates) if q in angles), None),
        "omega": in_a_figure(letters.notation.applied(SPACE.omega)),
    }


def _rays(model: RotationModel, scene: Scene | None, letters: Letters) -> Iterator[dict[str, Any]]:
    """Those of the scene; or those of axes that are not numbers, or of the one turn that R is."""
    rays: list[tuple[str, Formula, int, Vector | None]]
    if scene:
        moving = ("node", "vector")
        rays = [
            (r.kind, r.name, r.frame, None if r.kind in moving else r.direction) for r in scene.rays
        ]
    else:
        count = len(model.turns) if has_turns(model) else 1
        rays = [("space", Symbol(name), 0, d) for name, d in zip(AXES, STANDARD, strict=True)]
        rays += [("body", name, count, d) for name, d in zip(BODY, STANDARD, strict=True)]
        axes = [Symbol("N", index=Numeral(str(k + 1))) for k in range(count)]
        axes = axes if has_turns(model) else [Symbol("e", "bold")]
        rays += [("node", axis, k, None) for k, axis in enumerate(axes)]
    for kind, name, frame, direction in rays:
        letter = in_a_figure(letters.notation.applied(name))
        yield {"kind": kind, "name": letter, "frame": frame, "direction": direction}


def _turns(model: RotationModel, scene: Scene | None, letters: Letters) -> Iterator[dict[str, Any]]:
    """Names, radius and line of each turn; its axis and its angle are evaluated."""
    turns = turns_of(model) if has_turns(model) or scene else ()
    starts = [turn.start for turn in scene.turns] if scene and model.turns else [None] * len(turns)
    for turn, start, radius in zip(turns, starts, RADII, strict=False):
        rate = formula_of(generators.rate_of(turn.angle), letters) if model.turns else NOTHING
        name = in_a_figure(formula_of(turn.angle, letters))
        yield {"name": name, "rate_name": in_a_figure(rate), "start": start, "radius": radius}
    if not turns:
        yield {"name": "", "rate_name": "", "start": None, "radius": RADII[0]}


# The body


def body_of(derivation: Derivation, functions: Functions) -> dict[str, Any]:
    """`body` is the shape, `moments` are those of a cuboid that the script draws in its place.

    A known shape is drawn as it is. A motion of which only the principal moments are known is that
    of a cuboid with these moments, or of a top on its tip.
    """
    body, forces = derivation.body, derivation.forces
    own: Faces = ()
    if body:  # NumPy, with which it is meshed, takes longer to import than a rotation to derive
        from rigidsym.notes.figure.body_mesh import own_shape

        own = own_shape(body)
    moments = moments_of(body)
    axes = [turn.axis for turn in derivation.model.turns]
    # A sequence such as ZXZ: precession about z, nutation, and spin about z′.
    is_about_z = len(axes) == 3 and axes[0] == axes[2] == "z"
    is_heavy = forces is not None and forces.potential != 0 and moments[:1] == moments[1:2]
    if not own and is_about_z and (is_heavy or not functions.is_motion):
        own = spinning_top()
    if own:
        return {"body": as_data(own)}
    if not functions.is_motion:
        return {"moments": _SLAB}
    is_evaluated = any(kernel.name == "moments" for kernel in functions.kernels)
    return {"moments": None if is_evaluated else [*map(float, moments)]} if moments else {}


@cache
def spinning_top() -> Faces:
    """A top on its tip, about z′: its profile, turned, in sectors that show the spin."""
    turns = [2 * pi * k / _ROUND for k in range(_ROUND + 1)]
    profiles = [[(r * cos(turn), r * sin(turn), h) for r, h in _TOP] for turn in turns]
    return tuple(
        # no corner is repeated where the profile begins and ends on the axis
        (tuple(dict.fromkeys((a, c, d, b))), (RED, _WHITE)[k * _SECTORS // _ROUND % 2])
        for k, both in enumerate(pairwise(profiles))
        for (a, b), (c, d) in zip(*map(pairwise, both), strict=True)
    )


def as_data(faces: Faces) -> dict[str, Any]:
    """The faces by indices: points, colours, and faces as [colour, corner, corner, ...]."""
    points: dict[tuple[float, ...], int] = {}
    colors: dict[Color, int] = {}
    indices = []
    for corners, color in faces:
        # Rounding makes one point of the corners that faces share; + 0.0 turns −0.0 into 0.0.
        rounded = [tuple(round(float(x), 3) + 0.0 for x in corner) for corner in corners]
        places = [points.setdefault(corner, len(points)) for corner in rounded]
        indices.append([colors.setdefault(color, len(colors)), *places])
    return {"points": [*points], "colors": [*colors], "faces": indices}
