"""Names of the entries of a vector or matrix: Ω′₁, R₂₃, Ṙ₂₃, (W⁻¹)₁₂."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from rigidsym.formula.reader import formula
from rigidsym.formula.tree import (
    COMMA,
    Bracket,
    Formula,
    Indexed,
    Numeral,
    Rate,
    Row,
    Sign,
    Symbol,
    row,
)

RESIDUAL = formula(r"\boldsymbol{\Delta}")  # what is left over of a claim


def indexed(symbol: Formula, shape: tuple[int, ...]) -> tuple[Formula, ...]:
    """The symbol with the index of each entry, in light face; (a₁, a₂, a₃) lists its own."""
    if isinstance(symbol, Bracket) and isinstance(symbol.inside, Row):
        return tuple(part for part in symbol.inside.parts if not isinstance(part, Sign))
    return tuple(_indexed(symbol, index) for index in _indices(shape))


def _indices(shape: tuple[int, ...]) -> Iterator[str]:
    if len(shape) == 1:
        return (str(row + 1) for row in range(shape[0]))
    rows, columns = shape
    return (f"{row + 1}{column + 1}" for row in range(rows) for column in range(columns))


def _indexed(symbol: Formula, index: str) -> Formula:
    """R₂₃, or L_R,1 where the symbol has an index of its own; brackets around what is compound."""
    number = Numeral(index)
    if isinstance(symbol, Rate) and isinstance(symbol.of, Symbol):
        symbol = replace(symbol.of, dots=symbol.order)
    if not isinstance(symbol, Symbol):
        return Indexed(Bracket(_light(symbol)), number)
    own = symbol.index
    return replace(symbol, face="italic", index=number if own is None else row(own, COMMA, number))


def _light(symbol: Formula) -> Formula:
    """The symbol without bold face."""
    if isinstance(symbol, Symbol):
        return replace(symbol, face="italic")
    if isinstance(symbol, Row):
        return Row(tuple(map(_light, symbol.parts)))
    changed = {
        name: _light(part)
        for name in ("base", "of", "inside")
        if isinstance(part := getattr(symbol, name, None), Formula)
    }
    return replace(symbol, **changed) if changed else symbol
