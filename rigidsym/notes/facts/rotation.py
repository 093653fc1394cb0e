"""A rotation before its matrix: its coordinates, its axes, its figure, the vector behind it."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cached_property
from typing import Any

import sympy as sp

from rigidsym.formula import tree
from rigidsym.formula.letters import Letters
from rigidsym.formula.reader import formula
from rigidsym.formula.scalars import formula_of
from rigidsym.mechanics.derivation import Derivation
from rigidsym.mechanics.quantities.kinematics import SPACE
from rigidsym.mechanics.quantities.table import is_quaternion
from rigidsym.models.rotation import RotationModel, Turn, by_axis, carried_axes
from rigidsym.notes.document import Equation, EquationRow, Figure, NoteBlock, Text
from rigidsym.notes.figure.drawing import drawn
from rigidsym.notes.figure.scene import free_angle, scene_of
from rigidsym.notes.template import figure_with
from rigidsym.notes.words import symbols_of, unit_in_words, with_symbols
from rigidsym.system.records import NamedTuple, Record

PROPER = ("precession", "nutation", "spin")
TAIT_BRYAN = ("yaw", "pitch", "roll")
_QUATERNIONS = ("quaternion", "unit_quaternion")
_VECTORS = ("axis_angle", "rotation_vector", "gibbs_vector", "modified_rodrigues")
_TURN_ANGLES = ("beta", "chi", "delta", "epsilon")  # one that no coordinate is called by is taken
_MOST_WRITTEN = 3  # axes that are written out


def facts_of_rotation(derivation: Derivation, letters: Letters) -> dict[str, Any]:
    """The facts of the templates on conventions and on the rotation, by their names there."""
    q, model, body = derivation.argument("q"), derivation.model, derivation.body
    symbols, length = symbols_of(derivation, letters.own), letters.length
    symbols |= {turn.angle_text: formula_of(turn.angle, letters) for turn in model.turns}
    inputs = {name for step in derivation.steps for name in step.quantity.inputs}
    quantities = {step.quantity.name for step in derivation.steps}
    unit, *other_units = sorted({*q.units})
    units = dict(zip(model.coordinates, q.units, strict=True))
    pairs = [condition.as_coeff_Add() for condition in model.constraints]
    return {
        "derivation": derivation,
        "model": model,
        "angles": angle_facts(model),
        "rotation": RotationFacts(model, letters),
        "convention": {
            "sentences": [with_symbols(words, symbols) for words in model.convention],
            "names": q.notation,
            # that all coordinates have in common
            "unit": unit_in_words(unit) if unit and not other_units else "",
            # the names in programs, if those of the note are others
            "programs": q.names if is_quaternion(q.names, q.units) else (),
            # which the proofs make use of
            "conditions": [
                tree.equal(formula_of(moving, letters), formula_of(-number, letters))
                for number, moving in pairs
            ],
            # the components of v, the letters of a length and of its rate, if formulas hold them
            "vector": model.vector if any(step.vector_form for step in derivation.steps) else (),
            "unit_of_vector": next((units[q] for q in model.vector[:1]), ""),
            "length": tuple(length.names.values()) if length else (),
            "is_length_of_vector": length is not None and length.components == model.vector,
            # whether any quantity depends on the position of the centre of mass
            "is_centre_used": not derivation.forces or inputs & {"centre", "centre_dot"},
            "mass": derivation.step("mass").quantity.symbol
            if "mass" in quantities
            else body and body.mass,
        },
    }


class AngleFacts(NamedTuple):
    """What Euler angles are called, in the order of the factors."""

    all: tuple[sp.Expr, ...]
    are_proper: bool  # precession, nutation and spin: the outer axes are alike
    are_tait_bryan: bool  # yaw, pitch and roll
    have_these_names: bool
    are_exchanged: bool  # yaw and roll have the letters that aerospace texts give to roll and yaw


def angle_facts(model: RotationModel) -> AngleFacts | None:
    """None unless R is three turns by its coordinates about axes, no two in a row alike."""
    axes, angles = [t.axis for t in model.turns], tuple(t.angle for t in model.turns)
    if len(axes) != 3 or {*angles} != {*model.coordinates} or axes[1] in (axes[0], axes[2]):
        return None
    if any(t.components for t in model.turns):
        return None
    names = tuple(angle.func.__name__ for angle in angles)
    are_proper, are_tait_bryan = axes[0] == axes[2], axes == ["z", "y", "x"]
    return AngleFacts(
        angles,
        are_proper,
        are_tait_bryan,
        have_these_names=names == (PROPER if are_proper else TAIT_BRYAN),
        are_exchanged=are_tait_bryan and names == ("phi", "theta", "psi"),
    )


class RotationFacts(Record):
    """How the rotation is made, and where its angular velocity comes from."""

    model: RotationModel
    letters: Letters

    @property
    def name(self) -> str:
        """Of the parametrisation."""
        return self.model.name.removesuffix("_passive")

    @property
    def is_quaternion(self) -> bool:
        return self.name in _QUATERNIONS

    @property
    def is_vector(self) -> bool:
        return self.name in _VECTORS

    @property
    def product(self) -> tree.Formula:
        return product_of(self.model.turns, self.letters)

    @cached_property
    def figure(self) -> Figure | None:
        """Of a product of turns, or of one turn about a vector; None for any other model."""
        scene = scene_of(self.model, self.letters)
        if scene is None:
            return None
        posed = scene.shown
        kinds = ("space", "body", "node", "vector")
        named = [(k, [ray.name for ray in posed.rays if ray.kind == k]) for k in kinds]
        return figure_with(
            "en/figure",
            drawn(posed, scene.view.camera),
            self.letters,
            kinds=[(kind, names) for kind, names in named if names],
            turns=self.model.turns,
            has_oblique_axes=any(t.components for t in self.model.turns),
            down=posed.rays[2].name if self.model.z_down else None,
            # each with the rays of its axis and of the line that it carries along, if there are any
            arcs=[(a, *map(posed.named, (a.axis, a.before, a.after))) for a in posed.arcs],
        )

    @property
    def any_angle(self) -> sp.Symbol:
        taken = {coordinate.func.__name__ for coordinate in self.model.coordinates}
        return sp.Symbol(next(name for name in _TURN_ANGLES if name not in taken))

    @property
    def matrices(self) -> list[NoteBlock]:
        """Of a turn by any angle about each axis."""
        pairs = [
            (t, Equation(sides=(product_of((t,), self.letters),), matrix=matrix))
            for t, matrix in by_axis(self.model.turns, self.any_angle)
        ]
        short = tuple(equation for t, equation in pairs if not t.components)
        oblique = [equation for t, equation in pairs if t.components]
        return [*([EquationRow(short)] if short else []), *oblique]

    @property
    def alpha(self) -> sp.Symbol:
        """The angle of the rotation."""
        return sp.Symbol(free_angle(self.model))

    @property
    def scalar(self) -> sp.Expr:
        """The coordinate beside the vector."""
        return next(q for q in self.model.coordinates if q not in self.model.vector)

    @property
    def length(self) -> tree.Formula | str:
        """The letter of the length; nothing where it is 1."""
        return self.letters.names[self.letters.length.symbol] if self.letters.length else ""

    @cached_property
    def sum(self) -> tree.Formula | None:
        """Ω as a sum over the turns, if it can be read off."""
        is_sum = len(self.model.turns) > 1 and all(t.rate for t in self.model.turns)
        return sum_of_turns(self.model, self.letters) if is_sum else None

    @cached_property
    def axes(self) -> EquationRow | None:
        """The axes in space components, if they are few and short."""
        turns = self.model.turns
        if len(turns) > _MOST_WRITTEN or any(t.components for t in turns):
            return None
        pairs = zip(axes_of_turns(self.model, self.letters), carried_axes(turns), strict=True)
        return EquationRow(tuple(Equation(sides=(name,), matrix=axis) for name, axis in pairs))

    @property
    def has_carried_axes(self) -> bool:
        return _carried(2) in axes_of_turns(self.model, self.letters)


def product_of(turns: Iterable[Turn], letters: Letters) -> tree.Formula:
    """R_z(φ) R_[0, 3/5, 4/5](θ): each turn with the letter or the components of its axis."""

    def axis_of(turn: Turn) -> tree.Formula:
        if not turn.components:
            return tree.Symbol(turn.axis)
        components = [formula_of(component, letters) for component in turn.components]
        return tree.Bracket(tree.joined(components, tree.COMMA), "[]")

    pairs = ((axis_of(turn), formula_of(turn.angle, letters)) for turn in turns)
    return tree.row(*(formula(r"\R_{#1}(#2)", *pair) for pair in pairs))


def title_of(derivation: Derivation, letters: Letters) -> Text:
    """The title, with each turn in it as a formula, so that lines may break between turns."""
    turns = {str(turn): product_of([turn], letters) for turn in derivation.model.turns}
    return with_symbols(derivation.title, turns) if turns else (derivation.title,)


def axes_of_turns(model: RotationModel, letters: Letters) -> list[tree.Formula]:
    """The unit vectors about which the turns are made, named after the figure: e_z, e_N, e_z′."""
    scene = scene_of(model, letters)
    rays = [scene.shown.named(arc.axis) for arc in scene.shown.arcs] if scene else []
    if not rays or not all(rays) or len(rays) != len(model.turns):
        return [_carried(k) for k in range(1, len(model.turns) + 1)]
    return [formula(r"\e_{#1}", ray.name) for ray in rays if ray]


def _carried(k: int) -> tree.Formula:
    """P_{k-1} n_k: the k-th axis, as the rotations before it carry it along."""
    return formula((rf"\P_{{{k - 1}}}\," if k > 1 else "") + rf"\n_{{{k}}}")


def sum_of_turns(model: RotationModel, letters: Letters) -> tree.Formula:
    """Ω = φ̇ e_z + θ̇ e_N + ψ̇ e_z′; turns by constant angles add nothing."""
    terms = [
        tree.row(tree.bracketed(formula_of(turn.rate, letters)), axis)
        for turn, axis in zip(model.turns, axes_of_turns(model, letters), strict=True)
        if turn.rate != 0
    ]
    return tree.equal(SPACE.omega, tree.joined(terms, tree.PLUS))
