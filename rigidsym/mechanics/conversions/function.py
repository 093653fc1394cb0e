"""One conversion as a function of vectors or of a matrix."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import sympy as sp

from rigidsym.formula.tree import Symbol
from rigidsym.mechanics.conversions.values import NamedValues, Vector
from rigidsym.mechanics.derivation import Argument

Line = tuple[sp.Symbol, sp.Expr]


@dataclass(frozen=True, kw_only=True, slots=True)
class ConversionInput:
    """An argument of a conversion."""

    argument: Argument
    is_matrix: bool = False  # (3, 3), its components row by row
    is_optional: bool = False  # zero if left out


@dataclass(frozen=True, kw_only=True, slots=True)
class ConversionFunction:
    """One conversion of a vector, or of a matrix."""

    name: str
    symbol: str  # of the result, in Unicode
    inputs: tuple[ConversionInput, ...]
    shared: tuple[Line, ...] = ()  # values first of all, whose common parts are computed once
    values: tuple[Line, ...]
    outputs: Vector
    about: str
    remarks: tuple[str, ...] = ()  # paragraphs
    unit: str = ""


def argument_of(name: str, components: Sequence[sp.Symbol], about: str) -> Argument:
    names = tuple(symbol.name for symbol in components)
    return Argument(
        name=name,
        symbols=tuple(components),
        names=names,
        notation=tuple(map(Symbol, names)),
        units=("",) * len(names),
        about=about,
    )


def function_of(
    name: str,
    symbol: str,
    inputs: Iterable[ConversionInput],
    values: NamedValues,
    outputs: Sequence[sp.Expr],
    about: str,
    *remarks: str,
    unit: str = "",
) -> ConversionFunction:
    return ConversionFunction(
        name=name,
        symbol=symbol,
        inputs=tuple(inputs),
        values=tuple(values.lines),
        outputs=tuple(outputs),
        about=about,
        remarks=remarks,
        unit=unit,
    )
