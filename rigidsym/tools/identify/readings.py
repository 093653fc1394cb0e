"""Readings: what three angle columns, a matrix or quaternion, and an angular velocity may mean.

This file imports no NumPy. It defines a reading, says which readings are the same function of the
data, and lists the different ones.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import product
from math import pi
from typing import Literal

Three = tuple[int, int, int]
Frame = Literal["space", "body"]

SEQUENCES = tuple(
    first + second + third
    for first, second, third in product("XYZ", repeat=3)
    if first != second != third
)
ANGLE_NAMES = ("a1", "a2", "a3")
RADIANS_PER_DEGREE = pi / 180

# Of two column orders that are each other's reverse, the one that moves fewer columns.
_PLAIN_COLUMNS: tuple[Three, ...] = ((0, 1, 2), (0, 2, 1), (1, 0, 2))
# Of two patterns of signs that are each other's opposite, the one with fewer flips.
_PLAIN_SIGNS: tuple[Three, ...] = ((1, 1, 1), (-1, 1, 1), (1, -1, 1), (1, 1, -1))
_OTHER: dict[Frame, Frame] = {"space": "body", "body": "space"}
_FACTORS = {
    "": 1.0,
    "rates in deg/s, Ω in rad/s": pi / 180,
    "rates in rad/s, Ω in deg/s": 180 / pi,
}


@dataclass(frozen=True, kw_only=True, slots=True)
class Velocity:
    """One convention for three components of the angular velocity of R."""

    frame: Frame  # of the components
    is_opposite: bool = False  # −Ω: the velocity of the space axes as seen from the body
    units: str = ""  # in words, if rates and Ω differ in their unit

    @property
    def factor(self) -> float:
        """Ω = factor · W q̇, with the sign and the units of this reading."""
        return -_FACTORS[self.units] if self.is_opposite else _FACTORS[self.units]

    @property
    def of_what(self) -> str:
        """ "Ω in body components" """
        return f"{'−Ω' if self.is_opposite else 'Ω'} in {self.frame} components"

    @property
    def words(self) -> str:
        return f"{self.of_what}, {self.units}" if self.units else self.of_what

    def of_the_inverse(self) -> Velocity:
        """The same numbers, as the velocity of Rᵀ: its Ω is −Ω′ of R, and its Ω′ is −Ω."""
        return replace(self, frame=_OTHER[self.frame], is_opposite=not self.is_opposite)


VELOCITIES = tuple(
    Velocity(frame=frame, is_opposite=is_opposite, units=units)
    for units in _FACTORS
    for is_opposite in (False, True)
    for frame in _OTHER
)


@dataclass(frozen=True, kw_only=True, slots=True)
class Reading:
    """One convention: from three angle columns to a matrix or a quaternion.

    Turn k is about the axis `sequence[k]`, by the angle `signs[k]` · column `columns[k]`; upper
    case turns about the turning axes (intrinsic), lower case about the fixed ones (extrinsic).
    The product R of the turns takes body to space components. The matrix of the data is R, or Rᵀ
    if the reading is passive; the quaternion is that of R, or its conjugate.
    """

    sequence: str  # ZYX, zyx
    columns: Three = (0, 1, 2)  # counted from 0, in the order of the turns
    signs: Three = (1, 1, 1)  # in the order of the turns
    passive: bool = False
    degrees: bool = False
    scalar_last: bool | None = None  # None: a matrix
    velocity: Velocity | None = None

    @property
    def is_intrinsic(self) -> bool:
        return self.sequence.isupper()

    @property
    def unit(self) -> str:
        return "degrees" if self.degrees else "radians"

    @property
    def scalar_words(self) -> str:
        """The position of the scalar of a quaternion; empty for a matrix."""
        if self.scalar_last is None:
            return ""
        return "scalar last" if self.scalar_last else "scalar first"

    @property
    def factor(self) -> float:
        """Radians of one unit of the angles."""
        return RADIANS_PER_DEGREE if self.degrees else 1.0

    @property
    def is_plain(self) -> bool:
        """Whether the columns are the angles of the turns as they are."""
        return not (self.flips or _displaced(self.columns))

    @property
    def taken(self) -> str:
        """How Python takes the turns from the columns: "[..., [2, 1, 0]] * [1, -1, 1]"."""
        columns = f"[..., {[*self.columns]}]" if _displaced(self.columns) else ""
        return columns + (f" * {[*self.signs]}" if self.flips else "")

    @property
    def flips(self) -> int:
        return self.signs.count(-1)

    @property
    def orientation(self) -> Reading:
        """The reading without Ω."""
        return self if self.velocity is None else replace(self, velocity=None)

    def in_other_manner(self) -> Reading:
        """The same R with the other kind of axes: intrinsic ZYX is extrinsic xyz, reversed."""
        return replace(
            self,
            sequence=self.sequence[::-1].swapcase(),
            columns=self.columns[::-1],
            signs=self.signs[::-1],
        )

    def in_other_direction(self) -> Reading:
        """The same data from Rᵀ, which has the turns of R reversed, by the opposite angles."""
        first, second, third = self.signs
        return replace(
            self,
            sequence=self.sequence[::-1],
            columns=self.columns[::-1],
            signs=(-third, -second, -first),
            passive=not self.passive,
            velocity=self.velocity and self.velocity.of_the_inverse(),
        )

    def intrinsic(self) -> Reading:
        """The same R by turns about the turning axes, in the order of multiplication."""
        return self if self.is_intrinsic else self.in_other_manner()

    def active(self) -> Reading:
        """The same data, read without transposing."""
        return self.in_other_direction() if self.passive else self

    def aliases(self) -> tuple[Reading, ...]:
        """The other readings that are this function of the data, the plainest first."""
        other = self.in_other_direction()
        aliases = (self.in_other_manner(), other, other.in_other_manner())
        return tuple(sorted(aliases, key=Reading.plainness))

    def plainness(self) -> tuple[object, ...]:
        """Sorts readings: few signs flipped, columns as given, active, intrinsic, radians."""
        opposite = self.velocity is not None and self.velocity.is_opposite
        return (
            self.flips + opposite,
            _displaced(self.columns),
            self.passive,
            not self.is_intrinsic,
            bool(self.scalar_last),
            self.degrees,
            self.velocity.units if self.velocity else "",
            self.sequence,
            self.signs,
        )

    def words(self, names: Sequence[str] = ANGLE_NAMES) -> str:
        """ "ZYX intrinsic, passive, degrees, columns (yaw, −pitch, roll), scalar first" """
        turns, direction, columns = self._parts(names)
        parts = [turns, direction, self.unit, columns, self.scalar_words]
        parts += [self.velocity.words] if self.velocity else []
        return ", ".join(filter(None, parts))

    def brief(self, names: Sequence[str] = ANGLE_NAMES) -> str:
        """The parts in which it differs from its aliases."""
        velocity = [self.velocity.of_what] if self.velocity else []
        return ", ".join([*self._parts(names), *velocity])

    def _parts(self, names: Sequence[str]) -> tuple[str, str, str]:
        return (
            f"{self.sequence} {'intrinsic' if self.is_intrinsic else 'extrinsic'}",
            "passive" if self.passive else "active",
            f"columns ({', '.join(self._angles(names))})",
        )

    def product(self, names: Sequence[str] = ANGLE_NAMES) -> str:
        """ "Rz(yaw) Ry(pitch) Rx(roll)", or its transpose if the reading is passive."""
        turns = self.intrinsic()
        angles = turns._angles(names)
        text = " ".join(
            f"R{axis}({angle})" for axis, angle in zip(turns.sequence.lower(), angles, strict=True)
        )
        return f"({text})ᵀ" if self.passive else text

    def _angles(self, names: Sequence[str]) -> list[str]:
        return [
            ("−" if sign < 0 else "") + names[column]
            for column, sign in zip(self.columns, self.signs, strict=True)
        ]


def _displaced(columns: Three) -> int:
    return sum(column != place for place, column in enumerate(columns))


def distinct(layouts: Sequence[bool | None]) -> Iterator[Reading]:
    """The readings that differ as functions of the angles, each in its plainest words.

    Of the 12 · 2 · 2 · 6 · 8 · 2 = 4608 combinations of sequence, manner, direction, order,
    signs and unit, each function of the angles is four; 1152 are left for every entry of
    `layouts` (None: a matrix; whether the scalar of a quaternion stands last).
    """
    # The other manner reverses the columns and the signs; the other manner and direction together
    # make all signs opposite and leave the columns. One order of each reversed pair and one pattern
    # of each opposite pair of signs are therefore one reading of each four.
    for sequence, columns, signs, extrinsic, passive, degrees, scalar_last in product(
        SEQUENCES,
        _PLAIN_COLUMNS,
        _PLAIN_SIGNS,
        (False, True),
        (False, True),
        (False, True),
        layouts,
    ):
        yield Reading(
            sequence=sequence.lower() if extrinsic else sequence,
            columns=columns,
            signs=signs,
            passive=passive,
            degrees=degrees,
            scalar_last=scalar_last,
        )
