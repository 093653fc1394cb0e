"""How the tables of quantities are read: a quantity is two lines of text and its formulas."""

from __future__ import annotations

import re
from collections.abc import Mapping
from types import MappingProxyType
from typing import cast

from rigidsym.formula.tree import NOTHING, Formula
from rigidsym.mechanics.derivation import Quantity, Shape
from rigidsym.models.rotation import SOURCES

Formulas = Mapping[str, tuple[Formula, ...]]  # name: symbol and, if there is one, definition
_COLUMNS = re.compile(r" {2,}")


def read_table(text: str, formulas: Formulas) -> Mapping[str, Quantity]:
    """The quantities of a table, by name, in its order.

    Two or more spaces separate the columns: name, shape, SI unit, inputs, source; a dash leaves
    one empty. The words of the quantity fill the next line. A source is a place in a book:
    "Landau 32 (32.12)".
    """
    lines = [line.strip() for line in text.strip().splitlines()]
    found: dict[str, Quantity] = {}
    for head, about in zip(lines[::2], lines[1::2], strict=True):
        name, shape, unit, inputs, source = _COLUMNS.split(head)
        symbol, *definition = formulas[name]
        found[name] = Quantity(
            name=name,
            symbol=symbol,
            about=about,
            unit=unit.strip("-"),
            inputs=tuple(inputs.strip("-").split()),
            shape=cast(Shape, shape),
            definition=definition[0] if definition else NOTHING,
            source=None if source == "-" else SOURCES[source],
        )
    return MappingProxyType(found)
