"""Singular orientations: where the rate matrix loses rank, the axis lost, the null rates."""

from __future__ import annotations

import operator
from collections.abc import Iterator, Sequence
from functools import reduce
from itertools import combinations

import sympy as sp
from sympy.polys.rings import PolyElement

from rigidsym.algebra.codec import Codec
from rigidsym.algebra.configuration import configurations
from rigidsym.algebra.matrix import RingMatrix, Row, cross
from rigidsym.algebra.present import presenter_for
from rigidsym.algebra.ring import Ring
from rigidsym.algebra.shorten import shortest
from rigidsym.algebra.stumpff import at_zero, rewriter_for
from rigidsym.errors import ModelError
from rigidsym.mechanics.derivation import Measure, Singularities, Singularity
from rigidsym.mechanics.kinematics.workspace import Values
from rigidsym.mechanics.singularities.zeros import Zero, matrix_at, solver_for, substituted


def singularities_of(values: Values) -> Singularities:
    """The places where the rates that a model allows give fewer directions of Ω than elsewhere.

    These are the common zeros of the minors of the rate matrix, solved where `Solver` can; else
    the minors are reported and nothing is guessed.
    """
    if values.model.pullback is not None:
        inverse = values.inverse_space
        if inverse is not None and inverse[1].is_ground:
            # W G = 1 with a G that holds no divisor: the rank is 3 wherever the coordinates may be
            return Singularities(
                rank=3, measure="det W Wᵀ", determinant=None, minors=(), points=(), is_solved=True
            )
    study = _Study(values)
    found = study.singularities()
    if found.is_solved or not study.solver.missing:
        return found
    wider = Values(values.model, also=study.solver.missing)
    return _Study(wider).singularities()


class _Study:
    """The rank of the rate matrix of one model."""

    def __init__(self, values: Values) -> None:
        self.present = presenter_for(values.codec)
        self.model = values.model
        self.codec: Codec = values.codec
        self.coordinates = values.arguments["q"].symbols
        # rank, kernel and minors are the same in every frame: between the middle ones of the turns
        # each axis has been moved by few turns, and W is shortest
        turns = self.model.turns[: len(self.model.turns) // 2]
        frame = [values.codec.matrix(turn.matrix) for turn in turns]
        self.to_space = reduce(operator.matmul, frame or [values.one])
        self.to_body = values.R.T @ self.to_space
        here = self.to_space.T @ values.rate_matrix_space
        self.solver = solver_for(values.codec, self.coordinates)
        self.bound = values.bound
        self.bound_rank = _rank_and_minors(self.bound)[0] if self.bound is not None else 0
        below = self.bound.rows if self.bound is not None else ()  # the conditions on the rates
        self.whole = RingMatrix(values.ring, (*here.rows, *below))

    def singularities(self) -> Singularities:
        whole = self.whole
        full, minors = _rank_and_minors(whole)
        rank = full - self.bound_rank
        is_one = full == len(whole.rows) == whole.shape[1]
        squares = minors[0] if is_one else self._sum(minors)
        points, is_solved = self._strata(whole, (), full, minors)
        free = len(self.coordinates) - self.bound_rank
        if rank < min(3, free):
            points.insert(0, self._point((), whole, full))
        shown = [self.present.element(minor) for minor in minors]
        if any(place.is_length for point in points for place in point.places):
            is_solved = is_solved and self._is_regular_at_zero(shown)
        return Singularities(
            rank=rank,
            measure=self._measure(whole, full),
            determinant=self.present.element(squares),
            minors=tuple(shown),
            points=tuple(points),
            is_solved=is_solved,
        )

    def _sum(self, minors: Sequence[PolyElement]) -> PolyElement:
        return self.codec.ring.dot((minor, minor) for minor in minors)

    def _measure(self, whole: RingMatrix, full: int) -> Measure:
        rows, columns = whole.shape
        if rows == columns == full:
            return "det W" if rows == 3 else "det [W, J]"
        if rows == full == 3:
            return "det W Wᵀ"
        return "det Wᵀ W" if columns == full and rows == 3 else "minors"

    def _is_regular_at_zero(self, minors: Sequence[sp.Expr]) -> bool:
        """Whether a minor is not zero at zero coordinates, by its form in Stumpff functions."""
        rewriter = rewriter_for(self.codec)
        forms = (rewriter.rewritten(minor) for minor in minors) if rewriter else ()
        return any(form is not None and bool(at_zero(form) != 0) for form in forms)

    def _strata(
        self, matrix: RingMatrix, zero: Zero, rank: int, minors: Sequence[PolyElement]
    ) -> tuple[list[Singularity], bool]:
        """The points at which the rank falls, and further on those at which it falls again."""
        if not rank or any(minor.is_ground for minor in minors):
            return [], True
        if len(minors) > 1 and self.solver.is_never_zero(self._sum(minors)):
            return [], True
        zeros, is_solved = self.solver.common(minors)
        points: list[Singularity] = []
        for more in zeros:
            is_allowed = self._is_allowed((*zero, *more))
            if not is_allowed:
                is_solved = is_solved and is_allowed is False
                continue
            there = matrix_at(matrix, more)
            full, smaller = _rank_and_minors(there, rank - 1)
            points.append(self._point((*zero, *more), there, full))
            further, is_known = self._strata(there, (*zero, *more), full, smaller)
            points.extend(further)
            is_solved = is_solved and is_known
        return points, is_solved

    def _is_allowed(self, zero: Zero) -> bool | None:
        """Whether the conditions on the coordinates can hold at a zero; None if nothing tells.

        Nothing is told of points at which the conditions touch and leave more rates free.
        """
        relations = (substituted(relation, zero) for relation in self.codec.ring.relations)
        if any(relation.is_ground and relation for relation in relations):
            return False
        bound = self.bound
        if bound is not None and _rank_and_minors(matrix_at(bound, zero))[0] < self.bound_rank:
            return None
        if not any(c.has(root.place.coordinate) for c in self.model.constraints for root in zero):
            return True
        places = tuple(root.place.coordinate - root.place.value for root in zero)
        try:
            configurations(self.model.name, (*self.model.constraints, *places), ())
        except ModelError:
            return None
        return True

    def _point(self, zero: Zero, there: RingMatrix, full: int) -> Singularity:
        rank = full - self.bound_rank
        lost = _kernel(there.T, full) if rank == 2 else None
        line = self._line(there) if rank == 1 else None
        space, body = self._in_space_and_body(lost, zero)
        return Singularity(
            places=tuple(root.place for root in zero),
            rank=rank,
            lost_axis_space=space,
            lost_axis_body=body,
            null_rates=self.present.matrix(_kernel(there, full)),
            reachable_axis=self._in_space_and_body(line, zero)[0],
        )

    def _line(self, there: RingMatrix) -> RingMatrix:
        """The direction of all that allowed rates give, where the rank is one."""
        reached = RingMatrix(there.ring, there.rows[:3])
        if self.bound_rank:
            reached = reached @ _kernel(RingMatrix(there.ring, there.rows[3:]), self.bound_rank)
        column = next(row for row in reached.T.rows if any(row))
        return RingMatrix.column(there.ring, column)

    def _in_space_and_body(
        self, found: RingMatrix | None, zero: Zero
    ) -> tuple[sp.ImmutableMatrix | None, sp.ImmutableMatrix | None]:
        """A direction in the frame of W, along the axes of space and of the body."""
        if found is None:
            return None, None
        ring = found.ring
        here = RingMatrix.column(ring, found.T.rows[0][:3])
        space, body = (matrix_at(turned, zero) @ here for turned in (self.to_space, self.to_body))
        whole = _primitive((*space.entries, *body.entries), ring)
        halves = (RingMatrix.column(ring, part) for part in (whole[:3], whole[3:]))
        first, second = map(self.present.matrix, halves)
        return first, second


def _rank_and_minors(matrix: RingMatrix, most: int | None = None) -> tuple[int, list[PolyElement]]:
    """The generic rank, or `most` if that is less, and the minors of that size but zeros.

    With `most`, one minor that is a number is enough: the rank is then the same everywhere.
    """
    largest = min(matrix.shape) if most is None else min(*matrix.shape, most)
    for size in range(largest, 0, -1):
        minors: list[PolyElement] = []
        for minor in filter(None, _minors(matrix, size)):
            if most is not None and minor.is_ground:
                return size, [minor]
            minors.append(minor)
        if minors:
            return size, minors
    return 0, []


def _minors(matrix: RingMatrix, size: int) -> Iterator[PolyElement]:
    """The determinants of all parts of a matrix with so many rows and columns."""
    dot = matrix.ring.dot
    if matrix.shape == (size, size):
        yield matrix.det()
        return
    for rows in combinations(matrix.rows, size):
        if size == 2:
            first, second = rows
            for j, k in combinations(range(matrix.shape[1]), 2):
                yield dot(((first[j], second[k]),), minus=((first[k], second[j]),))
        else:
            for columns in combinations(range(matrix.shape[1]), size):
                yield _part(matrix.ring, rows, columns).det()


def _part(ring: Ring, rows: Sequence[Row], columns: Sequence[int]) -> RingMatrix:
    return RingMatrix(ring, tuple(tuple(row[k] for k in columns) for row in rows))


def _kernel(matrix: RingMatrix, rank: int) -> RingMatrix:
    """Columns that span the kernel of a matrix wider than its rank, by Cramer's rule."""
    width = matrix.shape[1]
    if not rank:
        return RingMatrix.identity(matrix.ring, width)
    if (rank, width) == (2, 3):
        pairs = combinations(matrix.rows, 2)
        normal = next(n for u, v in pairs if any(n := cross(matrix.ring, u, v)))
        return RingMatrix.column(matrix.ring, _primitive(normal, matrix.ring))
    vectors: dict[Row, None] = {}
    for rows, pivots in _regular_parts(matrix, rank):
        square = _part(matrix.ring, rows, pivots)
        found = list(_solutions(square, rows, pivots, width))
        if square.det().is_ground:
            return RingMatrix(matrix.ring, tuple(found)).T
        vectors |= dict.fromkeys(found)
    return RingMatrix(matrix.ring, tuple(vectors)).T


def _regular_parts(matrix: RingMatrix, rank: int) -> list[tuple[Sequence[Row], Sequence[int]]]:
    """Rows and columns of the regular parts; only one if its determinant is constant."""
    found: list[tuple[Sequence[Row], Sequence[int]]] = []
    for rows in combinations(matrix.rows, rank):
        for columns in combinations(range(matrix.shape[1]), rank):
            determinant = _part(matrix.ring, rows, columns).det()
            if determinant.is_ground and determinant:
                return [(rows, columns)]
            if determinant:
                found.append((rows, columns))
    return found


def _solutions(
    square: RingMatrix, rows: Sequence[Row], pivots: Sequence[int], width: int
) -> Iterator[Row]:
    """A vector of the kernel for each column that is no pivot."""
    ring = square.ring
    above, below = square.adjugate(), square.det()
    for free in (k for k in range(width) if k not in pivots):
        solved = above @ RingMatrix.column(ring, [-row[free] for row in rows])
        found = dict(zip(pivots, solved.entries, strict=True)) | {free: below}
        yield _primitive([found.get(k, ring.zero) for k in range(width)], ring)


def _primitive(given: Sequence[PolyElement], ring: Ring) -> Row:
    """The entries without their common factor, the first of them with a plus sign."""
    entries = [shortest(ring, entry) for entry in given]
    first, *others = (entry for entry in entries if entry)
    common = first
    for entry in others:
        if not common.is_ground:  # a search that can find nothing
            common = common.gcd(entry)
    common *= 1 if first.LC * common.LC > 0 else -1
    if len(common) == 1:
        (term,) = common.items()
        return tuple(entry.quo_term(term) for entry in entries)
    return tuple(entry.exquo(common) for entry in entries)
