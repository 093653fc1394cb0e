"""Time of one call of Ω′ and R of ZXZ at every size from 1 to a million, in both layouts.

One peer is what a user writes without us: np.stack of lambdify's functions (cse) of the columns.
The other is heyoka's compiled function, on an array with one component a row, its own layout.
All sides take turns and allocate their results; a turn repeats a short call until it lasts about
a millisecond. `--size 10000000` goes up to ten million.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from importlib import import_module
from importlib.util import find_spec
from time import perf_counter
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from benchmarks.measure import Settings, Spread, interleaved, progress, ratios
from benchmarks.report import Cell, Column, Figure, Report, Table, machine
from rigidsym.kernels.targets import TARGETS
from rigidsym.motion import Motion, derive

SIZES = (*(m * 10**k for k in range(7) for m in (1, 3)), 10**7)
QUANTITIES = {"angular_velocity_body": "Ω′", "rotation_matrix": "R"}
LAYOUTS = {"rows": np.ascontiguousarray, "columns": np.asfortranarray}
DOCUMENTED = (1, 100, 10**4, 10**6)  # of the table in the README
PEER, HEYOKA, REPEATS = "lambdify, cse, stacked", "heyoka cfunc", 15
MOST = {"numpy": 12e-6, "c": 1.5e-6}  # seconds of the smallest call
LIMITS = {"numpy": PEER, "c": HEYOKA}  # which no size takes longer than
_TURN = 1e-3  # seconds

Call = Callable[[], object]


def stacked(motion: Motion, name: str) -> Callable[..., NDArray[np.float64]]:
    """np.stack of lambdify's results, entries on the last axis."""
    function = sp.lambdify(*_in_plain_symbols(motion, name), "numpy", cse=True)

    def call(*arrays: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.stack(function(*(column for array in arrays for column in array.T)), -1)

    return call


def of_heyoka(motion: Motion, name: str) -> Callable[..., NDArray[np.float64]] | None:
    """The function of an array (components, orientations); None if heyoka is not installed."""
    if find_spec("heyoka") is None:
        return None
    heyoka: Any = import_module("heyoka")
    symbols, entries = _in_plain_symbols(motion, name)
    variables = heyoka.make_vars(*map(str, symbols))
    function: Callable[..., NDArray[np.float64]] = heyoka.cfunc(
        [heyoka.from_sympy(entry) for entry in entries], variables
    )
    return function


def _in_plain_symbols(motion: Motion, name: str) -> tuple[list[sp.Symbol], list[sp.Expr]]:
    """The inputs of a quantity as symbols, and its entries in them."""
    step = motion.step(name)
    given = [s for vector in step.quantity.inputs for s in motion.argument(vector).symbols]
    plain = {symbol: sp.Symbol(f"v{k}") for k, symbol in enumerate(given)}
    return list(plain.values()), list(step.expression.xreplace(plain))


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
    tables, smallest = [], dict.fromkeys(targets, 0.0)
    worst: dict[str, tuple[float, int]] = {}  # the largest ratio to the peer of LIMITS, and where
    for name, symbol in QUANTITIES.items():
        lambdified, compiled = stacked(motion, name), of_heyoka(motion, name)
        peers = [PEER, *([HEYOKA] if compiled else [])]
        for layout, arranged in LAYOUTS.items():
            rows: list[tuple[Cell, ...]] = []
            for size in (s for s in SIZES if s <= settings.size):
                progress(f"{symbol}, {layout}, {size}")
                inputs = motion.step(name).quantity.inputs
                random = np.random.default_rng(1)
                arrays = [arranged(random.uniform(-3, 3, (size, 3))) for _ in inputs]
                sides: dict[str, Call] = {PEER: partial(lambdified, *arrays)}
                if compiled:
                    by_component = np.array([column for a in arrays for column in a.T])
                    sides[HEYOKA] = partial(compiled, by_component)
                sides |= {t: partial(getattr(modules[t], name), *arrays) for t in targets}
                timed = interleaved(
                    {side: partial(seconds, call) for side, call in sides.items()},
                    settings.repeats or REPEATS,
                )
                rows.append(_row(size, timed, peers, targets))
                for target, peer in LIMITS.items():
                    if target in timed and peer in timed:
                        found = ratios(timed[target], timed[peer]).middle
                        worst[target] = max(worst.get(target, (0.0, 0)), (found, size))
                if size == 1:
                    least = {t: Spread.of(timed[t]).middle for t in targets}
                    smallest = {t: max(smallest[t], least[t]) for t in targets}
            columns = [Column("orientations", "d"), *(Column(f"{p}, µs", ".2f") for p in peers)]
            for target in targets:
                columns.append(Column(f"{target}, µs", ".2f"))
                columns += [Column(end, ".2f") for end in ("least", "middle", "most")]
                columns += [Column("of heyoka's", ".2f")] if compiled else []
            tables.append(Table(f"{symbol}, {layout}", tuple(columns), tuple(rows)))
    progress()
    shown = [row for row in tables[0].rows if row[0] in DOCUMENTED]
    heads = ("orientations, µs a call", "lambdify", *targets)
    documented = Table(
        tables[0].title,
        (Column(heads[0], "d"), *(Column(head, ".1f") for head in heads[1:])),
        tuple((size, peer, *rest[::4]) for size, peer, *rest in shown),
    )
    return Report(
        title="Sizes: time of one call, and as a part of lambdify's",
        tables=tuple(tables),
        figures=(
            *(_figure(t, smallest[t]) for t in targets if t in MOST),
            *(_limit(t, *worst[t]) for t in LIMITS if t in worst),
        ),
        notes=(
            "Least, middle and most: of the ratios to lambdify's time, turn by turn. The ratio to "
            f"heyoka's time is the middle one. Processor: {machine()['processor']}.",
        ),
        documented=documented,
    )


def _row(
    size: int, timed: Mapping[str, list[float]], peers: list[str], targets: list[str]
) -> tuple[Cell, ...]:
    cells: list[Cell] = [size, *(Spread.of(timed[peer]).middle * 1e6 for peer in peers)]
    for target in targets:
        cells += [Spread.of(timed[target]).middle * 1e6]
        cells += ratios(timed[target], timed[PEER]).in_order()
        cells += [ratios(timed[target], timed[peer]).middle for peer in peers[1:]]
    return tuple(cells)


def _figure(target: str, found: float) -> Figure:
    most = MOST[target]
    return Figure(
        f"one orientation by {target}",
        f"at most {most * 1e6:g} µs",
        f"{found * 1e6:.2f} µs",
        found <= most,
    )


def _limit(target: str, ratio: float, size: int) -> Figure:
    return Figure(
        f"{target} at every size",
        f"at most 1 of the time of {LIMITS[target]}",
        f"{ratio:.2f} at {size}",
        ratio <= 1,
    )
