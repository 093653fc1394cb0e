"""Where the rates of a rotation fail, and what is lost there."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property, lru_cache, reduce
from typing import Literal

import sympy as sp
from sympy.core.function import AppliedUndef

from rigidsym.algebra.generators import added
from rigidsym.formula.letters import TIME
from rigidsym.mechanics.derivation import Derivation, Singularities, Singularity
from rigidsym.models.rotation import RotationModel
from rigidsym.notes.facts.rotation import angle_facts
from rigidsym.system.records import NamedTuple, Record

_MOST_POINTS = 8  # that are told of one by one
_MOST_PLACES = 2  # of one point that are repeated
_COUNT = sp.Symbol("k")
_WHOLE_TURN = 2 * sp.pi


class Multiples(NamedTuple):
    """All multiples of a unit, or the odd ones, are the zeros of an angle."""

    angle: sp.Expr
    unit: sp.Expr
    are_odd: bool


class PointFacts(Record):
    """What is lost at a singular point, and what remains determined."""

    at: Singularity
    coordinates: tuple[sp.Expr, ...]
    is_only_one: bool = False  # so that its many places were just named

    @property
    def places(self) -> list[tuple[sp.Expr, bool]]:
        """θ = 0, or n = 2 π k, with whether it is counted by k = 1, 2, ..."""
        pairs = []
        for place in () if self.is_only_one else self.at.places:
            steps = place.period * (_COUNT - 1) if place.is_length else 0
            equation = sp.Eq(place.coordinate, sp.expand(place.value + steps), evaluate=False)
            pairs.append((equation, place.is_length))
        return pairs

    @property
    def varies(self) -> bool:
        """Whether the rates that turn nothing depend on the orientation."""
        return not all(entry.is_number for entry in self.at.null_rates)

    @property
    def undetermined(self) -> tuple[sp.Expr, ...]:
        """The coordinates whose rates are lost, if others remain and the loss varies."""
        moved = self._moved_by(self.at.null_rates.tolist())
        return moved if self.varies and len(moved) < len(self.coordinates) else ()

    @property
    def determined(self) -> tuple[sp.Expr, ...]:
        """The combinations that rates which turn nothing leave as they are, but for the fixed ones.

        They are those of the coordinates where such rates stay at the point: R is then the same
        all along. Where they leave it, only rates are determined, and the combinations are those
        of rates.
        """
        fixed = tuple(place.coordinate for place in self.at.places)
        return _determined(self.at.null_rates, self.coordinates, fixed)

    @property
    def idle(self) -> list[list[sp.Expr]]:
        """Rates that turn nothing."""
        rates: list[list[sp.Expr]] = self.at.null_rates.T.tolist()
        return rates

    @property
    def moved(self) -> tuple[sp.Expr, ...]:
        """The coordinates that change without a motion of the body."""
        return self._moved_by([[n] for n in self.idle[0]])

    @property
    def change(self) -> Literal["", "single", "equal", "opposite"]:
        """How these coordinates change, if it is simple to say."""
        match [n for n in self.idle[0] if n]:
            case [_] if len(self.idle) == 1:
                return "single"
            case [a, b] if len(self.idle) == 1 and abs(a) == abs(b):
                return "equal" if a == b else "opposite"
        return ""

    def _moved_by(self, rates: Sequence[Sequence[sp.Expr]]) -> tuple[sp.Expr, ...]:
        return tuple(q for q, row in zip(self.coordinates, rates, strict=True) if any(row))


@lru_cache(maxsize=32)  # the same in many conventions
def _determined(
    null_rates: sp.ImmutableMatrix, q: tuple[sp.Expr, ...], fixed: tuple[sp.Expr, ...]
) -> tuple[sp.Expr, ...]:
    if not all(entry.is_Rational for entry in null_rates):
        return ()
    gradients = sp.Matrix(
        len(fixed),
        len(q),
        [sp.Integer(f == by) if f in q else f.diff(by) for f in fixed for by in q],
    )
    if leaves := any(gradients * null_rates):
        gradients = gradients[:0, :]
    named = [by.diff(TIME) for by in q] if leaves else q
    # A combination c·q is kept if c·n = 0 for every null vector n of the rates. Its factors
    # become the smallest whole numbers, the first of them above zero. What is fixed comes
    # first, and only what is independent of it remains.
    kept = [(c / next(filter(None, c))).T for c in sp.Matrix(null_rates.T).nullspace()]
    rows = sp.Matrix.vstack(gradients, *kept)
    independent = [k for k in rows.T.rref()[1] if k >= gradients.rows]
    combinations = []
    for numbers in (rows.row(k).tolist()[0] for k in independent):
        common = reduce(sp.Rational.gcd, filter(None, numbers))
        parts = (n / common * by for n, by in zip(numbers, named, strict=True))
        combinations.append(added(*parts))
    return tuple(combinations)


class SingularFacts(Record):
    """Where the rate matrices lose rank."""

    model: RotationModel
    result: Singularities

    @property
    def is_gimbal_lock(self) -> bool:
        return len(self.model.turns) > 1 and bool(self.zeros)

    @property
    def binds_rates(self) -> bool:
        """Whether a condition holds for coordinates, not for constants only."""
        return any(condition.atoms(AppliedUndef) for condition in self.model.constraints)

    @property
    def has_constants(self) -> bool:
        """Whether a factor holds constants of the model and nothing that moves."""
        return any(
            factor.free_symbols and not factor.atoms(AppliedUndef)
            for factor in sp.Mul.make_args(self.result.determinant)
        )

    @cached_property
    def zeros(self) -> list[PointFacts]:
        return [PointFacts(p, self.model.coordinates) for p in self.result.points if p.places]

    @property
    def multiples(self) -> Multiples | None:
        places = {place for point in self.zeros for place in point.at.places}
        angle, *others = {place.coordinate for place in places} or {None}
        if angle is None or others or not self.result.is_solved:
            return None
        zeros = {place.value for place in places}
        if zeros == {sp.S.Zero, sp.pi}:
            return Multiples(angle, sp.pi, are_odd=False)
        if zeros == {sp.pi / 2, -sp.pi / 2}:
            return Multiples(angle, sp.pi / 2, are_odd=True)
        return None

    @property
    def periods(self) -> list[tuple[sp.Expr, sp.Expr | None]]:
        """The periods of the zeros: one for all coordinates, or 2π and the longer ones."""
        places = [place for point in self.zeros for place in point.at.places if not place.is_length]
        periods = {place.coordinate: place.period for place in places}
        if len({*periods.values()}) <= 1:
            return [(period, None) for period in {*periods.values()}]
        longer = [(period, q) for q, period in periods.items() if period != _WHOLE_TURN]
        return [*([(_WHOLE_TURN, None)] if len(longer) < len(periods) else []), *longer]

    @property
    def outer_angles(self) -> tuple[sp.Expr, ...]:
        """The angles of the two rotations that come to turn about one axis, in gimbal lock."""
        angles = angle_facts(self.model)
        return (angles.all[0], angles.all[2]) if angles and self.result.points else ()

    @cached_property
    def points(self) -> list[PointFacts]:
        first = self.result.points[:_MOST_POINTS]
        is_only_one = len(self.result.points) == 1
        return [
            PointFacts(p, self.model.coordinates, is_only_one and len(p.places) > _MOST_PLACES)
            for p in first
        ]

    @property
    def more_points(self) -> int:
        return max(0, len(self.result.points) - _MOST_POINTS)


def singular_facts(derivation: Derivation) -> SingularFacts | None:
    singularities = derivation.singularities
    return singularities and _facts(derivation.model, singularities)


_facts = lru_cache(maxsize=32)(SingularFacts)  # of the note, and of the terminal
