"""Which column is which argument of a function."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import pi

from rigidsym.data.columns import ColumnNames, counted
from rigidsym.errors import DataError, RequestError, offer
from rigidsym.tools.evaluate.callables import FunctionArgument, is_angle
from rigidsym.tools.evaluate.work import Input
from rigidsym.tools.spellings import groups_of, of_component

DEGREE = pi / 180


def inputs_of(
    arguments: Sequence[FunctionArgument],
    header: ColumnNames | None,
    width: int,
    *,
    given: Mapping[str, float],
    degrees: bool,
) -> tuple[tuple[int, ...], dict[str, Input]]:
    """The columns to read for some arguments, and each argument from these.

    Columns are found by their names or else by their order; `given` holds numbers for components
    that no column has, such as constants. Numbers are in the unit that the name of their column
    states, or else in radians, in degrees with `degrees`, and SI units. Raises DataError for a
    column that is missing or twice there and for a unit that does not fit; RequestError for given
    numbers that belong to no input.
    """
    known = [name for argument in arguments for name in argument.names]
    if strange := [name for name in given if name not in known]:
        raise RequestError(f"{strange[0]} is not an input; {offer(strange[0], sorted(known))}")
    free = [a for a in arguments if not set(a.names) <= given.keys()]
    if partly := [a for a in free if not given.keys().isdisjoint(a.names)]:
        raise RequestError(
            f"expected numbers for all of {', '.join(partly[0].names)}, or columns for all of them"
        )
    columns = _by_order(free, width) if header is None else _by_name(free, header)
    found: dict[str, Input] = {}
    start = 0
    for argument in arguments:
        if argument not in free:
            numbers = tuple(given[name] for name in argument.names)
            found[argument.name] = Input(columns=(), given=numbers, shape=argument.shape)
            continue
        places = range(start, start := start + len(argument.names))
        factors = tuple(
            _factor(header, columns[place], unit, degrees=degrees)
            for place, unit in zip(places, argument.units, strict=True)
        )
        found[argument.name] = Input(columns=tuple(places), factors=factors, shape=argument.shape)
    return columns, found


def _factor(header: ColumnNames | None, column: int, unit: str, *, degrees: bool) -> float:
    """What the numbers of a column are multiplied by to be in the unit of the functions."""
    stated = None if header is None else header.factor(column, unit)
    if stated is not None:
        return stated
    return DEGREE if degrees and is_angle(unit) else 1.0


def _by_order(arguments: Sequence[FunctionArgument], width: int) -> tuple[int, ...]:
    wanted = [name for argument in arguments for name in argument.names]
    if width != len(wanted):
        raise DataError(
            f"{counted(width, 'column')} without names: expected {len(wanted)} "
            f"({', '.join(wanted)}); or name them with --columns"
        )
    return tuple(range(width))


def _by_name(arguments: Sequence[FunctionArgument], header: ColumnNames) -> tuple[int, ...]:
    columns: list[int] = []
    missing: list[str] = []
    for argument in arguments:
        groups = groups_of(argument.name, argument.names)
        group = next((group for group in groups if all(map(header.has, group))), argument.names)
        for name in group:
            column = header.find(of_component(argument.name, name))
            if column is None:
                missing.append(name)
            else:
                columns.append(column)
    if missing:
        remedy = "--columns names the columns in order"
        if any(a.name == "q" and len(a.names) == 3 and {*a.names} <= {*missing} for a in arguments):
            remedy += (
                ", or --angles the coordinates in the order of the turns, "
                "such as `--angles yaw,pitch,roll`"
            )
        raise DataError(f"no column {', '.join(missing)} among {header.listed}; {remedy}")
    return tuple(columns)
