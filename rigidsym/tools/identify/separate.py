"""Further samples that tell the remaining readings apart: computed and verified."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import permutations
from math import pi

import numpy as np

from rigidsym.tools.identify.readings import Reading
from rigidsym.tools.identify.tolerance import Tolerance
from rigidsym.tools.identify.turns import Array, ReadingTable, angle_between
from rigidsym.tools.identify.velocity import angular_velocities, as_given

Triple = tuple[float, float, float]

_DEGREES = (15, 20, 25, 35, 40, 50, 60, 65, 70, 80)
_RADIANS = (0.2, 0.3, 0.4, 0.5, 0.7, 0.8, 1.0, 1.2, 1.3)
_RATES = (1.0, 2.0, 3.0)
_MAGNITUDES = (1.0, 10.0, 0.1, 100.0, 0.01, 1e3, 1e-3, 1e4, 1e5)
_CLEAR = 3.0  # tolerances; two readings less than two apart might fit one sample
_PAIRS = 8_000_000  # compared in the search at most
_FEWEST = 6  # candidates, even if that means more pairs
_MOST_SAMPLES = 5


@dataclass(frozen=True, kw_only=True, slots=True)
class FurtherSample:
    """Values for the angle columns and, if Ω is given, for their rates."""

    angles: Triple
    rates: Triple | None = None


@dataclass(frozen=True, kw_only=True, slots=True)
class Separation:
    """Samples at one of which any two of the readings differ clearly."""

    samples: tuple[FurtherSample, ...]
    difference: float  # radians; the least angle between two orientations
    velocity_difference: float | None  # the least |difference of Ω|, over the largest |Ω|


def separation(
    readings: Sequence[Reading], tolerance: Tolerance, scale: float
) -> Separation | None:
    """Further samples, as few as can be found, that leave one of these readings.

    None where one is left already, and where the tolerance is too wide for any sample.
    """
    if len(readings) < 2:
        return None
    orientations = list(dict.fromkeys(reading.orientation for reading in readings))
    angles, difference = _angles(orientations, _CLEAR * tolerance.orientation)
    if difference <= _CLEAR * tolerance.orientation:
        return None
    rates, apart = _rates(readings, angles[0], tolerance, scale)
    if apart is not None and apart <= _CLEAR * tolerance.velocity:
        return None
    return Separation(
        samples=tuple(FurtherSample(angles=triple, rates=rates) for triple in angles),
        difference=difference,
        velocity_difference=apart,
    )


def _angles(orientations: Sequence[Reading], clear: float) -> tuple[list[Triple], float]:
    """Angles at which the closest two readings are far apart; several samples if needed."""
    candidates = _candidates(orientations)
    if len(orientations) == 1:
        return candidates[:1], pi
    quaternions = ReadingTable(orientations).as_given(np.array(candidates))
    chosen: list[int] = []
    closeness = np.ones((len(orientations), len(orientations)))
    difference = 0.0
    while difference <= clear and len(chosen) < _MOST_SAMPLES:
        best = min(range(len(candidates)), key=lambda k: _closest(closeness, quaternions[k])[0])
        chosen.append(best)
        closeness = np.minimum(closeness, _closeness(quaternions[best]))
        first, second = _closest(closeness, quaternions[best])[1]
        pairs = quaternions[chosen]
        difference = float(angle_between(pairs[:, first], pairs[:, second]).max())
    return [candidates[k] for k in chosen], difference


def _candidates(orientations: Sequence[Reading]) -> list[Triple]:
    """Round numbers between the special angles, in the unit of the readings."""
    in_radians = not any(reading.degrees for reading in orientations)
    triples = np.array(list(permutations(_RADIANS if in_radians else _DEGREES, 3)), float)
    count = max(_FEWEST, _PAIRS // len(orientations) ** 2)
    # A random order, always the same one, so that the first few are a fair choice.
    some = np.random.default_rng(17).permutation(triples)[:count]
    return [(a, b, c) for a, b, c in some.tolist()]


def _closeness(quaternions: Array) -> Array:
    """|cos| of half the angle between each two; 0 for each with itself."""
    closeness = np.abs(quaternions @ quaternions.T)
    np.fill_diagonal(closeness, 0.0)
    return np.asarray(closeness)


def _closest(known: Array, quaternions: Array) -> tuple[float, tuple[int, int]]:
    """How close the closest two readings remain over all samples, and which they are."""
    joint = np.minimum(known, _closeness(quaternions))
    place = int(joint.argmax())
    return float(joint.flat[place]), divmod(place, len(joint))


def _rates(
    readings: Sequence[Reading], angles: Triple, tolerance: Tolerance, scale: float
) -> tuple[Triple | None, float | None]:
    """Rates at which the readings of Ω differ, about as fast as those in the data."""
    if readings[0].velocity is None:
        return None, None
    given = _velocities(readings, angles)
    found = [(_apart(given * size, scale), size) for size in _MAGNITUDES]
    clear = [pair for pair in found if pair[0] > _CLEAR * tolerance.velocity]
    difference, size = clear[0] if clear else max(found)
    first, second, third = _RATES
    return (first * size, second * size, third * size), difference


def _velocities(readings: Sequence[Reading], angles: Triple) -> Array:
    """Ω as each reading has it in the data, at _RATES; NaN for a reading that is excluded.

    (readings of the orientation, readings of Ω, 3)
    """
    orientations = list(dict.fromkeys(reading.orientation for reading in readings))
    velocities = list(dict.fromkeys(r.velocity for r in readings if r.velocity))
    omega = angular_velocities(orientations, np.array([angles]), np.array([_RATES]))
    given = as_given(omega[0], velocities)
    left = set(readings)
    is_left = [[replace(o, velocity=v) in left for v in velocities] for o in orientations]
    return np.where(np.array(is_left)[..., None], given, np.nan)


def _apart(given: Array, scale: float) -> float:
    """The least |difference of Ω| of two readings of one orientation, over the largest |Ω|."""
    differences = np.linalg.norm(given[:, :, None] - given[:, None], axis=-1)
    largest = np.maximum(np.linalg.norm(given, axis=-1), scale)
    shares = differences / largest[:, :, None]
    first, second = np.nonzero(~np.eye(shares.shape[1], dtype=bool))
    return float(np.nanmin(shares[:, first, second], initial=np.inf))
