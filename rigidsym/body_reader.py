"""Expressions of the [body] table of a derivation file, and the parameters that they bring.

A text is an expression, exact as it stands. A whole number is itself. A number with a point is a
measured one: it becomes a parameter, named after its place, that has this value, so that the
derivation stays exact and its formulas short.
"""

from __future__ import annotations

from collections.abc import Mapping
from math import isfinite

import sympy as sp

from rigidsym.errors import BodyError, ExpressionError
from rigidsym.expression import names_in, parse_expression
from rigidsym.models.body import Parameter
from rigidsym.names import check_name
from rigidsym.tables import Table

PARAMETER_KEYS = ("positive", "about", "unit", "value")
A_NUMBER = 'a number, or an expression in quotes such as "2*a"'


class Declared:
    """The parameters of one file: those of [parameters], and those that numbers bring."""

    def __init__(self) -> None:
        self._parameters: dict[str, Parameter] = {}

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        return tuple(self._parameters.values())

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

    def symbol(self, name: str) -> sp.Symbol:
        """The symbol of a name in an expression; raises ExpressionError for what names nothing."""
        return sp.Symbol(check_name(name))

    def measured(self, slot: str, value: float, *, positive: bool) -> sp.Symbol:
        """The parameter that stands for a number in a place; raises BodyError for a wrong one."""
        if not isfinite(value):
            raise BodyError(f"expected a finite number, got {value}")
        self._parameters[slot] = Parameter(
            symbol=sp.Symbol(slot), positive=positive or value > 0, value=float(value)
        )
        return sp.Symbol(slot)

    def given(self, about: Mapping[str, tuple[str, str]]) -> tuple[Parameter, ...]:
        """All parameters, those from numbers described by {name: (about, unit)}."""
        return tuple(
            Parameter(
                symbol=p.symbol,
                about=p.about or about.get(name, ("", ""))[0],
                unit=p.unit or about.get(name, ("", ""))[1],
                positive=p.positive,
                value=p.value,
            )
            for name, p in self._parameters.items()
        )


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
    """Reads the values of one table; what is wrong is noted there, and None is read."""

    def __init__(self, table: Table, declared: Declared, suffix: str = "") -> None:
        self.table = table
        self.declared = declared
        self.suffix = suffix  # of the names that numbers bring: "_2" in the second part

    def expression(
        self, value: object, slot: str, *at: str | int, positive: bool = False
    ) -> sp.Expr | None:
        """The exact expression of a text or a number that stands at a path."""
        try:
            if isinstance(value, str):
                names = {name: self.declared.symbol(name) for name in names_in(value)}
                return parse_expression(value, names)
            if isinstance(value, bool) or not isinstance(value, int | float):
                self.table.mistyped(value, A_NUMBER, *at)
                return None
            if isinstance(value, int) or value == 0:
                return self._exact(int(value), positive=positive)
            return self.declared.measured(slot + self.suffix, value, positive=positive)
        except ExpressionError as error:
            self.table.fault(f"column {error.column}: {error.message}", *at)
        except BodyError as error:
            self.table.fault(str(error), *at)
        return None

    def _exact(self, value: int, *, positive: bool) -> sp.Integer:
        if positive and value <= 0:
            raise BodyError(f"expected a positive number, got {value}")
        return sp.Integer(value)

    def single(self, key: str, slot: str, *, positive: bool = False) -> sp.Expr | None:
        """The expression of a key; None where it is missing or wrong."""
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
        """The expressions of a list; None where one of them is wrong."""
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
