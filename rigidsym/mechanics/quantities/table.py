"""How the tables of quantities are read: a quantity is two lines of text and its formulas."""

from __future__ import annotations

import re
from collections.abc import Mapping
from types import MappingProxyType
from typing import cast

from rigidsym.formula.tree import NOTHING, Formula
from rigidsym.mechanics.derivation import Quantity, Shape
from rigidsym.models.rotation import book

Formulas = Mapping[str, tuple[Formula, ...]]  # name: symbol and, if there is one, definition
_COLUMNS = re.compile(r" {2,}")


def read_table(text: str, formulas: Formulas) -> Mapping[str, Quantity]:
    """The quantities of a table, by name, in its order.

    Two or more spaces separate the columns: name, shape, SI unit, inputs, source; a dash leaves
    one empty. The words of the quantity fill the next line. A source is a place in a book:
    "Landau 32 (32.12)".
    """
    lines = [line.strip() for line in text.strip().splitlines()]
    return MappingProxyType(
        {
            quantity.name: quantity
            for head, about in zip(lines[::2], lines[1::2], strict=True)
            for quantity in (_read(head, about, formulas),)
        }
    )


def _read(head: str, about: str, formulas: Formulas) -> Quantity:
    name, shape, unit, inputs, source = (
        "" if column == "-" else column for column in _COLUMNS.split(head)
    )
    symbol, *definition = formulas[name]
    return Quantity(
        name=name,
        symbol=symbol,
        about=about,
        unit=unit,
        inputs=tuple(inputs.split()),
        shape=cast(Shape, shape),
        definition=definition[0] if definition else NOTHING,
        source=book(source) if source else None,
    )
