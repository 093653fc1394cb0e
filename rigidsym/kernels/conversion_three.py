"""Lines that take a quaternion to the angles of three turns about any axes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import sympy as sp

from rigidsym.kernels.conversion_halves import POLES, dot, halves
from rigidsym.kernels.formulas import Line
from rigidsym.kernels.writing_lines import LineWriter, Local, Vector, number
from rigidsym.mechanics.conversion_chain import ChainTurns

_COSINE, _SINE = Local("cosine"), Local("sine")  # of half the middle angle
_NEARER = 2  # steps, each of which squares the error that the inverse of a matrix leaves


def three_turns(
    writer: LineWriter, rule: ChainTurns, parts: Vector, axes: Sequence[Vector]
) -> tuple[str, ...]:
    """The angles; the first two where the third follows from the first."""
    plus, minus = halves(writer, parts, axes[0], axes[2])
    by_sum, by_difference = _components(axes, plus, 1), _components(axes, minus, -1)
    if rule.has_two_sets:
        _middle_of_triangle(writer, axes)
    else:
        fixed, free = (by_difference, by_sum) if rule.mirror > 0 else (by_sum, by_difference)
        _middle_of_half(writer, fixed, free, "far" if rule.mirror > 0 else "near")
    writer.lines += [("cosine", "$cos(0.5 * middle)"), ("sine", "$sin(0.5 * middle)")]
    _outer(writer, "half_sum", by_sum)
    _outer(writer, "half_difference", by_difference)
    writer.lines += [
        *(_alike(rule.mirror) if rule.mirror else POLES),
        ("half_sum", "$pick(beyond > $reach, $nan, half_sum)"),
        ("middle", "middle + 0.0 * half_sum"),  # NaN where that is
    ]
    outer = "$wrapped(half_sum + half_difference)", "$wrapped(half_sum - half_difference)"
    return (outer[0], "middle") if rule.mirror else (outer[0], "middle", outer[1])


def _middle_of_triangle(writer: LineWriter, axes: Sequence[Vector]) -> None:
    """The middle angle by the three sides, and how far they are from a triangle."""
    first, middle, last = axes
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
        ("near_side", "apart - half"),
        ("far_side", "half - $pick(together > 0.5 * $pi, $pi - together, together)"),
        ("beyond", "2.0 * $pick(near_side > far_side, near_side, far_side)"),
    ]


def _from_base(base: str) -> str:
    """The middle angle in the interval that ends at the flat triangle and holds 0."""
    if base == "base":
        return "base + $pick(base > 0.0, -bend, bend)"
    return f"{base} - bend" if float(base) > 0 else f"{base} + bend".removeprefix("0.0 + ")


@dataclass(frozen=True, kw_only=True, slots=True)
class _Components:
    """p± and m±, in one plane, by their components along a vector of it and across."""

    given: tuple[sp.Expr, sp.Expr]  # of p±
    by_cosine: tuple[sp.Expr, sp.Expr]  # of m± without the factor cos β/2
    by_sine: tuple[sp.Expr, sp.Expr]  # the same for sin β/2
    square: sp.Expr  # of the vector's length

    @property
    def compared(self) -> tuple[sp.Expr, ...]:
        """Those of p± and of m±."""
        pairs = zip(self.by_cosine, self.by_sine, strict=True)
        return (*self.given, *(_COSINE * a + _SINE * b for a, b in pairs))

    @property
    def matrix(self) -> tuple[sp.Expr, ...]:
        """That of m±, column by column, and the square that its entries are measured by."""
        return (*self.by_cosine, *self.by_sine, self.square)


_Either = tuple[_Components, _Components]


def _components(axes: Sequence[Vector], half: Vector, sign: int) -> _Either:
    """By the vectors 1± and e₂±: the longer serves where p± and m± are short too."""
    first, middle, last = axes
    scalar, *vector = half
    cross = sp.Matrix(first).cross(sp.Matrix(middle))
    before, after, opposite = dot(first, middle), dot(middle, last), dot(first, last)
    mixed, skew = sign * dot(cross, last) / 2, (before + sign * after) / 2
    one = (1 + sign * opposite) / 2
    axis = (1 + sign * (2 * before * after - opposite)) / 2
    return (
        _Components(
            given=(scalar, dot(vector, first)),
            by_cosine=(one, sp.S.Zero),
            by_sine=(mixed, skew),
            square=one,
        ),
        _Components(
            given=(dot(vector, middle), dot(vector, cross) - before * scalar),
            by_cosine=(mixed, -skew),
            by_sine=(axis, sp.S.Zero),
            square=axis,
        ),
    )


def _outer(writer: LineWriter, name: str, either: _Either) -> None:
    """The angle from m± to p±: half the sum or half the difference of the outer angles."""
    a, b, c, d = _longer(writer, either, [each.compared for each in either])
    writer.lines.append((name, f"$atan2({b} * {c} - {a} * {d}, {a} * {c} + {b} * {d})"))


def _longer(
    writer: LineWriter,
    either: _Either,
    values: Sequence[Sequence[sp.Expr]],
) -> list[str]:
    """Names for the values by the vector that is longer: by one vector where that is known."""
    of_one, of_axis = values
    names = [writer.fresh("v") for _ in of_one]
    lengths = [each.square for each in either]
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


def _middle_of_half(writer: LineWriter, fixed: _Either, free: _Either, length: str) -> None:
    """The middle angle where the fixed half of p is that of m, and how far they are apart.

    The components of m± are a matrix times cos β/2 and sin β/2: an ellipse, of which the first
    component tells β but for a sign, that of the second. Steps of least squares (Gauss, Newton)
    make it exact; they compare the lengths of the free halves too, which tell more where these are
    short.
    """
    a, b, *m = _longer(writer, fixed, [(*each.given, *each.matrix) for each in fixed])
    n = _longer(writer, free, [each.matrix for each in free])
    writer.lines += [
        ("size", "$hypot(near, far)"),
        *((name, f"{name} / (size * $sqrt({m[4]}))") for name in (a, b)),
        *((name, f"{name} / $sqrt({square})") for *names, square in (m, n) for name in names),
        ("side", f"{m[0]} * {m[3]} - {m[1]} * {m[2]}"),
        ("base", f"{m[0]} * {m[0]} + {m[2]} * {m[2]}"),
        ("bend", f"(base * {b} - ({m[0]} * {m[1]} + {m[2]} * {m[3]}) * {a}) * side"),
        ("opened", f"base - {a} * {a}"),
        ("opened", "$sqrt($pick(opened < 0.0, 0.0, opened))"),
        ("half", f"$atan2({m[2]}, {m[0]}) + $atan2($pick(bend < 0.0, -opened, opened), {a})"),
    ]
    for _ in range(_NEARER):
        writer.lines += [
            ("cosine", "$cos(half)"),
            ("sine", "$sin(half)"),
            ("apart", f"{a} - (cosine * {m[0]} + sine * {m[2]})"),
            ("together", f"{b} - (cosine * {m[1]} + sine * {m[3]})"),
            ("near_side", f"cosine * {m[2]} - sine * {m[0]}"),
            ("far_side", f"cosine * {m[3]} - sine * {m[1]}"),
            ("opened", f"cosine * {n[0]} + sine * {n[2]}"),
            ("closed", f"cosine * {n[1]} + sine * {n[3]}"),
            ("side", "$hypot(opened, closed)"),
            ("opened", f"opened * (cosine * {n[2]} - sine * {n[0]})"),
            ("opened", f"opened + closed * (cosine * {n[3]} - sine * {n[1]})"),
            ("opened", "opened / $pick(side == 0.0, 1.0, side)"),
            (
                "bend",
                f"apart * near_side + together * far_side + ({length} / size - side) * opened",
            ),
            ("bend", "bend / (near_side * near_side + far_side * far_side + opened * opened)"),
            ("half", "half + bend"),
        ]
    writer.lines += [
        ("beyond", "2.0 * $hypot(apart, together)"),
        ("middle", "$wrapped(half + half)"),
    ]


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
