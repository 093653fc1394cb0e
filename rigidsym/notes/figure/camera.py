"""Vectors (3,), frames (3, 3) with an axis a row, and the camera that projects onto the page."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import cos, radians, sin
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[Any]
Point = tuple[float, float]

STANDARD = np.eye(3)


def unit(a: Vector) -> Vector:
    return a / np.linalg.norm(a)


def turned(a: Vector, axis: Vector, angle: float) -> Vector:
    """The vector rotated right-handedly about a unit axis, by an angle in radians (Rodrigues)."""
    along = (1 - cos(angle)) * (axis @ a)
    return cos(angle) * a + sin(angle) * np.cross(axis, a) + along * axis


def frames(axes: Sequence[Vector], angles: Sequence[float]) -> Iterator[Vector]:
    """The frame of space, and the frame after each turn; axes have components before the turn."""
    frame = STANDARD
    yield frame
    for axis, angle in zip(axes, angles, strict=True):
        frame = np.array([turned(a, axis @ frame, angle) for a in frame])
        yield frame


def is_same(a: Vector, b: Vector) -> bool:
    return bool(np.abs(a - b).max() < 1e-6)


class Camera(NamedTuple):
    """Parallel projection; the third axis of space is vertical in the picture, up or down."""

    right: Vector
    up: Vector
    toward: Vector  # from the origin to the viewer

    def project(self, a: Vector) -> Point:
        return (float(self.right @ a), float(self.up @ a))

    def nearer(self, times: float) -> Camera:
        """The camera that shows everything so many times as large."""
        return self._replace(right=times * self.right, up=times * self.up)

    def depth(self, a: Vector) -> float:
        """Distance from the picture plane toward the viewer; negative behind the origin."""
        return float(self.toward @ a)


def camera(azimuth: float, elevation: float, *, z_down: bool = False) -> Camera:
    """The camera of a viewer at this azimuth and elevation, in degrees.

    Where z points down, the viewer is above the ground all the same, at a negative z.
    """
    a, e, up = radians(azimuth), radians(elevation), -1 if z_down else 1
    toward = np.array([cos(e) * cos(a), cos(e) * sin(a), up * sin(e)])
    right = np.array([-up * sin(a), up * cos(a), 0.0])
    return Camera(right, np.cross(toward, right), toward)
