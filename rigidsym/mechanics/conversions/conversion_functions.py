"""Conversions as functions: their arguments, their values in order, and what is said of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

import sympy as sp

from rigidsym.formula.sentence import text_of
from rigidsym.mechanics.conversions.chain_inverse import at_poles, chain_coordinates, outer_angles
from rigidsym.mechanics.conversions.closed_forms import ClosedForm
from rigidsym.mechanics.conversions.closed_inverse import BOTH_SIGNS, RULES, unit
from rigidsym.mechanics.conversions.continuity import Continuity, continuity_of
from rigidsym.mechanics.conversions.conversions import (
    SHEPPERD,
    UNIT,
    Conversions,
    InverseConversion,
    outer_product,
)
from rigidsym.mechanics.conversions.davenport_angles import DavenportAngles
from rigidsym.mechanics.conversions.function import (
    ConversionFunction,
    ConversionInput,
    argument_of,
    function_of,
)
from rigidsym.mechanics.conversions.turn_chain import TurnChain
from rigidsym.mechanics.conversions.values import (
    MATRIX,
    QUATERNION,
    NamedValues,
    Vector,
    Where,
    nearest,
    rounded,
    scalar_last,
    scaled,
    short_way,
    square,
    symbols,
)
from rigidsym.mechanics.derivation import Argument, Derivation, Step
from rigidsym.models.rotation import RotationModel

Each = TypeVar("Each")


@dataclass(frozen=True, kw_only=True, slots=True)
class Converted:
    """What a module offers of conversions."""

    steps: tuple[Step, ...] = ()  # in closed form, like other quantities
    functions: tuple[ConversionFunction, ...] = ()
    continuity: Continuity | None = None
    remarks: tuple[str, ...] = ()  # for the head of the module


def converted(derivation: Derivation, conversions: Conversions) -> Converted:
    """The functions of the conversions; where there is no inverse, a remark says why."""
    inverse = conversions.inverse
    steps, functions = _quaternion(derivation, conversions)
    if inverse is not None:
        functions += (_from_quaternion(derivation, inverse), _from_matrix(derivation, inverse))
        functions += _shadow_sets(derivation, inverse)
    names = {step.quantity.name for step in derivation.steps}
    variants = (v for v in conversions.variants if v.quantity.name.removesuffix(UNIT) in names)
    return Converted(
        steps=(*steps, *variants),
        functions=functions,
        continuity=continuity_of(derivation, inverse) if inverse else None,
        remarks=(conversions.without,) if conversions.without else (),
    )


def _quaternion(
    derivation: Derivation, conversions: Conversions
) -> tuple[tuple[Step, ...], tuple[ConversionFunction, ...]]:
    """The unit quaternion, as a step where it has a formula of its own."""
    number_in_note = len(derivation.steps) + 1
    rule = conversions.inverse.rule if conversions.inverse else None
    if isinstance(rule, ClosedForm) and conversions.variants:
        return (), (_of_any_length(derivation, rule, number_in_note),)
    if isinstance(rule, ClosedForm) and rule.rule == "rotation_vector":
        return (), (_of_rotation_vector(derivation, number_in_note),)
    if conversions.quaternion is not None:
        return (replace(conversions.quaternion, number=number_in_note),), ()
    return (), (_quaternion_of_matrix(derivation),)


def _inputs(derivation: Derivation, inverse: InverseConversion) -> list[ConversionInput]:
    """The arguments beside the rotation."""
    found = []
    if "parameters" in inverse.given:
        found.append(ConversionInput(argument=derivation.argument("parameters")))
    if isinstance(inverse.rule, TurnChain) and inverse.rule.kept:
        found.append(ConversionInput(argument=_kept(derivation, inverse.rule), is_optional=True))
    return found


def _kept(derivation: Derivation, rule: TurnChain) -> Argument:
    """The coordinates that a rotation does not determine."""
    q = derivation.argument("q")

    def chosen(of_all: Sequence[Each]) -> tuple[Each, ...]:
        return tuple(of_all[place] for place in rule.kept)

    return replace(
        q,
        name="kept",
        symbols=chosen(q.symbols),
        names=chosen(q.names),
        notation=chosen(q.notation),
        units=chosen(q.units),
        about="coordinates that the rotation does not determine",
    )


def _from_quaternion(derivation: Derivation, inverse: InverseConversion) -> ConversionFunction:
    given = symbols(QUATERNION)
    values = NamedValues(given[0])
    quaternion = scaled(values, given)
    order = "last" if inverse.is_scalar_last else "first"
    listed = scalar_last(given) if inverse.is_scalar_last else given
    rotation = argument_of("quaternion", listed, f"a quaternion of any length, scalar {order}")
    return function_of(
        "from_quaternion",
        "q",
        [ConversionInput(argument=rotation), *_inputs(derivation, inverse)],
        values,
        _coordinates(values, derivation.model, inverse, quaternion),
        f"the coordinates of a quaternion, scalar {order}",
        *_remarks(inverse),
        "Its length does not matter; zero gives NaN.",
        unit=_unit(derivation.model),
    )


def _from_matrix(derivation: Derivation, inverse: InverseConversion) -> ConversionFunction:
    model, rule = derivation.model, inverse.rule
    given = symbols(MATRIX)
    values = NamedValues(given[0])
    matrix = sp.Matrix(3, 3, given)
    matrix = matrix.T if model.passive else matrix
    if isinstance(rule, ClosedForm) and rule.rule == "direction_cosines":
        outputs = _in_order(tuple(matrix), rule.order)
    elif isinstance(rule, DavenportAngles):
        left, right = rule.turned
        turned = sp.Matrix(3, 3, [rounded(entry) for entry in left * matrix * right])
        outputs = _davenport(values, rule, shepperd(values, turned))
    else:
        quaternion = shepperd(values, matrix)
        if isinstance(rule, ClosedForm) and rule.rule in BOTH_SIGNS:
            quaternion = short_way(values, quaternion)
        outputs = _coordinates(values, model, inverse, quaternion)
    shown = "A, the transpose of R" if model.passive else "R"
    rotation = argument_of("matrix", given, f"a rotation matrix {shown}")
    return function_of(
        "from_rotation_matrix",
        "q",
        [ConversionInput(argument=rotation, is_matrix=True), *_inputs(derivation, inverse)],
        values,
        outputs,
        f"the coordinates of a rotation matrix {shown}, as `rotation_matrix` gives it",
        *_remarks(inverse),
        f"The quaternion is read off from R by its largest component ({SHEPPERD}). The matrix is "
        "taken to be a rotation; that is not checked.",
        unit=_unit(model),
    )


def _remarks(inverse: InverseConversion) -> tuple[str, ...]:
    source = (f"Source: {inverse.source}.",) if inverse.source else ()
    return (text_of(inverse.because), text_of(inverse.branch), *source)


def _unit(model: RotationModel) -> str:
    units = dict.fromkeys(model.coordinate_units)
    return next(iter(units)) if len(units) == 1 else f"({', '.join(model.coordinate_units)})"


def _coordinates(
    values: NamedValues, model: RotationModel, inverse: InverseConversion, quaternion: Vector
) -> Vector:
    """The coordinates of a scaled quaternion."""
    rule = inverse.rule
    if isinstance(rule, TurnChain):
        found = dict(zip(rule.places, chain_coordinates(values, rule, quaternion), strict=True))
        found |= {place: model.coordinates[place] for place in rule.kept}
        return tuple(found[place] for place in range(len(model.coordinates)))
    if isinstance(rule, DavenportAngles):
        parts = map(rounded, rule.forms * sp.Matrix(quaternion))
        return _davenport(values, rule, values.each(("a0", "a1", "a2", "a3"), parts))
    return _in_order(RULES[rule.rule](values, quaternion), rule.order)


def _in_order(found: Vector, order: Sequence[int]) -> Vector:
    """What a rule gives, in the order of the model's coordinates."""
    placed = dict(zip(order, found, strict=True))
    return tuple(placed[place] for place in range(len(found)))


def _davenport(values: NamedValues, rule: DavenportAngles, parts: Vector) -> Vector:
    """The angles from the quaternion in the frame of the turns."""
    far, near = values.length("far", parts[:2]), values.length("near", parts[2:])
    total = values.let("half_sum", sp.atan2(parts[1], parts[0]))
    difference = values.let("half_difference", sp.atan2(parts[3], parts[2]))
    sign = -1 if rule.last_is_first_turn else 1
    total, difference = at_poles(values, (near, far), (total, difference), sign)
    middle = rule.sign * (2 * sp.atan2(near, far) - nearest(rule.offset))
    first, last = outer_angles(values, total, difference)
    return _in_order((first, middle, last), rule.places)


def shepperd(values: NamedValues, matrix: sp.Matrix) -> Vector:
    """The column of 4 p pᵀ with the largest diagonal entry, so that nothing cancels.

    Its scalar is not negative where the first column is taken.
    """
    outer = outer_product(matrix)
    names = [[f"k{a}{b}" for b in QUATERNION] for a in QUATERNION]
    w, x, y, z = (
        values.each(names[k], [outer[min(j, k), max(j, k)] for j in range(4)]) for k in range(4)
    )
    by_x, by_z = x[1] > w[0], z[3] > y[2]
    upper = values.let("upper", Where(by_x, x[1], w[0]))
    lower = values.let("lower", Where(by_z, z[3], y[2]))
    return values.each(
        QUATERNION,
        [Where(lower > upper, Where(by_z, z[k], y[k]), Where(by_x, x[k], w[k])) for k in range(4)],
    )


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
    function = function_of(
        "quaternion",
        "p",
        [ConversionInput(argument=derivation.argument(name)) for name in names],
        values,
        unit(values, quaternion),
        "unit quaternion of the rotation, scalar first and not negative",
        f"It is read off from R by its largest component ({SHEPPERD}).",
    )
    return replace(function, shared=tuple(zip(entries, matrix, strict=True)))


def _of_any_length(
    derivation: Derivation, rule: ClosedForm, number_in_note: int
) -> ConversionFunction:
    q, is_last = derivation.model.coordinates, rule.is_scalar_last
    values = NamedValues(q[0])
    parts = unit(values, scaled(values, (q[3], *q[:3]) if is_last else q))
    order = "last" if is_last else "first"
    return function_of(
        "quaternion",
        "p",
        [ConversionInput(argument=derivation.argument("q"))],
        values,
        scalar_last(parts) if is_last else parts,
        f"unit quaternion of the rotation, scalar {order}",
        f"Equation ({number_in_note}) of the note.",
        "The coordinates are divided by their length; zero gives NaN.",
    )


def _of_rotation_vector(derivation: Derivation, number_in_note: int) -> ConversionFunction:
    """Where n² is too small for a float, sin(n/2)/n is 1/2."""
    q = derivation.argument("q")
    values = NamedValues(q.symbols[0])
    size = values.let("square", square(q.symbols))
    none = sp.Eq(size, 0)
    length = values.let("length", sp.sqrt(Where(none, sp.S.One, size)))
    factor = values.let("factor", Where(none, sp.S.Half, sp.sin(length / 2) / length))
    return function_of(
        "quaternion",
        "p",
        [ConversionInput(argument=q)],
        values,
        [Where(none, sp.S.One, sp.cos(length / 2)), *(factor * part for part in q.symbols)],
        "unit quaternion of the rotation, scalar first: cos(n/2) and v sin(n/2)/n",
        f"Equation ({number_in_note}) of the note; accurate at every length.",
    )


def _shadow_sets(
    derivation: Derivation, inverse: InverseConversion
) -> tuple[ConversionFunction, ...]:
    """The other set of modified Rodrigues parameters, and the shorter of both."""
    if not isinstance(inverse.rule, ClosedForm) or inverse.rule.rule != "modified_rodrigues":
        return ()
    q = derivation.argument("q")
    shadow, shorter = NamedValues(q.symbols[0]), NamedValues(q.symbols[0])
    size = shadow.let("square", square(q.symbols))
    length = shorter.let("square", square(q.symbols))
    scale = shorter.let("scale", Where(length > 1, -length, sp.S.One))
    return (
        function_of(
            "shadow_set",
            "s",
            [ConversionInput(argument=q)],
            shadow,
            [-part / size for part in q.symbols],
            "the other set of the same rotation, −s/(s·s)",
            "The shadow of zero is at infinity and comes as NaN.",
        ),
        function_of(
            "shorter_set",
            "s",
            [ConversionInput(argument=q)],
            shorter,
            [part / scale for part in q.symbols],
            "the same rotation by the set with s·s ≤ 1: the shadow set where s·s > 1",
        ),
    )
