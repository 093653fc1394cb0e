"""Rotations that functions back to coordinates are measured at, the same in every run.

Turns are drawn by their angles, up to π: of every ten, one has a middle turn beside a pole, from
0.1 down to 1e-17, two within a few eps of it, where functions take it to be there, and one has it
there, as near as floats come. Of other coordinates the rotations
are drawn, evenly over all there are: of every ten, one is beside no turn and one beside a half
turn, and one has a quaternion of −1, 0 and 1 alone. Every other point serves single precision.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from math import pi
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import NDArray
from sympy.core.function import AppliedUndef

from rigidsym.kernels.accuracy.points import NEAREST, Points
from rigidsym.kernels.accuracy.table import SMALL
from rigidsym.kernels.accuracy.truth import FLOATS, Truth, precise
from rigidsym.kernels.accuracy.ways import LONGEST, NEAREST_SINGLE, SHORTEST
from rigidsym.mechanics.conversions.closed_forms import ClosedForm
from rigidsym.mechanics.conversions.conversions import conversions_of, outer_product
from rigidsym.mechanics.conversions.turn_chain import ChainTurns, chain_turns
from rigidsym.mechanics.derivation import Derivation
from rigidsym.models.quaternions import Quaternion
from rigidsym.models.rotation import RotationModel

_AT_POLES = 1e-17  # how near the points come that are not at them
_FEW = (10, 40)  # eps: more than what counts as a pole where coordinates follow, and in `unwrap`
_UNBOUNDED = "gibbs_vector"  # it has no value at a half turn
_QUATERNION = Quaternion()  # of any length
_ENTRIES = sp.symbols("r:9")
_K = outer_product(sp.Matrix(3, 3, _ENTRIES))  # 4 p pᵀ

_TRANSPOSED = (0, 3, 6, 1, 4, 7, 2, 5, 8)

Array = NDArray[Any]
Values = dict[sp.Expr, Array]


@dataclass(frozen=True, kw_only=True)
class Given:
    """What functions are given, in one type, a point a row, and the same to 50 digits as R."""

    derivation: Derivation
    values: Values  # of coordinates and constants
    rotation: Array  # R that p and the matrix are made of, (count, 9), to 50 digits
    lengths: Array  # of the quaternions
    kept: tuple[int, ...]  # places of the coordinates that are given

    @property
    def model(self) -> RotationModel:
        return self.derivation.model

    @cached_property
    def arrays(self) -> Mapping[str, Array]:
        """All arguments by name."""
        dtype = self.values[self.model.coordinates[0]].dtype
        matrix = self.rotation.astype(dtype)
        p = _quaternions(self.rotation.astype(float)) * self.lengths[:, np.newaxis]
        return {
            "q": self._of(self.model.coordinates),
            "parameters": self._of(
                [s for a in self.derivation.arguments if a.name == "parameters" for s in a.symbols]
            ),
            "kept": self._of([self.model.coordinates[place] for place in self.kept]),
            "p": p.astype(dtype),
            "matrix": self._shown(matrix).reshape(-1, 3, 3),
        }

    @cached_property
    def exact(self) -> Mapping[str, Array]:
        """R of what is given, as it is given, by the name of the argument; (count, 9)."""
        of = precise().of
        p = dict(zip(_QUATERNION.coordinates, self.arrays["p"].T, strict=True))
        return {
            "q": rotation_of(self.model.matrix, self.values),
            "p": rotation_of(_QUATERNION.matrix, p),
            "matrix": of(self._shown(self.arrays["matrix"].reshape(-1, 9))),
        }

    def _of(self, symbols: Sequence[sp.Expr]) -> Array:
        rows = [self.values[symbol] for symbol in symbols]
        return np.stack(rows, axis=-1) if rows else np.empty((len(self.lengths), 0))

    def _shown(self, entries: Array) -> Array:
        """R as the model presents it, or that as R: with its transpose, where it does so."""
        return entries[:, _TRANSPOSED] if self.model.passive else entries


def rotation_of(matrix: sp.ImmutableMatrix, values: Mapping[sp.Expr, Array]) -> Array:
    """A matrix at all points to 50 digits, (count, 9)."""
    truth = Truth(values, precise())
    return np.stack([truth.of(entry) for entry in matrix], axis=-1)


def _quaternions(matrices: Array) -> Array:
    """Quaternions (count, 4) of matrices (count, 9): about, since their own R is compared with."""
    truth = Truth(dict(zip(_ENTRIES, matrices.T, strict=True)), FLOATS)
    k = np.stack([truth.of(entry) for entry in _K], axis=-1).reshape(-1, 4, 4)
    largest = np.einsum("nii->ni", k).argmax(axis=1)
    columns = k[np.arange(len(k)), largest]
    return columns / np.linalg.norm(columns, axis=1, keepdims=True)


@dataclass(frozen=True, kw_only=True)
class Rotations:
    """Coordinates and constants of one model at some points, and the rotations to go back from."""

    derivation: Derivation
    count: int
    is_steady: bool = False  # whether constants are the same at all points

    @property
    def model(self) -> RotationModel:
        return self.derivation.model

    @cached_property
    def turns(self) -> ChainTurns | None:
        """The turns whose angles follow from a rotation, where there are any."""
        backward = conversions_of(self.model).backward
        found = chain_turns(self.model) if backward else None
        return found if isinstance(found, ChainTurns) else None

    @property
    def reach(self) -> float:
        """The largest coordinate of those that are given."""
        if self.model.pullback is not None:  # to entries of R
            return 1.0
        return pi if self.turns else SMALL

    def nearest(self, argument: str) -> float:
        """How near the points come to poles, or to no turn and half turns; 0 for not at all."""
        if self.turns:
            return _AT_POLES if len(self.turns.solved) == 3 else 0.0
        return 0.0 if argument == "q" else NEAREST

    @cached_property
    def double(self) -> Given:
        return self._given(np.arange(self.count), np.float64)

    @cached_property
    def single(self) -> Given:
        """Of every other point."""
        return self._given(np.arange(1, self.count, 2), np.float32)

    def _given(self, some: Array, dtype: type[np.floating[Any]]) -> Given:
        values = {s: value[some].astype(dtype) for s, value in self._values.items()}
        if self.turns:
            rotation = rotation_of(self.model.matrix, values)
        else:
            parts = self._drawn[some].astype(dtype).T
            named = dict(zip(_QUATERNION.coordinates, parts, strict=True))
            rotation = rotation_of(_QUATERNION.matrix, named)
        source = np.random.default_rng(52)
        lengths = np.geomspace(SHORTEST, LONGEST, self.count) * source.choice([-1, 1], self.count)
        return Given(
            derivation=self.derivation,
            values=values,
            rotation=rotation,
            lengths=lengths[some].astype(dtype),
            kept=self.turns.kept if self.turns else (),
        )

    @cached_property
    def _values(self) -> Values:
        """Coordinates anywhere and constants, both under their conditions; turns by their own."""
        vectors = tuple(a for a in self.derivation.arguments if a.name in ("q", "parameters"))
        points = Points(
            derivation=replace(self.derivation, singularities=None),
            vectors=vectors,
            count=2 * self.count,
            is_large=False,
        )
        found = {s: value[::2] for s, value in points.values.items()}  # the others are rounded
        found = {**_allowed(found, self.model), **self._pulled_back()}
        if self.is_steady:
            found |= {s: np.full(self.count, found[s][0]) for s in self.model.constants}
        return {**found, **self._turned(self.turns, found)} if self.turns else found

    def _pulled_back(self) -> Values:
        """Coordinates that are bound as functions of others, which are those of a quaternion."""
        pullback = self.model.pullback
        if pullback is None:
            return {}
        others = sp.ordered(sp.Matrix(pullback.coordinates).atoms(AppliedUndef))
        truth = Truth(dict(zip(others, self._drawn.T, strict=True)), FLOATS)
        return {
            q: truth.of(value)
            for q, value in zip(self.model.coordinates, pullback.coordinates, strict=True)
        }

    def _turned(self, turns: ChainTurns, values: Values) -> Values:
        """The coordinates that follow from angles of the turns."""
        source, truth = np.random.default_rng(51), Truth(values, FLOATS)
        angles = source.uniform(-pi, pi, (turns.inverse.rows, self.count))
        if len(turns.solved) == 3:
            points = np.arange(self.count)
            kind = points // 2 % 10
            eps = np.where(points % 2, *(np.finfo(t).eps for t in (np.float32, np.float64)))
            few = [eps * limit * source.uniform(-1, 1, self.count) for limit in _FEW]
            away = np.select(
                [kind == k for k in range(4)], [self._away(source, _AT_POLES), *few, 0.0 * eps]
            )
            pole = _flat(turns, truth) + pi * source.integers(0, 2, self.count)
            angles[1] = np.where(kind < 4, _wrapped(pole + away), angles[1])
        offsets = np.stack([truth.of(offset) for offset in turns.offsets])
        found = np.array(turns.inverse, float) @ (angles - offsets)
        return {self.model.coordinates[p]: row for p, row in zip(turns.places, found, strict=True)}

    def _away(self, source: np.random.Generator, nearest: float | Array) -> Array:
        """Small distances of all orders of magnitude, to both sides."""
        powers = source.uniform(1, -np.log10(nearest), self.count)
        return source.choice([-1, 1], self.count) * 10.0**-powers

    @cached_property
    def _drawn(self) -> Array:
        """Unit quaternions, (count, 4)."""
        source, points = np.random.default_rng(53), np.arange(self.count)
        found = source.normal(size=(self.count, 4))
        kind = points // 2 % 10
        away = self._away(source, np.where(points % 2, NEAREST_SINGLE, NEAREST))
        axes = found[:, 1:] / np.linalg.norm(found[:, 1:], axis=1, keepdims=True)
        beside = kind < 2
        found[beside, 1:] = (axes * np.where(kind, np.cos(away), np.sin(away))[:, None])[beside]
        found[beside, 0] = np.where(kind, np.sin(away), np.cos(away))[beside]
        simple = kind == 2
        found[simple] = source.integers(-1, 2, (self.count, 4))[simple]
        found[simple & (found[:, 1:] == 0).all(axis=1), 1] = 1.0
        if self._is_unbounded:
            found[found[:, 0] == 0, 0] = 1.0
        return found / np.linalg.norm(found, axis=1, keepdims=True)

    @property
    def _is_unbounded(self) -> bool:
        backward = conversions_of(self.model).backward
        rule = backward.rule if backward else None
        return isinstance(rule, ClosedForm) and rule.rule == _UNBOUNDED


def _allowed(values: Values, model: RotationModel) -> Values:
    """Points that are rotations, some of them again in the place of reflections.

    Where R Rᵀ = 1 binds the coordinates, points may be found on either side of it.
    """
    if not model.constraints:
        return values
    truth = Truth(values, FLOATS)
    matrices = np.stack([truth.of(entry) for entry in model.matrix], axis=-1).reshape(-1, 3, 3)
    is_rotation = np.linalg.det(matrices) > 0
    some = np.resize(np.flatnonzero(is_rotation), len(is_rotation))
    return {s: value[some] for s, value in values.items()}


def _wrapped(angle: Array) -> Array:
    return np.where(angle > pi, angle - 2 * pi, angle)


def _flat(turns: ChainTurns, truth: Truth) -> Array:
    """The middle angle at which the first axis and the turned last are in a plane with it."""
    one, two, three = map(sp.Matrix, turns.axes)
    across, along = one.dot(two.cross(three)), one.dot(three) - one.dot(two) * two.dot(three)
    return np.arctan2(truth.of(across), truth.of(along))
