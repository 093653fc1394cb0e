"""Readings in numbers: unit quaternions (w, x, y, z), and angular velocities.

A turning frame is a pair (q, Ω). Turning on about a body axis e by the angle a gives the pair
(q · q_e(a), Ω + ȧ q e q*); three such steps are a reading.
"""

from __future__ import annotations

from collections.abc import Sequence

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
        velocities = [turn.velocity for turn in turns]
        self._factors = np.array([v.factor if v else 1.0 for v in velocities])
        self._is_in_body = np.array([v is not None and v.frame == "body" for v in velocities])

    def residuals(self, angles: Array, orientation: Array) -> Array:
        """Angles between each reading and the data, in radians: (n, readings).

        `orientation` (n, 4) is the quaternion of the data with its numbers in their own order.
        """
        data = np.repeat(orientation.T[..., None], len(self.readings), axis=2)
        data[..., self._scalar_last] = np.roll(data[..., self._scalar_last], 1, axis=0)
        return angle_between(self._turned(angles)[0], data, axis=0)

    def angular_velocities(self, angles: Array, rates: Array) -> Array:
        """Ω as the data have it under each reading, which has a velocity: (3, n, readings).

        `angles` and `rates` (n, 3) are columns of the data.
        """
        q, omega = self._turned(angles, rates)
        # With the vector v of q, q* Ω q = Ω − 2 w v × Ω + 2 v × (v × Ω).
        across = np.cross(q[1:], omega, axis=0)
        in_body = omega - 2 * q[0] * across + 2 * np.cross(q[1:], across, axis=0)  # q* Ω q
        return np.where(self._is_in_body, in_body, omega) * self._factors

    def _turned(self, angles: Array, rates: Array | None = None) -> tuple[Array, Array]:
        """The quaternions (4, n, readings) for rows of angles (n, 3), and Ω for their rates."""
        # Sine and cosine are taken once for each column and unit, for all readings.
        half = angles[:, :, None] * (np.array([1.0, RADIANS_PER_DEGREE]) / 2)
        cosines, sines = np.cos(half), np.sin(half)
        q = np.empty((4, len(angles), len(self.readings)))
        omega = np.zeros((3, *q.shape[1:]))
        for sequence, places in self._sequences.items():
            turn: Array = np.zeros((4, len(angles), len(places)))
            turn[0] = 1.0
            for axis, columns, signs in zip(
                map(_AXES.index, sequence),
                self._columns[:, places],
                self._signs[:, places],
                strict=True,
            ):
                if rates is not None:
                    # Ω grows by ȧ q e q*, with q before this turn: its axis e has been moved by the
                    # turns before it.
                    omega[..., places] += _image(axis, turn) * (rates[:, columns] * signs)
                which = (slice(None), columns, self._units[places])
                turn = _then_about(axis, turn, cosines[which], sines[which] * signs)
            q[..., places] = turn
        return q, omega


def _then_about(axis: int, turn: Array, cosine: Array, sine: Array) -> Array:
    """The quaternion product of a turn (4, ...) and one about an axis, from half its angle."""
    # With p = cos(a/2) + e sin(a/2), q p = (w c − v·e s, v c + w s e + s v × e).
    along, first, second = (1 + (axis + k) % 3 for k in range(3))
    product = turn * cosine
    product[0] -= turn[along] * sine
    product[along] += turn[0] * sine
    product[first] += turn[second] * sine
    product[second] -= turn[first] * sine
    return product


def _image(axis: int, turn: Array) -> Array:
    """Where a turn (4, ...) takes an axis: q e q* = (2 w² − 1) e + 2 (v·e) v + 2 w v × e."""
    first, second = ((axis + k) % 3 for k in (1, 2))
    scalar, vector = turn[0], turn[1:]
    image = 2 * vector[axis] * vector
    image[axis] += 2 * scalar**2 - 1
    image[first] += 2 * scalar * vector[second]
    image[second] -= 2 * scalar * vector[first]
    return np.asarray(image)


def angle_between(p: Array, q: Array, axis: int = -1) -> Array:
    """The angle in radians, 0 to π, of the turn from one rotation to the other; q and −q are one.

    Taken from the chord, so that angles far below the square root of eps are still right.
    """
    # |p − q| = 2 sin(α/4) for the angle α between the rotations. arccos of p·q would lose half of
    # the digits near α = 0.
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
    # The longest column is the one of the largest diagonal entry 4 q_k² of 4 q qᵀ.
    projector = k + np.eye(4)
    longest = np.argmax(np.diagonal(projector, axis1=-2, axis2=-1), axis=-1)
    q = np.take_along_axis(projector, longest[..., None, None], axis=-1)
    for _ in range(2):
        q = projector @ q
    return np.asarray(q[..., 0] / np.linalg.norm(q[..., 0], axis=-1, keepdims=True))
