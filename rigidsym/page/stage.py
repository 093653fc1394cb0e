"""The live figure before anything is moved: the view of it, and the names of its lines."""

from __future__ import annotations

from collections.abc import Mapping
from math import asin, atan2, degrees
from typing import Any

import sympy as sp

from rigidsym.mechanics.derivation import Markup
from rigidsym.mechanics.quantities import SPACE
from rigidsym.models.rotation import RotationModel
from rigidsym.models.so3 import AXES
from rigidsym.notes.figure import MOST_TURNS, view_of
from rigidsym.notes.formula import markup
from rigidsym.notes.notation import Notation
from rigidsym.notes.scene import BODY
from rigidsym.notes.svg import as_in_formulas

_AZIMUTH, _ELEVATION = 35, 22  # degrees, where no figure says better
_LENGTH = Markup("n", "n")  # of a vector: the angle of the one turn, as in the figure of the note


def has_turns(model: RotationModel) -> bool:
    """Whether the figure shows the turns one by one; else the one turn that R is."""
    return 1 <= len(model.turns) <= MOST_TURNS


def shown_angles(model: RotationModel) -> dict[sp.Expr, float]:
    """The coordinates that are angles of turns, as the figure of the note has them; radians."""
    view = view_of(model)
    angles = view[0] if view else ()
    pairs = zip(model.turns, angles, strict=False)
    return {turn.angle: angle for turn, angle in pairs if turn.angle in model.coordinates}


def stage_of(model: RotationModel, notation: Notation) -> Mapping[str, Any]:
    """Direction of the viewer in degrees, and the names of lines as plain text."""
    view = view_of(model)
    toward = view[1].toward if view else None
    named = notation.manner.symbol
    return {
        "azimuth": round(degrees(atan2(toward[1], toward[0]))) if toward else _AZIMUTH,
        "elevation": round(degrees(asin(toward[2]))) if toward else _ELEVATION,
        "space": list(AXES),
        "body": [_written(named(axis)) for axis in BODY],
        "turns": [_written(name) for name in _names_of_turns(model, notation)],
        "node": "N" if has_turns(model) else "e",
        "omega": _written(named(SPACE.omega)),
    }


def _names_of_turns(model: RotationModel, notation: Notation) -> list[Markup]:
    if has_turns(model):
        return [markup(turn.angle, notation) for turn in model.turns]
    return [_LENGTH] if model.vector else []


def _written(symbol: Markup) -> str:
    """A label; an arrow above it would not stand where it should in every browser."""
    return as_in_formulas(symbol.text.replace("\u20d7", ""))
