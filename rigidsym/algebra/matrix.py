"""Small matrices over a ring; every entry is kept in normal form."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

from sympy.polys.rings import PolyElement

from rigidsym.algebra.ring import Ring

Row = tuple[PolyElement, ...]


@dataclass(frozen=True, slots=True, eq=False)
class RingMatrix:
    """Rows of ring elements in normal form."""

    ring: Ring
    rows: tuple[Row, ...]

    @classmethod
    def of(cls, ring: Ring, rows: Iterable[Sequence[PolyElement]]) -> RingMatrix:
        return cls(ring, tuple(tuple(ring.reduce(entry) for entry in row) for row in rows))

    @classmethod
    def column(cls, ring: Ring, entries: Iterable[PolyElement]) -> RingMatrix:
        return cls.of(ring, [[entry] for entry in entries])

    @classmethod
    def identity(cls, ring: Ring, size: int) -> RingMatrix:
        return cls(
            ring,
            tuple(
                tuple(ring.one if i == j else ring.zero for j in range(size)) for i in range(size)
            ),
        )

    @property
    def shape(self) -> tuple[int, int]:
        return len(self.rows), len(self.rows[0])

    @property
    def T(self) -> RingMatrix:
        return RingMatrix(self.ring, tuple(zip(*self.rows, strict=True)))

    @property
    def entries(self) -> Row:
        """All entries, row by row."""
        return tuple(entry for row in self.rows for entry in row)

    def __getitem__(self, place: tuple[int, int]) -> PolyElement:
        return self.rows[place[0]][place[1]]

    def __matmul__(self, other: RingMatrix) -> RingMatrix:
        columns, dot = other.T.rows, self.ring.dot
        return RingMatrix(
            self.ring,
            tuple(
                tuple(dot(zip(row, column, strict=True)) for column in columns) for row in self.rows
            ),
        )

    def __add__(self, other: RingMatrix) -> RingMatrix:
        pairs = zip(self.rows, other.rows, strict=True)
        return RingMatrix.of(
            self.ring, [[a + b for a, b in zip(*rows, strict=True)] for rows in pairs]
        )

    def __sub__(self, other: RingMatrix) -> RingMatrix:
        return self + other.map(lambda entry: -entry)

    def map(self, function: Callable[[PolyElement], PolyElement]) -> RingMatrix:
        return RingMatrix.of(self.ring, [[function(entry) for entry in row] for row in self.rows])

    def scale(self, factor: PolyElement) -> RingMatrix:
        return self.map(lambda entry: entry * factor)

    def dt(self) -> RingMatrix:
        """The time derivative, entry by entry."""
        return self.map(self.ring.dt)

    def is_zero(self) -> bool:
        return not any(self.entries)

    def minor(self, row: int, column: int) -> RingMatrix:
        """What is left without one row and one column."""
        return RingMatrix(
            self.ring,
            tuple(
                tuple(entry for j, entry in enumerate(entries) if j != column)
                for i, entries in enumerate(self.rows)
                if i != row
            ),
        )

    def det(self) -> PolyElement:
        """The determinant, by expansion along the first row."""
        if len(self.rows) == 1:
            return self.rows[0][0]
        first = self.rows[0]
        terms = (
            (-1) ** j * entry * self.minor(0, j).det() for j, entry in enumerate(first) if entry
        )
        return self.ring.reduce(sum(terms, self.ring.zero))

    def adjugate(self) -> RingMatrix:
        """adj(M) with M adj(M) = det(M) 1."""
        size = len(self.rows)
        if size == 1:
            return RingMatrix.identity(self.ring, 1)
        return RingMatrix.of(
            self.ring,
            [[(-1) ** (i + j) * self.minor(j, i).det() for j in range(size)] for i in range(size)],
        )


def cross(u: Row, v: Row) -> Row:
    """The cross product of two triples of ring elements, unreduced."""
    return (
        u[1] * v[2] - u[2] * v[1],
        u[2] * v[0] - u[0] * v[2],
        u[0] * v[1] - u[1] * v[0],
    )
