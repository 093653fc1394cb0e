"""Kernels beside their peers: `kernels` at large batches, `sizes` from one orientation up.

All sides compute the same values in float64 on one core, by turns. Ours take one orientation a
row, or a column. A user without us writes np.stack of lambdify's functions (cse) of the columns;
heyoka's compiled function takes one component a row, its own layout. A plain copy of as many bytes
is the limit that memory sets. `sizes --size 10000000` goes up to ten million.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cache, partial
from importlib import import_module
from importlib.util import find_spec
from time import perf_counter
from types import ModuleType
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from benchmarks.measure import Settings, Spread, interleaved, on_one_core, progress, ratios, timed
from benchmarks.report import Cell, Column, Figure, Report, Table, machine, spread_columns
from rigidsym.kernels.targets import TARGETS
from rigidsym.motion import Motion, derive

QUANTITIES = {
    "angular_velocity_body": "Ω′",
    "rotation_matrix": "R",
    "rates_from_angular_velocity_body": "inverse rates",
}
OURS = ("numpy", "c", "numba", "jax")
PEER, HEYOKA, SCIPY = "lambdify, cse, stacked", "heyoka cfunc", "SciPy from_euler"
COPY = "a plain copy of as many bytes"
SIZES = (*(m * 10**k for k in range(7) for m in (1, 3)), 10**7)
LAYOUTS: Mapping[str, Any] = {"rows": np.ascontiguousarray, "columns": np.asfortranarray}
FILLED = "rows, out given"
DOCUMENTED = (1, 100, 10**4, 10**6)  # of the table in the README, and with `out`
MOST = {"numpy": 12e-6, "c": 1.5e-6}  # seconds of the smallest call
LIMITS = (  # of the time of a peer, from which size up
    ("numpy", PEER, 1, 1.0),
    ("c", HEYOKA, 1, 1.0),
    ("c", HEYOKA, 10**4, 0.8),
)
LARGE = (("numpy", PEER, 3.0), ("c", HEYOKA, 1.0))  # times as fast, at large batches
_TURN = 1e-3  # seconds of a turn: a short call is repeated until it lasts as long

Array = NDArray[np.float64]
Call = Callable[[], Any]
Turns = Mapping[str, Sequence[float]]  # seconds of a call of each side, turn by turn


@cache
def motion() -> Motion:
    return derive("ZXZ", list(QUANTITIES))


@cache
def modules() -> Mapping[str, ModuleType]:
    return {t: motion().kernels(t).load() for t in OURS if not TARGETS[t].missing}


def in_plain_symbols(motion: Motion, name: str) -> tuple[list[sp.Symbol], list[sp.Expr]]:
    """The inputs of a quantity as symbols, and its entries in them, written out.

    The peers know nothing of functions of time and of named intermediate quantities.
    """
    step = motion.step(name)
    entries = list(step.expression)
    for known in reversed(motion.definitions):
        entries = [entry.xreplace({known.symbol: known.expression}) for entry in entries]
    arguments = [motion.argument(vector) for vector in step.quantity.inputs]
    plain = {s: sp.Symbol(n) for a in arguments for s, n in zip(a.symbols, a.names, strict=True)}
    return list(plain.values()), [entry.xreplace(plain) for entry in entries]


@cache
def _lambdified(name: str) -> Callable[..., Any]:
    function: Callable[..., Any] = sp.lambdify(*in_plain_symbols(motion(), name), "numpy", cse=True)
    return function


@cache
def _compiled(name: str) -> Callable[..., Array]:
    heyoka: Any = import_module("heyoka")
    symbols, entries = in_plain_symbols(motion(), name)
    without = [e.replace(sp.cot, lambda angle: sp.cos(angle) / sp.sin(angle)) for e in entries]
    function: Callable[..., Array] = heyoka.cfunc(
        list(map(heyoka.from_sympy, without)), heyoka.make_vars(*map(str, symbols))
    )
    return function


def sides(name: str, size: int, layout: str, *, is_filled: bool) -> dict[str, Call]:
    """A call of each side on the same orientations; raises where one differs in value."""
    random, step = np.random.default_rng(1), motion().step(name)
    arrays = [LAYOUTS[layout](random.uniform(-3, 3, (size, 3))) for _ in step.quantity.inputs]
    columns = [column for a in arrays for column in a.T]
    shape = (size, *(n for n in step.expression.shape if n > 1))
    count = len(step.expression)

    def stacked(out: Array | None = None) -> Array:
        return np.stack(np.broadcast_arrays(*_lambdified(name)(*columns)), -1, out)

    found: dict[str, Call] = {
        PEER: partial(stacked, np.empty((size, count)) if is_filled else None)
    }
    if find_spec("heyoka"):
        room: dict[str, Array] = {"outputs": np.empty((count, size))} if is_filled else {}
        found[HEYOKA] = partial(_compiled(name), np.array(columns), **room)
    for target, module in modules().items():
        out = {"out": np.empty(shape)} if is_filled and target != "jax" else {}
        function = getattr(module, name)
        found[target] = partial(function, *arrays, **out)
        if target == "jax":
            found[target] = _jitted(function, arrays)
    if name == "rotation_matrix" and find_spec("scipy"):
        rotations: Any = import_module("scipy.spatial.transform").Rotation
        found[SCIPY] = lambda: rotations.from_euler("ZXZ", arrays[0]).as_matrix()
    expected = stacked()
    for side, call in found.items():
        values = np.asarray(call())
        values = values.T if side == HEYOKA else values.reshape(size, count)
        if not np.allclose(values, expected, rtol=1e-9, atol=1e-9):
            raise ArithmeticError(f"{name}: {side} differs from lambdify")
    moved = np.ones(size * (len(columns) + count) // 2)
    return {**found, COPY: partial(np.copyto, np.empty_like(moved), moved)}


def _jitted(function: Callable[..., Any], arrays: Sequence[Array]) -> Call:
    jax: Any = import_module("jax")
    jax.config.update("jax_enable_x64", True)
    compiled, given = jax.jit(function), list(map(jax.numpy.asarray, arrays))
    return lambda: jax.block_until_ready(compiled(*given))


def seconds(call: Call) -> float:
    """Of one call, from as many as last a millisecond."""
    count = max(1, int(_TURN / timed(call)))
    start = perf_counter()
    for _ in range(count):
        call()
    return (perf_counter() - start) / count


def measured(name: str, size: int, repeats: int, layout: str = "rows", **options: bool) -> Turns:
    progress(f"{name}, {layout}, {size}")
    calls = sides(name, size, layout, **options)
    return interleaved({side: partial(seconds, call) for side, call in calls.items()}, repeats)


# large batches


def run(settings: Settings) -> Report:
    """Every side, Ω′ and R, with `out` given: medians, then ratios turn by turn."""
    repeats = settings.repeats or 15
    with on_one_core():
        cases = {
            (size, name): measured(name, size, repeats, is_filled=True)
            for size in (settings.size, settings.size // 10)
            for name in ("angular_velocity_body", "rotation_matrix")
        }
    return report(cases)


def report(cases: Mapping[tuple[int, str], Turns]) -> Report:
    heads = {key: f"{QUANTITIES[key[1]]} at {key[0]:.0e}".replace("e+0", "e") for key in cases}
    order = (*OURS, PEER, HEYOKA, SCIPY, COPY)
    there = [side for side in order if any(side in turns for turns in cases.values())]
    medians = Table(
        "Medians, one core",
        (Column("ns an orientation"), *(Column(head, ".1f") for head in heads.values())),
        tuple(
            (
                f"rigidsym {side}" if side in OURS else side,
                *(
                    Spread.of(turns[side]).middle / size * 1e9 if side in turns else None
                    for (size, _), turns in cases.items()
                ),
            )
            for side in there
        ),
    )
    rows: list[tuple[Cell, ...]] = [
        (heads[key], above, below, *ratios(turns[above], turns[below]).in_order())
        for key, turns in cases.items()
        for below in ("numpy", "c")
        for above in there
        if above != below and above in turns and below in turns
    ]
    titles = (Column("case"), Column("time of"), Column("over ours"), *spread_columns("ratio", 2))
    figures = [
        Figure(
            f"{heads[key]}: {ours} against {peer}",
            f"at least {least:g} times as fast",
            "{1:.2f} times ({0:.2f} to {2:.2f})".format(*spread.in_order()),
            spread.middle >= least,
        )
        for key, turns in cases.items()
        for ours, peer, least in LARGE
        if ours in turns and peer in turns
        for spread in [ratios(turns[peer], turns[ours])]
    ]
    return Report(
        title="Kernels: one core, float64, ZXZ",
        tables=(medians, Table("Ratios, turn by turn", titles, tuple(rows))),
        figures=tuple(figures),
        documented=medians,
    )


# sizes


def sizes(settings: Settings) -> Report:
    """Every size up to that of the settings, in both layouts, and with `out` given."""
    tables, cases = [], []
    with on_one_core():
        for name, symbol in QUANTITIES.items():
            for layout, is_filled in (("rows", False), ("columns", False), ("rows", True)):
                chosen = DOCUMENTED if is_filled else SIZES
                found = {
                    size: measured(name, size, settings.repeats or 11, layout, is_filled=is_filled)
                    for size in chosen
                    if size <= settings.size
                }
                tables.append(_table(f"{symbol}, {FILLED if is_filled else layout}", found))
                cases.append(found)
    progress()
    return Report(
        title="Sizes: time of one call on one core, and as a part of its peers'",
        tables=tuple(tables),
        figures=(*_smallest(cases), *_limits(cases)),
        notes=(f"Ratios are turn by turn. Processor: {machine()['processor']}.",),
        documented=documented("Ω′, rows", cases[0]),
    )


def documented(title: str, found: Mapping[int, Turns]) -> Table:
    """Shortest times of every side, which other work disturbs least, for the README."""
    measured = next(iter(found.values()))
    shown = [side for side in (PEER, HEYOKA, "numpy", "c", "numba") if side in measured]
    heads = [{PEER: "lambdify", HEYOKA: "heyoka"}.get(side, side) for side in shown]
    rows: list[tuple[Cell, ...]] = [
        (size, *(f"{float(f'{min(turns[side]) * 1e6:.3g}'):,.9g}" for side in shown))
        for size, turns in found.items()
        if size in DOCUMENTED
    ]
    first = f"{title}: orientations, µs a call on one core, {machine()['processor']}"
    return Table(title, (Column(first, ",d"), *map(Column, heads)), tuple(rows))


def _table(title: str, found: Mapping[int, Turns]) -> Table:
    """Medians of all sides, and the ratios of ours to both peers with their spread."""
    measured = list(next(iter(found.values())))
    pairs = [(t, p) for t in ("numpy", "c", "numba") for p in (PEER, HEYOKA)]
    pairs = [(t, p) for t, p in pairs if t in measured and p in measured]
    columns = [Column("orientations", ",d"), *(Column(f"{side}, µs", ",.2f") for side in measured)]
    for target, peer in pairs:
        columns += [Column(f"{target}/{peer.partition(',')[0]}", ".2f"), *[Column("", ".2f")] * 2]
    rows = []
    for size, turns in found.items():
        cells: list[Cell] = [size, *(Spread.of(turns[side]).middle * 1e6 for side in measured)]
        for target, peer in pairs:
            cells += ratios(turns[target], turns[peer]).in_order()
        rows.append(tuple(cells))
    return Table(title, tuple(columns), tuple(rows))


def _smallest(cases: Sequence[Mapping[int, Turns]]) -> Iterator[Figure]:
    for target, most in MOST.items():
        found = max((Spread.of(c[1][target]).middle for c in cases if target in c[1]), default=0)
        name, goal = f"one orientation by {target}", f"at most {most * 1e6:g} µs"
        yield Figure(name, goal, f"{found * 1e6:.2f} µs", found <= most)


def _limits(cases: Sequence[Mapping[int, Turns]]) -> Iterator[Figure]:
    """The largest middle ratio from a size up, where both sides were measured."""
    for target, peer, least, most in LIMITS:
        found = [
            (ratios(turns[target], turns[peer]).middle, size)
            for case in cases
            for size, turns in case.items()
            if size >= least and target in turns and peer in turns
        ]
        if found:
            ratio, size = max(found)
            name = f"{target} at every size" + (f" from {least:,} up" if least > 1 else "")
            goal = f"at most {most:g} of the time of {peer}"
            yield Figure(name, goal, f"{ratio:.2f} at {size:,}", ratio <= most)
