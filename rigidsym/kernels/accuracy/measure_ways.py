"""Functions back to coordinates, and `unwrap`: R of what they give against R of what is given."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import gcd
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rigidsym.errors import CheckError
from rigidsym.kernels.accuracy.rotations import Given, Rotations, rotation_of
from rigidsym.kernels.accuracy.table import Row, rounded_up
from rigidsym.kernels.accuracy.tools import called, caller
from rigidsym.kernels.accuracy.ways import Way, ways_of
from rigidsym.kernels.conversions.conversions import lower_conversions
from rigidsym.kernels.lowering.lower import lower
from rigidsym.kernels.targets import TARGETS
from rigidsym.mechanics.conversions.conversions import conversions_of
from rigidsym.mechanics.derivation import Derivation
from rigidsym.models.quaternions import UnitQuaternion

_UNIT = UnitQuaternion()
_STEPS = 10  # of a trajectory

Array = NDArray[Any]


def ways_in(derivation: Derivation) -> tuple[Way, ...]:
    """All that are measured."""
    program = lower_conversions(derivation, conversions_of(derivation.model))
    return ways_of(program, derivation, lower(derivation).kernels)


def way_subjects(derivation: Derivation, ways: Sequence[Way], count: int) -> Iterator[WaySubject]:
    """Each way with the points that it is measured at."""
    rotations = Rotations(derivation=derivation, count=count)
    steady = Rotations(derivation=derivation, count=count, is_steady=True)
    for way in ways:
        yield WaySubject(way=way, rotations=steady if way.is_unwrap else rotations)


@dataclass(frozen=True, kw_only=True, slots=True)
class WaySubject:
    """One function that is no kernel, and the rotations that it is measured at."""

    way: Way
    rotations: Rotations

    @property
    def name(self) -> str:
        return self.way.name

    def row(self, errors: Mapping[str, tuple[float, ...]]) -> Row:
        return Row(
            digest=self.way.digest,
            points=self.rotations.count,
            reach=self.rotations.reach,
            nearest=self.rotations.nearest(self.way.arguments[0]),
            function=f"{self.rotations.derivation.name} {self.name}",
            errors=errors,
        )

    def errors(self, target: str, module: ModuleType) -> tuple[float, ...]:
        """In double precision, and in single where the target has it."""
        given = self.rotations.double
        values = self._called(target, module, given)
        found = [self._error(target, given, values)]
        twin = getattr(module, f"{self.name}_scalar", None)
        if target == "numpy" and twin is not None:  # the same text for numba and c
            rows = np.hstack([a.reshape(len(values), -1) for a in self._arrays(given)]).tolist()
            found[0] = max(
                found[0], self._error(target, given, np.array([twin(*row) for row in rows]))
            )
        if TARGETS[target].has_single:
            single = self.rotations.single
            found.append(self._error(target, single, self._called(target, module, single)))
        return tuple(map(rounded_up, found))

    def _arrays(self, given: Given) -> list[Array]:
        return [given.arrays[name] for name in self.way.arguments]

    def _called(self, target: str, module: ModuleType, given: Given) -> Array:
        function, arrays = getattr(module, self.name), self._arrays(given)
        if not self.way.is_unwrap:
            return caller(target, function)(*arrays)
        q, *constants = arrays
        constants = [array[0] for array in constants]
        shape = (gcd(_STEPS, len(q)), -1, q.shape[1])  # short, so that angles do not grow large
        if target == "javascript":  # where an array is one trajectory, row after row
            walks = q.reshape(shape).swapaxes(0, 1)
            found = module.unwrap_each(walks.reshape(len(walks), -1), *constants)
            return np.asarray(found).reshape(walks.shape).swapaxes(0, 1).reshape(q.shape)
        return np.asarray(called(target, function)(q.reshape(shape), *constants)).reshape(q.shape)

    def _error(self, target: str, given: Given, values: Array) -> float:
        """The largest at any point, in eps of the values' type and of the largest entry of R."""
        if not np.isfinite(values).all():
            raise CheckError(
                f"{self.rotations.derivation.name}: {self.name} for {target} gives NaN where "
                "there is a value"
            )
        exact = given.exact[self.way.arguments[0]]
        off = abs(self._rotation(given, values) - exact).max(axis=1).astype(float)
        relative = off / abs(exact).max(axis=1).astype(float) / self._sizes(values)
        return float(relative.max(initial=0.0)) / float(np.finfo(values.dtype).eps)

    def _rotation(self, given: Given, values: Array) -> Array:
        """R of what a function gives: of a quaternion, or of coordinates."""
        if self.name == "quaternion":
            return rotation_of(_UNIT.matrix, dict(zip(_UNIT.coordinates, values.T, strict=True)))
        model = self.rotations.model
        coordinates = dict(zip(model.coordinates, values.T, strict=True))
        return rotation_of(model.matrix, {**given.values, **coordinates})

    def _sizes(self, values: Array) -> Array | float:
        """Of the angles of a trajectory, which whole turns make large."""
        if not any(self.way.angles):
            return 1.0
        sizes: Array = np.abs(values[:, self.way.angles]).max(axis=1, initial=1.0)
        return sizes
