"""Expressions of the [body] table of a derivation file, and their parameters.

Texts and integers are exact. A number with a decimal point is measured: it becomes a parameter with
this value, named after its key, so that the derivation stays exact and its formulas short.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import chain, count
from math import isfinite
from pathlib import Path

import sympy as sp

from rigidsym.errors import BodyError, ExpressionError
from rigidsym.models.body import Parameter
from rigidsym.spec.tables import Path as Place, Table
from rigidsym.text.expression import names_in, parse_expression
from rigidsym.text.names import check_name

_OF_FILES = ("mesh", "particles", "columns", "scale", "density")  # keys of bodies in files
_WORD = re.compile(r"[^\W\d]\w*")
_A_NUMBER = 'a number, or an expression in quotes such as "2*a"'
_UNREAD = sp.Symbol("unread")  # in place of an expression whose fault is noted


class Declared:
    """The parameters of one file: declared in [parameters], or made from numbers."""

    def __init__(self, body: Table, parameters: Table | None) -> None:
        self._parameters: dict[str, Parameter] = {}
        self.files: dict[Place, Mapping[str, object]] = {}  # contents, by their tables
        self._notes: dict[str, tuple[str, str]] = {}  # name: meaning and unit
        self._taken = set(_words(body.data))  # names that no number may have
        self._numbers: dict[str, float] = {}  # names of numbers
        for key in parameters.data if parameters else ():
            if parameters and (entry := parameters.table(key)) is not None:
                with parameters.noting(key):
                    self._parameters[check_name(key)] = _parameter(entry, check_name(key))

    def symbol(self, name: str) -> sp.Symbol:
        """The symbol of a name in an expression; raises ExpressionError for an invalid name."""
        return sp.Symbol(check_name(name))

    def measured(self, slot: str, value: float, *, positive: bool) -> sp.Symbol:
        """The parameter for a number; raises BodyError if it should be positive and is not.

        It has the name of its slot, or a similar one if that has another meaning or value.
        """
        taken = self._taken | self._parameters.keys() - self._numbers.keys()
        name = next(
            name
            for name in chain([slot], (f"{slot}_{k}" for k in count(2)))
            if name not in taken and self._numbers.get(name, value) == value
        )
        self._numbers[name] = value
        self._parameters[name] = Parameter(
            symbol=sp.Symbol(name), positive=positive or value > 0, value=float(value)
        )
        return sp.Symbol(name)

    def without_files(self, data: object, at: Place) -> object:
        """The data at a path, with the contents of files instead of their names."""
        if isinstance(data, list):
            return [self.without_files(entry, (*at, k)) for k, entry in enumerate(data)]
        if not isinstance(data, Mapping):
            return data
        kept = {key: self.without_files(entry, (*at, key)) for key, entry in data.items()}
        if at not in self.files:
            return kept
        return {k: v for k, v in kept.items() if k not in _OF_FILES} | dict(self.files[at])

    def note(self, expressions: Sequence[sp.Expr], about: str, unit: str) -> None:
        """Note the meaning of expressions that are single symbols, unless it is known."""
        for expression in expressions:
            if expression.is_Symbol:
                self._notes.setdefault(expression.name, (about, unit))

    def number(self, expression: sp.Expr) -> float | None:
        """The value of an expression; None unless all its symbols have values."""
        values = {p.symbol: sp.Float(p.value, 17) for p in self.given() if p.value is not None}
        value = expression.xreplace(values)
        return float(value) if value.is_number else None

    def given(self) -> tuple[Parameter, ...]:
        """All parameters with a declaration, a value or a meaning."""
        noted = {
            name: Parameter(symbol=sp.Symbol(name), positive=unit != "m" or "coord" not in about)
            for name, (about, unit) in self._notes.items()
        }
        found = []
        for name, p in (noted | self._parameters).items():
            about, unit = self._notes.get(name, ("", ""))
            found.append(replace(p, about=p.about or about, unit=p.unit or unit))
        return tuple(found)


def _words(data: object) -> list[str]:
    """All words in the texts of a table."""
    if isinstance(data, str):
        return _WORD.findall(data)
    inner = data.values() if isinstance(data, Mapping) else data if isinstance(data, list) else ()
    return [word for entry in inner for word in _words(entry)]


def _parameter(entry: Table, name: str) -> Parameter:
    """A = { positive = true, about = "...", unit = "kg m^2" }."""
    entry.refuse_others(("positive", "about", "unit", "value"))
    positive = entry.flag("positive")
    return Parameter(
        symbol=sp.Symbol(name),
        about=entry.text("about") or "",
        unit=entry.text("unit") or "",
        positive=True if positive is None else positive,
        value=entry.number("value"),
    )


class BodyReader:
    """Reads the values of one table; a fault is noted, and something else is read instead."""

    def __init__(
        self,
        table: Table,
        declared: Declared,
        folder: Path | None,
        suffix: str = "",
        *,
        exact: bool = False,
    ) -> None:
        self.table = table
        self.declared = declared
        self.folder = folder  # paths in the file start here; None in a record, which has none
        self.suffix = suffix  # of the names of numbers: "_2" in the second part
        self._exact_only = exact  # whether numbers with a point stay numbers

    def inside(self, table: Table, suffix: str = "", *, exact: bool = False) -> BodyReader:
        """The reader of a table within this one."""
        return BodyReader(table, self.declared, self.folder, self.suffix + suffix, exact=exact)

    def expression(
        self, value: object, slot: str, *at: str | int, positive: bool = False
    ) -> sp.Expr:
        """The exact expression of a text or a number at a path."""
        try:
            if isinstance(value, str):
                names = {name: self.declared.symbol(name) for name in names_in(value)}
                return parse_expression(value, names)
            if isinstance(value, bool) or not isinstance(value, int | float):
                self.table.mistyped(value, _A_NUMBER, *at)
            elif not isfinite(value):
                self.table.fault(f"expected a finite number, got {value}", *at)
            elif isinstance(value, float) and value != 0 and not self._exact_only:
                return self.declared.measured(slot + self.suffix, value, positive=positive)
            elif positive and value <= 0:
                self.table.fault(f"expected a positive number, got {Fraction(str(value))}", *at)
            else:
                return sp.Rational(str(value))
        except ExpressionError as error:
            self.table.fault(f"column {error.column}: {error.message}", *at)
        except BodyError as error:
            self.table.fault(str(error), *at)
        return _UNREAD

    def single(self, key: str, slot: str, *, positive: bool = False) -> sp.Expr:
        """The expression of a key."""
        return self.expression(self.table.value(key), slot, key, positive=positive)

    def row(
        self, key: str, slots: Sequence[str], expected: str, *, positive: bool = False
    ) -> list[sp.Expr]:
        """A list of as many expressions as there are slots."""
        value = self.table.value(key)
        if not isinstance(value, list) or len(value) != len(slots):
            self.table.mistyped(value, expected, key)
            return [_UNREAD] * len(slots)
        return self.entries(value, slots, key, positive=positive)

    def rows(
        self, key: str, slots: Sequence[Sequence[str]] | int, expected: str
    ) -> list[list[sp.Expr]]:
        """A list of rows of as many expressions as there are slots, or any number of rows."""
        value = self.table.value(key)
        rows = value if isinstance(value, list) else []
        if isinstance(slots, int):
            slots = [[f"{axis}_{k}" for axis in "xyz"[:slots]] for k in range(max(1, len(rows)))]
        sizes = [len(row) if isinstance(row, list) else 0 for row in rows]
        if sizes != [len(row) for row in slots]:
            self.table.mistyped(value, expected, key)
            return [[_UNREAD] * len(row) for row in slots]
        return [self.entries(row, slots[k], key, k) for k, row in enumerate(rows)]

    def entries(
        self, values: Sequence[object], slots: Sequence[str], *at: str | int, positive: bool = False
    ) -> list[sp.Expr]:
        """The expressions of a list."""
        return [
            self.expression(value, slot, *at, place, positive=positive)
            for place, (value, slot) in enumerate(zip(values, slots, strict=True))
        ]
