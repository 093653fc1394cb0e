"""Lines that take a quaternion to the angles of three turns about any axes."""

from __future__ import annotations

from collections.abc import Sequence

from rigidsym.kernels.conversions.formulas import Line
from rigidsym.kernels.conversions.halves_lines import POLES, Either, components, halves, longer
from rigidsym.kernels.conversions.middle_lines import middle_of_half, middle_of_triangle
from rigidsym.kernels.conversions.writing_lines import LineWriter, Vector
from rigidsym.mechanics.conversions.turn_chain import ChainTurns


def three_turns(
    writer: LineWriter, rule: ChainTurns, parts: Vector, axes: Sequence[Vector]
) -> tuple[str, ...]:
    """The angles; the first two where the third follows from the first."""
    plus, minus = halves(writer, parts, axes[0], axes[2])
    by_sum, by_difference = components(axes, plus, 1), components(axes, minus, -1)
    base = middle_of_triangle(writer, axes)
    if not rule.has_two_sets:
        fixed, free = (by_difference, by_sum) if rule.mirror > 0 else (by_sum, by_difference)
        middle_of_half(writer, fixed, free, "far" if rule.mirror > 0 else "near", base)
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


def _outer(writer: LineWriter, name: str, either: Either) -> None:
    """The angle from m± to p±: half the sum or half the difference of the outer angles."""
    a, b, c, d = longer(writer, either, [each.compared for each in either])
    writer.lines.append((name, f"$atan2({b} * {c} - {a} * {d}, {a} * {c} + {b} * {d})"))


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
