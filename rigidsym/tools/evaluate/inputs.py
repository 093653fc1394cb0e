"""Which column is which argument of a function."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from rigidsym.data.chunk import Table
from rigidsym.data.column_names import counted, plain, unit_in
from rigidsym.errors import DataError, RequestError
from rigidsym.mechanics.derivation import Argument, Derivation
from rigidsym.text.names import offer

_RATES = ("{}_dot", "{}rate", "d{}")
_ACCELERATIONS = ("{}_ddot", "{}accel", "dd{}")
_OMEGAS = ("omega_{}", "omega_{axis}", "w{axis}", "gyro_{axis}", "{letter}")


@dataclass(frozen=True, kw_only=True, slots=True)
class Input:
    """One argument: columns of the rows that are read, or numbers that stay."""

    name: str
    columns: tuple[int, ...]  # among those read; empty where the numbers are given
    given: tuple[float, ...] = ()
    in_degrees: tuple[bool, ...] = ()

    def of(self, table: Table) -> Table:
        """The argument of each row, (rows, n), angles in radians."""
        if not self.columns:
            return np.array(self.given, table.dtype)
        values = table[:, list(self.columns)]
        if any(self.in_degrees):
            degree = np.array([np.pi / 180 if turned else 1 for turned in self.in_degrees])
            values = values * degree.astype(table.dtype)
        return values


@dataclass(frozen=True, kw_only=True, slots=True)
class Inputs:
    """The columns to read, and what becomes of them."""

    columns: tuple[int, ...]  # of the file
    arguments: Mapping[str, Input]


def inputs_of(
    derivation: Derivation,
    quantities: Sequence[str],
    names: Sequence[str] | None,
    width: int,
    *,
    given: Mapping[str, float],
    degrees: bool,
) -> Inputs:
    """The columns for all arguments of some quantities, by their names or else by their order.

    `given` holds numbers for components that no column has, such as constants. Raises DataError
    for a column that is missing, with the nearest names that are there, and for one whose name
    says degrees or radians where `degrees` says the other; RequestError for numbers that are
    for no input.
    """
    wanted = {name for q in quantities for name in derivation.step(q).quantity.inputs}
    arguments = [a for a in derivation.arguments if a.name in wanted]
    known = {name for argument in arguments for name in argument.names}
    if strange := [name for name in given if name not in known]:
        raise RequestError(f"{strange[0]} is no input here; {offer(strange[0], sorted(known))}")
    free = [a for a in arguments if not set(a.names) <= given.keys()]
    if partly := [a for a in free if not given.keys().isdisjoint(a.names)]:
        raise RequestError(
            f"give all of {', '.join(partly[0].names)} as numbers, or none and have them in columns"
        )
    if names is None:
        columns = _by_order(free, width)
    else:
        columns = _by_name(free, names)
        _check_units(free, [names[place] for place in columns], degrees=degrees)
    return Inputs(columns=columns, arguments=_inputs(arguments, free, given, degrees))


def _inputs(
    arguments: Sequence[Argument],
    free: Sequence[Argument],
    given: Mapping[str, float],
    degrees: bool,
) -> Mapping[str, Input]:
    found: dict[str, Input] = {}
    place = 0
    for argument in arguments:
        if argument not in free:
            numbers = tuple(given[name] for name in argument.names)
            found[argument.name] = Input(name=argument.name, columns=(), given=numbers)
            continue
        found[argument.name] = Input(
            name=argument.name,
            columns=tuple(range(place, place + len(argument.names))),
            in_degrees=tuple(degrees and is_angle(unit) for unit in argument.units),
        )
        place += len(argument.names)
    return found


def is_angle(unit: str) -> bool:
    """Whether a unit holds radians: rad, rad/s, rad/s^2."""
    return unit.split("/")[0] == "rad"


def _by_order(arguments: Sequence[Argument], width: int) -> tuple[int, ...]:
    wanted = [name for argument in arguments for name in argument.names]
    if width != len(wanted):
        raise DataError(
            f"{counted(width, 'column')} without names: expected {len(wanted)} "
            f"({', '.join(wanted)}); or name them with --columns"
        )
    return tuple(range(width))


def _by_name(arguments: Sequence[Argument], names: Sequence[str]) -> tuple[int, ...]:
    there = [plain(name) for name in names]
    columns: list[int] = []
    missing: list[str] = []
    for argument in arguments:
        for place, name in enumerate(argument.names):
            spelled = [plain(text) for text in _spellings(argument, place)]
            found = [there.index(text) for text in spelled if text in there]
            columns += found[:1]
            if not found:
                missing.append(name)
    if missing:
        known = ", ".join(name.strip() for name in names)
        raise DataError(
            f"no column {', '.join(missing)} among {known}; --columns says which is which"
        )
    return tuple(columns)


def _check_units(arguments: Sequence[Argument], names: Sequence[str], *, degrees: bool) -> None:
    """Raise DataError where the name of a column has a unit of angles that is not the one read."""
    units = [unit for argument in arguments for unit in argument.units]
    for name, unit in zip(names, units, strict=True):
        said = unit_in(name).lower()
        if is_angle(unit) and said.startswith(("rad",) if degrees else ("deg", "°")):
            raise DataError(
                f"column {name.strip()}: "
                + ("--degrees is given" if degrees else "--degrees is missing")
                + "; where the name is wrong, --columns gives another"
            )


def _spellings(argument: Argument, place: int) -> list[str]:
    """How a component may be called, the plain name first."""
    name = argument.names[place]
    if argument.name == "q_dot":
        return [name, *(form.format(name.removesuffix("_dot")) for form in _RATES)]
    if argument.name == "q_ddot":
        return [name, *(form.format(name.removesuffix("_ddot")) for form in _ACCELERATIONS)]
    if argument.name.startswith("omega"):
        axis, letter = "xyz"[place], "pqr"[place]
        forms = [form.format(place + 1, axis=axis, letter=letter) for form in _OMEGAS]
        return [name, *forms]
    return [name]
