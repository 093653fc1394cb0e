"""Readings: what three angle columns, a matrix or quaternion, and an angular velocity may mean.

This file imports no NumPy. It defines a reading, says which readings are the same function of the
data, and lists the different ones.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cache
from itertools import permutations, product
from math import pi
from typing import Literal

from rigidsym.system.records import Record

Three = tuple[int, ...]  # three of them
Frame = Literal["space", "body"]

SEQUENCES = tuple("".join(axes) for axes in product("XYZ", repeat=3) if axes[1] not in axes[::2])
ANGLE_NAMES = ("a1", "a2", "a3")
_OTHER: dict[Frame, Frame] = {"space": "body", "body": "space"}
_FACTORS = {"": 1.0, "rates in deg/s, Ω in rad/s": pi / 180, "rates in rad/s, Ω in deg/s": 180 / pi}


class Velocity(Record, kw_only=True):
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

    def of_the_inverse(self) -> Velocity:
        """The same numbers, as the velocity of Rᵀ: its Ω is −Ω′ of R, and its Ω′ is −Ω."""
        return replace(self, frame=_OTHER[self.frame], is_opposite=not self.is_opposite)


VELOCITIES = tuple(
    Velocity(frame=frame, is_opposite=is_opposite, units=units)
    for units, is_opposite, frame in product(_FACTORS, (False, True), _OTHER)
)


class Reading(Record, kw_only=True):
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
    def unit(self) -> str:
        return "degrees" if self.degrees else "radians"

    @property
    def factor(self) -> float:
        """Radians of one unit of the angles."""
        return pi / 180 if self.degrees else 1.0

    @property
    def taken(self) -> str:
        """How Python takes the turns from the columns: "[..., [2, 1, 0]] * [1, -1, 1]"."""
        columns = f"[..., {[*self.columns]}]" if self.columns != (0, 1, 2) else ""
        return columns + (f" * {[*self.signs]}" if -1 in self.signs else "")

    def disagreeing(self, stated: Mapping[str, str]) -> set[str]:
        """The parts in other units than these; of rates and Ω, only the quotient is known."""
        rates, omega = (stated.get(part, "") for part in ("rates", "omega"))
        units = f"rates in {rates}, Ω in {omega}" if rates != omega else ""
        agree = not (self.velocity and rates and omega) or self.velocity.units == units
        parts = set() if agree else {"rates", "omega"}
        return parts if self.unit.startswith(stated.get("angles", "")) else {"angles", *parts}

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
        return self if self.sequence.isupper() else self.in_other_manner()

    def aliases(self) -> tuple[Reading, ...]:
        """The other readings that are this function of the data, the plainest first."""
        other = self.in_other_direction()
        aliases = (self.in_other_manner(), other, other.in_other_manner())
        return tuple(sorted(aliases, key=Reading.plainness))

    def plainness(self) -> tuple[object, ...]:
        """Sorts readings: few signs flipped, columns as given, active, intrinsic, radians."""
        velocity = self.velocity
        return (
            self.signs.count(-1) + (velocity is not None and velocity.is_opposite),
            sum(column != place for place, column in enumerate(self.columns)),
            self.passive,
            self.sequence.islower(),
            bool(self.scalar_last),
            self.degrees,
            velocity.units if velocity else "",
            self.sequence,
            self.signs,
        )

    def words(self, names: Sequence[str] = ANGLE_NAMES, *, is_brief: bool = False) -> str:
        """ "ZYX intrinsic, passive, degrees, columns (yaw, −pitch, roll), scalar first"

        If brief, only the parts in which it differs from its aliases.
        """
        scalar = {None: "", True: "scalar last", False: "scalar first"}[self.scalar_last]
        parts = [
            f"{self.sequence} {'extrinsic' if self.sequence.islower() else 'intrinsic'}",
            "passive" if self.passive else "active",
            "" if is_brief else self.unit,
            f"columns ({', '.join(self._angles(names))})",
            "" if is_brief else scalar,
            self.velocity.of_what if self.velocity else "",
            self.velocity.units if self.velocity and not is_brief else "",
        ]
        return ", ".join(filter(None, parts))

    def product(self, names: Sequence[str] = ANGLE_NAMES) -> str:
        """ "Rz(yaw) Ry(pitch) Rx(roll)", or its transpose if the reading is passive."""
        turns = self.intrinsic()
        pairs = zip(turns.sequence.lower(), turns._angles(names), strict=True)
        text = " ".join(f"R{axis}({angle})" for axis, angle in pairs)
        return f"({text})ᵀ" if self.passive else text

    def _angles(self, names: Sequence[str]) -> list[str]:
        pairs = zip(self.columns, self.signs, strict=True)
        return [("−" if sign < 0 else "") + names[column] for column, sign in pairs]


@cache
def distinct(layouts: tuple[bool | None, ...]) -> tuple[Reading, ...]:
    """The readings that differ as functions of the data, each active and intrinsic.

    Of the 12 · 2 · 2 · 6 · 8 · 2 = 4608 combinations of sequence, manner, direction, order,
    signs and unit, each function of the angles is four, of which one is active and intrinsic; 1152
    are left for every entry of `layouts` (None: a matrix; whether the scalar of a quaternion is
    last).
    """
    signs = [*product((1, -1), repeat=3)]
    ways = product(SEQUENCES, permutations(range(3)), signs, (False, True), layouts)
    return tuple(
        Reading(sequence=axes, columns=columns, signs=flips, degrees=degrees, scalar_last=layout)
        for axes, columns, flips, degrees, layout in ways
    )
