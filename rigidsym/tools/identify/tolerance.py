"""How far data may be from a reading: as far as the rounding of printed numbers explains.

A matrix whose entries are each off by at most r is off by a rotation of at most 3 r, a quaternion
by 4 r, and angles by the sum of their roundings; these are bounds, not estimates.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import pi, sqrt

import numpy as np

from rigidsym.tools.identify.samples import SampleBlock, SampleError
from rigidsym.tools.identify.turns import Array

FLOOR = 1e-6  # the least tolerance, since data may have been in single precision
_EXACT = 1e-9  # a matrix this close to orthogonal was not rounded
_MOST_FOR_ANGLES = 0.05  # radians; angles as coarse as that are taken to be exact


@dataclass(frozen=True, kw_only=True, slots=True)
class Tolerance:
    """Radians for orientations, by the unit of the angles; a share of the largest |Ω| for Ω."""

    radians: float  # if a reading takes the angles to be radians
    degrees: float  # if it takes them to be degrees; in radians too
    velocity: float
    because: str  # in words

    @property
    def orientation(self) -> float:
        return max(self.radians, self.degrees)

    def of(self, in_degrees: np.ndarray) -> Array:
        return np.where(in_degrees, self.degrees, self.radians)


def tolerances(
    asked: float | None, block: SampleBlock, coarseness: float, scale: float
) -> Iterator[Tolerance]:
    """Tolerances to try, one after the other, until a reading fits.

    If the user asks for none, first the angles are taken to be exact, then to be rounded as
    they are printed. `scale` is the largest |Ω|.
    """
    if asked is not None:
        yield Tolerance(radians=asked, degrees=asked, velocity=asked, because="as asked")
        return
    floor = max(FLOOR, coarseness)
    attitude = max(floor, _attitude(block))
    velocity = floor
    if block.omega is not None and scale:
        velocity = max(floor, sqrt(3) * _largest(rounding_of(block.omega)) / scale)
    yield Tolerance(
        radians=attitude,
        degrees=attitude,
        velocity=velocity,
        because="from the digits of the data"
        if max(attitude, velocity) > FLOOR
        else "for exact data",
    )
    rounding = 3 * _largest(rounding_of(block.angles))
    slow = 0.0 if block.rates is None else 3 * _largest(rounding_of(block.rates))
    in_radians, in_degrees = (
        attitude + extra if extra <= _MOST_FOR_ANGLES else attitude
        for extra in (rounding, rounding * pi / 180)
    )
    if max(in_radians, in_degrees) > attitude:
        more = max(in_radians, in_degrees) - attitude
        yield Tolerance(
            radians=in_radians,
            degrees=in_degrees,
            velocity=velocity + more + min(slow / scale if scale else 0.0, _MOST_FOR_ANGLES),
            because="from the digits of the data and of the angles",
        )


def check_tolerance(asked: float | None) -> None:
    """Raises SampleError for a tolerance that is not between 0 and π."""
    if asked is not None and not 0 < asked < pi:
        raise SampleError([f"the tolerance is an angle between 0 and π radians, got {asked:g}"])


def _attitude(block: SampleBlock) -> float:
    """The largest rotation by which rounding has moved one of the matrices or quaternions."""
    defects = block.defects()
    rounding = np.where(
        defects <= _EXACT, 0.0, np.maximum(rounding_of(block.attitude), defects / 2)
    )
    return (3 if block.is_matrix else 4) * _largest(rounding)


def _largest(rounding: Array) -> float:
    return float(rounding.max(initial=0.0))


def rounding_of(rows: Array) -> Array:
    """Half a unit in the last place of the numbers of each row, as they print; 0 for integers."""
    return np.array([_rounding(row) for row in rows.tolist()])


def _rounding(row: list[float]) -> float:
    """By the numbers of the largest size: with %.4g, small ones have more decimal places."""
    least = max(map(abs, row)) / 10
    places = max(_places(number) for number in row if abs(number) >= least)
    if places <= 0:  # such as the ones of a turn about one axis
        places = max(map(_places, row))
    return 0.5 * 10.0**-places if places > 0 else 0.0


def _places(number: float) -> int:
    """Decimal places of a number as Python prints it: 1.25e-05 has 7, 3.0 has none."""
    digits, _, exponent = repr(number).partition("e")
    fraction = digits.partition(".")[2].rstrip("0")
    return len(fraction) - int(exponent or 0) if fraction or exponent else 0
