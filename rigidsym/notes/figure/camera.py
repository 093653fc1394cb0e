"""Vectors in space and the camera that looks at them, in plain floats."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import cos, hypot, radians, sin

Vector = tuple[float, float, float]
Point = tuple[float, float]
Frame = tuple[Vector, Vector, Vector]  # its axes

STANDARD: Frame = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


def dot(a: Vector, b: Vector) -> float:
    return sum(p * q for p, q in zip(a, b, strict=True))


def cross(a: Vector, b: Vector) -> Vector:
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def scaled(factor: float, a: Vector) -> Vector:
    return (factor * a[0], factor * a[1], factor * a[2])


def combined(coefficients: Sequence[float], vectors: Sequence[Vector]) -> Vector:
    """The sum of the vectors with these coefficients."""
    x, y, z = (
        sum(c * v[part] for c, v in zip(coefficients, vectors, strict=True)) for part in range(3)
    )
    return (x, y, z)


def unit(a: Vector) -> Vector:
    return scaled(1 / hypot(*a), a)


def turned(a: Vector, axis: Vector, angle: float) -> Vector:
    """Right-handed turn about a unit axis, by an angle in radians (Rodrigues)."""
    along = (1 - cos(angle)) * dot(axis, a)
    return combined((cos(angle), sin(angle), along), (a, cross(axis, a), axis))


def sweep(a: Vector, axis: Vector, angle: float, steps: int) -> Iterator[Vector]:
    """Where a vector passes on such a turn, both ends among it."""
    return (turned(a, axis, angle * step / steps) for step in range(steps + 1))


def is_same(a: Vector, b: Vector) -> bool:
    return max(abs(p - q) for p, q in zip(a, b, strict=True)) < 1e-6


@dataclass(frozen=True, slots=True)
class Camera:
    """Parallel projection; the third axis of space is upright in the picture."""

    right: Vector
    up: Vector
    toward: Vector  # the viewer

    def project(self, a: Vector) -> Point:
        return (dot(self.right, a), dot(self.up, a))

    def depth(self, a: Vector) -> float:
        """How far a point stands toward the viewer; negative behind the origin."""
        return dot(self.toward, a)


def camera(azimuth: float, elevation: float) -> Camera:
    """The camera of a viewer in this direction, in degrees; above the plane if positive."""
    a, e = radians(azimuth), radians(elevation)
    toward = (cos(e) * cos(a), cos(e) * sin(a), sin(e))
    right = (-sin(a), cos(a), 0.0)
    return Camera(right, cross(toward, right), toward)
