"""What a textbook says of a rotation before any matrix is written.

Of a product of turns: its angles, its figure, and Ω as a sum. Of a vector or a quaternion:
Rodrigues' formula and the product of quaternions, in blocks. A block is a paragraph, or an
equation whose lines begin with `=`. Formulas in a paragraph stand between dollar signs; <v> is the
vector of the coordinates, <n> its length, and <w> the coordinate beside it; of a quaternion <n> is
|q|, which is left out where it is 1.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from itertools import chain, groupby

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
    said,
)
from rigidsym.notes.figure.camera import Vector
from rigidsym.notes.figure.drawing import drawn
from rigidsym.notes.figure.scene import Arc, Kind, Posed, scene_of
from rigidsym.notes.formula.derivation_letters import VECTOR

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


_RODRIGUES = r"""
Let $\mathbf{e}$ be the unit vector along the axis and $\alpha$ the angle of the turn. A vector
$\mathbf{x}'$ has a part along the axis and a part perpendicular to it,

= \mathbf{x}'
= \mathbf{x}'_{\parallel} + \mathbf{x}'_{\perp}

with $\mathbf{x}'_{\parallel} = (\mathbf{e}\cdot\mathbf{x}')\,\mathbf{e}$. The turn keeps the first
part. It moves the second in the plane spanned by $\mathbf{x}'_{\perp}$ and
$\mathbf{e}\times\mathbf{x}'$, which are perpendicular and of equal length:

= \mathbf{x}
= \mathbf{x}'_{\parallel} + \cos\alpha\,\mathbf{x}'_{\perp}
  + \sin\alpha\,\mathbf{e}\times\mathbf{x}'

Since $\mathbf{x}'_{\perp} = -\mathbf{e}\times(\mathbf{e}\times\mathbf{x}')$, this is Rodrigues'
formula

= \mathbf{x}
= \mathbf{x}' + \sin\alpha\,\mathbf{e}\times\mathbf{x}'
  + (1 - \cos\alpha)\,\mathbf{e}\times(\mathbf{e}\times\mathbf{x}')
"""
_LENGTHS = {  # what the vector is, and the coefficients that follow
    "axis_angle": r"""
Here $\alpha = <w>$.
""",
    "rotation_vector": r"""
Here $<v> = \alpha\,\mathbf{e}$, so that $\alpha = <n>$, and the coefficients of
$<v>\times\mathbf{x}'$ and $<v>\times(<v>\times\mathbf{x}')$ are $\frac{\sin <n>}{<n>}$ and
$\frac{1 - \cos <n>}{<n>^2}$. For small angles they tend to 1 and to $\frac{1}{2}$, so that the
rotation vector has no singularity there.
""",
    "gibbs_vector": r"""
Here $<v> = \tan\frac{\alpha}{2}\,\mathbf{e}$. With $<n> = \tan\frac{\alpha}{2}$,

= \sin\alpha
= \frac{2 <n>}{1 + <n>^2}

= 1 - \cos\alpha
= \frac{2 <n>^2}{1 + <n>^2}

so that both coefficients, of $<v>\times\mathbf{x}'$ and of $<v>\times(<v>\times\mathbf{x}')$, are
$\frac{2}{1 + <n>^2}$.
""",
    "modified_rodrigues": r"""
Here $<v> = \tan\frac{\alpha}{4}\,\mathbf{e}$. With $<n> = \tan\frac{\alpha}{4}$,

= \sin\alpha
= \frac{4 <n>\,(1 - <n>^2)}{(1 + <n>^2)^2}

= 1 - \cos\alpha
= \frac{8 <n>^2}{(1 + <n>^2)^2}
""",
}
_QUATERNION = r"""
The quaternion $\mathbf{q} = <w> + <v>$ has a scalar and a vector part. Quaternions are multiplied
by the rule

= (a + \mathbf{a})\,(b + \mathbf{b})
= a\,b - \mathbf{a}\cdot\mathbf{b} + a\,\mathbf{b} + b\,\mathbf{a} + \mathbf{a}\times\mathbf{b}

and $\mathbf{q}^{\ast} = <w> - <v>$ is the conjugate, so that
$\mathbf{q}\,\mathbf{q}^{\ast} = <n>^2$. The quaternion takes $\mathbf{x}'$ to

= \mathbf{x}
= \frac{1}{<n>^2}\,\mathbf{q}\,\mathbf{x}'\,\mathbf{q}^{\ast}
= \mathbf{x}' + \frac{2}{<n>^2}\left(<w>\,<v>\times\mathbf{x}'
  + <v>\times(<v>\times\mathbf{x}')\right)

With $<w> = <n>\cos\frac{\alpha}{2}$ and
$<v> = <n>\sin\frac{\alpha}{2}\,\mathbf{e}$, where $\mathbf{e}$ is a unit vector, the
coefficients are $2\cos\frac{\alpha}{2}\sin\frac{\alpha}{2} = \sin\alpha$ and
$2\sin^2\frac{\alpha}{2} = 1 - \cos\alpha$. By Rodrigues' formula this is the turn by $\alpha$ about
$\mathbf{e}$.
"""
_OF_TURNING = r"""
If only the angle changes, the angular velocity is $\dot{\alpha}\,\mathbf{e}$. If only the axis
moves, a rotation $\mathbf{Q}$ with the angular velocity $\mathbf{e}\times\dot{\mathbf{e}}$ carries
it along. The turn about the moved axis undoes $\mathbf{Q}$, turns about the former axis and applies
$\mathbf{Q}$ again; its angular velocity is

= \mathbf{e}\times\dot{\mathbf{e}} - \mathbf{R}\,(\mathbf{e}\times\dot{\mathbf{e}})
= (1 - \cos\alpha)\,\mathbf{e}\times\dot{\mathbf{e}} + \sin\alpha\,\dot{\mathbf{e}}

by Rodrigues' formula. Both together are

= \boldsymbol{\Omega}
= \dot{\alpha}\,\mathbf{e} + \sin\alpha\,\dot{\mathbf{e}}
  + (1 - \cos\alpha)\,\mathbf{e}\times\dot{\mathbf{e}}

The derivative of the rotation matrix leads to the same result.
"""
_OF_RATES = r"""
Keep $<n>$ constant. Differentiating $<n>^2\,\mathbf{x} =
\mathbf{q}\,\mathbf{x}'\,\mathbf{q}^{\ast}$ for a point at rest in the body gives
$\dot{\mathbf{x}} = \boldsymbol{\Omega}\times\mathbf{x}$ with

= \boldsymbol{\Omega}
= \frac{2}{<n>^2}\,\dot{\mathbf{q}}\,\mathbf{q}^{\ast}

= \boldsymbol{\Omega}'
= \frac{2}{<n>^2}\,\mathbf{q}^{\ast}\,\dot{\mathbf{q}}

Multiplied by $\mathbf{q}$, this is the equation that attitude software integrates:

= \dot{\mathbf{q}}
= \frac{1}{2}\,\boldsymbol{\Omega}\,\mathbf{q}
= \frac{1}{2}\,\mathbf{q}\,\boldsymbol{\Omega}'

The derivative of the rotation matrix leads to the same result.
"""
_QUATERNIONS = ("quaternion", "unit_quaternion", "cayley_klein")


def is_told(model: RotationModel) -> bool:
    """Whether there are words on how the coordinates turn a vector."""
    return model.name.removesuffix("_passive") in (*_QUATERNIONS, *_LENGTHS)


def rotation_in_words(model: RotationModel, letters: Letters) -> Iterator[NoteBlock]:
    """How the coordinates turn a vector; nothing for other models."""
    name = model.name.removesuffix("_passive")
    if name in _QUATERNIONS:
        yield from _blocks(_QUATERNION, model, letters)
    elif name in _LENGTHS:
        yield from _blocks(_RODRIGUES + _LENGTHS[name], model, letters)


def rates_in_words(model: RotationModel, letters: Letters) -> Iterator[NoteBlock]:
    """The angular velocity as a product of quaternions, or of a turn whose axis moves."""
    name = model.name.removesuffix("_passive")
    if name in _QUATERNIONS:
        yield from _blocks(_OF_RATES, model, letters)
    elif name in _LENGTHS:
        yield from _blocks(_OF_TURNING, model, letters)


def _blocks(text: str, model: RotationModel, letters: Letters) -> Iterator[NoteBlock]:
    if "α" in model.convention[0]:  # a parameter of Cayley and Klein
        text = text.replace(r"\alpha", r"\gamma")
    others = [q for q in model.coordinates if q not in model.vector]
    spans: dict[str, Formula] = {"v": VECTOR}
    spans |= {"w": formula_of(others[0], letters)} if others else {}
    if letters.length:
        spans["n"] = letters.names[letters.length.symbol]
    else:  # it is 1
        text = re.sub(r"\\frac\{(\d)\}\{<n>\^2\}", r"\1", text).replace("$<n>^2$", "1")
        text = text.replace("Keep $<n>$ constant. ", "")
        text = re.sub(r"(?<!\d)1\\,|<n>(\^2)?(\\,|(?=\\))", "", text).replace("<n>^2", "1")
    blocks = text.strip().split("\n\n")
    for is_formula, group in groupby(blocks, lambda block: block.startswith("= ")):
        if is_formula:
            parts = (block.removeprefix("= ").split("\n= ") for block in group)
            yield EquationRow(
                tuple(
                    Equation(sides=tuple(formula(*_with_spans(side, spans)) for side in sides))
                    for sides in parts
                )
            )
        else:
            yield from (_paragraph(" ".join(block.split()), spans) for block in group)


def _with_spans(typed: str, spans: Mapping[str, Formula]) -> tuple[str, *tuple[Formula, ...]]:
    """The formula with #1, #2, ... for the letters of the model, and these."""
    for place, name in enumerate(spans, start=1):
        typed = typed.replace(f"<{name}>", f"#{place}")
    return (typed, *spans.values())


def _paragraph(text: str, spans: Mapping[str, Formula]) -> Paragraph:
    parts = text.split("$")
    formulas = [formula(*_with_spans(part, spans)) for part in parts[1::2]]
    words = "".join(part if k % 2 == 0 else "{}" for k, part in enumerate(parts))
    return said(words, *formulas)
