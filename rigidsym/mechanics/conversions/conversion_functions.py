"""Conversions as functions: their arguments, their values in order, and remarks on them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TypeVar

import sympy as sp

from rigidsym.formula.reader import text_of
from rigidsym.mechanics.conversions.closed_forms import ClosedForm
from rigidsym.mechanics.conversions.conversions import (
    UNIT,
    Conversions,
    Rule,
)
from rigidsym.mechanics.conversions.davenport_angles import DavenportAngles
from rigidsym.mechanics.conversions.function import (
    Continuity,
    ConversionFunction,
    ConversionInput,
    Converted,
    NamedValues,
    Where,
    argument_of,
    square,
    symbols,
)
from rigidsym.mechanics.conversions.turn_chain import TurnChain
from rigidsym.mechanics.conversions.unit_quaternions import (
    QUATERNION,
    SHEPPERD,
    scalar_last,
    scaled,
    shepperd,
    short_way,
    unit,
)
from rigidsym.mechanics.derivation import Argument, Derivation, Step
from rigidsym.models.rotation import RotationModel

MATRIX = tuple(f"r{row}{column}" for row in (1, 2, 3) for column in (1, 2, 3))
Each = TypeVar("Each")


_TWO_SETS = (
    "Two sets of angles in [−π, π] give each rotation, and whole turns may be added to them. Each "
    "sample gets the angles nearest to the sample before. At a pole, the undetermined angle is "
    "taken from the last sample away from poles; a sample within 32 eps (radians) of a pole counts "
    "as at the pole, which changes R by up to twice that."
)
_WHOLE_TURNS = "No angle of a turn changes by more than π from one sample to the next."


def converted(derivation: Derivation) -> Converted:
    """The functions of the conversions; where there is no inverse, a remark says why."""
    conversions = Conversions(derivation.model)
    inverse = conversions.inverse
    steps, functions = _quaternion(derivation, conversions)
    if inverse is not None:
        functions += (_from_quaternion(derivation, inverse), from_matrix(derivation, inverse))
        functions += _shadow_sets(derivation, inverse)
    names = {step.quantity.name for step in derivation.steps}
    variants = (v for v in conversions.variants if v.quantity.name.removesuffix(UNIT) in names)
    return Converted(
        steps=(*steps, *variants),
        functions=functions,
        continuity=_continuity(derivation, inverse) if inverse else None,
        remarks=(conversions.without,) if conversions.without else (),
    )


def _quaternion(
    derivation: Derivation, conversions: Conversions
) -> tuple[tuple[Step, ...], tuple[ConversionFunction, ...]]:
    """The unit quaternion, as a step where it has a formula of its own."""
    number_in_note = len(derivation.steps) + 1
    rule = conversions.inverse
    if isinstance(rule, ClosedForm) and conversions.variants:
        return (), (_of_any_length(derivation, rule, number_in_note),)
    if isinstance(rule, ClosedForm) and rule.rule == "rotation_vector":
        return (), (_of_rotation_vector(derivation, number_in_note),)
    if conversions.quaternion is not None:
        return (replace(conversions.quaternion, number=number_in_note),), ()
    return (), (_quaternion_of_matrix(derivation),)


def _inputs(derivation: Derivation, inverse: Rule) -> list[ConversionInput]:
    """The arguments beside the rotation."""
    found = []
    if "parameters" in inverse.given:
        found.append(ConversionInput(argument=derivation.argument("parameters")))
    if "kept" in inverse.given:
        kept = _kept(derivation, inverse.kept)
        found.append(ConversionInput(argument=kept, is_optional=True))
    return found


def _kept(derivation: Derivation, places: Sequence[int]) -> Argument:
    """The coordinates that a rotation does not determine."""
    q = derivation.argument("q")

    def chosen(of_all: Sequence[Each]) -> tuple[Each, ...]:
        return tuple(of_all[place] for place in places)

    return q._replace(
        name="kept",
        symbols=chosen(q.symbols),
        names=chosen(q.names),
        notation=chosen(q.notation),
        units=chosen(q.units),
        about="coordinates that the rotation does not determine",
    )


def _from_quaternion(derivation: Derivation, inverse: Rule) -> ConversionFunction:
    given = symbols(QUATERNION)
    values = NamedValues(given[0])
    quaternion = scaled(values, given)
    order = "last" if inverse.is_scalar_last else "first"
    listed = scalar_last(given) if inverse.is_scalar_last else given
    rotation = argument_of("quaternion", listed, f"a quaternion of any length, scalar {order}")
    return values.function(
        "from_quaternion",
        [ConversionInput(argument=rotation), *_inputs(derivation, inverse)],
        inverse.from_quaternion(values, quaternion),
        f"the coordinates of a quaternion, scalar {order}",
        *_remarks(inverse),
        "The length of the quaternion does not matter; a zero quaternion gives NaN.",
        unit=_unit(derivation.model),
    )


def from_matrix(derivation: Derivation, inverse: Rule) -> ConversionFunction:
    """The function `from_rotation_matrix`."""
    model = derivation.model
    given = symbols(MATRIX)
    values = NamedValues(given[0])
    matrix = sp.Matrix(3, 3, given)
    outputs = inverse.from_matrix(values, matrix.T if model.passive else matrix)
    shown = "A, the transpose of R" if model.passive else "R"
    rotation = argument_of("matrix", given, f"a rotation matrix {shown}")
    return values.function(
        "from_rotation_matrix",
        [ConversionInput(argument=rotation, is_matrix=True), *_inputs(derivation, inverse)],
        outputs,
        f"the coordinates of a rotation matrix {shown}, as `rotation_matrix` gives it",
        *_remarks(inverse),
        f"The largest component of the quaternion is computed first ({SHEPPERD}). The matrix is "
        "assumed to be a rotation; this is not checked.",
        unit=_unit(model),
    )


def _remarks(inverse: Rule) -> tuple[str, ...]:
    source = (f"Source: {inverse.source}.",) if inverse.source else ()
    return (text_of(inverse.because), text_of(inverse.branch), *source)


def _unit(model: RotationModel) -> str:
    units = dict.fromkeys(model.coordinate_units)
    return next(iter(units)) if len(units) == 1 else f"({', '.join(model.coordinate_units)})"


def _quaternion_of_matrix(derivation: Derivation) -> ConversionFunction:
    """The quaternion of a rotation that is known by its matrix alone."""
    model = derivation.model
    found = {step.quantity.name: step.expression for step in derivation.steps}
    presented = found.get("rotation_matrix")
    if presented is None:
        matrix = sp.Matrix(model.matrix)
    else:
        matrix = sp.Matrix(presented.T if model.passive else presented)
    entries = symbols(MATRIX)
    values = NamedValues(model.coordinates[0])
    quaternion = short_way(values, shepperd(values, sp.Matrix(3, 3, entries)))
    names = ("q", "parameters") if model.constants else ("q",)
    function = values.function(
        "quaternion",
        [ConversionInput(argument=derivation.argument(name)) for name in names],
        unit(values, quaternion),
        "unit quaternion of the rotation, scalar first and not negative",
        f"Its largest component is computed first, from R ({SHEPPERD}).",
        symbol="p",
    )
    return replace(function, shared=tuple(zip(entries, matrix, strict=True)))


def _of_any_length(
    derivation: Derivation, rule: ClosedForm, number_in_note: int
) -> ConversionFunction:
    q, is_last = derivation.model.coordinates, rule.is_scalar_last
    values = NamedValues(q[0])
    parts = unit(values, scaled(values, (q[3], *q[:3]) if is_last else q))
    order = "last" if is_last else "first"
    return values.function(
        "quaternion",
        [ConversionInput(argument=derivation.argument("q"))],
        scalar_last(parts) if is_last else parts,
        f"unit quaternion of the rotation, scalar {order}",
        f"Equation ({number_in_note}) of the note.",
        "The coordinates are divided by their length; zero gives NaN.",
        symbol="p",
    )


def _of_rotation_vector(derivation: Derivation, number_in_note: int) -> ConversionFunction:
    """Where n² is too small for a float, sin(n/2)/n is 1/2."""
    q = derivation.argument("q")
    values = NamedValues(q.symbols[0])
    size = values.let("square", square(q.symbols))
    none = sp.Eq(size, 0)
    length = values.let("length", sp.sqrt(Where(none, sp.S.One, size)))
    factor = values.let("factor", Where(none, sp.S.Half, sp.sin(length / 2) / length))
    return values.function(
        "quaternion",
        [ConversionInput(argument=q)],
        [Where(none, sp.S.One, sp.cos(length / 2)), *(factor * part for part in q.symbols)],
        "unit quaternion of the rotation, scalar first: cos(n/2) and v sin(n/2)/n",
        f"Equation ({number_in_note}) of the note; accurate at every length.",
        symbol="p",
    )


def _shadow_sets(derivation: Derivation, inverse: Rule) -> tuple[ConversionFunction, ...]:
    """The other set of modified Rodrigues parameters, and the shorter of both."""
    if not isinstance(inverse, ClosedForm) or inverse.rule != "modified_rodrigues":
        return ()
    q = derivation.argument("q")
    shadow, shorter = NamedValues(q.symbols[0]), NamedValues(q.symbols[0])
    size = shadow.let("square", square(q.symbols))
    length = shorter.let("square", square(q.symbols))
    scale = shorter.let("scale", Where(length > 1, -length, sp.S.One))
    return (
        shadow.function(
            "shadow_set",
            [ConversionInput(argument=q)],
            [-part / size for part in q.symbols],
            "the other set of the same rotation, −s/(s·s)",
            "The shadow of zero is at infinity; the result is NaN.",
            symbol="s",
        ),
        shorter.function(
            "shorter_set",
            [ConversionInput(argument=q)],
            [part / scale for part in q.symbols],
            "the same rotation by the set with s·s ≤ 1: the shadow set where s·s > 1",
            symbol="s",
        ),
    )


def _continuity(derivation: Derivation, inverse: Rule) -> Continuity | None:
    """The continuity of the coordinates; None if they are unique."""
    if not isinstance(inverse, ClosedForm):
        return _of_turns(derivation, inverse)
    if not inverse.continuity:
        return None
    kind = "quaternion" if inverse.has_both_signs else inverse.rule
    return Continuity(kind=kind, inputs=("q",), remarks=(inverse.continuity,))


def _of_turns(derivation: Derivation, rule: DavenportAngles | TurnChain) -> Continuity:
    model = derivation.model
    names = ("q", *(name for name in rule.given if name == "parameters"))
    inputs = [ConversionInput(argument=derivation.argument(name)) for name in names]
    values = NamedValues(model.coordinates[0])
    relation = rule.relation(values)
    turns = values.function(
        "turns_of_coordinates",
        inputs,
        [*rule.turn_angles(), *relation],
        "angles of the turns",
        symbol="",
    )
    found = symbols(f"turn_{k}" for k in range(1, len(rule.places) + 1))
    followed = rule.inverse * (sp.Matrix(found) - sp.Matrix(rule.offsets))
    placed = dict(zip(rule.places, followed, strict=True))
    coordinates = NamedValues(model.coordinates[0]).function(
        "coordinates_of_turns",
        [*inputs, ConversionInput(argument=argument_of("turns", found, "angles of the turns"))],
        [placed.get(place, q) for place, q in enumerate(model.coordinates)],
        "coordinates",
        symbol="",
        unit=_unit(model),
    )
    remarks = [_TWO_SETS if relation else _WHOLE_TURNS]
    if len(rule.places) < len(model.coordinates):
        remarks.append("Coordinates that the rotation does not determine are not changed.")
    return Continuity(
        kind="turns", inputs=names, remarks=tuple(remarks), turns=turns, coordinates=coordinates
    )
