"""A rotation before its matrix: its angles, its axes, its figure, the vector behind it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import sympy as sp

from rigidsym.formula.letters import Letters
from rigidsym.formula.reader import formula
from rigidsym.formula.scalars import formula_of
from rigidsym.formula.tree import (
    COMMA,
    PLUS,
    Apply,
    Bracket,
    Formula,
    Numeral,
    Symbol,
    bracketed,
    equal,
    joined,
    row,
)
from rigidsym.mechanics.quantities.kinematics import (
    COSINES_ARE_ORTHOGONAL,
    COSINES_ARE_SKEW,
    IS_SKEW,
    ORTHOGONAL,
    SPACE,
    SPIN,
    SPIN_OF_COSINES,
)
from rigidsym.models.rotation import SOURCES, RotationModel, Turn, by_axis, carried_axes, hat
from rigidsym.notes.document import Cited, Equation, EquationRow, Figure, NoteBlock
from rigidsym.notes.figure.drawing import drawn
from rigidsym.notes.figure.scene import Posed, scene_of
from rigidsym.notes.letters import VECTOR
from rigidsym.notes.template import texts_of

PROPER = ("precession", "nutation", "spin")
TAIT_BRYAN = ("yaw", "pitch", "roll")
GOLDSTEIN = SOURCES["Goldstein 4.9"]
OPERATOR = formula(r"\mathbf{C}(\mathbf{u})")  # of u ×
_QUATERNIONS = ("quaternion", "unit_quaternion", "cayley_klein")
_VECTORS = ("axis_angle", "rotation_vector", "gibbs_vector", "modified_rodrigues")
_TURN_ANGLES = ("beta", "chi", "delta", "epsilon")  # one that no coordinate is called by is taken
_MOST_WRITTEN = 3  # axes that are written out


def are_euler_angles(model: RotationModel) -> bool:
    """Whether R is three turns by its coordinates about coordinate axes, no two in a row alike."""
    turns = model.turns
    if len(turns) != 3 or {turn.angle for turn in turns} != set(model.coordinates):
        return False
    axes = [turn.axis for turn in turns]
    return axes[0] != axes[1] != axes[2] and not any(turn.components for turn in turns)


def turn(turn: Turn, letters: Letters) -> Formula:
    """R_z(φ), or R_[0, 3/5, 4/5](φ)."""
    return Apply(Symbol("R", "bold", index=axis_of(turn, letters)), formula_of(turn.angle, letters))


def axis_of(turn: Turn, letters: Letters) -> Formula:
    """The axis of a turn: its letter, or its components."""
    if not turn.components:
        return Symbol(turn.axis)
    return Bracket(joined([formula_of(c, letters) for c in turn.components], COMMA), "[]")


@dataclass(frozen=True)
class AngleFacts:
    """What Euler angles are called, and the ranges in which they are unique."""

    model: RotationModel

    @property
    def all(self) -> list[sp.Expr]:
        """In the order of the factors."""
        return [turn.angle for turn in self.model.turns]

    @property
    def are_proper(self) -> bool:
        """Precession, nutation and spin: the outer axes are alike."""
        return self.model.turns[0].axis == self.model.turns[2].axis

    @property
    def are_tait_bryan(self) -> bool:
        """Yaw, pitch and roll."""
        return [turn.axis for turn in self.model.turns] == ["z", "y", "x"]

    @property
    def have_these_names(self) -> bool:
        return self._names == (PROPER if self.are_proper else TAIT_BRYAN)

    @property
    def are_exchanged(self) -> bool:
        """Whether yaw and roll have the letters that aerospace texts give to roll and yaw."""
        return self.are_tait_bryan and self._names == ("phi", "theta", "psi")

    @property
    def _names(self) -> tuple[str, ...]:
        return tuple(angle.func.__name__ for angle in self.all)

    @property
    def middle(self) -> sp.Expr:
        return self.all[1]


def angle_facts(model: RotationModel) -> AngleFacts | None:
    return AngleFacts(model) if are_euler_angles(model) else None


@dataclass(frozen=True)
class RotationFacts:
    """How the rotation is made, and where its angular velocity comes from."""

    model: RotationModel
    letters: Letters

    @property
    def turns(self) -> tuple[Turn, ...]:
        return self.model.turns

    @property
    def is_product(self) -> bool:
        return len(self.turns) > 1

    @property
    def is_passive(self) -> bool:
        return self.model.passive

    @property
    def source(self) -> Cited:
        return Cited(self.model.source)

    @property
    def product(self) -> Formula:
        return row(*(turn(each, self.letters) for each in self.turns))

    @cached_property
    def figure(self) -> Figure | None:
        """Of a product of turns, or of one turn about a vector; None for any other model."""
        return figure_of(self.model, self.letters)

    @property
    def any_angle(self) -> sp.Symbol:
        taken = {coordinate.func.__name__ for coordinate in self.model.coordinates}
        return sp.Symbol(next(name for name in _TURN_ANGLES if name not in taken))

    @property
    def matrices(self) -> list[NoteBlock]:
        """Of a turn by any angle about each axis."""
        shown = [
            (t, Equation(sides=(turn(t, self.letters),), matrix=matrix))
            for t, matrix in by_axis(self.turns, self.any_angle)
        ]
        short = tuple(equation for t, equation in shown if not t.components)
        oblique = [equation for t, equation in shown if t.components]
        return [*([EquationRow(short)] if short else []), *oblique]

    @property
    def is_quaternion(self) -> bool:
        return self._name in _QUATERNIONS

    @property
    def is_vector(self) -> bool:
        return self._name in _VECTORS

    @property
    def is_axis_angle(self) -> bool:
        return self._name == "axis_angle"

    @property
    def is_rotation_vector(self) -> bool:
        return self._name == "rotation_vector"

    @property
    def is_gibbs_vector(self) -> bool:
        return self._name == "gibbs_vector"

    @property
    def _name(self) -> str:
        return self.model.name.removesuffix("_passive")

    @property
    def alpha(self) -> Formula:
        """The angle of the rotation; α may be a parameter of Cayley and Klein."""
        return formula(r"\gamma" if "α" in self.model.convention[0] else r"\alpha")

    @property
    def vector(self) -> Formula:
        return VECTOR

    @property
    def scalar(self) -> sp.Expr:
        """The coordinate beside the vector."""
        return next(q for q in self.model.coordinates if q not in self.model.vector)

    @property
    def length(self) -> Formula | str:
        """The letter of the length; nothing where it is 1."""
        return self.letters.names[self.letters.length.symbol] if self.letters.length else ""

    @property
    def is_sum(self) -> bool:
        """Whether Ω can be read off as a sum over the turns."""
        return self.is_product and all(turn.rate for turn in self.turns)

    @property
    def of_addition(self) -> Cited:
        return Cited(GOLDSTEIN)

    @property
    def sum(self) -> Equation:
        return Equation(sides=(sum_of_turns(self.model, self.letters),))

    @property
    def has_carried_axes(self) -> bool:
        return _carried(2) in axes_of_turns(self.model, self.letters)

    @property
    def axes(self) -> EquationRow | None:
        """The axes in space components, if they are few and short."""
        if len(self.turns) > _MOST_WRITTEN or any(turn.components for turn in self.turns):
            return None
        names = axes_of_turns(self.model, self.letters)
        pairs = zip(names, carried_axes(self.turns), strict=True)
        return EquationRow(tuple(Equation(sides=(name,), matrix=axis) for name, axis in pairs))

    @property
    def of_turning(self) -> Cited:
        return Cited(SOURCES["Landau 31"])

    @property
    def spin(self) -> Formula:
        return SPIN_OF_COSINES if self.is_passive else SPIN

    @property
    def orthogonal(self) -> Formula:
        return COSINES_ARE_ORTHOGONAL if self.is_passive else ORTHOGONAL

    @property
    def operator(self) -> EquationRow:
        """The matrix of u ×, and that the spin matrix is skew."""
        matrix = Equation(sides=(OPERATOR,), matrix=hat(sp.Matrix(sp.symbols("u_1:4"))))
        skew = COSINES_ARE_SKEW if self.is_passive else IS_SKEW
        return EquationRow((matrix, Equation(sides=(skew,))))


def axes_of_turns(model: RotationModel, letters: Letters) -> list[Formula]:
    """The unit vectors about which the turns are made, named after the figure: e_z, e_N, e_z′."""
    scene = scene_of(model, letters)
    posed = scene.posed(scene.view.angles) if scene else None
    rays = [posed.named(arc.axis) for arc in posed.arcs] if posed else []
    if not rays or not all(rays) or len(rays) != len(model.turns):
        return [_carried(k) for k in range(1, len(model.turns) + 1)]
    return [Symbol("e", "bold", index=ray.name) for ray in rays if ray]


def _carried(k: int) -> Formula:
    """P_{k-1} n_k: the k-th axis, as the rotations before it carry it along."""
    axis = Symbol("n", "bold", index=Numeral(str(k)))
    before = Symbol("P", "bold", index=Numeral(str(k - 1)))
    return row(before, axis) if k > 1 else axis


def sum_of_turns(model: RotationModel, letters: Letters) -> Formula:
    """Ω = φ̇ e_z + θ̇ e_N + ψ̇ e_z′; turns by constant angles add nothing."""
    axes = axes_of_turns(model, letters)
    terms = [
        row(bracketed(formula_of(turn.rate, letters)), axis)
        for turn, axis in zip(model.turns, axes, strict=True)
        if turn.rate != 0
    ]
    return equal(SPACE.omega, joined(terms, PLUS))


# The figure


class AxesFacts(NamedTuple):
    """Axes of one kind in a figure."""

    kind: str  # "space", "body"; any other is between them
    names: tuple[Formula, ...]
    turns: tuple[Turn, ...]

    @property
    def is_space(self) -> bool:
        return self.kind == "space"

    @property
    def is_body(self) -> bool:
        return self.kind == "body"

    @property
    def has_several(self) -> bool:
        return len(self.names) > 1

    @property
    def is_of_vector(self) -> bool:
        return not self.turns

    @property
    def is_of_one_rotation(self) -> bool:
        return len(self.turns) == 1

    @property
    def is_line_of_nodes(self) -> bool:
        return not any(turn.components for turn in self.turns)


class ArcFacts(NamedTuple):
    """A turn by an angle about an axis, which takes one line of the figure to another."""

    angle: Formula
    axis: Formula | None
    start: Formula | str
    end: Formula | str
    is_start_rotated: bool
    is_end_rotated: bool


@dataclass(frozen=True)
class FigureFacts:
    """Which axis is which in a figure, and what each turn does."""

    scene: Posed
    model: RotationModel

    @property
    def kinds(self) -> list[AxesFacts]:
        between = "node" if any(ray.kind == "node" for ray in self.scene.rays) else "vector"
        named = (
            (kind, tuple(ray.name for ray in self.scene.rays if ray.kind == kind))
            for kind in ("space", "body", between)
        )
        return [AxesFacts(kind, names, self.model.turns) for kind, names in named if names]

    @property
    def down(self) -> Formula | None:
        """The axis that points down."""
        return self.scene.rays[2].name if self.model.z_down else None

    @property
    def arcs(self) -> Iterator[ArcFacts]:
        for arc in self.scene.arcs:
            axis, start, end = map(self.scene.named, (arc.axis, arc.before, arc.after))
            yield ArcFacts(
                arc.turn.name,
                axis.name if axis else None,
                start.name if start else arc.turn.start_name,
                end.name if end else arc.turn.start_name,
                is_start_rotated=start is None,
                is_end_rotated=end is None,
            )


def figure_of(model: RotationModel, letters: Letters) -> Figure | None:
    """The figure of a product of turns, or of one turn about a vector; None for any other model."""
    scene = scene_of(model, letters)
    if scene is None:
        return None
    posed = scene.posed(scene.view.angles)
    caption, *description = texts_of("en/figure", letters, figure=FigureFacts(posed, model))
    return Figure(drawn(posed, scene.view.camera), caption, description[0] if description else ())
