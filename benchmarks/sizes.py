"""Time of one call of Ω′ and R of ZXZ at every size from 1 to 10 million, in both layouts.

The peer is what a user writes without us: np.stack of lambdify's functions (cse) of the columns.
All sides take turns; a turn repeats a short call until it lasts about a millisecond.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from time import perf_counter

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from benchmarks.measure import Settings, Spread, interleaved, progress, ratios
from benchmarks.report import Cell, Column, Figure, Report, Table
from rigidsym.kernels.targets import TARGETS
from rigidsym.motion import Motion, derive

SIZES = (*(m * 10**k for k in range(7) for m in (1, 3)), 10**7)
QUANTITIES = {"angular_velocity_body": "Ω′", "rotation_matrix": "R"}
LAYOUTS = {"rows": np.ascontiguousarray, "columns": np.asfortranarray}
DOCUMENTED = (1, 100, 10**4, 10**6)  # of the table in the README
PEER, REPEATS = "lambdify, cse, stacked", 15
MOST = {"numpy": 12e-6, "c": 1.5e-6}  # seconds of the smallest call
_TURN = 1e-3  # seconds

Call = Callable[[], object]


def stacked(motion: Motion, name: str) -> Callable[..., NDArray[np.float64]]:
    """np.stack of lambdify's results, entries on the last axis."""
    step = motion.step(name)
    given = [s for vector in step.quantity.inputs for s in motion.argument(vector).symbols]
    plain = {symbol: sp.Dummy() for symbol in given}
    function = sp.lambdify(
        list(plain.values()), list(step.expression.xreplace(plain)), "numpy", cse=True
    )

    def call(*arrays: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.stack(function(*(column for array in arrays for column in array.T)), -1)

    return call


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
    """Every size up to ten times that of the settings."""
    motion = derive("ZXZ", list(QUANTITIES))
    targets = [name for name in ("numpy", "c", "numba") if not TARGETS[name].missing]
    modules = {target: motion.kernels(target).load() for target in targets}
    tables, smallest = [], dict.fromkeys(targets, 0.0)
    for name, symbol in QUANTITIES.items():
        for layout, arranged in LAYOUTS.items():
            rows: list[tuple[Cell, ...]] = []
            for size in (s for s in SIZES if s <= 10 * settings.size):
                progress(f"{symbol}, {layout}, {size}")
                inputs = motion.step(name).quantity.inputs
                random = np.random.default_rng(1)
                arrays = [arranged(random.uniform(-3, 3, (size, 3))) for _ in inputs]
                sides: dict[str, Call] = {PEER: partial(stacked(motion, name), *arrays)}
                sides |= {t: partial(getattr(modules[t], name), *arrays) for t in targets}
                timed = interleaved(
                    {side: partial(seconds, call) for side, call in sides.items()},
                    settings.repeats or REPEATS,
                )
                rows.append(_row(size, timed, targets))
                if size == 1:
                    least = {t: Spread.of(timed[t]).middle for t in targets}
                    smallest = {t: max(smallest[t], least[t]) for t in targets}
            columns = [Column("orientations", "d"), Column(f"{PEER}, µs", ".2f")]
            for target in targets:
                columns.append(Column(f"{target}, µs", ".2f"))
                columns += [Column(end, ".2f") for end in ("least", "middle", "most")]
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
        figures=tuple(_figure(t, smallest[t]) for t in targets if t in MOST),
        notes=("Least, middle and most: of the ratios to lambdify's time, turn by turn.",),
        documented=documented,
    )


def _row(size: int, timed: Mapping[str, list[float]], targets: list[str]) -> tuple[Cell, ...]:
    cells: list[Cell] = [size, Spread.of(timed[PEER]).middle * 1e6]
    for target in targets:
        found = ratios(timed[target], timed[PEER])
        cells += [Spread.of(timed[target]).middle * 1e6, *found.in_order()]
    return tuple(cells)


def _figure(target: str, found: float) -> Figure:
    most = MOST[target]
    return Figure(
        f"one orientation by {target}",
        f"at most {most * 1e6:g} µs",
        f"{found * 1e6:.2f} µs",
        found <= most,
    )
