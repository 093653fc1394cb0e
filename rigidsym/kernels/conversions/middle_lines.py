"""The middle one of three angles: from a triangle, and from a half where the outer are one."""

from __future__ import annotations

from collections.abc import Sequence

from rigidsym.kernels.conversions.halves_lines import Either, longer
from rigidsym.kernels.conversions.writing_lines import LineWriter, Vector

_STEPS = 2  # of least squares, from a start that is off by √eps at most


def middle_of_triangle(writer: LineWriter, axes: Sequence[Vector]) -> str:
    """The middle angle by the three sides, and how far they are from a triangle.

    Returns where the triangle is flat: the other middle angle is twice that, less the first.
    """
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
    return base


def _from_base(base: str) -> str:
    """The middle angle in the interval that ends at the flat triangle and holds 0."""
    if base == "base":
        return "base + $pick(base > 0.0, -bend, bend)"
    return f"{base} - bend" if float(base) > 0 else f"{base} + bend".removeprefix("0.0 + ")


def middle_of_half(writer: LineWriter, fixed: Either, free: Either, length: str, base: str) -> None:
    """The one of the triangle's two middle angles for which the fixed half of p is that of m.

    The components of m± are a matrix times cos β/2 and sin β/2: an ellipse. By its first component
    alone follows a third angle to choose from, for the triangle is none where e₂ is e₁ or e₃. Then
    steps of least squares (Gauss, Newton) compare the fixed halves, and the lengths of the free
    ones, which tell more where these are short.
    """
    a, b, *m = longer(writer, fixed, [(*each.given, *each.matrix) for each in fixed])
    n = longer(writer, free, [each.matrix for each in free])
    for *names, square in (m, n):
        writer.lines.append((square, f"$sqrt($pick({square} > 0.0, {square}, 1.0))"))
        writer.lines += [(name, f"{name} / {square}") for name in names]
    writer.lines += [
        ("whole", "$hypot(near, far)"),
        *((name, f"{name} / ({m[4]} * whole)") for name in (a, b)),
        ("other", f"2.0 * {base} - middle"),
    ]
    _choose(writer, (a, b), m)
    for _ in range(_STEPS):
        writer.lines += [
            ("cosine", "$cos(half)"),
            ("sine", "$sin(half)"),
            ("miss", f"{a} - (cosine * {m[0]} + sine * {m[2]})"),
            ("miss_2", f"{b} - (cosine * {m[1]} + sine * {m[3]})"),
            ("slope", f"cosine * {m[2]} - sine * {m[0]}"),
            ("slope_2", f"cosine * {m[3]} - sine * {m[1]}"),
            ("along", f"cosine * {n[0]} + sine * {n[2]}"),
            ("across", f"cosine * {n[1]} + sine * {n[3]}"),
            ("size", "$hypot(along, across)"),
            ("slope_3", f"along * (cosine * {n[2]} - sine * {n[0]})"),
            ("slope_3", f"slope_3 + across * (cosine * {n[3]} - sine * {n[1]})"),
            ("slope_3", "slope_3 / $pick(size == 0.0, 1.0, size)"),
            ("miss_3", f"{length} / whole - size"),
            ("step", "miss * slope + miss_2 * slope_2 + miss_3 * slope_3"),
            ("weight", "slope * slope + slope_2 * slope_2 + slope_3 * slope_3"),
            ("half", "half + step / (weight + $tiny)"),  # no step that is rounding alone
        ]
    writer.lines += [
        ("beyond", "2.0 * $hypot(miss, miss_2)"),
        ("middle", "$wrapped(half + half)"),
    ]


def _choose(writer: LineWriter, given: tuple[str, str], m: Sequence[str]) -> None:
    """`half`, half the middle angle for which the given components are nearest to those of m±."""
    a, b = given
    writer.lines += [
        ("base", f"{m[0]} * {m[0]} + {m[2]} * {m[2]}"),
        ("side", f"{m[0]} * {m[3]} - {m[1]} * {m[2]}"),
        ("side", f"(base * {b} - ({m[0]} * {m[1]} + {m[2]} * {m[3]}) * {a}) * side"),
        ("opened", f"base - {a} * {a}"),
        ("opened", "$sqrt($pick(opened < 0.0, 0.0, opened))"),
        ("third", f"$atan2({m[2]}, {m[0]}) + $atan2($pick(side < 0.0, -opened, opened), {a})"),
    ]
    for guess, nearer in (
        ("0.5 * middle", ""),
        ("0.5 * other", "miss < least"),
        ("third", "miss + $reach < least"),  # the triangle is better where it is one
    ):
        writer.lines += [
            ("guess", guess),
            ("cosine", "$cos(guess)"),
            ("sine", "$sin(guess)"),
            ("along", f"cosine * {m[0]} + sine * {m[2]}"),
            ("across", f"cosine * {m[1]} + sine * {m[3]}"),
            ("sign", f"$pick({a} * along + {b} * across < 0.0, -1.0, 1.0)"),
            ("guess", "$pick(sign < 0.0, guess + $pi, guess)"),
            ("miss", f"$hypot({a} - sign * along, {b} - sign * across)"),
            ("half", f"$pick({nearer}, guess, half)" if nearer else "guess"),
            ("least", f"$pick({nearer}, miss, least)" if nearer else "miss"),
        ]
