"""Up to three turns about any axes, among turns that are known, from a quaternion or a matrix.

Let e₁, e₂, e₃ be the axes as the known turns before them leave them. For any quaternion x,
x₊ = (x − e₁ x e₃)/2 and x₋ = (x + e₁ x e₃)/2 obey e₁ x₊ = x₊ e₃ and e₁ x₋ = −x₋ e₃. So a turn by α
on the left and one by γ on the right, p = exp(e₁ α/2) m exp(e₃ γ/2), leave p₊ = exp(e₁ σ) m₊ and
p₋ = exp(e₁ δ) m₋ with σ = (α + γ)/2 and δ = (α − γ)/2, whatever the angle between the axes. What
is between, m, is 1 for two turns and cos(β/2) + e₂ sin(β/2) for three. |p₋|/|p₊| = tan χ/2, where χ
is the angle between e₁ and R e₃: the third side of a spherical triangle with the corners e₁, e₂ and
the turned e₃, whose angle at e₂ is β, counted from where the triangle is flat.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, reduce
from itertools import combinations, pairwise

import sympy as sp

from rigidsym.algebra.codec import codec_for
from rigidsym.formula.reader import Sentence, named, sentence
from rigidsym.mechanics.conversions.function import NamedValues, Vector, rounded
from rigidsym.mechanics.conversions.inverse import Claim, InverseRule, claim
from rigidsym.mechanics.conversions.three_axes import of_any_axes
from rigidsym.mechanics.conversions.three_turns import (
    ACROSS,
    angle_between,
    angle_of_one,
    angles_of_three,
    angles_of_two,
    flat_angle,
)
from rigidsym.mechanics.conversions.unit_quaternions import QUATERNION, half_turn, product
from rigidsym.mechanics.derivation import Proof
from rigidsym.models.rotation import Citation, RotationModel, Turn, rodrigues

WITTENBURG_LILOV_2003 = Citation(
    text="J. Wittenburg, L. Lilov, Decomposition of a Finite Rotation into Three Rotations about "
    "Given Axes, Multibody System Dynamics 9 (2003)"
)
_MOST = 3  # turns that a rotation determines


@dataclass(frozen=True, kw_only=True)
class TurnChain(InverseRule):
    """The turns whose angles follow from the rotation, and all that is known beside them."""

    source = WITTENBURG_LILOV_2003

    before: tuple[Turn, ...]  # known turns left of them: constant, or by angles that are kept
    solved: tuple[Turn, ...]  # one to three
    between: tuple[tuple[Turn, ...], ...]  # known turns behind each of them but the last
    after: tuple[Turn, ...]  # known turns right of them
    places: tuple[int, ...]  # of the coordinates that follow, among all
    inverse: sp.ImmutableMatrix  # solved coordinates = inverse (angles − offsets); numbers
    offsets: tuple[sp.Expr, ...]  # of the angles, in constants and kept coordinates
    mirror: int = 0  # ±1 where the angle of the third turn is that of the first, times this

    @property
    def axes(self) -> tuple[sp.ImmutableMatrix, ...]:
        """The axes (3, 1) of the solved turns, each moved by the known turns before it."""
        moved, axes = sp.eye(3), []
        for turn, known in zip(self.solved, (*self.between, ()), strict=True):
            axes.append(sp.ImmutableMatrix(moved * sp.Matrix(turn.direction)))
            moved = reduce(lambda m, t: m * t.matrix, known, moved)
        return tuple(axes)

    @property
    def right(self) -> tuple[Turn, ...]:
        """The known turns that stand right of the solved ones once their axes are moved."""
        return (*(turn for known in self.between for turn in known), *self.after)

    @property
    def has_two_sets(self) -> bool:
        """Whether there are two middle angles, those of triangles that mirror one another.

        They have other outer angles. Where these are to be alike, e₁·e₂ = ±e₂·e₃ makes them so: it
        makes the sides alike, and with them the angles at e₁ and e₃.
        """
        if not self.mirror:
            return len(self.solved) == _MOST
        first, middle, last = self.axes
        return self._is_zero(first.dot(middle) - self.mirror * middle.dot(last))

    @property
    def has_one_axis_twice(self) -> bool:
        """Whether there are three turns, the middle one about the axis of a neighbour."""
        if len(self.solved) < _MOST:
            return False
        return any(
            all(map(self._is_zero, sp.Matrix(one).cross(sp.Matrix(other))))
            for one, other in pairwise(self.axes)
        )

    @property
    def is_across(self) -> bool:
        """Whether there are three turns, the middle one about an axis across the others."""
        if len(self.solved) < _MOST:
            return False
        first, middle, last = self.axes
        return self._is_zero(first.dot(middle)) and self._is_zero(middle.dot(last))

    def _is_zero(self, expression: sp.Expr) -> bool:
        """Whether an expression in constants vanishes for all of them, as the ring decides."""
        codec = codec_for([expression], constraints=self.model.constraints, order=0)
        return not codec.encode_quotient(expression).numerator

    @property
    def because(self) -> Sentence:
        return sentence(_because(self))

    @property
    def branch(self) -> Sentence:
        branch = []
        for text, *places in _branch(self):
            names = [named(self.model.coordinates[place].func.__name__) for place in places]
            blanks = " and ".join([", ".join(["{}"] * (len(names) - 1)), "{}"][-len(names) :])
            branch += [*sentence(text.replace("{}", blanks), *names), " "]
        return tuple(branch[:-1])

    def claims(self) -> list[Claim]:
        """R is the known turns before, the solved ones about the moved axes, the known after."""
        before, after = ([turn.matrix for turn in known] for known in (self.before, self.right))
        if not (before or after):
            return []
        solved = [rodrigues(a, turn.angle) for a, turn in zip(self.axes, self.solved, strict=True)]
        whole = reduce(lambda a, b: a * b, [*before, *solved, *after])
        names = [*"a" * bool(before), *map(str, range(1, len(solved) + 1)), *"b" * bool(after)]
        text = r"\mathbf{R} = " + "".join(rf"\mathbf{{R}}_{name}" for name in names)
        return [claim(text, *(whole - self.model.matrix))]

    @cached_property
    def proofs(self) -> tuple[Proof, ...]:
        return super().proofs + of_any_axes(len(self.solved), has_two_sets=self.has_two_sets)

    def from_quaternion(self, values: NamedValues, quaternion: Vector) -> Vector:
        """With the known turns taken off."""
        for turn in self.before:
            undone = half_turn(turn.direction, -turn.angle)
            quaternion = values.each(QUATERNION, map(rounded, product(undone, quaternion)))
        for turn in reversed(self.right):
            undone = half_turn(turn.direction, -turn.angle)
            quaternion = values.each(QUATERNION, map(rounded, product(quaternion, undone)))
        axes = self._named_axes(values)
        if len(axes) < _MOST:
            angles = (angle_of_one, angles_of_two)[len(axes) - 1](values, axes, quaternion)
        else:
            angles = angles_of_three(
                values,
                axes,
                quaternion,
                is_across=self.is_across,
                has_two_sets=self.has_two_sets,
                mirror=self.mirror,
            )
        solved = self.inverse * (sp.Matrix(angles) - sp.Matrix(self.offsets))
        found = dict(zip(self.places, solved, strict=True))
        return tuple(found.get(place, q) for place, q in enumerate(self.model.coordinates))

    def _named_axes(self, values: NamedValues) -> list[Vector]:
        return [values.each(("axis_x", "axis_y", "axis_z"), axis) for axis in self.axes]

    def turn_angles(self) -> Vector:
        """The angles that are followed along a trajectory."""
        count = _MOST if self.has_two_sets else len(self.places)
        return tuple(turn.angle for turn in self.solved[:count])

    def relation(self, values: NamedValues) -> Vector:
        """What relates the two sets of angles of one rotation; empty if there is one set.

        The flat middle angle, the difference and the sum of the sides, and of half of each its
        cosine and its sine.
        """
        if not self.has_two_sets:
            return ()
        first, middle, last = self._named_axes(values)
        sides = angle_between(values, first, middle), angle_between(values, middle, last)
        base = flat_angle(values, first, middle, last)
        apart = values.let("apart", sides[0] - sides[1])
        together = values.let("together", sides[0] + sides[1])
        if self.is_across:
            return base, apart, together, *ACROSS
        halves = (apart / 2, together / 2)
        return base, apart, together, *(f(half) for half in halves for f in (sp.cos, sp.sin))


def turn_chain(model: RotationModel) -> TurnChain | str:
    """The turns that are solved for, or why there are none, as the end of a sentence."""
    if not model.turns:
        return "its coordinates are entries or formulas of R"
    turns = _merged(model.turns)
    moving = [place for place, turn in enumerate(turns) if turn.angle.has(*model.coordinates)]
    if not moving:
        return "its turns undo one another"
    linear = {  # the multiples of the coordinates in each angle, (1, n)
        place: sp.ImmutableMatrix([[sp.diff(turns[place].angle, q) for q in model.coordinates]])
        for place in moving
    }
    if not all(entry.is_Rational for row in linear.values() for entry in row):
        return "an angle is not a sum of multiples of the coordinates by numbers"
    count = min(_MOST, len(moving))  # neighbours among the moving turns that a rotation determines
    found = [
        rule
        for start in range(len(moving) - count + 1)
        for rule in _solutions(model, turns, moving[start : start + count], linear)
    ]
    if not found:
        return "a coordinate stands in several turns, whose angles do not determine it one by one"
    sound = [rule for rule in found if not rule.has_one_axis_twice]
    if not sound:
        return "turns that follow one another are about one axis, once those between are taken off"
    return next((rule for rule in sound if rule.is_across), sound[0])


def _merged(turns: Sequence[Turn]) -> tuple[Turn, ...]:
    """The turns, those side by side about one axis, or its opposite, as one."""
    merged: list[Turn] = []
    for turn in turns:
        before = merged[-1] if merged else None
        if before and before.direction == turn.direction:
            merged[-1] = replace(before, angle=before.angle + turn.angle)
        elif before and before.direction == tuple(-part for part in turn.direction):
            merged[-1] = replace(before, angle=before.angle - turn.angle)
        else:
            merged.append(turn)
    return tuple(merged)


def _solutions(
    model: RotationModel,
    turns: Sequence[Turn],
    window: Sequence[int],
    linear: dict[int, sp.ImmutableMatrix],
) -> Iterator[TurnChain]:
    """What a window of turns determines: coordinates that stand nowhere else, one a turn."""
    rows = sp.Matrix.vstack(*(linear[place] for place in window))
    others = [row for place, row in linear.items() if place not in window]
    own = [k for k in range(rows.cols) if not any(row[k] for row in others)]
    solved = tuple(turns[place] for place in window)
    mirror = 0 if others else _mirror(solved)  # beside others that move it would not suffice
    if mirror:
        rows = rows[:2, :]
    for places in combinations(own, rows.rows):
        square = rows[:, list(places)]
        if square.det() == 0:
            continue
        free = {model.coordinates[k]: sp.S.Zero for k in places}
        yield TurnChain(
            model=model,
            before=tuple(turns[: window[0]]),
            solved=solved,
            between=tuple(tuple(turns[a + 1 : b]) for a, b in pairwise(window)),
            after=tuple(turns[window[-1] + 1 :]),
            places=places,
            kept=tuple(k for k in range(rows.cols) if k not in places),
            inverse=sp.ImmutableMatrix(square.inv()),
            offsets=tuple(turn.angle.xreplace(free) for turn in solved[: rows.rows]),
            mirror=mirror,
        )
        return


def _mirror(turns: Sequence[Turn]) -> int:
    """±1 where the third angle is the first one or its negative, as in `z(a) x(b) z(-a)`."""
    if len(turns) < _MOST:
        return 0
    first, last = turns[0].angle, turns[-1].angle
    return 1 if first == last else -1 if first == -last else 0


def _because(rule: TurnChain) -> str:
    known = (
        "The known turns are factored out, and the axes are turned accordingly. "
        if (*rule.before, *rule.right)
        else ""
    )
    if len(rule.solved) == 1:
        return (
            known + r"With $\mathbf{e}_3 = \mathbf{e}_1$, "
            r"$\mathbf{p}_+ = (\mathbf{p} - \mathbf{e}_1\mathbf{p}\,\mathbf{e}_3)/2$ and "
            r"$\mathbf{m} = 1$, the angle is "
            r"$2\operatorname{atan2}(\mathbf{p}_+\cdot\mathbf{e}_1, \mathbf{p}_+\cdot 1)$."
        )
    halves = (
        known + r"With $\mathbf{p}_+ = (\mathbf{p} - \mathbf{e}_1\mathbf{p}\,\mathbf{e}_3)/2$ and "
        r"$\mathbf{p}_- = (\mathbf{p} + \mathbf{e}_1\mathbf{p}\,\mathbf{e}_3)/2$, half the sum and "
        r"half the difference of the outer angles are the angles about $\mathbf{e}_1$ from "
        r"$\mathbf{m}_+$ to $\mathbf{p}_+$ and from $\mathbf{m}_-$ to $\mathbf{p}_-$"
    )
    if len(rule.solved) < _MOST:
        return halves + r", where $\mathbf{e}_3$ is the second axis and $\mathbf{m} = 1$."
    halves += r", where $\mathbf{m} = \cos\frac{\beta}{2} + \mathbf{e}_2\sin\frac{\beta}{2}$"
    if not rule.has_two_sets:
        sign, angle = ("-", "difference") if rule.mirror > 0 else ("+", "sum")
        return (
            f"{halves}. As half the {angle} is 0, the middle angle is the angle of "
            rf"$\mathbf{{m}}_{sign} = \mathbf{{p}}_{sign}$, which is linear in "
            r"$\cos\frac{\beta}{2}$ and $\sin\frac{\beta}{2}$, with "
            r"$k_1 = \mathbf{e}_1\cdot\mathbf{e}_2$, $k_3 = \mathbf{e}_2\cdot\mathbf{e}_3$ and "
            r"$B = \mathbf{e}_1\cdot(\mathbf{e}_2\times\mathbf{e}_3)$."
        )
    return (
        halves + r". The middle angle is the angle at $\mathbf{e}_2$ of the spherical triangle of "
        r"$\mathbf{e}_1$, $\mathbf{e}_2$ and the turned $\mathbf{e}_3$, whose third side is "
        r"$\chi = 2\operatorname{atan2}(|\mathbf{p}_-|, |\mathbf{p}_+|)$, counted from where that "
        r"triangle is flat, $\operatorname{atan2}(B, A)$. The other sides are $\theta_1$, between "
        r"$\mathbf{e}_1$ and $\mathbf{e}_2$, and $\theta_3$, between $\mathbf{e}_2$ and "
        r"$\mathbf{e}_3$; $k_1$ and $k_3$ are their cosines, "
        r"$A = \mathbf{e}_1\cdot\mathbf{e}_3 - k_1 k_3$ and "
        r"$B = \mathbf{e}_1\cdot(\mathbf{e}_2\times\mathbf{e}_3)$."
    )


def _branch(rule: TurnChain) -> Iterator[tuple[str, *tuple[int, ...]]]:
    """Sentences, each with the places of the coordinates that its {} names."""
    is_one, is_kept_alone = len(rule.places) == 1, len(rule.kept) == 1
    if rule.has_two_sets:
        yield (
            "The outer angles of the turns are in (−π, π]; the middle one is in the interval of "
            "length π that contains 0 and ends where the triangle is flat.",
        )
        if not rule.mirror:
            outer = "the sum or difference of the outer angles"
            yield (f"If only {outer} is determined, the last is 0.",)
    else:
        angles = "angle of the turn is" if len(rule.solved) == 1 else "angles of the turns are"
        yield (f"The {angles} in (−π, π].",)
    if len(rule.solved) == 2:
        yield ("If only their sum or their difference is determined, the last is 0.",)
    if rule.mirror:
        yield ("If any outer angle gives the rotation, it is 0.",)
    if rule.inverse != sp.eye(len(rule.places)) or any(offset != 0 for offset in rule.offsets):
        yield f"From {'it follows' if is_one else 'them follow'} {{}}.", *rule.places
    if rule.kept:
        yield (
            f"The rotation does not determine {{}}, which {'is' if is_kept_alone else 'are'} set "
            "to the given values, or to 0.",
            *rule.kept,
        )
    if rule.mirror or not rule.is_across:
        yield (
            "These turns may not reach every rotation: a rotation farther than √eps (radians) from "
            "all reachable ones gives NaN.",
        )
