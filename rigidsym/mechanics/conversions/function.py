"""A conversion as a function: its arguments, and its values in order, each in those before it.

Where a formula has cases, such as the poles of Euler angles, a value is a `Where`. The order of
the operations is part of a conversion, since its digits depend on it.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import sympy as sp

from rigidsym.formula.tree import Symbol
from rigidsym.mechanics.derivation import Argument, Step

Vector = tuple[sp.Expr, ...]
Line = tuple[sp.Symbol, sp.Expr]

_DIGITS = 30
_ZERO = sp.Float("1e-25")  # a number known to 30 digits is larger or zero


class ConversionInput(NamedTuple):
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


class Continuity(NamedTuple):
    """How coordinates are made continuous; only turns need functions."""

    kind: str
    inputs: tuple[str, ...]  # names of arguments
    remarks: tuple[str, ...]
    # From the coordinates to the angles and what relates two sets of them, and back.
    turns: ConversionFunction | None = None
    coordinates: ConversionFunction | None = None


class Converted(NamedTuple):
    """What a module offers of conversions."""

    steps: tuple[Step, ...] = ()  # in closed form, like other quantities
    functions: tuple[ConversionFunction, ...] = ()
    continuity: Continuity | None = None
    remarks: tuple[str, ...] = ()  # for the head of the module


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


class Where(sp.Function):
    """Where(condition, a, b): a where the comparison holds, else b."""

    nargs = 3

    @classmethod
    def eval(cls, condition: sp.Basic, then: sp.Expr, otherwise: sp.Expr) -> sp.Expr | None:
        if condition in (sp.true, sp.false):
            return then if condition == sp.true else otherwise
        return then if then == otherwise else None


class Epsilon(sp.Function):
    """The distance from one to the next float, in the type of the argument."""

    nargs = 1


class NamedValues:
    """The named values of one function, in order.

    `given` is one of its inputs, for its type.
    """

    def __init__(self, given: sp.Expr) -> None:
        self.lines: list[Line] = []
        self._known: dict[sp.Expr, sp.Symbol] = {}
        self._eps = Epsilon(given)

    def function(
        self,
        name: str,
        inputs: Iterable[ConversionInput],
        outputs: Sequence[sp.Expr],
        about: str,
        *remarks: str,
        symbol: str = "q",
        unit: str = "",
    ) -> ConversionFunction:
        """The function with these outputs."""
        return ConversionFunction(
            name=name,
            symbol=symbol,
            inputs=tuple(inputs),
            values=tuple(self.lines),
            outputs=tuple(outputs),
            about=about,
            remarks=remarks,
            unit=unit,
        )

    @property
    def tiny(self) -> sp.Expr:
        """Four times the distance from one to the next float."""
        return 4 * self._eps

    @property
    def reach(self) -> sp.Expr:
        """The square root of that distance, in radians."""
        return self.let("reach", sp.sqrt(self._eps))

    def let(self, name: str, value: sp.Expr) -> sp.Expr:
        """A name for a value that is neither a number nor a symbol."""
        if value.is_number or value.is_Symbol or (-value).is_Symbol:
            return value
        if value not in self._known:
            symbol = self._known[value] = sp.Dummy(name)
            self.lines.append((symbol, value))
        return self._known[value]

    def each(self, names: Iterable[str], values: Iterable[sp.Expr]) -> Vector:
        return tuple(self.let(name, value) for name, value in zip(names, values, strict=True))

    def length(self, name: str, vector: Sequence[sp.Expr]) -> sp.Expr:
        return self.let(name, sp.sqrt(square(vector)))

    def positive(self, name: str, value: sp.Expr) -> sp.Expr:
        """The value, or zero if it is negative."""
        value = self.let(name, value)
        return self.let(name, Where(value < 0, sp.S.Zero, value))

    def wrapped(self, name: str, value: sp.Expr) -> sp.Expr:
        """An angle between −2π and 2π, taken into (−π, π]."""
        angle = self.let(name, value)
        turned = Where(angle <= -sp.pi, angle + 2 * sp.pi, angle)
        return self.let(name, Where(angle > sp.pi, angle - 2 * sp.pi, turned))


def symbols(names: Iterable[str]) -> tuple[sp.Dummy, ...]:
    """Symbols that equal no other, even of the same name."""
    return tuple(map(sp.Dummy, names))


def dot(first: Iterable[sp.Expr], second: Iterable[sp.Expr]) -> sp.Expr:
    """The sum of products, part by part, as it comes."""
    return sp.Add(*(a * b for a, b in zip(first, second, strict=True)))


def square(vector: Sequence[sp.Expr]) -> sp.Expr:
    return dot(vector, vector)


def number(exact: sp.Expr) -> float:
    """The nearest float; zero is zero in whatever radicals it is written."""
    value = sp.N(exact, _DIGITS)
    return 0.0 if abs(value) < _ZERO else float(value)


def nearest(exact: sp.Expr) -> sp.Expr:
    """The same as a SymPy number."""
    found = number(exact)
    return sp.Float(found) if found else sp.S.Zero


def rounded(expression: sp.Expr) -> sp.Expr:
    """A sum of products in which every irrational number is rounded once."""
    terms = sp.Add.make_args(sp.expand(expression))
    return sp.Add(*(_rounded_term(sp.Mul.make_args(term)) for term in terms))


def _rounded_term(factors: Sequence[sp.Expr]) -> sp.Expr:
    size = sp.Mul(*(factor for factor in factors if factor.is_number))
    size = size if size.is_Rational else nearest(size)
    return sp.Mul(size, *(factor for factor in factors if not factor.is_number))
