"""What a textbook says of the angles of a product of turns, and of Ω as the sum of the turns."""

from __future__ import annotations

from collections.abc import Iterator

from rigidsym.formula.letters import Letters
from rigidsym.formula.reader import formula
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
from rigidsym.models.rotation import SOURCES, RotationModel, carried_axes
from rigidsym.notes.document.document import (
    Cited,
    Equation,
    EquationRow,
    FigureReference,
    NoteBlock,
    Paragraph,
    Text,
    words,
)
from rigidsym.notes.figure.scene import scene_of

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
        yield words(
            f"{text}each orientation has exactly one set with {{}} and {{}}, except for the "
            "singular ones.",
            first,
            middle,
            last,
            *ranges,
        )
    else:
        yield words(
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
