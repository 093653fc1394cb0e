"""Points to measure at, the same in every run: anywhere, at large angles, near poles.

Of every ten, four have coordinates up to π, four up to 1e4, one up to 1e6 and one up to 1e15,
where the functions take sines and cosines of coordinates alone; else all have them up to 3.
Beside poles lie one in ten, from 0.1 down to 1e-12. All other inputs are at most one. Every other
point is rounded to single precision, to serve both.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from math import pi
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from rigidsym.algebra.adjoin import rate_of
from rigidsym.kernels.accuracy.table import LARGE, LARGEST, SMALL
from rigidsym.kernels.accuracy.truth import FLOATS, Truth
from rigidsym.mechanics.derivation import Argument, Derivation, Place

NEAREST = 1e-12
_SIZES = (*(pi,) * 4, *(LARGE,) * 4, 1e6, LARGEST)  # in turn
_STEPS = 30  # of Newton's method, at most
_POSITIVE = 0.25  # the least of what is positive, such as a mass

Array = NDArray[Any]


@dataclass(frozen=True, kw_only=True)
class Points:
    """Values of some vectors of inputs at `count` points."""

    derivation: Derivation
    vectors: tuple[Argument, ...]
    count: int
    is_large: bool  # whether angles are as large as angles can be

    @property
    def reach(self) -> float:
        return LARGEST if self.is_large else SMALL

    @cached_property
    def is_single(self) -> Array:
        """Which points hold numbers of single precision."""
        return np.arange(self.count) % 2 == 1

    @cached_property
    def is_near(self) -> Array:
        """Which points lie near poles."""
        return (np.arange(self.count) % 20 < 2) & bool(self._poles)

    @cached_property
    def is_plain(self) -> Array:
        """Which points have neither large angles nor poles beside them."""
        return ~self.is_near & (np.arange(self.count) % len(_SIZES) < _SIZES.count(pi))

    @cached_property
    def values(self) -> Mapping[sp.Expr, Array]:
        """symbol: one value a point."""
        random = np.random.default_rng(50)
        found = {s: self._drawn(s, random) for v in self.vectors for s in v.symbols}
        for vector in self.vectors:
            if vector.name == "q":
                found |= self._sized(vector, random)
            elif vector.name == "direction":
                found |= _of_length_one(found, vector)
        found |= self._beside_poles(found)
        found |= self._bound(found)
        return {symbol: self._rounded(value) for symbol, value in found.items()}

    def of(self, vector: Argument) -> Array:
        """(count, n)"""
        return np.stack([self.values[symbol] for symbol in vector.symbols], axis=-1)

    def _drawn(self, symbol: sp.Expr, random: np.random.Generator) -> Array:
        least = _POSITIVE if symbol.is_positive else -1.0
        return random.uniform(least, 1.0, self.count)

    def _sized(self, q: Argument, random: np.random.Generator) -> dict[sp.Expr, Array]:
        sizes = np.resize(_SIZES, self.count) if self.is_large else SMALL
        return {symbol: sizes * random.uniform(-1, 1, self.count) for symbol in q.symbols}

    def _rounded(self, value: Array) -> Array:
        return np.where(self.is_single, value.astype(np.float32), value)

    @cached_property
    def _poles(self) -> tuple[tuple[Place, ...], ...]:
        """Places of poles; coordinates under a condition, and lengths, are left where they are."""
        found = self.derivation.singularities
        points = found.points if found and not self.derivation.model.constraints else ()
        return tuple(
            p.places for p in points if p.places and not any(x.is_length for x in p.places)
        )

    def _beside_poles(self, values: Mapping[sp.Expr, Array]) -> dict[sp.Expr, Array]:
        found: dict[sp.Expr, Array] = {}
        turns = np.cumsum(self.is_near) - 1  # of the points near poles
        for number, places in enumerate(self._poles):
            here = self.is_near & (turns // 2 % len(self._poles) == number)
            powers = 1 + np.arange(self.count) // 20 % np.where(self.is_single, 4, 12)
            away = np.where(turns // 4 % 2, 1, -1) * 10.0**-powers
            for place in places:
                known = {s: a for s, a in values.items() if s in place.value.free_symbols}
                at = Truth(known or {place.coordinate: away}, FLOATS).of(place.value)
                before = found.get(place.coordinate, values[place.coordinate])
                found[place.coordinate] = np.where(here, at + away, before)
        return found

    def _bound(self, values: Mapping[sp.Expr, Array]) -> dict[sp.Expr, Array]:
        """Coordinates, rates and second rates moved to where the conditions hold."""
        found: dict[sp.Expr, Array] = {}
        conditions = self.derivation.model.constraints
        free = [*self.derivation.model.coordinates, *self.derivation.model.constants]
        slopes = sp.Matrix(conditions).jacobian(free) if conditions else None
        for order in range(3):
            symbols = [self._derived(symbol, order) for symbol in free]
            if slopes is None or not any(symbol in values for symbol in symbols):
                break
            moving = [k for k, s in enumerate(symbols) if s in values]
            moved = _moved({**values, **found}, symbols, conditions, slopes, moving)
            found |= moved
            conditions = tuple(map(rate_of, conditions))
        return found

    def _derived(self, symbol: sp.Expr, order: int) -> sp.Expr:
        """A coordinate's derivative; a constant has none."""
        for _ in range(order):
            symbol = rate_of(symbol)
        return symbol


def _of_length_one(values: Mapping[sp.Expr, Array], vector: Argument) -> dict[sp.Expr, Array]:
    length = np.sqrt(sum(values[symbol] ** 2 for symbol in vector.symbols))
    return {symbol: values[symbol] / length for symbol in vector.symbols}


def _moved(
    values: Mapping[sp.Expr, Array],
    symbols: Iterable[sp.Expr],
    conditions: Iterable[sp.Expr],
    slopes: sp.Matrix,
    moving: list[int],
) -> dict[sp.Expr, Array]:
    """The symbols after Newton's method, by the shortest steps; `slopes` are by coordinates."""
    names = [s for k, s in enumerate(symbols) if k in moving]
    found = {name: values[name] for name in names}
    for _ in range(_STEPS):
        truth = Truth({**values, **found}, FLOATS)
        off = np.stack([truth.of(c) for c in conditions], axis=-1)
        rows = [[truth.of(slopes[i, k]) for k in moving] for i in range(slopes.rows)]
        steps = np.linalg.pinv(np.moveaxis(np.array(rows), -1, 0)) @ off[..., np.newaxis]
        found = {name: found[name] - steps[:, k, 0] for k, name in enumerate(names)}
    return found
