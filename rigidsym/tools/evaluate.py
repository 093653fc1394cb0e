"""Generated functions over a file of any length, in bounded memory."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from inspect import signature
from itertools import compress, product
from math import pi
from pathlib import Path
from types import ModuleType
from typing import BinaryIO, NamedTuple

import numpy as np

from rigidsym.data import tables
from rigidsym.data.columns import COLUMNS, ColumnNames, counted, in_both_units, names_for
from rigidsym.errors import DataError, QuantityError, RequestError, offer
from rigidsym.mechanics.derivation import remark
from rigidsym.mechanics.quantities import CONVERSIONS
from rigidsym.motion import Motion
from rigidsym.system.processes import Progress
from rigidsym.system.records import Record
from rigidsym.tools.identify.samples import SLACK, Columns, samples_of
from rigidsym.tools.spellings import MATRICES, groups_of, of_component


class Evaluated(Record, kw_only=True):
    """What was written."""

    path: Path
    rows: int
    columns: tuple[str, ...]
    remarks: tuple[str, ...]  # how columns without a unit were read, rows without a value


def evaluate(
    motion: Motion,
    quantities: Sequence[str],
    source: Path | BinaryIO,
    path: Path | BinaryIO,
    *,
    columns: Sequence[str] | None = None,
    given: Mapping[str, float] | None = None,
    keep: Sequence[str] = (),
    missing: tables.Missing = "error",
    degrees: bool = False,
    threads: int = 1,
    rows: int = tables.ROWS,
    progress: Progress | None = None,
) -> Evaluated:
    """Write functions of a motion for each row of a file: NPY, Parquet, or text with separators.

    `quantities` are quantities or conversions (`quaternion`, `from_quaternion`,
    `from_rotation_matrix`). `source` and `path` may be binary streams of text with commas. Columns
    are found by their names, or by `columns`; without either they are the arguments in the order
    of the functions. Units in names are converted; without one, angles and their rates are in
    radians, with `degrees` in degrees, as they then are in the result. `given` has numbers for
    arguments that are in no column. Columns to `keep` are written before the result. Rows with
    `missing` numbers are an error, have NaN as their result, or are dropped. The result is in
    place when all of it is there, or not at all. `rows` are in memory at once.

    Raises DataError for rows that are not numbers and columns that do not fit, RequestError for a
    request that cannot be met, such as an unknown ending of the result, and QuantityError;
    SampleError, with the rows, for matrices that are not rotations.
    """
    if isinstance(source, Path):
        table = tables.open_table(source)
    else:
        table = tables.TextTable(Path("standard input"), source.read())
    where, stream = (path, None) if isinstance(path, Path) else (Path("standard output"), path)
    if stream is None:
        tables.check_ending(where)
        if isinstance(source, Path) and where.resolve() == source.resolve():
            raise RequestError(f"{where}: the result would replace the file that is read")
    calls = _calls_of(motion, quantities)
    constants = _constants(calls.inputs, given or {})
    free = [each for each in calls.inputs if each.name not in constants]
    if not free:
        raise RequestError(f"{table.source}: no column is used; every row has the same result")
    try:
        match = _matched(table, free, columns, keep, degrees=degrees)
    except DataError as error:
        raise DataError(f"{table.source}: {error}") from None
    names = [name for name, _ in match.components]
    complete = tables.without_missing(
        table, table.batches(match.columns, rows, [*match.kept]), names, missing
    )
    factors = [180 / pi if degrees and _is_angle(unit) else 1.0 for _, unit in calls.results]
    largest = np.zeros(len(names))  # the sizes in each column
    # how many rows there are, how many have inputs and no value, and where the first of these is
    total, lost, first = 0, 0, ""

    def computed() -> Iterator[tables.Rows]:
        nonlocal total, lost, first
        for batch in complete:
            result = _values(calls, table, batch, match.scales, constants, free, threads)
            is_lost = np.isfinite(batch.table).all(axis=1) & ~np.isfinite(result).all(axis=1)
            if is_lost.any() and not lost:
                first = table.place(int(batch.rows[is_lost.argmax()]))
            total, lost = total + len(result), lost + int(is_lost.sum())
            np.fmax(largest, np.fmax.reduce(np.abs(batch.table), initial=0), out=largest)
            yield result * factors, batch.kept
            if progress is not None:
                progress(batch.share)

    titles = (*match.kept.values(), *(_title(*each, degrees=degrees) for each in calls.results))
    tables.write_table(where, titles, computed(), stream)
    read_as = ", ".join(_title(*match.components[k], degrees=degrees) for k in match.unstated)
    remarks = [remark("unit_assumed", columns=read_as)] if read_as else []
    remarks += [
        remark("may_be_degrees", name=names[k], value=in_both_units(largest[k]))
        for k in match.unstated
        if match.components[k][1] == "rad" and largest[k] > 2 * pi and not degrees
    ]
    if lost:
        remarks.append(remark("rows_without_value", count=lost, total=total, first=first))
    return Evaluated(path=where, rows=total, columns=titles, remarks=tuple(remarks))


def _values(
    calls: _Calls,
    table: tables.Table,
    batch: tables.Batch,
    scales: Sequence[float],
    constants: Mapping[str, tables.Numbers],
    free: Sequence[_Input],
    threads: int,
) -> tables.Numbers:
    """The values of all functions for the rows of a batch, side by side."""
    count = len(batch.table)
    ends = np.cumsum([len(each.names) for each in free])[:-1]
    vectors = dict(constants)
    parts = np.split(batch.table * np.array(scales), ends, axis=1)
    for each, part in zip(free, parts, strict=True):
        vectors[each.name] = each.rows(part)
        if each is _MATRIX:
            samples_of(table, _ENTRIES, replace(batch, table=part), drops_missing=True).check(SLACK)
    values = []
    for name, arguments in calls.arguments.items():
        function = getattr(calls.module, name)
        value = function(*(vectors[each] for each in arguments), threads=threads)
        is_constant = constants.keys() >= {*arguments}
        value = np.asarray(value).reshape(1 if is_constant else count, -1)
        values.append(np.broadcast_to(value, (count, value.shape[1])))
    return np.concatenate(values, axis=1)


# The functions, their arguments and results


class _Input(Record):
    """A vector or matrix that functions take, with a name and a unit for each component."""

    name: str
    names: tuple[str, ...]
    units: tuple[str, ...]
    shape: tuple[int, ...] = (-1,)  # of one row
    every: tuple[str, ...] = ()  # of constants, also those on which no result depends

    def rows(self, numbers: tables.Numbers) -> tables.Numbers:
        """The argument, from numbers (n, k); NaN where no result depends on it."""
        if not self.every:
            return numbers.reshape(len(numbers), *self.shape)
        whole = np.full((len(numbers), len(self.every)), np.nan, numbers.dtype)
        whole[:, [self.every.index(name) for name in self.names]] = numbers
        return whole


_QUATERNION = _Input("quaternion", ("qw", "qx", "qy", "qz"), ("",) * 4)
_MATRIX = _Input("matrix", MATRICES[0], ("",) * 9, (3, 3))
_ENTRIES = Columns({"matrix": range(9)})


class _Calls(NamedTuple):
    """Functions of one module, and what they take and return."""

    module: ModuleType
    arguments: Mapping[str, tuple[str, ...]]  # by the name of the function
    inputs: Sequence[_Input]  # of all functions
    results: Sequence[tuple[str, str]]  # names and units of their columns


def _calls_of(motion: Motion, names: Sequence[str]) -> _Calls:
    """The functions of these names; raises QuantityError or RequestError for one without rows."""
    chosen = motion.select(derived_for(names))
    converts = not CONVERSIONS.keys().isdisjoint(names)
    module = chosen.kernels(conversions=converts).load()
    rule = chosen.conversions.inverse if converts else None
    quaternion = replace(_QUATERNION, names=rule.listed(_QUATERNION.names)) if rule else _QUATERNION
    arguments = {name: _arguments(chosen, module, name) for name in names}
    taken = {argument for each in arguments.values() for argument in each}
    values = [chosen.step(name).expression for name in derived_for(names)]
    values += [definition.expression for definition in chosen.definitions]
    acting = set(chosen.model.constants).union(*(value.free_symbols for value in values))
    known = {a.name: _Input(a.name, a.names, a.units) for a in chosen.arguments}
    for a in chosen.arguments:
        if a.name == "parameters":
            used = [symbol in acting for symbol in a.symbols]
            own, units = (tuple(compress(each, used)) for each in (a.names, a.units))
            known[a.name] = _Input(a.name, own, units, every=a.names)
    return _Calls(
        module=module,
        arguments=arguments,
        inputs=[each for each in (*known.values(), quaternion, _MATRIX) if each.name in taken],
        results=[result for name in names for result in _results(chosen, name, quaternion)],
    )


def derived_for(names: Sequence[str]) -> tuple[str, ...]:
    """The quantities to derive for some functions."""
    return tuple(name for name in names if name not in CONVERSIONS) or ("rotation_matrix",)


def _is_angle(unit: str) -> bool:
    """Whether a unit holds radians: rad, rad/s, rad/s^2."""
    return unit.split("/")[0] == "rad"


def _arguments(motion: Motion, module: ModuleType, name: str) -> tuple[str, ...]:
    """The names of the arguments of a function; raises RequestError if it has none."""
    if name in CONVERSIONS:
        if hasattr(module, name):
            taken = signature(getattr(module, name)).parameters.values()
            others = [each.name for each in taken if each.kind is not each.KEYWORD_ONLY][1:]
            return (CONVERSIONS[name], *others)  # parameters, of a turn by a constant angle
        raise QuantityError(
            f"this rotation has no function {name}: only the 24 Euler conventions and the named "
            "parametrisations have it; for other coordinates, fit rotation_matrix(q) to the matrix "
            "with scipy.optimize.least_squares"
        )
    if not (inputs := motion.step(name).quantity.inputs):
        raise RequestError(f"{name} takes no input: it is the same for every row")
    return inputs


def _results(derivation: Motion, name: str, quaternion: _Input) -> Iterable[tuple[str, str]]:
    """The names and units of the columns of a result, entries row by row."""
    if name == "quaternion":
        return zip(quaternion.names, quaternion.units, strict=True)
    of_coordinates = {"from_quaternion": "q", "from_rotation_matrix": "q"}
    of_coordinates |= {f"rates_from_angular_velocity_{f}": "q_dot" for f in ("space", "body")}
    if name in of_coordinates:
        argument = derivation.argument(of_coordinates[name])
        return zip(argument.names, argument.units, strict=True)
    step = derivation.step(name)
    indices = product(*(range(1, size + 1) for size in step.shape))
    names = ["_".join(filter(None, [name, "".join(map(str, index))])) for index in indices]
    return [(each, step.quantity.unit) for each in names]


def _title(name: str, unit: str, *, degrees: bool) -> str:
    unit = unit.replace("rad", "deg", 1) if degrees and _is_angle(unit) else unit
    return f"{name} [{unit}]" if unit else name


# Which column is which argument


def _constants(inputs: Sequence[_Input], given: Mapping[str, float]) -> dict[str, tables.Numbers]:
    """The arguments whose components all have given numbers.

    Raises RequestError for numbers that belong to no input, and for some of a vector only.
    """
    known = {name for each in inputs for name in each.every or each.names}
    if strange := [name for name in given if name not in known]:
        raise RequestError(f"{strange[0]} is not an input; {offer(strange[0], sorted(known))}")
    constants = {}
    for each in inputs:
        if given.keys() >= {*each.names}:
            numbers = np.array([[given[name] for name in each.names]])
            constants[each.name] = each.rows(numbers)[0]
        elif not given.keys().isdisjoint(each.names):
            names = ", ".join(each.names)
            lacking = ", ".join(name for name in each.names if name not in given)
            raise RequestError(
                f"expected numbers for all of {names}, or columns; none for {lacking}"
            )
    return constants


class _Match(NamedTuple):
    """Which column is which component, and the factors to SI units."""

    components: Sequence[tuple[str, str]]  # names and units
    columns: Sequence[int]
    scales: Sequence[float]
    unstated: Sequence[int]  # components whose columns state no unit
    kept: Mapping[int, str]  # columns to copy, with their names


def _matched(
    table: tables.Table,
    inputs: Sequence[_Input],
    columns: Sequence[str] | None,
    keep: Sequence[str],
    *,
    degrees: bool,
) -> _Match:
    """The columns of the inputs by their names, or in their order; raises DataError."""
    components = [pair for each in inputs for pair in zip(each.names, each.units, strict=True)]
    named = names_for(columns, table.width, table.names)
    if named is None and table.width != len(components):
        raise DataError(
            f"{counted(table.width, 'column')} without names: expected {len(components)} "
            f"({', '.join(name for name, _ in components)}); or name them with {COLUMNS}"
        )
    header = ColumnNames(named or [name for name, _ in components])
    used = [*range(table.width)] if named is None else _by_name(inputs, header)
    scales, unstated = [], []
    for k, (_, unit) in enumerate(components):
        stated = None if named is None else header.factor(used[k], unit)
        if stated is None:
            stated = pi / 180 if degrees and _is_angle(unit) else 1.0
            unstated += [k] if named is None or unit else []
        scales.append(stated)
    kept = {}
    for name in keep:
        if (place := header.find([name])) is None:
            raise DataError(f"no column {name}; {offer(name, header.names)}")
        kept[place] = header.names[place]
    return _Match(components, used, scales, unstated, kept)


def _by_name(arguments: Sequence[_Input], header: ColumnNames) -> list[int]:
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
        names = {each.name: {*each.names} for each in arguments}
        rates, coordinates = names.get("q_dot"), names.get("q", {*missing})
        constants = {name for each in arguments if each.every for name in each.names}
        lacks_rates = {*missing} == rates
        names_angles = not coordinates.isdisjoint(missing)
        same = f"--given {min(constants, default='')}=NUMBER gives a constant; "
        raise DataError(
            f"no column {', '.join(missing)} among {header.listed}; "
            f"{'without rates, --quantity rotation_matrix gives the attitude; ' * lacks_rates}"
            f"{same * (not constants.isdisjoint(missing))}"
            f"if the file names them otherwise, {COLUMNS} names all its columns, in order"
            f"{', or --angles the coordinates, such as `--angles yaw,pitch,roll`' * names_angles}"
        )
    return columns
