"""The figure of a rotation with its caption, and the same in words."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import chain

from rigidsym.formula.letters import Letters
from rigidsym.models.rotation import RotationModel, Turn
from rigidsym.notes.document.document import Figure, Text, listed
from rigidsym.notes.figure.camera import Vector
from rigidsym.notes.figure.drawing import drawn
from rigidsym.notes.figure.scene import Arc, Kind, Posed, scene_of


def figure_of(model: RotationModel, letters: Letters) -> Figure | None:
    """The figure of a product of turns, or of one turn about a vector; None for any other model."""
    scene = scene_of(model, letters)
    if scene is None:
        return None
    view = scene.view
    posed = scene.posed(view.angles)
    return Figure(
        drawing=drawn(posed, view.camera),
        caption=(
            *_caption(posed, _between_in_words(model.turns)),
            *((" The ", posed.rays[2].name, "-axis points down.") if model.z_down else ()),
        ),
        description=tuple(chain.from_iterable((*s, " ") for s in _in_words(posed)))[:-1],
    )


def _between_in_words(turns: Sequence[Turn]) -> str:
    """What the only axis that is neither of space nor of the body is called."""
    if not turns:
        return "the vector {} along the axis of the turn"
    if len(turns) == 1:
        return "the axis {} of the turn"
    are_coordinate_axes = not any(turn.components for turn in turns)
    return "the line of nodes {}" if are_coordinate_axes else "the axis {} of a turn"


def _caption(scene: Posed, between: str) -> Text:
    """Which axes are which."""
    nodes = _names(scene, "node") or _names(scene, "vector")
    parts = [
        _filled("the axes {} of space", _names(scene, "space")),
        _filled("the axes {} of the body", _names(scene, "body")),
        _filled(between if len(nodes) == 1 else "the axes {} of turns", nodes),
    ]
    return ("Shown are ", *listed([part for part in parts if part]), ".")


def _names(scene: Posed, kind: Kind) -> Text:
    return listed([(ray.name,) for ray in scene.rays if ray.kind == kind], ", ")


def _filled(text: str, names: Text) -> Text:
    before, after = text.split("{}")
    return (before, *names, after) if names else ()


def _in_words(scene: Posed) -> Iterator[Text]:
    """The turn by φ about z takes x to N; and so on, as the product is read from left to right."""
    for arc in scene.arcs:
        about = scene.named(arc.axis)
        axis = about.name if about else "its axis"
        start, end = (_called(scene, arc, v) for v in (arc.before, arc.after))
        turn = ("The turn by ", arc.turn.name, " about ", axis)
        yield (*turn, " takes ", *start, " to ", *end, ".")


def _called(scene: Posed, arc: Arc, direction: Vector) -> Text:
    """The name of the axis in a direction; any other line is named after what was turned."""
    ray = scene.named(direction)
    return (ray.name,) if ray else ("the turned ", arc.turn.start_name)
