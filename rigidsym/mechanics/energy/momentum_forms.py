"""The angular momentum in forms that people read: grouped by the moments, not multiplied out."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import partial

import sympy as sp
from sympy.polys.rings import PolyElement

from rigidsym.algebra.matrix import RingMatrix
from rigidsym.algebra.present import Presenter
from rigidsym.algebra.squares import agrees, shortest_of
from rigidsym.mechanics.kinematics.workspace import Turning

_MOST_TERMS = 60  # of a component that is worth being presented multiplied out


def in_body(present: Presenter, inertia: RingMatrix, turning: Turning) -> sp.ImmutableMatrix:
    """I′Ω′, (3, 1): each moment times its component."""
    rows = [_row(present, row, turning.omega_body.entries) for row in inertia.rows]
    return _shortest(present, [rows], inertia @ turning.omega_body)


def in_space(present: Presenter, inertia: RingMatrix, turning: Turning) -> sp.ImmutableMatrix:
    """R I′Ω′, (3, 1): multiplied out, row by row, or as b Ω + R (I′ − b 1) Ω′ for a moment b."""
    momentum = turning.R @ inertia @ turning.omega_body
    by_body = list(in_body(present, inertia, turning))
    forms = [_rotated(present, turning.R, by_body), *_multiplied_out(present, momentum)]
    forms += _about_a_moment(present, inertia, turning)
    return _shortest(present, forms, momentum)


def _about_a_moment(
    present: Presenter, inertia: RingMatrix, turning: Turning
) -> Iterator[list[sp.Expr]]:
    along = [present.element(entry) for entry in turning.omega_space.entries]
    zero = inertia.ring.zero
    for moment in dict.fromkeys(inertia[k, k] for k in range(3)):
        rows = [
            [entry - (moment if j == k else zero) for k, entry in enumerate(row)]
            for j, row in enumerate(inertia.rows)
        ]
        rest = [_row(present, tuple(row), turning.omega_body.entries) for row in rows]
        turned = _rotated(present, turning.R, rest)
        base = present.element(moment)
        yield [base * entry + more for entry, more in zip(along, turned, strict=True)]


def _row(
    present: Presenter, row: tuple[PolyElement, ...], omega: tuple[PolyElement, ...]
) -> sp.Expr:
    pairs = zip(row, omega, strict=True)
    return sp.Add(*(present.element(a) * present.element(w) for a, w in pairs if a))


def _rotated(present: Presenter, R: RingMatrix, column: list[sp.Expr]) -> list[sp.Expr]:
    return [
        sp.Add(*(present.element(r) * c for r, c in zip(row, column, strict=True) if r))
        for row in R.rows
    ]


def _multiplied_out(present: Presenter, momentum: RingMatrix) -> Iterator[list[sp.Expr]]:
    if max(map(len, momentum.entries)) <= _MOST_TERMS:
        yield [present.element(entry) for entry in momentum.entries]


def _shortest(
    present: Presenter, forms: Iterable[list[sp.Expr]], momentum: RingMatrix
) -> sp.ImmutableMatrix:
    """The shortest form that the ring knows to be equal.

    Where constraints bind the coordinates, b Ω may be equal and the ring unable to tell.
    """
    return shortest_of(
        [form for form in forms if all(map(partial(agrees, present), form, momentum.entries))]
    )
