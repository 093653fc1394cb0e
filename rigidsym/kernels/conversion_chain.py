"""Lines that take a quaternion to the angles of up to three turns about any axes."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import sympy as sp

from rigidsym.kernels.formulas import QUATERNION, Line
from rigidsym.kernels.naming import Names
from rigidsym.kernels.writing_lines import LineWriter, Local, number
from rigidsym.mechanics.conversion_chain import ChainTurns
from rigidsym.mechanics.davenport import quaternion_product
from rigidsym.models.rotation import RotationModel, Turn

Vector = tuple[sp.Expr, ...]

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
        angles = _three(writer, rule, parts, axes)
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


def _halves(
    writer: LineWriter, parts: Vector, first: Vector, last: Vector
) -> tuple[Vector, Vector]:
    """p₊ and p₋, their lengths as `far` and `near`, and twice the angle between as `swing`."""
    zero = sp.S.Zero
    across = quaternion_product(quaternion_product((zero, *first), parts), (zero, *last))
    halves = []
    for name, sign, length in (("plus", -1, "far"), ("minus", 1, "near")):
        half = tuple((a + sign * b) / 2 for a, b in zip(parts, across, strict=True))
        found = writer.let([f"{name}_{part}" for part in QUATERNION], half)
        writer.lines += [
            (length, f"{name}_w * {name}_w + {name}_x * {name}_x"),
            (length, f"$sqrt({length} + {name}_y * {name}_y + {name}_z * {name}_z)"),
        ]
        halves.append(found)
    writer.lines.append(("swing", "2.0 * $atan2(near, far)"))
    return halves[0], halves[1]


def _one(writer: LineWriter, parts: Vector, axis: Vector) -> tuple[str, ...]:
    (_, *vector), _ = _halves(writer, parts, axis, axis)
    writer.let(["sine"], [_dot(vector, axis)])
    writer.lines += [
        ("half_sum", "$atan2(sine, plus_w)"),
        ("half_sum", "$pick(swing > $reach, $nan, half_sum)"),
    ]
    return ("$wrapped(half_sum + half_sum)",)


def _two(writer: LineWriter, parts: Vector, axes: Sequence[Vector]) -> tuple[str, ...]:
    first, last = axes
    _halves(writer, parts, first, last)
    _from_one(writer, parts, *_across_each_other(writer, first, last))
    side = writer.angle("side", first, last)
    writer.lines += [
        ("beyond", f"abs(swing - {side})"),
        *_POLES,
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
        by_one = writer.whole(part / 2 for part in (_dot(along, along), *(sign * cross)))
        sine, cosine = _dot(vector, writer.whole(along)), _dot((scalar, *vector), by_one)
        writer.let(["sine", "cosine"], [sine, cosine])
        writer.lines.append((name, "$atan2(sine, cosine)"))


def _across_each_other(writer: LineWriter, first: Vector, last: Vector) -> tuple[Vector, Vector]:
    """The sum and the difference of two unit vectors.

    Axes that are rounded are not of one length, and the shorter of the two would hold some of the
    longer: that is taken off.
    """
    sums, differences = ([a + sign * b for a, b in zip(first, last, strict=True)] for sign in (1, -1))
    if all(part.is_number for part in (*first, *last)):
        return tuple(sums), tuple(differences)
    s, d = writer.shared(sums), writer.shared(differences)
    sizes = writer.let([writer.fresh("v"), writer.fresh("v")], [_dot(s, s), _dot(d, d)])
    longer, common = Local(writer.fresh("v")), Local(writer.fresh("v"))
    writer.lines.append((longer.name, "$pick({0} > {1}, {0}, {1})".format(*sizes)))
    writer.lines.append((common.name, f"({writer.text(_dot(s, d))}) / {longer}"))
    return (
        writer.shared(a - common * b for a, b in zip(s, d, strict=True)),
        writer.shared(b - common * a for a, b in zip(s, d, strict=True)),
    )


_POLES: tuple[Line, ...] = (
    ("half_difference", "$pick(near <= $tiny * far, half_sum, half_difference)"),
    ("half_sum", "$pick(far <= $tiny * near, half_difference, half_sum)"),
)


def _alike(mirror: int) -> tuple[Line, ...]:
    """Lines for outer angles that are equal, or opposite: the half that is 0 or π is made so."""
    fixed, short = ("half_difference", "near") if mirror > 0 else ("half_sum", "far")
    free, long = ("half_sum", "far") if mirror > 0 else ("half_difference", "near")
    return (
        ("apart", f"abs($sin({fixed})) * {short} / $hypot(near, far)"),
        ("is_turned", f"({short} > $tiny * {long}) & (abs({fixed}) > 0.5 * $pi)"),
        (fixed, "$pick(is_turned, 0.0 * half + $pi, 0.0 * half)"),
        (free, f"$pick({long} <= $tiny * {short}, 0.0 * half, {free})"),
        ("half_sum", "$pick(apart > $reach, $nan, half_sum)"),
    )


def _three(
    writer: LineWriter, rule: ChainTurns, parts: Vector, axes: Sequence[Vector]
) -> tuple[str, ...]:
    first, middle, last = axes
    plus, minus = _halves(writer, parts, first, last)
    before = writer.angle("first_side", first, middle)
    after = writer.angle("third_side", middle, last)
    base = writer.flat("base", first, middle, last)
    writer.lines += [
        ("apart", f"0.5 * abs({before} - {after})"),
        ("together", f"0.5 * ({before} + {after})"),
        ("half", "0.5 * swing"),
        ("opened", "$sin(half + apart) * $sin(half - apart)"),
        ("opened", "$pick(opened < 0.0, 0.0, opened)"),
        ("closed", "$sin(together + half) * $sin(together - half)"),
        ("closed", "$pick(closed < 0.0, 0.0, closed)"),
        ("bend", "2.0 * $atan2($sqrt(opened), $sqrt(closed))"),
        ("middle", _from_base(base)),
        ("cosine", "$cos(0.5 * middle)"),
        ("sine", "$sin(0.5 * middle)"),
    ]
    _outer(writer, axes, plus, minus)
    writer.lines += [
        ("near_side", "apart - half"),
        ("far_side", "half - $pick(together > 0.5 * $pi, $pi - together, together)"),
        ("beyond", "2.0 * $pick(near_side > far_side, near_side, far_side)"),
        *(_alike(rule.mirror) if rule.mirror else _POLES),
        ("half_sum", "$pick(beyond > $reach, $nan, half_sum)"),
    ]
    writer.lines.append(("middle", "middle + 0.0 * half_sum"))  # NaN where that is
    outer = "$wrapped(half_sum + half_difference)", "$wrapped(half_sum - half_difference)"
    return (outer[0], "middle") if rule.mirror else (outer[0], "middle", outer[1])


def _from_base(base: str) -> str:
    """The middle angle in the interval that ends at the flat triangle and holds 0."""
    if base == "base":
        return "base + $pick(base > 0.0, -bend, bend)"
    return f"{base} - bend" if float(base) > 0 else f"{base} + bend".removeprefix("0.0 + ")


def _outer(writer: LineWriter, axes: Sequence[Vector], plus: Vector, minus: Vector) -> None:
    """Half the sum and half the difference of the outer angles, for a middle angle that is known.

    They are the angles from m± to p±, both counted from a vector of their plane: 1± or e₂±,
    whichever is longer, so that nothing is lost where both p± and m± are short.
    """
    first, middle, last = axes
    cosine, sine = Local("cosine"), Local("sine")
    cross = sp.Matrix(first).cross(sp.Matrix(middle))
    before, after, opposite = _dot(first, middle), _dot(middle, last), _dot(first, last)
    volume = _dot(cross, last)
    for name, (scalar, *vector), sign in (("half_sum", plus, 1), ("half_difference", minus, -1)):
        lengths = (1 + sign * opposite) / 2, (1 + sign * (2 * before * after - opposite)) / 2
        mixed, skew = sign * volume / 2, (before + sign * after) / 2
        of_one = (
            *(scalar, _dot(vector, first)),
            *(cosine * lengths[0] + sine * mixed, sine * skew),
        )
        of_axis = (
            *(_dot(vector, middle), _dot(vector, cross) - before * scalar),
            *(cosine * mixed + sine * lengths[1], -cosine * skew),
        )
        a, b, c, d = _longer(writer, lengths, of_one, of_axis)
        writer.lines.append((name, f"$atan2({b} * {c} - {a} * {d}, {a} * {c} + {b} * {d})"))


def _longer(
    writer: LineWriter,
    lengths: tuple[sp.Expr, sp.Expr],
    of_one: Sequence[sp.Expr],
    of_axis: Sequence[sp.Expr],
) -> list[str]:
    """Names for the components by the vector that is longer: one vector where that is known."""
    names = [writer.fresh("v") for _ in of_one]
    if all(length.is_number for length in lengths):
        writer.let(names, of_one if number(lengths[0]) >= number(lengths[1]) else of_axis)
        return names
    others = [writer.fresh("v") for _ in of_axis]
    is_one, size, other_size = (writer.fresh("v") for _ in range(3))
    writer.let([*names, *others, size, other_size], [*of_one, *of_axis, *lengths])
    writer.lines.append((is_one, f"{size} >= {other_size}"))
    writer.lines += [
        (name, f"$pick({is_one}, {name}, {other})")
        for name, other in zip(names, others, strict=True)
    ]
    return names


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


def _dot(first: Iterable[sp.Expr], second: Iterable[sp.Expr]) -> sp.Expr:
    return sp.Add(*(a * b for a, b in zip(first, second, strict=True)))
