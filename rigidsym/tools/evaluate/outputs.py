"""What the columns of a result are called, and their units."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from rigidsym.data.chunk import Table
from rigidsym.mechanics.derivation import Derivation, Step
from rigidsym.tools.evaluate.inputs import is_angle


@dataclass(frozen=True, slots=True)
class Column:
    """One column of a result."""

    name: str
    unit: str
    in_degrees: bool

    def __str__(self) -> str:
        unit = self.unit.replace("rad", "deg", 1) if self.in_degrees else self.unit
        return f"{self.name} [{unit}]" if unit else self.name


def columns_of(
    derivation: Derivation, quantities: Sequence[str], *, degrees: bool
) -> tuple[Column, ...]:
    """The columns of some quantities, one after the other, entries row by row."""
    return tuple(
        Column(name, unit, degrees and is_angle(unit))
        for quantity in quantities
        for name, unit in _named(derivation, derivation.step(quantity))
    )


def _named(derivation: Derivation, step: Step) -> list[tuple[str, str]]:
    quantity = step.quantity
    if quantity.name.startswith("rates_from"):
        rates = derivation.argument("q_dot")
        return list(zip(rates.names, rates.units, strict=True))
    if not step.shape:
        return [(quantity.name, quantity.unit)]
    indices = product(*(range(1, size + 1) for size in step.shape))
    return [(f"{quantity.name}_{''.join(map(str, index))}", quantity.unit) for index in indices]


def in_units(columns: Sequence[Column], table: Table) -> Table:
    """Results in the units of their columns."""
    if not any(column.in_degrees for column in columns):
        return table
    degree = np.array([180 / np.pi if column.in_degrees else 1 for column in columns])
    scaled: Table = table * degree.astype(table.dtype)
    return scaled
