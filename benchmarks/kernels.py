"""Kernels beside their peers: `kernels` at large batches, `sizes` from one orientation up.

All sides compute the same values in float64 on one core, by turns. Ours take one orientation a
row, or a column. A user without us writes np.stack of lambdify's functions (cse) of the columns;
heyoka's compiled function takes one component a row, its own layout. A plain copy of as many bytes
is the limit that memory sets. `sizes` goes up to two million rows, or to those of `--size`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cache, partial
from importlib import import_module
from importlib.util import find_spec
from statistics import median
from time import process_time
from types import ModuleType
from typing import Any, NamedTuple

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from benchmarks.measure import Settings, Spread, interleaved, on_one_core, progress, ratios
from benchmarks.report import Cell, Column, Figure, Report, Table, machine
from rigidsym.kernels.targets import TARGETS
from rigidsym.models.body import principal_moments
from rigidsym.motion import Motion, derive

QUANTITIES = ("angular_velocity_body", "rotation_matrix", "rates_from_angular_velocity_body")
SYMBOLS = {
    **dict(zip(QUANTITIES, ("Ω′", "R", "inverse rates"), strict=True)),
    "from_quaternion": "angles from quaternion",
    "state_derivative": "right-hand side of a top",
}
TOP = {"A": 1.3, "C": 0.7, "g": 9.81, "l": 0.4, "m": 2.0}
OURS = ("numpy", "numba", "c", "jax")  # between lambdify and heyoka, by turns: peers are adjacent
PEER, HEYOKA, SCIPY = "lambdify, cse, stacked", "heyoka cfunc", "SciPy from_euler"
COPY = "a plain copy of as many bytes"
SIZES = tuple(map(int, (1, 10, 100, 1e3, 1e4, 3e4, 1e5, 2e5, 3e5, 5e5, 1e6, 2e6, 1e7)))
PLACES: Mapping[str, tuple[str, Mapping[str, bool]]] = {
    "rows": ("rows", {}),
    "columns": ("columns", {}),
    "rows, 8 bytes off": ("rows", {"is_aligned": False}),
    "columns, 8 bytes off": ("columns", {"is_aligned": False}),
    "rows, out given": ("rows", {"is_filled": True}),
}
DOCUMENTED = (1, 100, 10**4, 10**6)  # of the table in the README, and with `out`
MOST = {"numpy": 12e-6, "c": 1.5e-6}  # seconds of the smallest call, by its shortest time
LIMITS = (("numpy", PEER, 1.0), ("c", HEYOKA, 0.9), ("numba", "numpy", 1.0))  # of a peer's time
MOST_FLAT, FROM = 1.35, 10**4  # slowest over fastest size, from this size on
FLAT = f" as a part of its time at {FROM:,} rows"
LARGE = (("numpy", PEER, 3.0), ("c", HEYOKA, 1.0))  # times as fast, at large batches
_TURN = 3e-4  # seconds of a turn: a short call is repeated until it lasts as long
_PAIRS = 51  # turns of two sizes

Array = NDArray[np.float64]
Call = Callable[[], Any]
Turns = Mapping[str, Sequence[float]]  # seconds of a call of each side, turn by turn


class Case(NamedTuple):
    """A function whose arguments are rows of numbers in some widths, beside constants."""

    symbol: str
    motion: Motion
    widths: tuple[int, ...]
    entries: tuple[sp.Expr, ...]  # what it computes, for the peers, in the columns
    columns: tuple[sp.Symbol, ...]
    shape: tuple[int, ...]
    before: tuple[Any, ...] = ()  # arguments that are the same for all orientations
    after: tuple[Any, ...] = ()

    @property
    def bytes(self) -> int:
        """Of the arguments and results of one orientation."""
        return 8 * (sum(self.widths) + len(self.entries))


@cache
def case(name: str) -> Case:
    """Quantities of ZXZ, its angles from a quaternion, or the equations of a heavy top."""
    symbol = SYMBOLS[name]
    if name == "state_derivative":
        return _top(symbol)
    motion = derive("ZXZ", QUANTITIES)
    if name == "from_quaternion":  # as textbooks read them off R, between -pi and pi
        w, x, y, z = columns = sp.symbols("w x y z")
        theta = 2 * sp.atan2(sp.sqrt(x**2 + y**2), sp.sqrt(w**2 + z**2))
        phi, psi = (sp.atan2(x * z + s * w * y, w * x - s * y * z) for s in (1, -1))
        return Case(symbol, motion, (4,), (phi, theta, psi), columns, (3,))
    step = motion.step(name)
    vectors = [motion.argument(vector) for vector in step.quantity.inputs]
    plain = {s: sp.Symbol(n) for a in vectors for s, n in zip(a.symbols, a.names, strict=True)}
    entries = motion.spelled(step.expression).xreplace(plain)
    shape = tuple(n for n in step.expression.shape if n > 1)
    widths = tuple(len(a.symbols) for a in vectors)
    return Case(symbol, motion, widths, (*entries,), (*plain.values(),), shape)


def _top(symbol: str) -> Case:
    a, c = sp.symbols("A C")
    body = principal_moments(a, a, c)
    motion = derive("ZXZ", ["state_derivative"], body=body, potential="m*g*l*cos(theta)")
    constants, columns = motion.argument("parameters"), sp.symbols("y0:6")
    values = [TOP.get(name, 1.0) for name in constants.names]
    plain = dict(zip(constants.symbols, map(sp.Float, values), strict=True))
    plain |= dict(zip(reversed(motion.argument("y").symbols), reversed(columns), strict=True))
    entries = (*motion.state_derivative.xreplace(plain),)
    return Case(symbol, motion, (6,), entries, columns, (6,), (0.0,), (np.array(values),))


@cache
def modules(name: str) -> Mapping[str, ModuleType]:
    motion, is_conversion = case(name).motion, name == "from_quaternion"
    return {
        t: motion.kernels(t, conversions=is_conversion).load()
        for t in OURS
        if not TARGETS[t].missing
    }


@cache
def _lambdified(name: str) -> Callable[..., Any]:
    entries, columns = case(name).entries, case(name).columns
    function: Callable[..., Any] = sp.lambdify(columns, entries, "numpy", cse=True)
    return function


@cache
def _compiled(name: str) -> Callable[..., Array]:
    heyoka: Any = import_module("heyoka")
    without = [e.replace(sp.cot, lambda a: sp.cos(a) / sp.sin(a)) for e in case(name).entries]
    function: Callable[..., Array] = heyoka.cfunc(
        list(map(heyoka.from_sympy, without)), heyoka.make_vars(*map(str, case(name).columns))
    )
    return function


def placed(values: Array, layout: str, *, is_aligned: bool) -> Array:
    """The values by rows or by columns, from the start of a line of the cache or 8 bytes behind."""
    room = np.empty(values.size + 9)
    start = -room.ctypes.data % 64 // 8 + (not is_aligned)
    flat = room[start : start + values.size]
    result = flat.reshape(values.shape) if layout == "rows" else flat.reshape(values.T.shape).T
    result[...] = values
    return result


def sides(
    name: str,
    size: int,
    layout: str,
    *,
    is_filled: bool = False,
    is_aligned: bool = True,
    is_large: bool = False,
) -> dict[str, Call]:
    """A call of each side on the same orientations; raises where one differs in value."""
    of, random, count = case(name), np.random.default_rng(1), len(case(name).entries)
    arrays = [
        placed(random.uniform(0.3, 3, (size, n)), layout, is_aligned=is_aligned) for n in of.widths
    ]
    arguments = (*of.before, *arrays, *of.after)
    columns = [column for a in arrays for column in a.T]

    def stacked(out: Array | None = None) -> Array:
        return np.stack(np.broadcast_arrays(*_lambdified(name)(*columns)), -1, out)

    calls: dict[str, Call] = {
        PEER: partial(stacked, np.empty((size, count)) if is_filled else None)
    }
    for target, module in modules(name).items():
        if target == "jax" and not is_large:
            continue  # it compiles anew for every size
        out = {"out": np.empty((size, *of.shape))} if is_filled and target != "jax" else {}
        whole = partial(getattr(module, name), *arguments, **out)
        calls[target] = _jitted(whole.func, arguments) if target == "jax" else whole
    if find_spec("heyoka"):
        room: dict[str, Array] = {"outputs": np.empty((count, size))} if is_filled else {}
        calls[HEYOKA] = partial(_compiled(name), np.array(columns), **room)
    if name == "rotation_matrix" and is_large and find_spec("scipy"):
        rotations: Any = import_module("scipy.spatial.transform").Rotation
        calls[SCIPY] = lambda: rotations.from_euler("ZXZ", arrays[0]).as_matrix()
    expected = stacked()
    for side, call in calls.items():
        values = np.asarray(call())
        difference = (values.T if side == HEYOKA else values.reshape(size, count)) - expected
        if not np.all(np.abs(difference) <= 1e-9 * (1 + np.abs(expected))):
            raise ArithmeticError(f"{name}: {side} differs from lambdify")
    moved = np.ones(size * of.bytes // 16)
    return {**calls, COPY: partial(np.copyto, np.empty_like(moved), moved)}


def _jitted(function: Callable[..., Any], arrays: Sequence[Array]) -> Call:
    jax: Any = import_module("jax")
    jax.config.update("jax_enable_x64", True)
    compiled, given = jax.jit(function), list(map(jax.numpy.asarray, arrays))
    return lambda: jax.block_until_ready(compiled(*given))


def seconds(call: Call) -> float:
    """Of the processor, which others may share: of one call, from as many as last a turn."""
    start = process_time()
    call()
    count = max(1, int(_TURN / max(process_time() - start, 1e-7)))
    start = process_time()
    for _ in range(count):
        call()
    return (process_time() - start) / count


def measured(name: str, size: int, repeats: int, layout: str = "rows", **options: bool) -> Turns:
    """Seconds of a call of each side, and of c and the copy the ratio to a call of `FROM` rows.

    That call is made by turns with the other: if others share the processor, its speed changes by
    a half within milliseconds, and sizes that are measured one after the other differ by as much.
    """
    progress(f"{name}, {layout}, {size}")
    calls = sides(name, size, layout, **options)
    turns = interleaved({side: partial(seconds, call) for side, call in calls.items()}, repeats)
    is_flat = size > FROM and "c" in calls and not options.get("is_large")
    for side in ("c", COPY) if is_flat else ():
        first = sides(name, FROM, layout, **options)[side]
        pair = {"this": partial(seconds, calls[side]), "first": partial(seconds, first)}
        each = interleaved(pair, _PAIRS)
        turns[side + FLAT] = [a / b for a, b in zip(each["this"], each["first"], strict=True)]
    return turns


# large batches


def run(settings: Settings) -> Report:
    """Every side, Ω′ and R, with `out` given."""
    repeats, most = settings.repeats or 15, settings.size or 10**6
    with on_one_core():
        cases = {
            (size, name): measured(name, size, repeats, is_filled=True, is_large=True)
            for size in (most, most // 10)
            for name in ("angular_velocity_body", "rotation_matrix")
        }
    return report(cases)


def report(cases: Mapping[tuple[int, str], Turns]) -> Report:
    heads = {key: f"{SYMBOLS[key[1]]} at {key[0]:.0e}".replace("e+0", "e") for key in cases}
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
        tables=(medians,),
        figures=tuple(figures),
        documented=medians,
    )


# sizes


def sizes(settings: Settings) -> Report:
    """Every size up to the largest asked for, by rows and by columns, aligned and not."""
    cases: dict[str, dict[int, Turns]] = {}
    with on_one_core():
        for name, symbol in SYMBOLS.items():
            for place, (layout, options) in PLACES.items():
                cases[f"{symbol}, {place}"] = {
                    size: measured(name, size, settings.repeats or repeats, layout, **options)
                    for size in SIZES
                    for repeats in [max(7, min(151, 10**6 // size))]  # for ten minutes in all
                    if size <= (settings.size or 2 * 10**6)
                }
    progress()
    return Report(
        title="Sizes: time of one call on one core, and as a part of its peers'",
        tables=tuple(_table(title, turns) for title, turns in cases.items()),
        figures=(*_smallest([*cases.values()]), *_limits(cases), *_flat(cases)),
        notes=(f"Ratios are turn by turn. Processor: {machine()['processor']}.",),
        documented=documented("Ω′, rows", cases["Ω′, rows"]),
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
    pairs.append(("c", COPY))  # c cannot be flat over the sizes where a plain copy is not
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
        found = max((min(c[1][target]) for c in cases if target in c[1]), default=0)
        name, goal = f"one orientation by {target}", f"at most {most * 1e6:g} µs"
        yield Figure(name, goal, f"{found * 1e6:.2f} µs", found <= most)


def _limits(cases: Mapping[str, Mapping[int, Turns]]) -> Iterator[Figure]:
    """The largest middle ratio of all sizes and places."""
    for target, peer, most in LIMITS:
        middles = [
            (ratios(turns[target], turns[peer]).middle, f"{title}, {size:,}")
            for title, sized in cases.items()
            for size, turns in sized.items()
            if target in turns and peer in turns
        ]
        if middles:
            ratio, where = max(middles)
            goal = f"at most {most:g} of the time of {peer}"
            yield Figure(f"{target} at every size", goal, f"{ratio:.2f}: {where}", ratio <= most)


def _flat(cases: Mapping[str, Mapping[int, Turns]]) -> Iterator[Figure]:
    """The slowest size over the fastest, by the middle ratios to the time at `FROM` rows."""
    for title, sized in cases.items():
        large = {size: turns for size, turns in sized.items() if f"c{FLAT}" in turns}
        each = {
            side: [1.0, *(median(t[side + FLAT]) * FROM / n for n, t in large.items())]
            for side in ("c", COPY)
        }
        c, copy = (max(ratios) / min(ratios) for ratios in each.values())
        if large:
            name, goal = f"c from {FROM:,} on: {title}", f"at most {MOST_FLAT:g} from size to size"
            yield Figure(name, goal, f"{c:.2f}; a plain copy {copy:.2f}", c <= MOST_FLAT)
