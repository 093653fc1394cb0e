"""Long products of turns, turn by turn: named intermediate quantities in place of expansion.

R = T₁ T₂ ⋯ Tₙ, where turn k has the constant axis nₖ and the angle θₖ. Multiplied out, the entries
of R have up to 2ⁿ terms. As recursions everything is linear in n:

    Pₖ = Pₖ₋₁ Tₖ                         R = Pₙ; Pₖ₋₁ nₖ are the axes in space
    Bₖ = Tₖ Bₖ₊₁                         Bₖ₊₁ᵀ nₖ are the axes in the body
    uₖ = θ̇ₖ nₖ + Tₖ uₖ₊₁                 Ω = u₁
    wₖ = θ̇ₖ nₖ + Tₖᵀ wₖ₋₁                Ω′ = wₙ
    u̇ₖ = θ̈ₖ nₖ + θ̇ₖ nₖ × uₖ + Tₖ u̇ₖ₊₁    dΩ/dt = u̇₁
    ẇₖ = θ̈ₖ nₖ − θ̇ₖ nₖ × wₖ + Tₖᵀ ẇₖ₋₁   dΩ′/dt = ẇₙ

Each is an identity in the ring of one turn, with free symbols for what the other turns contribute,
so that the proofs are linear in n as well.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import cached_property
from itertools import product
from typing import NamedTuple, TypeAlias

import sympy as sp
from sympy.core.function import AppliedUndef

from rigidsym.mechanics.derivation import Definition
from rigidsym.models.rotation import TIME, RotationModel

Vector: TypeAlias = sp.ImmutableMatrix  # (3, 1)
Matrix: TypeAlias = sp.ImmutableMatrix  # (3, 3)
_ZERO, _ONE = sp.ImmutableMatrix(sp.zeros(3, 1)), sp.ImmutableMatrix(sp.eye(3))


class Recursion:
    """The recursions of one product of turns, each worked out when it is asked for."""

    def __init__(self, model: RotationModel) -> None:
        self.model = model
        self._groups: dict[str, dict[sp.Symbol, sp.Expr]] = {}
        named = {q.func.__name__ for q in model.coordinates}
        self._taken = named | {constant.name for constant in model.constants}
        self.angles = [turn.angle for turn in model.turns]
        self.axes = [sp.ImmutableMatrix(turn.direction) for turn in model.turns]
        self.plain = [turn.matrix for turn in model.turns]
        self.turns = [self.named(f"T{k}", turn) for k, turn in enumerate(self.plain, 1)]
        self.count = len(self.turns)

    @property
    def definitions(self) -> tuple[Definition, ...]:
        """What has been named so far, each in terms of inputs and of those before it."""
        return tuple(
            Definition(symbol, value)
            for group in self._groups.values()
            for symbol, value in group.items()
        )

    def named(self, group: str, matrix: sp.MatrixBase) -> sp.ImmutableMatrix:
        """The matrix with a name for each entry that is worth one, group_1 or group_12."""
        places = product(range(1, matrix.rows + 1), range(1, matrix.cols + 1))
        entries = [
            self.define(f"{group}_{row}" + (str(column) if matrix.cols > 1 else ""), entry, group)
            for (row, column), entry in zip(places, matrix, strict=True)
        ]
        return sp.ImmutableMatrix(*matrix.shape, entries)

    def define(self, name: str, value: sp.Expr, group: str = "") -> sp.Expr:
        """A symbol for the value; a number, an input or a sine of one stays as it is."""
        plain = value.as_coeff_Mul()[1]
        if plain.is_Atom or plain.is_Function or plain.is_Derivative:
            return value
        while name in self._taken:
            name += "_"
        self._taken.add(name)
        symbol = sp.Symbol(name)
        self._groups.setdefault(group or name, {})[symbol] = value
        return symbol

    def opened(self, entries: Iterable[sp.Expr], group: str) -> list[sp.Expr]:
        """The entries; names of this group are replaced by their definitions."""
        own = self._groups.get(group, {})
        return [own.get(entry, entry) for entry in entries]

    # The recursions, from the first turn to the last or the other way round

    @cached_property
    def partial(self) -> list[Matrix]:
        """P₀ = 1, P₁, ..., Pₙ."""
        return self._each("P", lambda k, before: before * self.turns[k], start=_ONE)

    @cached_property
    def remaining(self) -> list[Matrix]:
        """B₁, ..., Bₙ, Bₙ₊₁ = 1."""
        return self._each("B", lambda k, b: self.turns[k] * b, is_backwards=True, start=_ONE)

    @cached_property
    def speeds(self) -> list[sp.Expr]:
        return [self._rate(k, angle, 1) for k, angle in enumerate(self.angles, 1)]

    @cached_property
    def spins(self) -> list[sp.Expr]:
        """θ̈ of each turn."""
        return [self._rate(k, angle, 2) for k, angle in enumerate(self.angles, 1)]

    def _rate(self, turn: int, angle: sp.Expr, order: int) -> sp.Expr:
        return self.define(f"{'d' * order}theta{turn}", sp.diff(angle, TIME, order))

    @cached_property
    def omega_space(self) -> list[Vector]:
        """u₁, ..., uₙ, uₙ₊₁ = 0."""
        return self._each(
            "u",
            lambda k, u: self.axes[k] * self.speeds[k] + self.turns[k] * u,
            is_backwards=True,
        )

    @cached_property
    def omega_body(self) -> list[Vector]:
        """w₀ = 0, w₁, ..., wₙ."""
        return self._each("w", lambda k, w: self.axes[k] * self.speeds[k] + self.turns[k].T * w)

    @cached_property
    def alpha_space(self) -> list[Vector]:
        """u̇₁, ..., u̇ₙ₊₁ = 0."""
        return self._each(
            "du",
            lambda k, du: self._gained(k, self.omega_space[k]) + self.turns[k] * du,
            is_backwards=True,
        )

    @cached_property
    def alpha_body(self) -> list[Vector]:
        """ẇ₀ = 0, ..., ẇₙ."""
        return self._each(
            "dw",
            lambda k, dw: self._gained(k, -self.omega_body[k + 1]) + self.turns[k].T * dw,
        )

    def _each(
        self,
        name: str,
        follow: Callable[[int, sp.ImmutableMatrix], sp.ImmutableMatrix],
        *,
        is_backwards: bool = False,
        start: sp.ImmutableMatrix = _ZERO,
    ) -> list[sp.ImmutableMatrix]:
        """What follows turn by turn from `start`, which is last if the last turn comes first."""
        found = [start]
        for k in reversed(range(self.count)) if is_backwards else range(self.count):
            found.append(self.named(f"{name}{k + 1}", follow(k, found[-1])))
        return found[::-1] if is_backwards else found

    def _gained(self, k: int, omega: Vector) -> Vector:
        """θ̈ n + θ̇ n × omega of one turn."""
        axis = self.axes[k]
        return axis * self.spins[k] + axis.cross(omega) * self.speeds[k]

    @cached_property
    def axes_space(self) -> list[Vector]:
        """Pₖ₋₁ nₖ."""
        pairs = zip(self.partial, self.axes, strict=False)
        return [self.named(f"n{k}", before * axis) for k, (before, axis) in enumerate(pairs, 1)]

    @cached_property
    def axes_body(self) -> list[Vector]:
        """Bₖ₊₁ᵀ nₖ."""
        pairs = zip(self.remaining[1:], self.axes, strict=True)
        return [self.named(f"m{k}", after.T * axis) for k, (after, axis) in enumerate(pairs, 1)]

    def rate_matrix(self, axes: Sequence[Vector]) -> sp.ImmutableMatrix:
        """Columns: what each coordinate turns about, ∂θₖ/∂q times axis k, added up; (3, m)."""
        columns = {q: sp.zeros(3, 1) for q in self.model.coordinates}
        for axis, angle in zip(axes, self.angles, strict=True):
            for q in angle.atoms(AppliedUndef):
                columns[q] += axis * sp.diff(angle, q)
        return sp.ImmutableMatrix(sp.Matrix.hstack(*columns.values()))

    def orthogonal_rows(self, name: str, rate_matrix: sp.ImmutableMatrix) -> OrthogonalRows:
        """The rows of W made orthogonal one after the other (Gram and Schmidt)."""
        r1, r2, r3 = (rate_matrix.row(k) for k in range(3))
        d1 = self.define(f"d1_{name}", r1.dot(r1))
        l21 = self.define(f"l21_{name}", r2.dot(r1) / d1)
        l31 = self.define(f"l31_{name}", r3.dot(r1) / d1)
        u2 = self.named(f"v2_{name}", r2 - l21 * r1)
        d2 = self.define(f"d2_{name}", u2.dot(u2))
        l32 = self.define(f"l32_{name}", r3.dot(u2) / d2)
        u3 = self.named(f"v3_{name}", r3 - l31 * r1 - l32 * u2)
        return OrthogonalRows(
            name=name,
            given=rate_matrix,
            rows=(r1, u2, u3),
            squares=(d1, d2, self.define(f"d3_{name}", u3.dot(u3))),
            factors=(l21, l31, l32),
        )

    def least_rates(
        self, name: str, rows: OrthogonalRows, omega: Sequence[sp.Expr]
    ) -> sp.ImmutableMatrix:
        """W⁺ Ω, the rates of least norm that give Ω; (n, 1)."""
        l21, l31, l32 = rows.factors
        y1 = omega[0]
        y2 = self.define(f"y2_{name}", omega[1] - l21 * y1)
        y3 = self.define(f"y3_{name}", omega[2] - l31 * y1 - l32 * y2)
        parts = [
            row.T * self.define(f"z{k}_{name}", y / square)
            for k, (row, y, square) in enumerate(
                zip(rows.rows, (y1, y2, y3), rows.squares, strict=True), 1
            )
        ]
        return sp.ImmutableMatrix(parts[0] + parts[1] + parts[2])


class OrthogonalRows(NamedTuple):
    """W = L U with L unit lower triangular and rows of U at right angles, so W Wᵀ = L D Lᵀ.

    W⁺ = Uᵀ D⁻¹ L⁻¹ loses as many digits near a pole as W has lost rank; the determinant of
    W Wᵀ would lose twice as many.
    """

    name: str
    given: sp.ImmutableMatrix  # W, (3, n)
    rows: tuple[sp.ImmutableMatrix, ...]  # of U, each (1, n)
    squares: tuple[sp.Expr, ...]  # the diagonal of D, their squared lengths
    factors: tuple[sp.Expr, ...]  # L21, L31, L32
