"""The live figure before anything is moved: the view of it, and the names of its lines."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import sympy as sp

from rigidsym.mechanics.derivation import Markup
from rigidsym.mechanics.quantities.kinematics import SPACE
from rigidsym.models.rotation import RotationModel
from rigidsym.models.so3 import AXES
from rigidsym.notes.figure.scene import BODY, MOST_TURNS, NODE, scene_of, turns_of
from rigidsym.notes.figure.svg import as_in_formulas
from rigidsym.notes.formula.lengths import VECTOR
from rigidsym.notes.formula.notation import Notation

_AZIMUTH, _ELEVATION = 35, 22  # degrees, where no figure says better
_AXIS = Markup(r"\mathbf{e}", "e")  # of the one turn that any rotation is


def has_turns(model: RotationModel) -> bool:
    """Whether the figure shows the turns one by one; else the one turn that R is."""
    return 1 <= len(model.turns) <= MOST_TURNS


def shown_angles(model: RotationModel, notation: Notation) -> dict[sp.Expr, float]:
    """The coordinates that are angles of turns, as in the figure of the note; radians."""
    scene = scene_of(model, notation)
    angles = scene.view.angles if scene else ()
    pairs = zip(turns_of(model), angles, strict=False)
    return {turn.angle: angle for turn, angle in pairs if turn.angle in model.coordinates}


def stage_of(model: RotationModel, notation: Notation) -> Mapping[str, Any]:
    """Direction of the viewer in degrees, the names of lines as plain text, and what is a vector.

    `vector` are the places of its components among the coordinates, `angle` is the place of the
    angle about it, where that is a coordinate.
    """
    scene = scene_of(model, notation)
    view = scene.view if scene else None
    named = notation.manner.symbol
    shown = turns_of(model) if has_turns(model) or model.vector else ()
    angles = {turn.angle for turn in shown} if model.vector else set()
    return {
        "azimuth": view.azimuth if view else _AZIMUTH,
        "elevation": view.elevation if view else _ELEVATION,
        "space": list(AXES),
        "body": [_written(named(axis)) for axis in BODY],
        "turns": [_written(turn.name) for turn in scene.turns] if scene else [],
        "node": _written(_between(model)),
        "vector": [*map(model.coordinates.index, model.vector)],
        "angle": next((k for k, q in enumerate(model.coordinates) if q in angles), None),
        "omega": _written(named(SPACE.omega)),
    }


def _between(model: RotationModel) -> Markup:
    """An axis that is neither of space nor of the body, as the note calls it."""
    if has_turns(model):
        return NODE
    return VECTOR if model.vector else _AXIS


def _written(symbol: Markup) -> str:
    """A label; an arrow above it would not stand where it should in every browser."""
    return as_in_formulas(symbol.text.replace("\u20d7", ""))
