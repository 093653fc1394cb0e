"""The figure of a rotation: Figure 1 of the lecture, for any convention and in words too."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import chain

import sympy as sp

from rigidsym.models.rotation import RotationModel, Turn
from rigidsym.notes.document.document import Figure, Text
from rigidsym.notes.figure.camera import Camera, Vector, unit
from rigidsym.notes.figure.drawing import Kind
from rigidsym.notes.figure.scene import BODY, Arc, Names, Scene, scene_of
from rigidsym.notes.figure.sketch import best_view, drawn
from rigidsym.notes.formula.formula import markup
from rigidsym.notes.formula.lengths import length_of
from rigidsym.notes.formula.notation import Notation
from rigidsym.notes.prose.words import VECTOR, listed, words

MOST_TURNS = 5  # more would be a tangle


def figure_of(model: RotationModel, notation: Notation) -> Figure | None:
    """The figure of a model that is a product of turns, or one turn about the axis of a vector.

    None for any other, for more than MOST_TURNS, and for axes that are not numbers.
    """
    turns = turns_of(model)
    if not _can_be_drawn(turns):
        return None
    axes = tuple(map(_components, turns))
    angles, view = _view(turns)
    names = Names(
        angles=tuple(markup(turn.angle, notation) for turn in turns),
        body=tuple(map(notation.manner.symbol, BODY)),
        between=None if model.turns else notation.manner.symbol(VECTOR),
        is_vector=not model.turns,
    )
    scene = scene_of(axes, angles, names)
    return Figure(
        drawing=drawn(scene, view),
        caption=_caption(scene, _between_in_words(turns)),
        description=tuple(chain.from_iterable((*s, " ") for s in _in_words(scene)))[:-1],
    )


def view_of(model: RotationModel) -> tuple[tuple[float, ...], Camera] | None:
    """The angles of the turns, in radians, and the camera of the figure; None where it has none."""
    turns = turns_of(model)
    return _view(turns) if _can_be_drawn(turns) else None


def turns_of(model: RotationModel) -> tuple[Turn, ...]:
    """The turns that the figure shows: those of the model, or the one about its vector."""
    return model.turns or _about_the_vector(model)


def _can_be_drawn(turns: Sequence[Turn]) -> bool:
    are_numbers = (part.is_number for turn in turns for part in turn.direction)
    return 1 <= len(turns) <= MOST_TURNS and all(are_numbers)


def _view(turns: Sequence[Turn]) -> tuple[tuple[float, ...], Camera]:
    return best_view(tuple(map(_components, turns)), tuple(map(_fixed_angle, turns)))


def _about_the_vector(model: RotationModel) -> tuple[Turn, ...]:
    """The one turn that the components of a vector along its axis stand for; some axis of space."""
    if not model.vector:
        return ()
    axis = tuple(sp.Rational(part, 3) for part in (1, 2, 2))
    return (Turn(axis=VECTOR.text, angle=_angle_about(model), components=axis),)


def _angle_about(model: RotationModel) -> sp.Expr:
    """The angle of the turn: a coordinate, the length of the vector, or a letter for it."""
    units = dict(zip(model.coordinates, model.coordinate_units, strict=True))
    angles = [q for q, unit in units.items() if unit == "rad" and q not in model.vector]
    length = length_of(model)
    if not angles and length is not None and units[model.vector[0]] == "rad":
        return length.symbol
    taken = {q.func.__name__ for q in model.coordinates}
    letters = (letter for letter in ("alpha", "beta", "gamma") if letter not in taken)
    return angles[0] if angles else sp.Symbol(next(letters))


def _between_in_words(turns: Sequence[Turn]) -> str:
    """What the only axis that is neither of space nor of the body is called."""
    if len(turns) == 1:
        is_vector = turns[0].axis == VECTOR.text
        return (
            "the vector {} along the axis of the turn" if is_vector else "the axis {} of the turn"
        )
    are_coordinate_axes = not any(turn.components for turn in turns)
    return "the line of nodes {}" if are_coordinate_axes else "the axis {} of a turn"


def _components(turn: Turn) -> Vector:
    x, y, z = (float(part) for part in turn.direction)
    return unit((x, y, z))


def _fixed_angle(turn: Turn) -> float | None:
    return float(turn.angle) if turn.angle.is_number else None


def _caption(scene: Scene, between: str) -> Text:
    """Which axes are which."""
    nodes = _names(scene, "node") or _names(scene, "vector")
    parts = [
        _filled("the axes {} of space", _names(scene, "space")),
        _filled("the axes {} of the body", _names(scene, "body")),
        _filled(between if len(nodes) == 1 else "the axes {} of turns", nodes),
    ]
    shown = listed([part for part in parts if part])
    return ("Shown are ", *shown, ".")


def _names(scene: Scene, kind: Kind) -> Text:
    return listed([(ray.name,) for ray in scene.rays if ray.kind == kind], ", ")


def _filled(text: str, names: Text) -> Text:
    before, after = text.split("{}")
    return (before, *names, after) if names else ()


def _in_words(scene: Scene) -> Iterator[Text]:
    """The turn by φ about z takes x to N; and so on, as the product is read from left to right."""
    for arc in scene.arcs:
        about = scene.named(arc.axis)
        axis = about.name if about else "its axis"
        start, end = (_called(scene, arc, v) for v in (arc.start, arc.end))
        head = words("The turn by {} about {} takes ", arc.name, axis)
        yield (*head, *start, " to ", *end, ".")


def _called(scene: Scene, arc: Arc, direction: Vector) -> Text:
    """The name of the ray in a direction; a line that has none is named after its axis."""
    ray = scene.named(direction)
    return (ray.name,) if ray else ("the turned ", arc.start_name)
