"""Small linear systems in numbers of many digits, for Newton's method."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from rigidsym.algebra.real_values import RealValues

Matrix = Sequence[Sequence[Any]]
_DAMPING = 1e-40  # of normal equations: dependent rows then do no harm


def solved(jacobian: Matrix, values: Sequence[Any], work: RealValues) -> list[Any] | None:
    """λ with (J Jᵀ + ε 1) λ = values, so that Jᵀ λ is the shortest step; None if J vanishes."""
    gram = [[sum(a * b for a, b in zip(r, s, strict=True)) for s in jacobian] for r in jacobian]
    size = max(gram[k][k] for k in range(len(gram)))
    if not size > 0:
        return None
    for k, row in enumerate(gram):
        row[k] += size * work.number(_DAMPING)
    columns = inverse(gram, work)
    return [sum(a * v for a, v in zip(row, values, strict=True)) for row in columns]


def inverse(matrix: Matrix, work: RealValues) -> list[list[Any]]:
    """The inverse of a regular matrix, by elimination with the largest pivots."""
    count = len(matrix)
    rows = [
        [*row, *(work.number(int(i == j)) for j in range(count))] for i, row in enumerate(matrix)
    ]
    for k in range(count):
        best = max(range(k, count), key=lambda r: abs(rows[r][k]))
        rows[k], rows[best] = rows[best], rows[k]
        rows[k] = [entry / rows[k][k] for entry in rows[k]]
        for r in range(count):
            if r != k:
                factor = rows[r][k]
                rows[r] = [a - factor * b for a, b in zip(rows[r], rows[k], strict=True)]
    return [row[count:] for row in rows]


def pivots(matrix: Matrix, work: RealValues) -> tuple[list[int], list[int]]:
    """Rows and columns of a regular part of the full rank, as far as digits tell."""
    rest = [list(row) for row in matrix]
    size = max((abs(entry) for row in rest for entry in row), default=work.number(0))
    rows: list[int] = []
    columns: list[int] = []
    for _ in rest:
        free = [
            (abs(entry), r, c)
            for r, row in enumerate(rest)
            if r not in rows
            for c, entry in enumerate(row)
            if c not in columns
        ]
        largest, r, c = max(free, key=lambda found: found[0], default=(0, 0, 0))
        if not largest > size * work.number(1e-12):
            break
        rows.append(r)
        columns.append(c)
        for other in range(len(rest)):
            if other not in rows:
                factor = rest[other][c] / rest[r][c]
                rest[other] = [a - factor * b for a, b in zip(rest[other], rest[r], strict=True)]
    return rows, columns
