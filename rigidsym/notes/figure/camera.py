"""Vectors in plain floats, and the camera that projects them onto the page.

Plain floats, since a figure has a dozen vectors: importing NumPy for them would take longer than
deriving the rotation.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import cos, hypot, radians, sin
from typing import NamedTuple

Vector = tuple[float, float, float]
Point = tuple[float, float]
Frame = tuple[Vector, Vector, Vector]  # three orthonormal axes

STANDARD: Frame = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


def dot(a: Vector, b: Vector) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Vector, b: Vector) -> Vector:
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def combined(factors: Sequence[float], vectors: Sequence[Vector]) -> Vector:
    """The linear combination Σ c_k v_k; of the axes of a frame, a vector from its components."""
    pairs = list(zip(factors, vectors, strict=True))
    x, y, z = (sum(c * v[k] for c, v in pairs) for k in range(3))
    return (x, y, z)


def unit(a: Vector) -> Vector:
    return combined((1 / hypot(*a),), (a,))


def turned(a: Vector, axis: Vector, angle: float) -> Vector:
    """The vector rotated right-handedly about a unit axis, by an angle in radians (Rodrigues)."""
    # a cos α + (n × a) sin α + n (n·a)(1 − cos α)
    along = (1 - cos(angle)) * dot(axis, a)
    return combined((cos(angle), sin(angle), along), (a, cross(axis, a), axis))


def frames(axes: Sequence[Vector], angles: Sequence[float]) -> Iterator[Frame]:
    """The frame of space, and the frame after each turn; axes have components before the turn."""
    frame = STANDARD
    yield frame
    for axis, angle in zip(axes, angles, strict=True):
        about = combined(axis, frame)
        x, y, z = (turned(a, about, angle) for a in frame)
        frame = (x, y, z)
        yield frame


def is_same(a: Vector, b: Vector) -> bool:
    return max(abs(p - q) for p, q in zip(a, b, strict=True)) < 1e-6


class Camera(NamedTuple):
    """Parallel projection; the third axis of space is vertical in the picture, up or down."""

    right: Vector
    up: Vector
    toward: Vector  # from the origin to the viewer

    def project(self, a: Vector) -> Point:
        return (dot(self.right, a), dot(self.up, a))

    def depth(self, a: Vector) -> float:
        """Distance from the picture plane toward the viewer; negative behind the origin."""
        return dot(self.toward, a)


def camera(azimuth: float, elevation: float, *, z_down: bool = False, scale: float = 1.0) -> Camera:
    """The camera of a viewer at this azimuth and elevation, in degrees.

    Where z points down, the viewer is above the ground all the same, at a negative z.
    """
    a, e, up = radians(azimuth), radians(elevation), -1 if z_down else 1
    toward = (cos(e) * cos(a), cos(e) * sin(a), up * sin(e))
    # toward × right has the vertical component ±cos e with the sign of `up`: the side of the ground
    # from which the viewer looks is up in the picture.
    right = (-up * sin(a) * scale, up * cos(a) * scale, 0.0)
    return Camera(right, cross(toward, right), toward)
