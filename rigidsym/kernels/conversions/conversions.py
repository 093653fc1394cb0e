"""Conversions of a model -> formulas with arctangents and choices, in no language yet."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import sympy as sp

from rigidsym.kernels import ir
from rigidsym.kernels.conversions.chain_lines import ChainInputs, chain_lines, inputs_of
from rigidsym.kernels.conversions.formulas import (
    BOTH_SIGNS,
    LENGTH,
    MATRIX,
    QUATERNION,
    RULES,
    SCALED,
    SHORT_WAY,
    Line,
    of_quaternion,
    shepperd,
)
from rigidsym.kernels.conversions.unwrap import Unwrapping, unwrapping_of
from rigidsym.kernels.conversions.writing_lines import number
from rigidsym.kernels.lowering.lower import lower
from rigidsym.mechanics.conversions.closed_forms import ClosedForm
from rigidsym.mechanics.conversions.conversions import SHEPPERD, UNIT, Backward, Conversions
from rigidsym.mechanics.conversions.davenport_angles import ThreeTurns
from rigidsym.mechanics.conversions.turn_chain import ChainTurns
from rigidsym.mechanics.derivation import Derivation, Step
from rigidsym.models.rotation import RotationModel

Rule = ThreeTurns | ChainTurns | ClosedForm

_FRAME = ("a0", "a1", "a2", "a3")


@dataclass(frozen=True, kw_only=True, slots=True)
class Formula:
    """One conversion as a function of a vector, or of the coordinates and the constants."""

    name: str
    arguments: tuple[str, ...]  # "p", "matrix", "q", "parameters", "kept"
    inputs: tuple[str, ...]  # the names of their components; empty: all, passed on to R
    lines: tuple[Line, ...]
    outputs: tuple[str, ...]
    about: str  # one line
    remarks: tuple[str, ...]  # paragraphs
    unit: str = ""
    kept: tuple[str, ...] = ()  # the last inputs, the components of "kept": 0 where left out

    @property
    def components(self) -> dict[str, tuple[str, ...]]:
        """The inputs by argument."""
        end = len(self.inputs) - len(self.kept)
        sizes = {"p": len(QUATERNION), "matrix": len(MATRIX)}
        start = sizes.get(self.arguments[0], end)
        found = {"parameters": self.inputs[start:end], "kept": self.kept}
        return {a: found.get(a, self.inputs[:start]) for a in self.arguments}


@dataclass(frozen=True, kw_only=True, slots=True)
class ConversionProgram:
    """What a module offers beside the quantities of its derivation."""

    arguments: tuple[ir.Argument, ...]  # of the kernels
    kernels: tuple[ir.Kernel, ...]  # in closed form: the quaternion, and variants
    formulas: tuple[Formula, ...]
    unwrapping: Unwrapping | None
    remarks: tuple[str, ...]  # for the module's docstring


def lower_conversions(
    derivation: Derivation, conversions: Conversions, reserved: Iterable[str] = ()
) -> ConversionProgram:
    """The conversions as kernels and formulas; what cannot be computed is left out and said."""
    _, formulas, missing = _forward(derivation, conversions)
    program = lower(in_closed_form(derivation, conversions), tuple(reserved))
    backward, unwrapping = conversions.backward, None
    if backward is not None:
        constants = _constants(derivation)
        given = _given(derivation.model, backward.rule, constants, reserved)
        formulas += (*_backward(derivation.model, backward, given), *_shadow_sets(backward.rule))
        unwrapping = unwrapping_of(derivation.model, backward.rule, constants, reserved)
    return ConversionProgram(
        arguments=_with_parameters(derivation, program.arguments, formulas),
        kernels=program.kernels,
        formulas=formulas,
        unwrapping=unwrapping,
        remarks=tuple(text for text in (missing, conversions.without) if text),
    )


def in_closed_form(derivation: Derivation, conversions: Conversions) -> Derivation:
    """The conversions that are quantities like others, as the steps of a derivation."""
    steps, _, _ = _forward(derivation, conversions)
    names = {step.quantity.name for step in derivation.steps}
    variants = (v for v in conversions.variants if v.quantity.name.removesuffix(UNIT) in names)
    return replace(derivation, steps=(*steps, *variants), singularities=None)


def _with_parameters(
    derivation: Derivation, arguments: tuple[ir.Argument, ...], formulas: Iterable[Formula]
) -> tuple[ir.Argument, ...]:
    """The arguments, and the constants where formulas alone take them."""
    if not any("parameters" in formula.arguments for formula in formulas):
        return arguments
    (found,) = (a for a in derivation.arguments if a.name == "parameters")
    constants = ir.Argument(
        name=found.name, components=found.names, units=found.units, about=found.about
    )
    return tuple({a.name: a for a in (constants, *arguments)}.values())


def _forward(
    derivation: Derivation, conversions: Conversions
) -> tuple[tuple[Step, ...], tuple[Formula, ...], str]:
    """The quaternion as a step, or as a formula, or why there is none."""
    step, number = conversions.quaternion, len(derivation.steps) + 1  # as in the note
    if _is_rule(conversions, "rotation_vector"):
        return (), (_quaternion_of_rotation_vector(number),), ""
    if conversions.variants:
        return (), (_quaternion_of_any_length(derivation.model, number),), ""
    if step is not None:
        return (replace(step, number=number),), (), ""
    if any(s.quantity.name == "rotation_matrix" for s in derivation.steps):
        return (), (_quaternion_of_matrix(derivation.model),), ""
    return (), (), "The quaternion is taken from R: ask for rotation_matrix to have it."


def _is_rule(conversions: Conversions, name: str) -> bool:
    rule = conversions.backward and conversions.backward.rule
    return isinstance(rule, ClosedForm) and rule.rule == name


def _constants(derivation: Derivation) -> tuple[sp.Expr, ...]:
    """All that "parameters" holds, of the body too, where the rotation has constants."""
    if not derivation.model.constants:
        return ()
    return derivation.argument("parameters").symbols


def _given(
    model: RotationModel, rule: Rule, constants: Sequence[sp.Expr], reserved: Iterable[str]
) -> ChainInputs:
    """What a rule needs beside the rotation."""
    if isinstance(rule, ChainTurns):
        return inputs_of(model, rule, constants, reserved)
    return ChainInputs(constants=(), kept=(), names={})


def _backward(model: RotationModel, backward: Backward, given: ChainInputs) -> tuple[Formula, ...]:
    """from_quaternion and from_rotation_matrix."""
    quaternion, matrix = _ways(model, backward.rule, given)
    shown = "A, the transpose of R" if model.passive else "R"
    source = (f"Source: {backward.source}.",) if backward.source else ()
    shared = (backward.because, backward.branch, *source)
    names = (*given.constants, *given.kept)
    return (
        Formula(
            name="from_quaternion",
            arguments=("p", *backward.given),
            inputs=(*QUATERNION, *names),
            kept=given.kept,
            lines=quaternion.lines,
            outputs=quaternion.outputs,
            about="The coordinates of a quaternion, scalar first.",
            remarks=(*shared, "Its length does not matter; zero gives NaN."),
            unit=_unit(model),
        ),
        Formula(
            name="from_rotation_matrix",
            arguments=("matrix", *backward.given),
            inputs=(*MATRIX, *names),
            kept=given.kept,
            lines=matrix.lines,
            outputs=matrix.outputs,
            about=f"The coordinates of a rotation matrix {shown}, as `rotation_matrix` gives it.",
            remarks=(
                *shared,
                f"The quaternion is read off from R by its largest component ({SHEPPERD}). The "
                "matrix is taken to be a rotation; that is not checked.",
            ),
            unit=_unit(model),
        ),
    )


def _unit(model: RotationModel) -> str:
    units = dict.fromkeys(model.coordinate_units)
    return next(iter(units)) if len(units) == 1 else f"({', '.join(model.coordinate_units)})"


@dataclass(frozen=True, slots=True)
class _Way:
    """Lines, and what they give in the order of the coordinates."""

    lines: tuple[Line, ...]
    outputs: tuple[str, ...]


def _ways(model: RotationModel, rule: Rule, given: ChainInputs) -> tuple[_Way, _Way]:
    """From the quaternion, and from the matrix."""
    if isinstance(rule, ChainTurns):
        after, outputs = chain_lines(model, rule, given)
        read_off = (*_plain(model), *shepperd(QUATERNION))
        return _Way((*SCALED, *after), outputs), _Way((*read_off, *after), outputs)
    if isinstance(rule, ThreeTurns):
        quaternion, matrix = _turn_lines(rule, model)
        after, outputs = _angle_lines(rule)
        return _Way((*quaternion, *after), outputs), _Way((*matrix, *after), outputs)
    after, unordered = RULES[rule.rule]()
    outputs = _in_order(unordered, rule.order)
    from_quaternion = _Way((*SCALED, *after), outputs)
    if rule.rule == "direction_cosines":
        return from_quaternion, _Way(_plain(model), MATRIX)
    sign = SHORT_WAY if rule.rule in BOTH_SIGNS else ()
    read_off = (*_plain(model), *shepperd(QUATERNION), *sign)
    return from_quaternion, _Way((*read_off, *after), outputs)


def _in_order(outputs: tuple[str, ...], order: tuple[int, ...]) -> tuple[str, ...]:
    """What a rule gives, in the order of the model's coordinates."""
    placed = dict(zip(order, outputs, strict=True))
    return tuple(placed[place] for place in range(len(outputs)))


def _plain(model: RotationModel) -> tuple[Line, ...]:
    """R from what is given, where that is the transpose."""
    if not model.passive:
        return ()
    return (("r12, r13, r21, r23, r31, r32", "r21, r31, r12, r32, r13, r23"),)


def _turn_lines(
    rule: ThreeTurns, model: RotationModel
) -> tuple[tuple[Line, ...], tuple[Line, ...]]:
    """Lines to a0 to a3, the quaternion in the frame of the turns, from p and from R."""
    forms = rule.forms
    from_quaternion = tuple(
        (name, _linear(forms[k, :], QUATERNION)) for k, name in enumerate(_FRAME)
    )
    left, right = rule.turned
    entries = [
        _linear([left[i, a] * right[b, j] for a in range(3) for b in range(3)], MATRIX)
        for i in range(3)
        for j in range(3)
    ]
    renamed = tuple((f"s{name[1:]}", e) for name, e in zip(MATRIX, entries, strict=True))
    back = tuple((f"r{name[1:]}", f"s{name[1:]}") for name in MATRIX)
    turned = (*_joined(renamed), *_joined(back))
    return (*SCALED, *from_quaternion), (*_plain(model), *turned, *shepperd(_FRAME))


def _joined(lines: Sequence[Line]) -> tuple[Line, ...]:
    """Three assignments in a line, which is how matrices are read."""
    rows = [lines[k : k + 3] for k in range(0, len(lines), 3)]
    if any(len(value) > 12 for _, value in lines):
        return tuple(lines)
    return tuple((", ".join(n for n, _ in row), ", ".join(v for _, v in row)) for row in rows)


def _linear(coefficients: Iterable[sp.Expr], names: Sequence[str]) -> str:
    """The sum of numbers times names."""
    terms = []
    for coefficient, name in zip(coefficients, names, strict=True):
        value = number(coefficient)
        if value:
            size = name if abs(value) == 1 else f"{abs(value)!r} * {name}"
            terms.append(("- " if value < 0 else "+ ") + size)
    text = " ".join(terms).removeprefix("+ ")
    return "-" + text.removeprefix("- ") if text.startswith("- ") else text


def _angle_lines(rule: ThreeTurns) -> tuple[tuple[Line, ...], tuple[str, ...]]:
    """Lines from a0 to a3 to the angles, by the half sum and the half difference."""
    sign = "-" if rule.last_is_first_turn else ""
    offset = number(rule.offset)
    middle = "2.0 * $atan2(near, far)"
    if rule.sign > 0:
        middle += f" - {offset!r}" if offset else ""
    else:
        middle = f"{offset!r} - {middle}"
    lines: tuple[Line, ...] = (
        ("near", "$hypot(a2, a3)"),
        ("far", "$hypot(a0, a1)"),
        ("half_sum", "$atan2(a1, a0)"),
        ("half_difference", "$atan2(a3, a2)"),
        ("half_difference", f"$pick(near <= $tiny * far, {sign}half_sum, half_difference)"),
        ("half_sum", f"$pick(far <= $tiny * near, {sign}half_difference, half_sum)"),
    )
    angles = (
        "$wrapped(half_sum + half_difference)",
        middle,
        "$wrapped(half_sum - half_difference)",
    )
    return lines, _in_order(angles, rule.places)


def _quaternion_of_matrix(model: RotationModel) -> Formula:
    """The quaternion of a rotation that is known by its matrix alone."""
    return Formula(
        name="quaternion",
        arguments=("q", "parameters") if model.constants else ("q",),
        inputs=(),
        lines=(*_plain(model), *shepperd(QUATERNION), *SHORT_WAY, *LENGTH),
        outputs=of_quaternion()[1],
        about="The unit quaternion of the rotation, scalar first and not negative.",
        remarks=(f"It is read off from R by its largest component ({SHEPPERD}).",),
    )


def _quaternion_of_any_length(model: RotationModel, number: int) -> Formula:
    scalar_last = model.coordinates[0] in model.vector
    return Formula(
        name="quaternion",
        arguments=("q",),
        inputs=(*QUATERNION[1:], QUATERNION[0]) if scalar_last else QUATERNION,
        lines=(*SCALED, *LENGTH),
        outputs=of_quaternion()[1],
        about="The unit quaternion of the rotation, scalar first.",
        remarks=(
            f"Equation ({number}) of the note.",
            "The coordinates are divided by their length; zero gives NaN.",
        ),
    )


def _quaternion_of_rotation_vector(number: int) -> Formula:
    return Formula(
        name="quaternion",
        arguments=("q",),
        inputs=("x", "y", "z"),
        lines=(
            ("angle", "$sqrt(x * x + y * y + z * z)"),
            ("divisor", "$pick(angle == 0.0, 1.0, angle)"),
            ("factor", "$pick(angle == 0.0, 0.5, $sin(0.5 * angle) / divisor)"),
        ),
        outputs=("$cos(0.5 * angle)", "factor * x", "factor * y", "factor * z"),
        about="The unit quaternion of the rotation, scalar first: cos n/2 and v sin(n/2)/n.",
        remarks=(
            f"Equation ({number}) of the note.",
            "Accurate at every length: where n² is too small for a float, sin(n/2)/n is 1/2.",
        ),
    )


def _shadow_sets(rule: Rule) -> tuple[Formula, ...]:
    """The other set of modified Rodrigues parameters, and the shorter of both."""
    if not isinstance(rule, ClosedForm) or rule.rule != "modified_rodrigues":
        return ()
    square = ("square", "x * x + y * y + z * z")
    return (
        Formula(
            name="shadow_set",
            arguments=("q",),
            inputs=("x", "y", "z"),
            lines=(square,),
            outputs=("-x / square", "-y / square", "-z / square"),
            about="The other set of the same rotation, −s/(s·s).",
            remarks=("The shadow of zero is at infinity and comes as NaN.",),
        ),
        Formula(
            name="shorter_set",
            arguments=("q",),
            inputs=("x", "y", "z"),
            lines=(square, ("scale", "$pick(square > 1.0, -square, 1.0)")),
            outputs=("x / scale", "y / scale", "z / scale"),
            about="The same rotation by the set with s·s ≤ 1: the shadow set where s·s > 1.",
            remarks=(),
        ),
    )
