"""Small matrices over a ring; every entry is kept in normal form."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from functools import partial
from itertools import combinations, product
from operator import add, mul, sub
from typing import Any

from sympy.polys.rings import PolyElement

from rigidsym.algebra.ring import Ring, shortest
from rigidsym.errors import AlgebraError

Row = tuple[PolyElement, ...]
Values = Sequence[Sequence[Any]]  # of the entries at a point, row by row
Origin = tuple[Callable[..., Values], tuple["RingMatrix", ...]]


@dataclass(frozen=True, slots=True, eq=False)
class RingMatrix:
    """Rows of ring elements in normal form.

    `origin` is an operation on values, and the matrices that this one was made of by it in the
    ring, so that values can be worked out again without the ring's reduction.
    """

    ring: Ring
    rows: tuple[Row, ...]
    origin: Origin | None = field(default=None, repr=False)

    @classmethod
    def of(cls, ring: Ring, rows: Iterable[Iterable[PolyElement]]) -> RingMatrix:
        return cls(ring, tuple(tuple(ring.reduce(entry) for entry in row) for row in rows))

    @classmethod
    def column(cls, ring: Ring, entries: Iterable[PolyElement]) -> RingMatrix:
        return cls.of(ring, [[entry] for entry in entries])

    @classmethod
    def identity(cls, ring: Ring, size: int, entry: PolyElement | None = None) -> RingMatrix:
        """The unit matrix, or a multiple of it."""
        one, places = ring.one if entry is None else entry, range(size)
        return cls(ring, tuple(tuple(one if i == j else ring.zero for j in places) for i in places))

    @property
    def shape(self) -> tuple[int, int]:
        return len(self.rows), len(self.rows[0])

    @property
    def T(self) -> RingMatrix:
        return RingMatrix(self.ring, tuple(zip(*self.rows, strict=True)), (_transposed, (self,)))

    @property
    def entries(self) -> Row:
        """All entries, row by row."""
        return tuple(entry for row in self.rows for entry in row)

    def __getitem__(self, place: tuple[int, int]) -> PolyElement:
        return self.rows[place[0]][place[1]]

    def __matmul__(self, other: RingMatrix) -> RingMatrix:
        columns, dot = tuple(zip(*other.rows, strict=True)), self.ring.dot
        rows = [
            tuple([dot(zip(row, column, strict=True)) for column in columns]) for row in self.rows
        ]
        return RingMatrix(self.ring, tuple(rows), (_multiplied, (self, other)))

    def __add__(self, other: RingMatrix) -> RingMatrix:
        rows = _entrywise(add, self.rows, other.rows)
        return RingMatrix(self.ring, rows, (partial(_entrywise, add), (self, other)))

    def __sub__(self, other: RingMatrix) -> RingMatrix:
        if self.ring is not other.ring:  # the same monomial means something else there
            raise AlgebraError("the matrices are over different rings")
        rows = _entrywise(self.ring.difference, self.rows, other.rows)
        return RingMatrix(self.ring, rows, (partial(_entrywise, sub), (self, other)))

    def scale(self, factor: PolyElement) -> RingMatrix:
        return self @ RingMatrix.identity(self.ring, self.shape[1], factor)

    def dt(self) -> RingMatrix:
        """The time derivative, entry by entry."""
        return RingMatrix(self.ring, tuple(tuple(map(self.ring.dt, row)) for row in self.rows))

    def jacobian(self, places: Sequence[int]) -> RingMatrix:
        """The derivatives of the entries by generators, at their places: an entry a row."""
        rows = (tuple(entry.diff(place) for place in places) for entry in self.entries)
        return RingMatrix(self.ring, tuple(rows))

    def cross(self, other: RingMatrix) -> RingMatrix:
        """The vector product of two columns, (3, 1)."""
        return RingMatrix.column(self.ring, cross(self.ring, self.entries, other.entries))

    def values(
        self, value: Callable[[PolyElement], Any], known: dict[RingMatrix, Values]
    ) -> Values:
        """The values of the entries from those of the matrices that this one was made of."""
        if self not in known:
            if self.origin is None:
                known[self] = [list(map(value, row)) for row in self.rows]
            else:
                operation, parts = self.origin
                known[self] = operation(*(part.values(value, known) for part in parts))
        return known[self]

    def is_zero(self) -> bool:
        """Whether each entry reduces to zero."""
        return all(self.ring.is_zero(entry) for row in self.rows for entry in row)

    def det(self) -> PolyElement:
        """The determinant, by the first row."""
        return _det(self.ring, self.rows)

    def adjugate(self) -> RingMatrix:
        """adj(M), with M adj(M) = det(M) 1."""
        # adj(M)_ij is the cofactor of M_ji, (−1)^(i+j) times the minor without row j and column i.
        places = range(len(self.rows))
        rows = (tuple(self._cofactor(j, i) for j in places) for i in places)
        return RingMatrix(self.ring, tuple(rows))

    def rank_and_minors(self, most: int | None = None) -> tuple[int, list[PolyElement]]:
        """The generic rank, or `most` if that is less, and the minors of that size but zeros.

        With `most`, one minor that is a number is enough: the rank is then the same everywhere.
        """
        # The generic rank is the size of the largest minor that is not zero in the ring.
        largest = min(self.shape) if most is None else min(*self.shape, most)
        for size in range(largest, 0, -1):
            minors: list[PolyElement] = []
            columns = combinations(range(self.shape[1]), size)
            for part in product(combinations(self.rows, size), columns):
                minor = self._part(*part).det()
                if minor and minor.is_ground and most is not None:
                    return size, [minor]
                minors += [minor] if minor else []
            if minors:
                return size, minors
        return 0, []

    def _part(self, rows: Sequence[Row], columns: Sequence[int]) -> RingMatrix:
        return RingMatrix(self.ring, tuple(tuple(row[k] for k in columns) for row in rows))

    def kernel(self, rank: int) -> RingMatrix:
        """Columns that span the kernel of a matrix wider than its rank, by Cramer's rule."""
        width = self.shape[1]
        if not rank:
            return RingMatrix.identity(self.ring, width)
        # Two independent rows u and v span the row space, and u × v is orthogonal to it.
        if (rank, width) == (2, 3):
            pairs = combinations(self.rows, 2)
            normal = next(n for u, v in pairs if any(n := cross(self.ring, u, v)))
            return RingMatrix.column(self.ring, primitive(self.ring, normal))
        # With the regular square part A of the pivot columns and the column a of a free unknown,
        # A x + a = 0 has the solution x = −adj(A) a / det A. Times det A, this is the kernel vector
        # (−adj(A) a, det A), without divisions. It vanishes where A is singular, so all regular
        # parts contribute a vector, unless one determinant is a number.
        parts: list[tuple[RingMatrix, Sequence[Row], Sequence[int]]] = []
        for rows, pivots in product(
            combinations(self.rows, rank), combinations(range(width), rank)
        ):
            square = self._part(rows, pivots)
            determinant = square.det()
            if determinant and determinant.is_ground:  # it is regular everywhere
                parts = [(square, rows, pivots)]
                break
            if determinant:
                parts.append((square, rows, pivots))
        vectors: dict[Row, None] = {}
        for square, rows, pivots in parts:
            above, below = square.adjugate(), square.det()
            for free in (k for k in range(width) if k not in pivots):  # a vector for each
                solved = above @ RingMatrix.column(self.ring, [-row[free] for row in rows])
                found = dict(zip(pivots, solved.entries, strict=True)) | {free: below}
                entries = [found.get(k, self.ring.zero) for k in range(width)]
                vectors[primitive(self.ring, entries)] = None
        return RingMatrix(self.ring, tuple(vectors)).T

    def right_inverse(self, bound: RingMatrix | None = None) -> Inverse | None:
        """G (n, 3) and d with W G = d 1, for a rate matrix W (3, n); None if there is none.

        With as many coordinates as dimensions it is the inverse; with more, the rates of least norm
        are taken, W⁺ = Wᵀ (W Wᵀ)⁻¹. `bound` is the matrix J of the constraints on the rates,
        J q̇ = 0; then J G = 0 as well.
        """
        count, square = self.shape[1], self
        # W Wᵀ adj(W Wᵀ) = det(W Wᵀ) 1, so G = Wᵀ adj(W Wᵀ) and d = det(W Wᵀ). Rates in the row
        # space of W have the least norm. Those of a unit quaternion also keep |q| constant:
        # J G = 0 holds without further work.
        if count > 3 or (count == 3 and bound is not None):
            gram = self @ self.T
            least, divisor = self.T @ gram.adjugate(), gram.det()
            if not divisor or bound is None or (bound @ least).is_zero():
                return (least, divisor) if divisor else None
            # Otherwise W q̇ = Ω and J q̇ = 0 are one square system, [W; J] G = [d 1; 0].
            square = RingMatrix(self.ring, (*self.rows, *bound.rows))
        # M adj(M) = det(M) 1, of which G is the first three columns.
        if square.shape != (count, count):
            return None
        columns = square.adjugate().T.rows
        divisor = self.ring.dot(zip(square.rows[0], columns[0], strict=True))
        return (RingMatrix(self.ring, columns[:3]).T, divisor) if divisor else None

    def _cofactor(self, row: int, column: int) -> PolyElement:
        kept = (entries for place, entries in enumerate(self.rows) if place != row)
        minor = _det(self.ring, [e[:column] + e[column + 1 :] for e in kept])
        return -minor if (row + column) % 2 else minor


def _det(ring: Ring, rows: Sequence[Row]) -> PolyElement:
    # Laplace expansion: det M = Σ_j (−1)ʲ M_0j det(M without row 0 and column j). Unlike
    # elimination it needs no division, and zeros spare their minors.
    if len(rows) < 2:
        return rows[0][0] if rows else ring.one
    first, *rest = rows
    pairs = [
        (entry, _det(ring, [e[:j] + e[j + 1 :] for e in rest]) if entry else entry)
        for j, entry in enumerate(first)
    ]
    return ring.dot(pairs[::2], minus=pairs[1::2])


def _transposed(rows: Values) -> Values:
    return list(zip(*rows, strict=True))


def _multiplied(rows: Values, others: Values) -> Values:
    columns = list(zip(*others, strict=True))
    return [[sum(map(mul, row, column)) for column in columns] for row in rows]


def _entrywise(operation: Callable[..., Any], rows: Values, others: Values) -> tuple[Any, ...]:
    return tuple(tuple(map(operation, *pair)) for pair in zip(rows, others, strict=True))


Inverse = tuple[RingMatrix, PolyElement]  # G and d, for G/d


def cross(ring: Ring, u: Row, v: Row) -> Row:
    """The cross product of two triples, in normal form."""
    return tuple(
        ring.dot(((u[j], v[k]),), minus=((u[k], v[j]),)) for j, k in ((1, 2), (2, 0), (0, 1))
    )


def square(vector: RingMatrix) -> RingMatrix:
    """|v|², (1, 1)."""
    return vector.T @ vector


def hat(vector: RingMatrix) -> RingMatrix:
    """C(u), the matrix of u ×, over the ring (lecture, section 3.2)."""
    x, y, z = vector.entries
    zero = vector.ring.zero
    return RingMatrix(vector.ring, ((zero, -z, y), (z, zero, -x), (-y, x, zero)))


def unhat(skew: RingMatrix) -> RingMatrix:
    """C⁻¹: the vector of a skew matrix, from its entries below the diagonal (lecture, 3.2)."""
    return RingMatrix.column(skew.ring, [skew[2, 1], skew[0, 2], skew[1, 0]])


def primitive(ring: Ring, given: Sequence[PolyElement]) -> Row:
    """The entries without their common factor, the first of them with a plus sign."""
    entries = [shortest(ring, entry) for entry in given]
    first, *others = (entry for entry in entries if entry)
    # The greatest common divisor of all entries; the sign makes the result unique.
    common = first
    for entry in others:
        if not common.is_ground:  # a search that can find nothing
            common = common.gcd(entry)
    common *= 1 if first.LC * common.LC > 0 else -1
    if len(common) == 1:
        (term,) = common.items()
        return tuple(entry.quo_term(term) for entry in entries)
    return tuple(entry.exquo(common) for entry in entries)
