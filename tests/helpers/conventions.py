"""Data in a known convention, made without `identify`: SciPy, and differences for Ω."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import permutations, product

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

import rigidsym as rs
from rigidsym.tools.identify.readings import VELOCITIES, Reading

Array = NDArray[np.float64]

GENERIC = {True: (17.0, 38.0, -63.0), False: (0.3, 0.9, -1.4)}  # by whether in degrees
RATES = (0.7, -1.1, 0.4)

EVERY = tuple(
    Reading(sequence=sequence, columns=columns, signs=signs, passive=passive, degrees=degrees)
    for sequence, columns, signs, passive, degrees in product(
        rs.EULER_SEQUENCES,
        permutations(range(3)),
        product((1, -1), repeat=3),
        (False, True),
        (False, True),
    )
)


def rotation(reading: Reading, angles: Sequence[float] | Array) -> Rotation:
    """R of a reading: body to space components."""
    turns = np.asarray(angles, float)[..., list(reading.columns)] * np.array(reading.signs)
    return Rotation.from_euler(reading.sequence, turns, degrees=reading.degrees)


def attitude(reading: Reading, angles: Sequence[float] | Array) -> dict[str, Array]:
    """The matrix or the quaternion that this reading gives, by its name in `identify`."""
    given = rotation(reading, angles)
    given = given.inv() if reading.passive else given
    if reading.scalar_last is None:
        return {"matrix": given.as_matrix()}
    return {"quaternion": given.as_quat(scalar_first=not reading.scalar_last)}


def omega(reading: Reading, angles: Sequence[float], rates: Sequence[float]) -> Array:
    """Ω as this reading has it, from two rotations close to each other."""
    step = 1e-4 / (np.linalg.norm(rates) or 1.0)
    before, after = (
        rotation(reading, np.asarray(angles) + sign * step * np.asarray(rates))
        for sign in (-1.0, 1.0)
    )
    # A turn during which Ω is constant to first order; what is left is of third order.
    turned = (after * before.inv()).as_rotvec() / (2 * step) / reading.factor
    if reading.velocity.frame == "body":
        turned = rotation(reading, angles).inv().apply(turned)
    return turned * reading.velocity.factor


def sample(reading: Reading, angles: Sequence[float], rates: Sequence[float] = RATES):
    """One sample as the arguments of `identify`."""
    given = {"angles": angles, **attitude(reading, angles)}
    if reading.velocity:
        given |= {"rates": rates, "omega": omega(reading, angles, rates)}
    return given


def holds(answer, reading: Reading) -> bool:
    """Whether an answer is this reading, in these or in other words."""
    return reading in (answer.reading, *answer.aliases)


def some(count: int, *, seed: int, layouts=(None,), velocities=(None, *VELOCITIES)):
    """Readings drawn from all there are."""
    rng = np.random.default_rng(seed)
    return [
        replace(
            EVERY[rng.integers(len(EVERY))],
            scalar_last=layouts[rng.integers(len(layouts))],
            velocity=velocities[rng.integers(len(velocities))],
        )
        for _ in range(count)
    ]
