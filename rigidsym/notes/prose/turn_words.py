"""What a textbook says of a product of turns: its angles, its figure, and Ω as a sum."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import chain

from rigidsym.formula.letters import Letters
from rigidsym.formula.reader import formula, sentence
from rigidsym.formula.scalars import formula_of
from rigidsym.formula.tree import (
    PLUS,
    Formula,
    Numeral,
    Symbol,
    bracketed,
    equal,
    joined,
    row,
)
from rigidsym.mechanics.quantities.kinematics import SPACE
from rigidsym.models.rotation import SOURCES, RotationModel, Turn, carried_axes
from rigidsym.notes.document.document import (
    Cited,
    Equation,
    EquationRow,
    Figure,
    FigureReference,
    NoteBlock,
    Paragraph,
    Text,
    listed,
)
from rigidsym.notes.figure.camera import Vector
from rigidsym.notes.figure.drawing import drawn
from rigidsym.notes.figure.scene import Arc, Kind, Posed, scene_of

PROPER = ("precession", "nutation", "spin")
TAIT_BRYAN = ("yaw", "pitch", "roll")
GOLDSTEIN = SOURCES["Goldstein 4.9"]
_OUTER_RANGE = r"-\pi < #1, #2 \le \pi"
_PROPER_RANGE = r"0 \le #1 \le \pi"
_TAIT_BRYAN_RANGE = r"-\frac{\pi}{2} \le #1 \le \frac{\pi}{2}"
_MOST_WRITTEN = 3  # axes that are written out


def are_euler_angles(model: RotationModel) -> bool:
    """Whether R is three turns by its coordinates about coordinate axes, no two in a row alike."""
    turns = model.turns
    if len(turns) != 3 or {turn.angle for turn in turns} != set(model.coordinates):
        return False
    axes = [turn.axis for turn in turns]
    return axes[0] != axes[1] != axes[2] and not any(turn.components for turn in turns)


def names_of_angles(model: RotationModel) -> tuple[str, ...]:
    """Precession, nutation, spin, or yaw, pitch, roll; none where the angles have no such names."""
    if not are_euler_angles(model):
        return ()
    axes = [turn.axis for turn in model.turns]
    if axes[0] == axes[2]:
        return PROPER
    return TAIT_BRYAN if axes == ["z", "y", "x"] else ()


def angles_in_words(model: RotationModel, letters: Letters) -> Iterator[Text]:
    """What the angles are called, and the ranges in which they are unique."""
    if not are_euler_angles(model):
        return
    found = names_of_angles(model)
    axes = [turn.axis for turn in model.turns]
    of_middle = _PROPER_RANGE if axes[0] == axes[2] else _TAIT_BRYAN_RANGE
    first, middle, last = [formula_of(turn.angle, letters) for turn in model.turns]
    ranges = formula(_OUTER_RANGE, first, last), formula(of_middle, middle)
    called = [f"the {name} angle {{}}" if found is PROPER else f"the {name} {{}}" for name in found]
    if found and found == tuple(turn.angle.func.__name__ for turn in model.turns):
        called = ["{}"] * 3
    if found:
        text = f"The angles are {called[0]}, {called[1]} and {called[2]}; "
        yield sentence(
            f"{text}each orientation has exactly one set with {{}} and {{}}, except for the "
            "singular ones.",
            first,
            middle,
            last,
            *ranges,
        )
    else:
        yield sentence(
            "Each orientation has exactly one set of angles with {} and {}, except for the "
            "singular ones.",
            *ranges,
        )


def axes_of_turns(model: RotationModel, letters: Letters) -> list[Formula]:
    """The unit vectors about which the turns are made, named after the figure: e_z, e_N, e_z′."""
    scene = scene_of(model, letters)
    posed = scene.posed(scene.view.angles) if scene else None
    rays = [posed.named(arc.axis) for arc in posed.arcs] if posed else []
    if not rays or not all(rays) or len(rays) != len(model.turns):
        return [Symbol("n", "bold", index=Numeral(str(k))) for k in range(1, len(model.turns) + 1)]
    return [Symbol("e", "bold", index=ray.name) for ray in rays if ray]


def sum_of_turns(model: RotationModel, letters: Letters) -> Formula:
    """Ω = φ̇ e_z + θ̇ e_N + ψ̇ e_z′; turns by constant angles add nothing."""
    axes = axes_of_turns(model, letters)
    terms = [
        row(bracketed(formula_of(turn.rate, letters)), axis)
        for turn, axis in zip(model.turns, axes, strict=True)
        if turn.rate != 0
    ]
    return equal(SPACE.omega, joined(terms, PLUS))


def sum_in_words(model: RotationModel, letters: Letters) -> Iterator[NoteBlock]:
    """Ω read off the figure, with the axes in space components."""
    if len(model.turns) < 2 or not all(turn.rate for turn in model.turns):
        return
    see = ("; see Figure\u00a0", FigureReference(1)) if scene_of(model, letters) else ()
    add = ("Angular velocities about different axes add\u00a0", Cited(GOLDSTEIN))
    yield Paragraph((*add, ". Each turn contributes its rate about its own axis", *see, ":"))
    yield Equation(sides=(sum_of_turns(model, letters),))
    if len(model.turns) > _MOST_WRITTEN or any(turn.components for turn in model.turns):
        return
    yield Paragraph(
        ("Each axis is carried along by the turns before it. In space components the axes are",)
    )
    named = zip(axes_of_turns(model, letters), carried_axes(model.turns), strict=True)
    yield EquationRow(tuple(Equation(sides=(name,), matrix=axis) for name, axis in named))
    yield Paragraph(("The derivative of the rotation matrix leads to the same result.",))


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
