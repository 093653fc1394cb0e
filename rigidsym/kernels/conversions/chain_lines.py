"""Lines that take a quaternion to the coordinates of turns about any axes."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import sympy as sp

from rigidsym.kernels.conversions.formulas import QUATERNION, Line
from rigidsym.kernels.conversions.halves_lines import POLES, halves
from rigidsym.kernels.conversions.three_lines import three_turns
from rigidsym.kernels.conversions.writing_lines import LineWriter, Local, Vector
from rigidsym.kernels.lowering.naming import Names
from rigidsym.mechanics.conversions.davenport import dot, quaternion_product
from rigidsym.mechanics.conversions.turn_chain import ChainTurns
from rigidsym.models.rotation import RotationModel, Turn

_LOCAL = (
    *QUATERNION,
    *(f"{half}_{part}" for half in ("plus", "minus") for part in QUATERNION),
    *("near", "far", "swing", "beyond", "bend", "half", "cosine", "sine", "opened", "closed"),
    *("half_sum", "half_difference", "middle", "first_side", "third_side", "side", "base", "size"),
    *(
        "apart",
        "together",
        "near_side",
        "far_side",
        "turn_1",
        "turn_2",
        "turn_3",
        "kx",
        "ky",
        "kz",
        "kw",
        "by_x",
        "by_z",
    ),
    *("whole", "other", "third", "guess", "least", "sign", "along", "across", "step", "weight"),
    *("miss", "miss_2", "miss_3", "slope", "slope_2", "slope_3"),
    *("wx", "wy", "wz", "xy", "xz", "yz", "second", "matrix", "p", "kept", "parameters"),
    *(f"r{i}{j}" for i in (1, 2, 3) for j in (1, 2, 3)),
)


@dataclass(frozen=True, kw_only=True, slots=True)
class ChainInputs:
    """What is given beside the rotation, by the names of a signature."""

    constants: tuple[str, ...]
    kept: tuple[str, ...]
    names: Mapping[sp.Expr, str]


def inputs_of(
    model: RotationModel,
    rule: ChainTurns,
    constants: Sequence[sp.Expr],
    reserved: Iterable[str],
) -> ChainInputs:
    """Constants and kept coordinates under names that none of the lines uses."""
    free = Names((*_LOCAL, *reserved))
    fixed = {symbol: free.fresh(symbol.name) for symbol in constants}
    kept = {q: free.fresh(q.func.__name__) for q in (model.coordinates[k] for k in rule.kept)}
    return ChainInputs(
        constants=tuple(fixed.values()),
        kept=tuple(kept.values()),
        names={**fixed, **kept},
    )


def chain_lines(
    model: RotationModel, rule: ChainTurns, inputs: ChainInputs
) -> tuple[tuple[Line, ...], tuple[str, ...]]:
    """Lines from a quaternion (w, x, y, z) of any length to the coordinates, and these."""
    writer = LineWriter(inputs.names, taken=_LOCAL)
    parts = _freed(writer, rule)
    axes = [writer.shared(axis) for axis in rule.axes]
    if len(rule.solved) == 3:
        angles = three_turns(writer, rule, parts, axes)
    elif len(rule.solved) == 2:
        angles = _two(writer, parts, axes)
    else:
        angles = _one(writer, parts, axes[0])
    outputs = _coordinates(writer, model, rule, inputs, angles)
    return tuple(writer.lines), outputs


def _freed(writer: LineWriter, rule: ChainTurns) -> Vector:
    """The quaternion without the known turns."""
    parts: Vector = tuple(map(Local, QUATERNION))
    for turn in rule.before:
        parts = writer.let(QUATERNION, quaternion_product(_backward(writer, turn), parts))
    for turn in reversed(rule.right):
        parts = writer.let(QUATERNION, quaternion_product(parts, _backward(writer, turn)))
    return parts


def _backward(writer: LineWriter, turn: Turn) -> Vector:
    """The quaternion of the turn by −β."""
    half = -turn.angle / 2
    return tuple(writer.shared((sp.cos(half), *(sp.sin(half) * part for part in turn.direction))))


def _one(writer: LineWriter, parts: Vector, axis: Vector) -> tuple[str, ...]:
    (_, *vector), _ = halves(writer, parts, axis, axis)
    writer.let(["sine"], [dot(vector, axis)])
    writer.lines += [
        ("half_sum", "$atan2(sine, plus_w)"),
        ("half_sum", "$pick(swing > $reach, $nan, half_sum)"),
    ]
    return ("$wrapped(half_sum + half_sum)",)


def _two(writer: LineWriter, parts: Vector, axes: Sequence[Vector]) -> tuple[str, ...]:
    first, last = axes
    halves(writer, parts, first, last)
    _from_one(writer, parts, *_across_each_other(writer, first, last))
    side = writer.angle("side", first, last)
    writer.lines += [
        ("beyond", f"abs(swing - {side})"),
        *POLES,
        ("half_sum", "$pick(beyond > $reach, $nan, half_sum)"),
    ]
    return "$wrapped(half_sum + half_difference)", "$wrapped(half_sum - half_difference)"


def _from_one(writer: LineWriter, parts: Vector, sums: Vector, differences: Vector) -> None:
    """Half the sum and half the difference of two angles: from 1± to p±, counted about e₁.

    1± and e₁ 1± have the parts (s·s, ∓ d × s)/4 and (0, s)/2 with the sum s and the difference d
    of the axes, d in place of s for 1₋. So nothing cancels where the axes are nearly parallel or
    nearly opposite, and p± are short.
    """
    scalar, *vector = parts
    cross = sp.Matrix(differences).cross(sp.Matrix(sums))
    for name, sign, along in (("half_sum", -1, sums), ("half_difference", 1, differences)):
        by_one = writer.whole(part / 2 for part in (dot(along, along), *(sign * cross)))
        sine, cosine = dot(vector, writer.whole(along)), dot((scalar, *vector), by_one)
        writer.let(["sine", "cosine"], [sine, cosine])
        writer.lines.append((name, "$atan2(sine, cosine)"))


def _across_each_other(writer: LineWriter, first: Vector, last: Vector) -> tuple[Vector, Vector]:
    """The sum and the difference of two unit vectors.

    Axes that are rounded are not of one length, and the shorter of the two would hold some of the
    longer: that is taken off.
    """
    pairs = tuple(zip(first, last, strict=True))
    sums, differences = (tuple(a + sign * b for a, b in pairs) for sign in (1, -1))
    if all(part.is_number for part in (*first, *last)):
        return sums, differences
    s, d = writer.shared(sums), writer.shared(differences)
    sizes = writer.let([writer.fresh("v"), writer.fresh("v")], [dot(s, s), dot(d, d)])
    longer, common = Local(writer.fresh("v")), Local(writer.fresh("v"))
    writer.lines.append((longer.name, "$pick({0} > {1}, {0}, {1})".format(*sizes)))
    writer.lines.append((common.name, f"({writer.text(dot(s, d))}) / {longer}"))
    return (
        writer.shared(a - common * b for a, b in zip(s, d, strict=True)),
        writer.shared(b - common * a for a, b in zip(s, d, strict=True)),
    )


def _coordinates(
    writer: LineWriter,
    model: RotationModel,
    rule: ChainTurns,
    inputs: ChainInputs,
    angles: Sequence[str],
) -> tuple[str, ...]:
    """The coordinates in their order: what the angles give, and what is kept."""
    if rule.inverse == sp.eye(len(angles)) and not any(rule.offsets):
        found = list(angles)
    else:
        names = [f"turn_{k + 1}" for k in range(len(angles))]
        writer.lines += zip(names, angles, strict=True)
        turns = sp.Matrix([*map(Local, names)]) - sp.Matrix(rule.offsets)
        found = [writer.text(entry) for entry in rule.inverse * turns]
    placed = dict(zip(rule.places, found, strict=True)) | dict(
        zip(rule.kept, inputs.kept, strict=True)
    )
    return tuple(placed[place] for place in range(len(model.coordinates)))
