"""The scene of the live figure as data: the note's, or the single turn of any other rotation."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import sympy as sp

from rigidsym.algebra import generators
from rigidsym.formula.letters import Letters
from rigidsym.formula.scalars import formula_of
from rigidsym.formula.tree import NOTHING, Formula, Numeral, Symbol
from rigidsym.mechanics.derivation import Quantity, Step
from rigidsym.mechanics.quantities.kinematics import SPACE
from rigidsym.models.rotation import AXES, RotationModel
from rigidsym.notes.figure.camera import STANDARD, Vector
from rigidsym.notes.figure.scene import BODY, MOST_TURNS, RADII, Scene, scene_of, turns_of
from rigidsym.notes.formats.drawings import as_in_formulas

_AZIMUTH, _ELEVATION = 35, 22  # degrees, where the note has no figure


def has_turns(model: RotationModel) -> bool:
    """Whether the figure shows the turns one by one; else the single turn that R is."""
    return 1 <= len(model.turns) <= MOST_TURNS


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
    view = scene.view if scene else None
    named = letters.notation.applied
    angles = {turn.angle for turn in turns_of(model)} if model.vector else set()
    return {
        "azimuth": view.azimuth if view else _AZIMUTH,
        "elevation": view.elevation if view else _ELEVATION,
        "rays": [*(_rays_of(scene) if scene else _rays(model, letters))],
        "turns": [*_turns(model, scene, letters)],
        "letters": AXES,
        "vector": [*map(model.coordinates.index, model.vector)],
        "angle": next((k for k, q in enumerate(model.coordinates) if q in angles), None),
        "omega": label(named(SPACE.omega)),
    }


def label(symbol: Formula) -> str:
    """A symbol in the picture; browsers do not place an arrow above a letter reliably."""
    return as_in_formulas(symbol.text.replace("\u20d7", ""))


def rate_of(angle: sp.Expr, letters: Letters) -> Formula:
    """The rate of the angle of a turn: φ̇."""
    return formula_of(generators.rate_of(angle), letters)


def _rays_of(scene: Scene) -> Iterator[dict[str, Any]]:
    for ray in scene.rays:
        is_axis = ray.kind in ("node", "vector")
        yield _ray(ray.kind, ray.name, ray.frame, None if is_axis else ray.direction)


def _rays(model: RotationModel, letters: Letters) -> Iterator[dict[str, Any]]:
    """Those of axes that are not numbers, or of the single turn that R is."""
    count = len(model.turns) if has_turns(model) else 1
    for name, direction in zip(AXES, STANDARD, strict=True):
        yield _ray("space", Symbol(name), 0, direction)
    for axis, direction in zip(BODY, STANDARD, strict=True):
        yield _ray("body", letters.notation.applied(axis), count, direction)
    for k in range(count):
        axis = Symbol("N", index=Numeral(str(k + 1))) if has_turns(model) else Symbol("e", "bold")
        yield _ray("node", axis, k, None)


def _ray(kind: str, name: Formula, frame: int, direction: Vector | None) -> dict[str, Any]:
    return {"kind": kind, "name": label(name), "frame": frame, "direction": direction}


def _turns(model: RotationModel, scene: Scene | None, letters: Letters) -> Iterator[dict[str, Any]]:
    """Names, radius and line of each turn; its axis and its angle are evaluated."""
    turns = turns_of(model) if has_turns(model) or scene else ()
    starts = [turn.start for turn in scene.turns] if scene and model.turns else [None] * len(turns)
    for turn, start, radius in zip(turns, starts, RADII, strict=False):
        rate = rate_of(turn.angle, letters) if model.turns else NOTHING
        name = label(formula_of(turn.angle, letters))
        yield {"name": name, "rate_name": label(rate), "start": start, "radius": radius}
    if not turns:
        yield {"name": "", "rate_name": "", "start": None, "radius": RADII[0]}


def turns_step(model: RotationModel) -> Step:
    """The function of the axis, the angle and the rate of each turn."""
    rows = [[*turn.direction, turn.angle, turn.rate] for turn in model.turns]
    about = "axis, angle and rate of each turn, one turn a row"
    return step_of("turns", sp.ImmutableMatrix(rows), about, ("q", "q_dot"), model)


def step_of(
    name: str, matrix: sp.MatrixBase, about: str, inputs: tuple[str, ...], model: RotationModel
) -> Step:
    """A function that is evaluated like the quantities but is in no note."""
    quantity = quantity_of(name, about, (*inputs, "parameters") if model.constants else inputs)
    return Step(quantity=quantity, expression=matrix.as_immutable())


def quantity_of(name: str, about: str, inputs: tuple[str, ...]) -> Quantity:
    return Quantity(
        name=name,
        symbol=Symbol(name),
        definition=NOTHING,
        about=about,
        unit="",
        inputs=inputs,
    )
