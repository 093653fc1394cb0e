"""Singular orientations: where the rate matrix loses rank, the axis lost, the null rates."""

from __future__ import annotations

import operator
from dataclasses import replace
from functools import lru_cache, reduce

import sympy as sp

from rigidsym.algebra.matrix import RingMatrix, Row, primitive
from rigidsym.algebra.present import Presenter, presenter_for
from rigidsym.algebra.stable_forms import at_zero, rewriter_for
from rigidsym.algebra.zeros import FallingRank, Stratum, matrix_at
from rigidsym.mechanics.derivation import Measure, Singularities, Singularity
from rigidsym.mechanics.kinematics.workspace import Renamed, Values


def singularities_of(values: Values) -> Singularities:
    """The places where the rates that a model allows give fewer directions of Ω than elsewhere.

    These are the common zeros of the minors of the rate matrix, solved where `Solver` can; else
    the minors are reported and nothing is guessed.
    """
    if isinstance(values, Renamed):
        return _renamed(values)
    if values.model.pullback is not None:
        inverse = values.inverse("space")
        if inverse is not None and inverse[1].is_ground:
            # W G = 1 with a G that holds no divisor: the rank is 3 wherever the coordinates may be
            return Singularities(
                rank=3, measure="det W Wᵀ", determinant=None, minors=(), points=(), is_solved=True
            )
    study = _Study(values)
    found = study.singularities()
    missing = study.falling.solver.missing
    if found.is_solved or not missing:
        return found
    return _Study(Values(values.model, also=missing)).singularities()


_of_original = lru_cache(maxsize=32)(singularities_of)


def _renamed(values: Renamed) -> Singularities:
    """Those of the original, with the components of the lost axes renamed."""
    original, codec = _of_original(values.original), values.original.codec
    points = []
    for point in original.points:
        axes = filter(None, (point.lost_axis_space, point.lost_axis_body))
        entries = codec.column(axis[k] for axis in axes for k in values.moves).entries
        in_space, in_body = _one_vector(presenter_for(codec), entries)
        points.append(replace(point, lost_axis_space=in_space, lost_axis_body=in_body))
    return original._replace(points=tuple(points))


def _one_vector(present: Presenter, entries: Row) -> list[sp.ImmutableMatrix]:
    """A vector in two frames, from its six components.

    One common factor is taken out of all of them, so that it stays the same vector in both.
    """
    entries = primitive(present.ring, entries)
    halves = entries[:3], entries[3:]
    return [present.matrix(RingMatrix.column(present.ring, half)) for half in halves]


class _Study:
    """The rank of the rate matrix of one model."""

    def __init__(self, values: Values) -> None:
        model, codec, bound = values.model, values.codec, values.bound
        self.present = presenter_for(codec)
        self.coordinates = values.arguments["q"].symbols
        # rank, kernel and minors are the same in every frame: between the middle ones of the turns
        # each axis has been moved by few turns, and W is shortest
        matrices = [turn.matrix for turn in model.turns[: len(model.turns) // 2]]
        rotation, rates = values.rotation, values.rate_matrix("space")
        self.to_space = reduce(operator.matmul, map(codec.matrix, matrices), values.one)
        self.to_body = rotation.T @ self.to_space
        # Pᵀ W has the rank and the kernel of W, since P is a rotation. J is stacked below it, so
        # that the rates of the whole kernel are those that give no Ω and keep the constraints.
        here = self.to_space.T @ rates
        self.whole = RingMatrix(codec.ring, (*here.rows, *(bound.rows if bound else ())))
        self.falling = FallingRank(
            codec,
            self.coordinates,
            self.whole,
            bound=bound,
            constraints=model.constraints,
            example=model.example,
        )

    def singularities(self) -> Singularities:
        found, rows, columns = self.falling, len(self.whole.rows), len(self.whole.rows[0])
        # The allowed rates are the kernel of J, so they reach dim W(ker J) = rank [W; J] − rank J
        # directions of Ω.
        rank, minors = found.rank - found.bound_rank, found.minors
        measure: Measure = "det Wᵀ W" if columns == found.rank and rows == 3 else "minors"
        if rows == found.rank == 3:
            measure = "det W" if columns == 3 else "det W Wᵀ"
        elif rows == columns == found.rank:
            measure = "det [W, J]"
        points = list(map(self._point, found.strata))
        if rank < min(3, len(self.coordinates) - found.bound_rank):
            points.insert(0, self._point(Stratum((), self.whole, found.rank)))
        is_one = found.rank == rows == columns
        squares = minors[0] if is_one else found.sum_of_squares(minors)
        printed = tuple(map(self.present.element, minors))
        is_solved = found.is_solved
        if any(place.is_length for point in points for place in point.places):
            # whether a minor is not zero at zero coordinates, by its form in Stumpff functions
            rewriter = rewriter_for(found.codec)
            forms = map(rewriter.rewritten, printed) if rewriter else ()
            is_regular = any(form is not None and at_zero(form) != 0 for form in forms)
            is_solved = is_solved and is_regular
        determinant = self.present.element(squares)
        return Singularities(rank, measure, determinant, printed, tuple(points), is_solved)

    def _point(self, stratum: Stratum) -> Singularity:
        zero, there, full = stratum
        rank, axis = full - self.falling.bound_rank, None
        if rank == 2:  # the direction that no rates give
            # (a, b) [W; J] = 0 means a·W q̇ = −b·J q̇ = 0 for all allowed rates: a is the lost
            # axis.
            axis = there.T.kernel(full).T.rows[0]
        elif rank == 1:  # the direction of all that the allowed rates give
            # W times a basis of the kernel of J; all columns are multiples of one.
            reached = RingMatrix(there.ring, there.rows[:3])
            if self.falling.bound_rank:
                bound = RingMatrix(there.ring, there.rows[3:])
                reached = reached @ bound.kernel(self.falling.bound_rank)
            axis = next(row for row in reached.T.rows if any(row))
        in_space = in_body = None
        if axis is not None:
            here = RingMatrix.column(there.ring, axis[:3])
            both = (matrix_at(frame @ here, zero) for frame in (self.to_space, self.to_body))
            entries = tuple(entry for vector in both for entry in vector.entries)
            in_space, in_body = _one_vector(self.present, entries)
        return Singularity(
            places=tuple(root.place for root in zero),
            rank=rank,
            lost_axis_space=in_space if rank == 2 else None,
            lost_axis_body=in_body if rank == 2 else None,
            null_rates=self.present.matrix(there.kernel(full)),
            reachable_axis=in_space if rank == 1 else None,
        )
