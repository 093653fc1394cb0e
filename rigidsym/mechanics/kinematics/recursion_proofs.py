"""What must vanish, in the ring of each turn, for the recursions over turns to hold.

T Tᵀ = 1, det T = 1, T n = n, dT/dt Tᵀ = C(θ̇ n) and T C(v) Tᵀ = C(T v) with v free are laws of one
turn, and the printed definitions are the recursions. By induction over the turns R Rᵀ = 1,
dR/dt Rᵀ = C(Ω), Ω = R Ω′, Ω = W q̇ and their derivatives hold for the product.
"""

from __future__ import annotations

from collections.abc import Iterator

import sympy as sp
from sympy.core.function import AppliedUndef

from rigidsym.algebra.codec import Codec, codec_for
from rigidsym.algebra.matrix import RingMatrix, hat
from rigidsym.mechanics.kinematics.recursion import OrthogonalRows, Recursion
from rigidsym.models.so3 import TIME

Encoded = tuple[Codec, RingMatrix]

_FREE = sp.ImmutableMatrix(sp.symbols("free_1:4"))  # what the other turns contribute


def residuals(recursion: Recursion, law: str) -> Iterator[Encoded]:
    """(ring, residual) of a law for every turn: of `turns`, or of a recursion by its name."""
    for k in range(recursion.count):
        if law == "turns":
            yield from _of_turn(recursion, k)
        else:
            yield _encoded([entry for entry in _LAWS[law](recursion, k) if entry != 0], recursion)


def _of_turn(r: Recursion, k: int) -> Iterator[Encoded]:
    """T Tᵀ − 1, det T − 1, T n − n, dT/dt Tᵀ − C(θ̇ n) and T C(v) Tᵀ − C(T v) for a free v."""
    rate = sp.diff(r.angles[k], TIME)
    parts = [*r.plain[k], *r.axes[k], rate, *_FREE]
    bound = [c for c in r.model.constraints if c.has(*r.axes[k].free_symbols)]
    codec = codec_for(parts, constraints=bound)
    encoded = [codec.encode(part) for part in parts]
    turn = RingMatrix(codec.ring, tuple(tuple(encoded[j : j + 3]) for j in (0, 3, 6)))
    axis, free = (RingMatrix.column(codec.ring, part) for part in (encoded[9:12], encoded[13:]))
    yield codec, turn.gram() - RingMatrix.identity(codec.ring, 3)
    yield codec, RingMatrix.column(codec.ring, [turn.det() - 1])
    yield codec, turn @ axis - axis
    yield codec, turn.dt() @ turn.T - hat(axis.scale(encoded[12]))
    yield codec, turn @ hat(free) @ turn.T - hat(turn @ free)


def rows_residuals(r: Recursion, rows: OrthogonalRows) -> Iterator[Encoded]:
    """Column by column: the rows of U, and their products as products of the rows of W.

    Added up over the columns these are the products of the rows that G = L D Lᵀ is about.
    """
    l21, l31, l32 = rows.factors
    _, u2, u3 = rows.rows
    opened2, opened3 = r.opened(u2, f"v2_{rows.name}"), r.opened(u3, f"v3_{rows.name}")
    for j in range(rows.given.cols):
        r1, r2, r3 = rows.given.col(j)
        first, second = r2 - l21 * r1, r3 - l31 * r1 - l32 * u2[j]
        yield _encoded([opened2[j] - first, opened3[j] - second], r)


def gram_of_rows() -> tuple[sp.ImmutableMatrix, sp.ImmutableMatrix]:
    """G = W Wᵀ of free entries, and L D Lᵀ by what the rows of U are defined as."""
    g = sp.ImmutableMatrix(3, 3, lambda i, j: sp.Symbol(f"g{min(i, j) + 1}{max(i, j) + 1}"))
    d1, l21, l31 = g[0, 0], g[0, 1] / g[0, 0], g[0, 2] / g[0, 0]
    d2 = g[1, 1] - 2 * l21 * g[0, 1] + l21**2 * g[0, 0]  # |r2 - l21 r1|²
    l32 = (g[1, 2] - l21 * g[0, 2]) / d2  # r3 · (r2 - l21 r1) over it
    last = sp.Matrix([-l31 + l32 * l21, -l32, 1])  # r3 - l31 r1 - l32 (r2 - l21 r1)
    d3 = (last.T * g * last)[0]
    lower = sp.Matrix([[1, 0, 0], [l21, 1, 0], [l31, l32, 1]])
    return g, sp.ImmutableMatrix(lower * sp.diag(d1, d2, d3) * lower.T)


def _encoded(entries: list[sp.Expr], recursion: Recursion) -> Encoded:
    symbols = {symbol for entry in entries for symbol in entry.free_symbols}
    bound = [c for c in recursion.model.constraints if not symbols.isdisjoint(c.free_symbols)]
    codec = codec_for(entries, constraints=bound)
    return codec, RingMatrix.column(
        codec.ring, [codec.encode(entry) for entry in entries or [sp.S.Zero]]
    )


def _product(r: Recursion, k: int) -> Iterator[sp.Expr]:
    yield from r.opened(r.turns[k], f"T{k + 1}") - r.plain[k]
    yield from r.opened(r.partial[k + 1], f"P{k + 1}") - r.partial[k] * r.turns[k]


def _speed(r: Recursion, k: int) -> sp.Expr:
    """θ̇ − Σ ∂θ/∂q q̇, and what stands for θ̇."""
    angle, (speed,) = r.angles[k], r.opened(sp.Matrix([r.speeds[k]]), f"dtheta{k + 1}")
    rates = (sp.diff(angle, q) * sp.diff(q, TIME) for q in angle.atoms(AppliedUndef))
    return speed - sp.Add(*rates)


def _omega_space(r: Recursion, k: int) -> Iterator[sp.Expr]:
    u = r.omega_space
    yield from r.opened(u[k], f"u{k + 1}") - r.axes[k] * r.speeds[k] - r.turns[k] * u[k + 1]


def _omega_body(r: Recursion, k: int) -> Iterator[sp.Expr]:
    w = r.omega_body
    yield from r.opened(w[k + 1], f"w{k + 1}") - r.axes[k] * r.speeds[k] - r.turns[k].T * w[k]


def _alpha_space(r: Recursion, k: int) -> Iterator[sp.Expr]:
    du, gained = r.alpha_space, r.axes[k].cross(r.omega_space[k]) * r.speeds[k]
    yield from (
        r.opened(du[k], f"du{k + 1}") - r.axes[k] * r.spins[k] - gained - r.turns[k] * du[k + 1]
    )


def _alpha_body(r: Recursion, k: int) -> Iterator[sp.Expr]:
    dw, gained = r.alpha_body, r.axes[k].cross(r.omega_body[k + 1]) * r.speeds[k]
    yield from (
        r.opened(dw[k + 1], f"dw{k + 1}") - r.axes[k] * r.spins[k] + gained - r.turns[k].T * dw[k]
    )


def _axes_space(r: Recursion, k: int) -> Iterator[sp.Expr]:
    yield from r.opened(r.axes_space[k], f"n{k + 1}") - r.partial[k] * r.axes[k]
    yield _speed(r, k)


def _axes_body(r: Recursion, k: int) -> Iterator[sp.Expr]:
    yield from r.opened(r.remaining[k], f"B{k + 1}") - r.turns[k] * r.remaining[k + 1]
    yield from r.opened(r.axes_body[k], f"m{k + 1}") - r.remaining[k + 1].T * r.axes[k]
    yield _speed(r, k)


_LAWS = {
    "product": _product,
    "omega_space": _omega_space,
    "omega_body": _omega_body,
    "alpha_space": _alpha_space,
    "alpha_body": _alpha_body,
    "axes_space": _axes_space,
    "axes_body": _axes_body,
}
