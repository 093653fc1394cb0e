"""What must vanish, in the ring of each turn, for the recursions over turns to hold.

T Tᵀ = 1, det T = 1, T n = n, dT/dt Tᵀ = C(θ̇ n) and T C(v) Tᵀ = C(T v) with v free are laws of one
turn, and the printed definitions are the recursions. By induction over the turns R Rᵀ = 1,
dR/dt Rᵀ = C(Ω), Ω = R Ω′, Ω = W q̇ and their derivatives hold for the product.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator

import sympy as sp
from sympy.core.function import AppliedUndef

from rigidsym.algebra.codec import Codec, codec_for
from rigidsym.algebra.matrix import RingMatrix, hat
from rigidsym.mechanics.kinematics.recursion import OrthogonalRows, Recursion
from rigidsym.models.rotation import TIME

Encoded = tuple[Codec, RingMatrix]
Equal = tuple[Iterable[sp.Expr], Iterable[sp.Expr]]  # entries that are to be equal, one by one

_FREE = sp.ImmutableMatrix(sp.symbols("free_1:4"))  # what the other turns contribute


def residuals(recursion: Recursion, law: str) -> Iterator[Encoded]:
    """(ring, residual) of a law for every turn: of `turns`, or of a recursion by its name."""
    for k in range(recursion.count):
        if law == "turns":
            yield from _of_turn(recursion, k)
        else:
            pairs = (
                pair for sides in _LAWS[law](recursion, k) for pair in zip(*sides, strict=True)
            )
            yield _encoded([left - right for left, right in pairs if left != right], recursion)


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
    return codec, codec.column(entries or [sp.S.Zero])


def _speed(r: Recursion, k: int) -> Equal:
    """The symbol for θ̇, and its value Σ ∂θ/∂q q̇."""
    angle = r.angles[k]
    rates = (sp.diff(angle, q) * sp.diff(q, TIME) for q in angle.atoms(AppliedUndef))
    return r.opened([r.speeds[k]], f"dtheta{k + 1}"), [sp.Add(*rates)]


_LAWS: dict[str, Callable[[Recursion, int], Iterable[Equal]]] = {
    "product": lambda r, k: (
        (r.opened(r.turns[k], f"T{k + 1}"), r.plain[k]),
        (r.opened(r.partial[k + 1], f"P{k + 1}"), r.partial[k] * r.turns[k]),
    ),
    "omega_space": lambda r, k: (
        (
            r.opened(r.omega_space[k], f"u{k + 1}"),
            r.axes[k] * r.speeds[k] + r.turns[k] * r.omega_space[k + 1],
        ),
    ),
    "omega_body": lambda r, k: (
        (
            r.opened(r.omega_body[k + 1], f"w{k + 1}"),
            r.axes[k] * r.speeds[k] + r.turns[k].T * r.omega_body[k],
        ),
    ),
    "alpha_space": lambda r, k: (
        (
            r.opened(r.alpha_space[k], f"du{k + 1}"),
            r.axes[k] * r.spins[k]
            + r.axes[k].cross(r.omega_space[k]) * r.speeds[k]
            + r.turns[k] * r.alpha_space[k + 1],
        ),
    ),
    "alpha_body": lambda r, k: (
        (
            r.opened(r.alpha_body[k + 1], f"dw{k + 1}"),
            r.axes[k] * r.spins[k]
            + r.axes[k].cross(-r.omega_body[k + 1]) * r.speeds[k]
            + r.turns[k].T * r.alpha_body[k],
        ),
    ),
    "axes_space": lambda r, k: (
        (r.opened(r.axes_space[k], f"n{k + 1}"), r.partial[k] * r.axes[k]),
        _speed(r, k),
    ),
    "axes_body": lambda r, k: (
        (r.opened(r.remaining[k], f"B{k + 1}"), r.turns[k] * r.remaining[k + 1]),
        (r.opened(r.axes_body[k], f"m{k + 1}"), r.remaining[k + 1].T * r.axes[k]),
        _speed(r, k),
    ),
}
