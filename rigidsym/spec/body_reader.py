"""Expressions of the [body] table of a derivation file, and the parameters that they bring.

Texts and integers are exact. A number with a decimal point is measured: it becomes a parameter with
this value, named after its key, so that the derivation stays exact and its formulas short.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import replace
from fractions import Fraction
from itertools import chain, count
from math import isfinite
from pathlib import Path

import sympy as sp

from rigidsym.errors import BodyError, ExpressionError
from rigidsym.models.body import Parameter
from rigidsym.spec.tables import Table
from rigidsym.spec.toml_lines import Path as Place
from rigidsym.text.expression import names_in, parse_expression
from rigidsym.text.names import check_name

PARAMETER_KEYS = ("positive", "about", "unit", "value")
OF_FILES = ("mesh", "particles", "columns", "scale", "density")  # keys of bodies in files
_WORD = re.compile(r"[^\W\d]\w*")
A_NUMBER = 'a number, or an expression in quotes such as "2*a"'


class Declared:
    """The parameters of one file: declared in [parameters], or made from numbers."""

    def __init__(self) -> None:
        self._parameters: dict[str, Parameter] = {}
        self.files: dict[Place, Mapping[str, object]] = {}  # contents, by their tables
        self._notes: dict[str, tuple[str, str]] = {}  # name: meaning and unit
        self._taken: set[str] = set()  # names used in the file
        self._numbers: dict[str, float] = {}  # names of numbers

    def read(self, table: Table) -> None:
        """The tables of [parameters]: A = { positive = true, about = "...", unit = "kg m^2" }."""
        for key in table.data:
            entry = table.table(key)
            if entry is None:
                continue
            entry.refuse_others(PARAMETER_KEYS)
            try:
                name = check_name(key)
                self._parameters[name] = _parameter(entry, name)
            except ExpressionError as error:
                table.fault(error.message, key)
            except BodyError as error:
                table.fault(str(error), key)

    def take_names(self, data: object) -> None:
        """Note all words in the texts of a table, which no number may have as its name."""
        if isinstance(data, str):
            self._taken.update(_WORD.findall(data))
        elif isinstance(data, Mapping):
            for entry in data.values():
                self.take_names(entry)
        elif isinstance(data, list):
            for entry in data:
                self.take_names(entry)

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
        return {k: v for k, v in kept.items() if k not in OF_FILES} | dict(self.files[at])

    def note(self, expression: sp.Expr, about: str, unit: str) -> None:
        """Note the meaning of an expression that is a single symbol, unless it is known."""
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


def _parameter(entry: Table, name: str) -> Parameter:
    positive = entry.flag("positive")
    return Parameter(
        symbol=sp.Symbol(name),
        about=entry.text("about") or "",
        unit=entry.text("unit") or "",
        positive=True if positive is None else positive,
        value=entry.number("value"),
    )


class BodyReader:
    """Reads the values of one table; a fault is noted, and None is returned."""

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
    ) -> sp.Expr | None:
        """The exact expression of a text or a number at a path."""
        try:
            if isinstance(value, str):
                names = {name: self.declared.symbol(name) for name in names_in(value)}
                return parse_expression(value, names)
            if isinstance(value, bool) or not isinstance(value, int | float):
                self.table.mistyped(value, A_NUMBER, *at)
                return None
            if not isfinite(value):
                raise BodyError(f"expected a finite number, got {value}")
            if isinstance(value, int) or value == 0 or self._exact_only:
                return self._exact(Fraction(str(value)), positive=positive)
            return self.declared.measured(slot + self.suffix, value, positive=positive)
        except ExpressionError as error:
            self.table.fault(f"column {error.column}: {error.message}", *at)
        except BodyError as error:
            self.table.fault(str(error), *at)
        return None

    def _exact(self, value: Fraction, *, positive: bool) -> sp.Rational:
        if positive and value <= 0:
            raise BodyError(f"expected a positive number, got {value}")
        return sp.Rational(value.numerator, value.denominator)

    def single(self, key: str, slot: str, *, positive: bool = False) -> sp.Expr | None:
        """The expression of a key; None if it is missing or wrong."""
        value = self.table.value(key)
        return None if value is None else self.expression(value, slot, key, positive=positive)

    def row(
        self, key: str, slots: tuple[str, ...], expected: str, *, positive: bool = False
    ) -> list[sp.Expr] | None:
        """A list of as many expressions as there are slots."""
        value = self.table.value(key)
        if not isinstance(value, list) or len(value) != len(slots):
            self._missing_or_mistyped(value, expected, key)
            return None
        return self.entries(value, slots, key, positive=positive)

    def entries(
        self, values: list[object], slots: tuple[str, ...], *at: str | int, positive: bool = False
    ) -> list[sp.Expr] | None:
        """The expressions of a list; None if one of them is wrong."""
        read = [
            self.expression(value, slot, *at, place, positive=positive)
            for place, (value, slot) in enumerate(zip(values, slots, strict=True))
        ]
        found = [entry for entry in read if entry is not None]
        return found if len(found) == len(read) else None

    def _missing_or_mistyped(self, value: object, expected: str, key: str) -> None:
        if value is None:
            self.table.fault(f"missing; expected {expected}", key)
        else:
            self.table.mistyped(value, expected, key)
