"""Time of one call of Ω′, R and the inverse rates of ZXZ, from one orientation to a million.

One peer is what a user writes without us: np.stack of lambdify's functions (cse) of the columns.
The other is heyoka's compiled function, on an array with one component a row, its own layout.
All sides take turns on one core; a turn repeats a short call until it lasts about a millisecond.
They allocate their results, or fill an array that is given them. heyoka takes all cores by itself
from some thousand orientations up: a second process compares that with one thread of ours and
with as many.
`--size 10000000` goes up to ten million.
"""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from importlib import import_module
from importlib.util import find_spec
from math import prod
from time import perf_counter
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from benchmarks.measure import (
    Settings,
    Spread,
    interleaved,
    on_one_core,
    progress,
    ratios,
    run_process,
)
from benchmarks.peers import in_plain_symbols
from benchmarks.report import Cell, Column, Figure, Report, Table, machine
from rigidsym.kernels.targets import TARGETS
from rigidsym.motion import Motion, derive

SIZES = (*(m * 10**k for k in range(7) for m in (1, 3)), 10**7)
QUANTITIES = {
    "angular_velocity_body": "Ω′",
    "rotation_matrix": "R",
    "rates_from_angular_velocity_body": "inverse rates",
}
LAYOUTS = {"rows": np.ascontiguousarray, "columns": np.asfortranarray}
FILLED = "rows, out given"
DOCUMENTED = (1, 100, 10**4, 10**6)  # of the table in the README, and with `out`
PEER, HEYOKA, REPEATS = "lambdify, cse, stacked", "heyoka cfunc", 11
MOST = {"numpy": 12e-6, "c": 1.5e-6}  # seconds of the smallest call
LIMITS = (  # of the time of a peer, from which size up
    ("numpy", PEER, 1, 1.0),
    ("c", HEYOKA, 1, 1.0),
    ("c", HEYOKA, 10**4, 0.8),
)
_LARGE = 10**4  # where threads share a call
_CORES = os.cpu_count() or 1
_TURN = 1e-3  # seconds

Array = NDArray[np.float64]
Turns = Mapping[str, list[float]]  # seconds of a call of each side, turn by turn
Call = Callable[[], object]


def stacked(motion: Motion, name: str) -> Callable[..., Array]:
    """np.stack of lambdify's results, entries on the last axis."""
    function = sp.lambdify(*in_plain_symbols(motion, name), "numpy", cse=True)

    def call(*arrays: Array, out: Array | None = None) -> Array:
        return np.stack(function(*(column for array in arrays for column in array.T)), -1, out)

    return call


def of_heyoka(motion: Motion, name: str) -> Callable[..., Array] | None:
    """The function of an array (components, orientations); None if heyoka is not installed."""
    if find_spec("heyoka") is None:
        return None
    heyoka: Any = import_module("heyoka")
    symbols, entries = in_plain_symbols(motion, name)
    variables = heyoka.make_vars(*map(str, symbols))
    function: Callable[..., Array] = heyoka.cfunc(
        [heyoka.from_sympy(_without_cotangents(entry)) for entry in entries], variables
    )
    return function


def _without_cotangents(entry: sp.Expr) -> sp.Expr:
    """heyoka has none."""
    written: sp.Expr = entry.replace(sp.cot, lambda angle: sp.cos(angle) / sp.sin(angle))
    return written


def seconds(call: Call) -> float:
    """Of one call, from as many as last a millisecond."""
    start = perf_counter()
    call()
    count = max(1, int(_TURN / (perf_counter() - start)))
    start = perf_counter()
    for _ in range(count):
        call()
    return (perf_counter() - start) / count


def run(settings: Settings) -> Report:
    """Every size up to that of the settings."""
    motion = derive("ZXZ", list(QUANTITIES))
    targets = [name for name in ("numpy", "c", "numba") if not TARGETS[name].missing]
    modules = {target: motion.kernels(target).load() for target in targets}
    tables, measured = [], []
    with on_one_core():
        for name, symbol in QUANTITIES.items():
            peers = _peers(motion, name)
            for layout in (*LAYOUTS, FILLED):
                chosen = DOCUMENTED if layout == FILLED else SIZES
                found = {}
                for size in (s for s in chosen if s <= settings.size):
                    progress(f"{symbol}, {layout}, {size}")
                    sides = _sides(motion, name, {**peers, **modules}, layout, size)
                    found[size] = _timed(sides, settings.repeats or REPEATS)
                tables.append(_table(f"{symbol}, {layout}", found, targets))
                measured.append(found)
    progress()
    large = [s for s in SIZES if _LARGE <= s <= settings.size]
    if large and "c" in targets and find_spec("heyoka"):
        tables.append(_on_all_cores(large, settings.repeats or REPEATS))
    return Report(
        title="Sizes: time of one call on one core, and as a part of its peers'",
        tables=tuple(tables),
        figures=(
            *(_figure(t, measured) for t in targets if t in MOST),
            *(line for limit in LIMITS for line in _limit(measured, *limit)),
        ),
        notes=(
            "Least, middle and most: of the ratios to lambdify's time, turn by turn. The ratio to "
            f"heyoka's time is the middle one. Processor: {machine()['processor']}.",
        ),
        documented=documented("Ω′, rows", measured[0]),
    )


def documented(title: str, found: Mapping[int, Turns]) -> Table:
    """Shortest times of every side, which other work disturbs least, for the README."""
    sides = list(next(iter(found.values())))
    heads = [{PEER: "lambdify", HEYOKA: "heyoka"}.get(side, side) for side in sides]
    rows: list[tuple[Cell, ...]] = [
        (size, *(f"{float(f'{Spread.of(turns[side]).least * 1e6:.3g}'):,.9g}" for side in sides))
        for size, turns in found.items()
        if size in DOCUMENTED
    ]
    first = f"{title}: orientations, µs a call on one core, {machine()['processor']}"
    columns = (Column(first, ",d"), *map(Column, heads))
    return Table(title, columns, tuple(rows))


def _peers(motion: Motion, name: str) -> dict[str, Callable[..., Array]]:
    compiled = of_heyoka(motion, name)
    return {PEER: stacked(motion, name), **({HEYOKA: compiled} if compiled else {})}


def _sides(
    motion: Motion, name: str, makers: Mapping[str, Any], layout: str, size: int
) -> dict[str, Call]:
    """A call of each side, a peer or a module, on the same orientations."""
    random, step = np.random.default_rng(1), motion.step(name)
    arranged: Any = LAYOUTS.get(layout, np.ascontiguousarray)
    arrays = [arranged(random.uniform(-3, 3, (size, 3))) for _ in step.quantity.inputs]
    by_component = np.array([column for a in arrays for column in a.T])
    shape = (size, *(n for n in step.expression.shape if n > 1))
    sides: dict[str, Call] = {}
    for side, made in makers.items():
        function: Any = made if side in (PEER, HEYOKA) else getattr(made, name)
        given = [by_component] if side == HEYOKA else arrays
        room: dict[str, Array] = {
            "out": np.empty((size, prod(shape[1:])) if side == PEER else shape)
        }
        if side == HEYOKA:
            room = {"outputs": np.empty((prod(shape[1:]), size))}
        sides[side] = partial(function, *given, **(room if layout == FILLED else {}))
    return sides


def _timed(sides: Mapping[str, Call], repeats: int) -> Turns:
    return interleaved({side: partial(seconds, call) for side, call in sides.items()}, repeats)


def _table(title: str, found: Mapping[int, Turns], targets: Sequence[str]) -> Table:
    peers = [peer for peer in (PEER, HEYOKA) if any(peer in turns for turns in found.values())]
    columns = [Column("orientations", ",d"), *(Column(f"{p}, µs", ",.2f") for p in peers)]
    for target in targets:
        columns.append(Column(f"{target}, µs", ",.2f"))
        columns += [Column(end, ".2f") for end in ("least", "middle", "most")]
        columns += [Column("of heyoka's", ".2f")] * (len(peers) - 1)
    rows = []
    for size, turns in found.items():
        cells: list[Cell] = [size, *(Spread.of(turns[peer]).middle * 1e6 for peer in peers)]
        for target in targets:
            cells += [Spread.of(turns[target]).middle * 1e6]
            cells += ratios(turns[target], turns[PEER]).in_order()
            cells += [ratios(turns[target], turns[peer]).middle for peer in peers[1:]]
        rows.append(tuple(cells))
    return Table(title, tuple(columns), tuple(rows))


def _on_all_cores(sizes: Sequence[int], repeats: int) -> Table:
    """heyoka as it comes beside the C module, in a process that nothing holds back."""
    command = [sys.executable, "-m", "benchmarks.sizes", str(repeats), *map(str, sizes)]
    rows = tuple(map(tuple, json.loads(run_process(command))))
    heads = [f"{side}, {part}" for side in ("c", f"threads={_CORES}") for part in ("µs", "part")]
    first = Column("quantity"), Column("orientations", ",d"), Column("heyoka, µs", ",.1f")
    columns = (*first, *(Column(head, ",.2f") for head in heads))
    return Table(f"Rows, heyoka as it comes, on {_CORES} cores", columns, rows)


def _compare_on_all_cores(repeats: int, sizes: Sequence[int]) -> list[list[Cell]]:
    motion = derive("ZXZ", list(QUANTITIES))
    module = motion.kernels("c").load()
    rows: list[list[Cell]] = []
    for name, symbol in QUANTITIES.items():
        makers = {**_peers(motion, name), "c": module}
        for size in sizes:
            sides = _sides(motion, name, makers, "rows", size)
            shared = partial(sides["c"], threads=_CORES)  # type: ignore[call-arg]
            turns = _timed({"c": sides["c"], "shared": shared, HEYOKA: sides[HEYOKA]}, repeats)
            cells: list[Cell] = [symbol, size, Spread.of(turns[HEYOKA]).middle * 1e6]
            for side in ("c", "shared"):
                cells.append(Spread.of(turns[side]).middle * 1e6)
                cells.append(ratios(turns[side], turns[HEYOKA]).middle)
            rows.append(cells)
    return rows


def _figure(target: str, measured: Sequence[Mapping[int, Turns]]) -> Figure:
    found = max(Spread.of(sizes[1][target]).middle for sizes in measured)
    most = MOST[target]
    return Figure(
        f"one orientation by {target}",
        f"at most {most * 1e6:g} µs",
        f"{found * 1e6:.2f} µs",
        found <= most,
    )


def _limit(
    measured: Sequence[Mapping[int, Turns]], target: str, peer: str, least: int, most: float
) -> list[Figure]:
    """The largest middle ratio from a size up; none where a side is missing."""
    found = [
        (ratios(turns[target], turns[peer]).middle, size)
        for sizes in measured
        for size, turns in sizes.items()
        if size >= least and target in turns and peer in turns
    ]
    if not found:
        return []
    ratio, size = max(found)
    goal = f"at most {most:g} of the time of {peer}"
    name = f"{target} at every size" + (f" from {least:,} up" if least > 1 else "")
    return [Figure(name, goal, f"{ratio:.2f} at {size:,}", ratio <= most)]


if __name__ == "__main__":
    _repeats, *_sizes = map(int, sys.argv[1:])
    print(json.dumps(_compare_on_all_cores(_repeats, _sizes)))
