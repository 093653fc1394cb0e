"""Motions with numbers: a note draws them, and `simulate` begins with the first."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from math import isfinite
from numbers import Real
from typing import Any, NamedTuple

import sympy as sp

from rigidsym.errors import ModelError, offer
from rigidsym.models.rotation import RotationModel

OMEGA = "angular_velocity_body"
OMEGA_COMPONENTS = (f"{OMEGA}_1", f"{OMEGA}_2", f"{OMEGA}_3")
_KEYS = ("parameters", "initial", "time")


class Example(NamedTuple):
    """One motion; SI units, angles in radians."""

    parameters: Mapping[str, float]
    initial: Mapping[str, float]  # coordinates, and rates or components of Ω′, by name
    time: float  # s


def examples_of(model: RotationModel, given: Sequence[Mapping[str, Any]]) -> Iterator[Example]:
    """The examples in the order given; each takes from the first what it does not name.

    Raises ModelError for a key or an initial value that does not exist, and for no time.
    """
    names = [q.func.__name__ for q in model.coordinates]
    known = (*names, *(f"{name}_dot" for name in names), *OMEGA_COMPONENTS)
    first = Example({}, {}, 0.0)
    for k, example in enumerate(given):
        for key in set(example) - set(_KEYS):
            raise ModelError(f"an example: unknown key {key}; expected {', '.join(_KEYS)}")
        if not all(isinstance(example.get(key, {}), Mapping) for key in _KEYS[:2]):
            raise ModelError("an example: expected parameters and initial values by name")
        found = Example(
            {**first.parameters, **example.get("parameters", {})},
            {**first.initial, **example.get("initial", {})},
            example.get("time", first.time),
        )
        for name in found.initial:
            if name not in known:
                raise ModelError(f"an example: unknown initial value {name}; {offer(name, known)}")
        numbers: tuple[Any, ...] = (*found.parameters.values(), *found.initial.values(), found.time)
        are_finite = all(isinstance(value, Real) and isfinite(value) for value in numbers)
        if not are_finite or found.time <= 0:
            raise ModelError("an example needs finite numbers, and a time > 0 in seconds")
        first = first if k else found
        yield found


def initial_values(model: RotationModel, given: Mapping[str, Any]) -> dict[str, Any]:
    """All coordinates, and all rates or components of Ω′: no rotation, at rest, if not given."""
    names = [q.func.__name__ for q in model.coordinates]
    start: dict[str, Any] = dict.fromkeys(names, 0.0)
    if start.keys().isdisjoint(given):
        start = no_rotation(model)
    turning = [f"{name}_dot" for name in names]
    if not set(OMEGA_COMPONENTS).isdisjoint(given):
        turning = list(OMEGA_COMPONENTS)
    return {**start, **dict.fromkeys(turning, 0.0), **given}


def no_rotation(model: RotationModel) -> dict[str, float]:
    """Coordinates of R = 1: all 0, or one of them 1."""
    q = model.coordinates
    for place in range(-1, len(q)):
        values = {x: sp.S.One if k == place else sp.S.Zero for k, x in enumerate(q)}
        if model.matrix.xreplace(values) == sp.eye(3):
            return {x.func.__name__: float(value) for x, value in values.items()}
    return dict.fromkeys((x.func.__name__ for x in q), 0.0)
