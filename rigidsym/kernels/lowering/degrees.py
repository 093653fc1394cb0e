"""Angles in degrees: what is scaled, and by which power of 180/π.

Angles, angular velocities and rates, and angular accelerations are in degrees as arguments and as
results; everything else stays in SI units. So Ω = W q̇ still holds, and a derivative with respect
to an angle is per degree.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from math import pi

import sympy as sp

from rigidsym.mechanics.derivation import Argument, Step

DEGREE, RADIAN = sp.Dummy("degree"), sp.Dummy("radian")
FACTORS = {DEGREE: pi / 180, RADIAN: 180 / pi}  # in radians, in degrees

SUFFIX = "_deg"  # of the names of modules and of components

ABOUT = (
    "Angles are in degrees, angular velocities and rates of angles in deg/s, angular "
    "accelerations in deg/s^2, both as arguments and as results, and derivatives with respect to "
    "an angle are per degree. Constants in `parameters`, energies, momenta, and the formulas and "
    "ranges in this text are in SI units, with angles in radians."
)

# Quantities whose entries differ in their units: the arguments that have the units of rows and
# columns; an entry is a row's over a column's.
_OF_ENTRIES = {
    "rate_matrix": ("omega_body", "q_dot"),
    "inverse_rate_matrix": ("q_dot", "omega_body"),
    "rates_from_angular_velocity": ("q_dot",),
    "accelerations": ("q",),
    "state_derivative": ("y",),
    "state_jacobian": ("y", "y"),
}


def is_angle(unit: str) -> bool:
    """Whether a unit holds radians: rad, rad/s, rad/s^2."""
    return unit.split("/")[0] == "rad"


def powers_in(unit: str, count: int) -> list[int]:
    """Of the angle in a unit of so many entries: "rad/s", "(, , , rad)"."""
    powers = [int(is_angle(each)) for each in unit.strip("()").split(", ")]
    return powers if len(powers) == count else powers * count


def powers_of(step: Step, arguments: Mapping[str, Argument]) -> list[int]:
    """Of the angle in the unit of each entry of a quantity."""
    quantity = step.quantity
    name = quantity.name.removesuffix("_space").removesuffix("_body")
    if name not in _OF_ENTRIES:
        return powers_in(quantity.unit, len(step.expression))
    rows, *columns = ([int(is_angle(u)) for u in arguments[v].units] for v in _OF_ENTRIES[name])
    return [row - column for row in rows for column in (columns[0] if columns else [0])]


def in_degrees(entries: Iterable[sp.Expr], powers: Sequence[int]) -> list[sp.Expr]:
    """Results in degrees from results in radians."""
    return [
        entry * (RADIAN**power if power > 0 else DEGREE**-power)
        for entry, power in zip(entries, powers, strict=True)
    ]
