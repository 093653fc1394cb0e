"""Coordinates that are continuous along a trajectory: which kind, and what it needs to know."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import sympy as sp

from rigidsym.mechanics.conversions.conversions import InverseConversion
from rigidsym.mechanics.conversions.davenport_angles import DavenportAngles
from rigidsym.mechanics.conversions.function import (
    ConversionFunction,
    ConversionInput,
    argument_of,
    function_of,
)
from rigidsym.mechanics.conversions.middle_angle import angle_between, flat_angle
from rigidsym.mechanics.conversions.turn_chain import TurnChain
from rigidsym.mechanics.conversions.values import NamedValues, nearest, symbols
from rigidsym.mechanics.derivation import Derivation


@dataclass(frozen=True, kw_only=True, slots=True)
class Continuity:
    """How coordinates are made continuous; only turns need functions."""

    kind: str
    inputs: tuple[str, ...]  # names of arguments
    remarks: tuple[str, ...]
    # From the coordinates to the angles and what relates two sets of them, and back.
    turns: ConversionFunction | None = None
    coordinates: ConversionFunction | None = None


_REMARKS: Mapping[str, str] = {
    "quaternion": "Of p and −p the one nearer to the sample before: exact, since only signs "
    "change.",
    "cayley_klein": "Of the parameters and their negatives those nearer to the sample before: "
    "exact, since only signs change.",
    "axis_angle": "The axis turns by at most π/2 from one sample to the next, and the angle "
    "changes by at most π. Where there is no turn, the axis is that of the sample before.",
    "rotation_vector": "The axis turns by at most π/2 from one sample to the next, and the length "
    "goes on beyond π, also through whole turns.",
    "modified_rodrigues": "Of the two sets the one whose quaternion is nearer to that of the "
    "sample before; at a whole turn it is infinite.",
}
_TWO_SETS = (
    "Two sets of angles in [−π, π] give each rotation, and whole turns may be added to them. Each "
    "sample gets the angles nearest to the sample before. At a pole, the undetermined angle is "
    "taken from the last sample away from poles; what is within 32 eps (radians) of a pole counts "
    "as there, and R is off by up to twice that."
)
_WHOLE_TURNS = "No angle of a turn changes by more than π from one sample to the next."


def continuity_of(derivation: Derivation, inverse: InverseConversion) -> Continuity | None:
    """The continuity of the coordinates; None if they are unique."""
    rule = inverse.rule
    if isinstance(rule, DavenportAngles | TurnChain):
        return _of_turns(derivation, rule, inverse.given)
    if rule.rule not in _REMARKS:
        return None
    kind = "quaternion" if rule.rule == "cayley_klein" else rule.rule
    return Continuity(kind=kind, inputs=("q",), remarks=(_REMARKS[rule.rule],))


def _of_turns(
    derivation: Derivation, rule: DavenportAngles | TurnChain, given: Sequence[str]
) -> Continuity:
    model = derivation.model
    names = ("q", *(name for name in given if name == "parameters"))
    inputs = [ConversionInput(argument=derivation.argument(name)) for name in names]
    values = NamedValues(model.coordinates[0])
    if isinstance(rule, DavenportAngles):
        angles = [model.coordinates[place] for place in rule.places]
        base = -rule.sign * nearest(rule.offset)
        relation: Sequence[sp.Expr] = (base, sp.S.Zero, sp.pi, *_ACROSS)
        followed, offsets = sp.eye(3), sp.zeros(3, 1)
    else:
        count = 3 if rule.has_two_sets else len(rule.places)
        angles = [turn.angle for turn in rule.solved[:count]]
        relation = _relation(values, rule) if rule.has_two_sets else ()
        followed, offsets = rule.inverse, sp.Matrix(rule.offsets)
    places: tuple[int, ...] = rule.places
    turns = function_of(
        "turns_of_coordinates", "", inputs, values, [*angles, *relation], "angles of the turns"
    )
    found = symbols(f"turn_{k}" for k in range(1, len(places) + 1))
    placed = dict(zip(places, followed * (sp.Matrix(found) - offsets), strict=True))
    coordinates = function_of(
        "coordinates_of_turns",
        "",
        [*inputs, ConversionInput(argument=argument_of("turns", found, "angles of the turns"))],
        NamedValues(model.coordinates[0]),
        [placed.get(place, q) for place, q in enumerate(model.coordinates)],
        "coordinates",
    )
    remarks = [_TWO_SETS if relation else _WHOLE_TURNS]
    if len(places) < len(model.coordinates):
        remarks.append("What the rotation does not determine stays as it is.")
    return Continuity(
        kind="turns", inputs=names, remarks=tuple(remarks), turns=turns, coordinates=coordinates
    )


_ACROSS = (sp.S.One, sp.S.Zero, sp.S.Zero, sp.S.One)  # exactly, as no cosine of π/2 is


def _relation(values: NamedValues, rule: TurnChain) -> tuple[sp.Expr, ...]:
    """The flat middle angle, the difference and the sum of the sides, and of half of each its
    cosine and its sine."""
    first, middle, last = (values.each(("axis_x", "axis_y", "axis_z"), axis) for axis in rule.axes)
    sides = angle_between(values, first, middle), angle_between(values, middle, last)
    base = flat_angle(values, first, middle, last)
    apart = values.let("apart", sides[0] - sides[1])
    together = values.let("together", sides[0] + sides[1])
    if rule.is_across:
        return base, apart, together, *_ACROSS
    halves = (apart / 2, together / 2)
    return base, apart, together, *(f(half) for half in halves for f in (sp.cos, sp.sin))
