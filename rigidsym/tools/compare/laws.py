"""Formulas in vectors rather than in the coordinates of one rotation: one entry of a table each.

With quaternions as a = a₀ + **a**, about the centre of mass, and in principal axes:

    a b = a₀b₀ − **a**·**b** + a₀**b** + b₀**a** + **a** × **b**     product of quaternions
    q v q* = v + 2 w (u × v) + 2 u × (u × v)                         vector turned by q = w + u
    I dω/dt + ω × I ω = τ                                            Euler's equations
    I + m (d² 1 − d dᵀ)                                              parallel-axis theorem
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import cache, cached_property
from itertools import permutations, product

import sympy as sp

from rigidsym.tools.compare.language import cross_matrix
from rigidsym.tools.compare.targets import TABLE, KnownQuantity, Names, Values, quaternion, target

Vectors = tuple[tuple[sp.Symbol, ...], ...]
_COMPONENT = re.compile(r"(?P<stem>.*?)_?(?P<part>[xyz]{2}|[0-3]_?[0-3]|[wxyz0-4]|)")
_LETTER_FIRST = re.compile(r"(?P<part>[wxyz])_?(?P<stem>\d|[a-z]?)")  # w1, x1, y1, z1


@dataclass(frozen=True, kw_only=True)
class Law(KnownQuantity):
    """The value of a law in its vectors, in one of the ways in which texts write it."""

    vectors: Vectors
    ways: tuple[tuple[str, sp.ImmutableMatrix], ...] = field(repr=False)

    @cached_property
    def matrix(self) -> sp.ImmutableMatrix:
        return dict(self.ways)[self.arrangement]

    @cached_property
    def arrangements(self) -> tuple[KnownQuantity, ...]:
        return tuple(replace(self, arrangement=words) for words, _ in self.ways)

    @cached_property
    def inputs(self) -> dict[str, tuple[sp.Expr, ...]]:
        return {str(k): vector for k, vector in enumerate(self.vectors)}

    @cached_property
    def points(self) -> Values:
        return {s: TABLE[k, j] for k, v in enumerate(self.vectors) for j, s in enumerate(v)}

    @cached_property
    def names(self) -> dict[str, sp.Expr]:
        return {symbol.name: symbol for vector in self.vectors for symbol in vector}

    @property
    def coordinates(self) -> dict[str, sp.Expr]:
        return self.names

    def readings(self, matrix: sp.MatrixBase) -> Iterator[Names]:
        """Every assignment of vectors of the formula to those of the law."""
        sizes = [len(vector) for vector in self.vectors]
        for vectors in _vectors(sorted(matrix.free_symbols, key=str)):
            for order in permutations(vectors) if len(vectors) == len(sizes) else ():
                if [len(vector) for vector in order] == sizes:
                    for parts in product(*map(_orders, order)):
                        yield dict(zip(sum(parts, ()), sum(self.vectors, ()), strict=True))

    def __str__(self) -> str:
        return self.quantity


def _vectors(symbols: Sequence[sp.Symbol]) -> Iterator[Vectors]:
    """Names with a common stem are a vector, and so are p, q, r; any other name is a number."""
    for pattern in (_COMPONENT, _LETTER_FIRST):
        groups: dict[str, list[tuple[str, sp.Symbol]]] = {}
        for symbol in symbols:
            match = pattern.fullmatch(symbol.name)
            stem, part = (match["stem"], match["part"]) if match else (symbol.name, "")
            if symbol.name in ("p", "q", "r"):
                stem, part = "p, q, r", symbol.name
            groups.setdefault(stem if part else symbol.name, []).append((part, symbol))
        yield tuple(
            tuple(symbol for _, symbol in sorted(group, key=lambda each: (each[0] != "w", each[0])))
            for group in groups.values()
        )


def _orders(vector: tuple[sp.Symbol, ...]) -> Iterator[tuple[sp.Symbol, ...]]:
    """Of a quaternion in an array, the scalar may be the first or the last entry."""
    yield vector
    if len(vector) == 4 and vector[0].name[-1].isdigit():
        yield (vector[3], *vector[:3])


def _quaternion_products(a: sp.Matrix, b: sp.Matrix) -> dict[str, sp.Matrix]:
    conjugate = sp.diag(1, -1, -1, -1)
    factors = {
        "": (a, b),
        "the first conjugated": (conjugate * a, b),
        "the second conjugated": (a, conjugate * b),
    }
    values = {words: quaternion(*pair) for words, pair in factors.items()}
    last = {f"{words}, scalar last".lstrip(", "): m[[1, 2, 3, 0], :] for words, m in values.items()}
    return values | last


def _turned_vectors(q: sp.Matrix, v: sp.Matrix) -> dict[str, sp.Matrix]:
    w, cross = q[0], cross_matrix(q[1:, :])
    values = {}
    for words, sign in (("", 1), ("by the inverse", -1)):
        double = 2 * sign * w * cross * v + 2 * cross * cross * v
        values[words] = v + double
        values[f"{words}, times |q|²".lstrip(", ")] = q.dot(q) * v + double
    return values


def _accelerations(w: sp.Matrix, i: sp.Matrix, torque: sp.Matrix) -> dict[str, sp.Matrix]:
    return {"": sp.diag(*i).inv() * (torque - w.cross(sp.diag(*i) * w))}


def _torques(w: sp.Matrix, i: sp.Matrix, acceleration: sp.Matrix) -> dict[str, sp.Matrix]:
    return {"": sp.diag(*i) * acceleration + w.cross(sp.diag(*i) * w)}


def _parallel_axes(mass: sp.Matrix, d: sp.Matrix, *tensor: sp.Matrix) -> dict[str, sp.Matrix]:
    added = mass[0] * (d.dot(d) * sp.eye(3) - d * d.T)
    if not tensor:
        diagonal = sp.diag(*added.diagonal())
        return {"": added, "off-diagonal entries with the other sign": 2 * diagonal - added}
    xx, xy, xz, yy, yz, zz = tensor[0]
    matrix = sp.Matrix([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    return {"": matrix + added, "to the centre of mass": matrix - added}


_LAWS: tuple[tuple[str, tuple[int, ...], Callable[..., dict[str, sp.Matrix]]], ...] = (
    ("quaternion_product", (4, 4), _quaternion_products),
    ("turned_vector", (4, 3), _turned_vectors),
    ("euler_equations_acceleration", (3, 3, 3), _accelerations),
    ("euler_equations_torque", (3, 3, 3), _torques),
    ("parallel_axis_term", (1, 3), _parallel_axes),
    ("parallel_axis_theorem", (1, 3, 6), _parallel_axes),
)  # name, entries of each vector, the value for each way of writing it


@cache
def laws(shape: tuple[int, int]) -> tuple[Law, ...]:
    """The laws whose value has this shape."""
    motion = target("quaternion", "rotation_matrix").motion  # a ring without conditions
    entries = []
    for name, sizes, value in _LAWS:
        vectors = tuple(
            tuple(sp.Symbol(f"{'abc'[k]}_{n}", real=True) for n in range(size))
            for k, size in enumerate(sizes)
        )
        ways = value(*map(sp.Matrix, vectors))
        if ways[""].shape == shape:
            table = tuple((words, sp.ImmutableMatrix(each)) for words, each in ways.items())
            entries.append(
                Law(motion=motion, rotation="", quantity=name, vectors=vectors, ways=table)
            )
    return tuple(entries)
