"""Readings in numbers: unit quaternions (w, x, y, z) on the last axis, and angular velocities."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from types import ModuleType

import numpy as np
from numpy.typing import NDArray

from rigidsym.tools.identify.readings import RADIANS_PER_DEGREE, Reading

Array = NDArray[np.float64]
_AXES = "XYZ"


class ReadingTable:
    """Many readings as arrays; each is rewritten with active turns about turning axes."""

    def __init__(self, readings: Sequence[Reading]) -> None:
        self.readings = tuple(readings)
        turns = [reading.active().intrinsic() for reading in self.readings]
        sequences = np.array([turn.sequence for turn in turns])
        self._sequences = {s: np.flatnonzero(sequences == s) for s in dict.fromkeys(sequences)}
        self._columns = np.array([turn.columns for turn in turns]).T
        self._signs = np.array([turn.signs for turn in turns], float).T
        self._units = np.array([int(turn.degrees) for turn in turns])
        self._scalar_last = np.array([bool(reading.scalar_last) for reading in self.readings])

    def __len__(self) -> int:
        return len(self.readings)

    def residuals(self, angles: Array, orientation: Array) -> Array:
        """Angles between each reading and the data, in radians: (n, readings).

        `orientation` (n, 4) is the quaternion of the data with its numbers in their own order.
        """
        return angle_between(self._quaternions(angles), self._given(orientation), axis=0)

    def _given(self, orientation: Array) -> Array:
        """The data as each reading takes them, scalar first: (4, n, readings)."""
        given = np.repeat(orientation.T[..., None], len(self), axis=2)
        given[..., self._scalar_last] = np.roll(given[..., self._scalar_last], 1, axis=0)
        return given

    def as_given(self, angles: Array) -> Array:
        """The quaternions with their numbers in the order of the data: (n, readings, 4)."""
        q = self._quaternions(angles)
        q[..., self._scalar_last] = np.roll(q[..., self._scalar_last], -1, axis=0)
        return np.moveaxis(q, 0, -1)

    def _quaternions(self, angles: Array) -> Array:
        """The quaternion of each reading for each row of angles (n, 3): (4, n, readings)."""
        # Sine and cosine are taken once for each column and unit, for all readings.
        half = angles[:, :, None] * (np.array([1.0, RADIANS_PER_DEGREE]) / 2)
        cosines, sines = np.cos(half), np.sin(half)
        q = np.empty((4, len(angles), len(self)))
        for sequence, places in self._sequences.items():
            turn: Array = np.zeros((4, len(angles), len(places)))
            turn[0] = 1.0
            for axis, columns, signs in zip(
                sequence, self._columns[:, places], self._signs[:, places], strict=True
            ):
                which = (slice(None), columns, self._units[places])
                turn = _then_about(_AXES.index(axis), turn, cosines[which], sines[which] * signs)
            q[..., places] = turn
        return q


def _then_about(axis: int, turn: Array, cosine: Array, sine: Array) -> Array:
    """The quaternion product of a turn (4, ...) and one about an axis, from half its angle."""
    along, first, second = (1 + (axis + k) % 3 for k in range(3))
    product = turn * cosine
    product[0] -= turn[along] * sine
    product[along] += turn[0] * sine
    product[first] += turn[second] * sine
    product[second] -= turn[first] * sine
    return product


def angle_between(p: Array, q: Array, axis: int = -1) -> Array:
    """The angle in radians, 0 to π, of the turn from one rotation to the other; q and −q are one.

    Taken from the chord, so that angles far below the square root of eps are still right.
    """
    same = np.sum(p * q, axis=axis, keepdims=True) >= 0
    chord = np.sqrt(np.sum((p - np.where(same, q, -q)) ** 2, axis=axis))
    return np.asarray(4 * np.arcsin(np.minimum(chord / 2, 1)))


def quaternion_of(matrix: Array) -> Array:
    """The quaternion of the rotation nearest to each matrix M: (..., 3, 3) to (..., 4).

    Horn (1987): K has the blocks tr M, the vector of M - Mᵀ, and M + Mᵀ - tr M. For a rotation,
    K + 1 is 4 q qᵀ; for numbers with rounding or noise, the eigenvector of K to its largest
    eigenvalue is that of the nearest rotation. The longest column of K + 1 is close to it;
    multiplying by K + 1 twice more leaves an error of third order.
    """
    transpose = matrix.swapaxes(-1, -2)
    trace = np.trace(matrix, axis1=-2, axis2=-1)
    k = np.empty((*matrix.shape[:-2], 4, 4))
    k[..., 0, 0] = trace
    k[..., 0, 1:] = k[..., 1:, 0] = (matrix - transpose)[..., [2, 0, 1], [1, 2, 0]]
    k[..., 1:, 1:] = matrix + transpose - trace[..., None, None] * np.eye(3)
    projector = k + np.eye(4)
    longest = np.argmax(np.diagonal(projector, axis1=-2, axis2=-1), axis=-1)
    q = np.take_along_axis(projector, longest[..., None, None], axis=-1)
    for _ in range(2):
        q = projector @ q
    return np.asarray(q[..., 0] / np.linalg.norm(q[..., 0], axis=-1, keepdims=True))


_FRAMES = ("space", "body")


@cache
def _kernels(sequence: str) -> ModuleType:
    # Loaded here, so that identifying orientations does not need SymPy.
    from rigidsym.motion import derive

    wanted = [f"angular_velocity_{frame}" for frame in _FRAMES]
    return derive(sequence).select(wanted).kernels().load()


def angular_velocities(readings: Sequence[Reading], angles: Array, rates: Array) -> Array:
    """Ω as the data have it under each reading, which has a velocity: (n, readings, 3).

    `angles` and `rates` (n, 3) are columns of the data.
    """
    kernels: dict[tuple[str, str], list[int]] = {}
    for k, reading in enumerate(readings):
        assert reading.velocity
        kernels.setdefault((reading.intrinsic().sequence, reading.velocity.frame), []).append(k)
    omega = np.empty((len(angles), len(readings), 3))
    for (sequence, frame), places in kernels.items():
        turns = [readings[k].intrinsic() for k in places]
        columns, signs = ([getattr(t, name) for t in turns] for name in ("columns", "signs"))
        units = np.array([[t.factor] for t in turns])
        factors = np.array([[t.velocity.factor if t.velocity else 1.0] for t in turns])
        kernel = getattr(_kernels(sequence), f"angular_velocity_{frame}")
        q, q_dot = angles[:, columns] * (signs * units), rates[:, columns] * signs
        omega[:, places] = kernel(q, q_dot) * factors
    return omega
