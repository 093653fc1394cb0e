"""Kernels of every target beside their peers: time, threads, memory, generation, growth, errors.

All sides evaluate the same expressions in float64, on one processor core, by turns. Ours take q as
one C-contiguous (N, 3) and fill an `out`; each peer has the layout that it is fastest in.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, partial
from types import ModuleType
from typing import Any

import numpy as np

from benchmarks.kernel_parts import (
    calls,
    chains,
    errors,
    figures_of_parts,
    generation,
    memory,
    sizes_of_targets,
    threads,
)
from benchmarks.measure import (
    Settings,
    Spread,
    interleaved,
    on_one_core,
    progress,
    ratios,
    timed,
)
from benchmarks.node import node_side
from benchmarks.peers import PEERS, Array, Side, Task, in_plain_symbols, jitted
from benchmarks.report import Cell, Column, Figure, Report, Table, spread_columns
from rigidsym.kernels.targets import TARGETS
from rigidsym.motion import Motion, derive

SEQUENCE = "ZXZ"
QUANTITIES = {"angular_velocity_body": "Ω′", "rotation_matrix": "R"}
ARRAYS = ("numpy", "numba", "c", "jax")
OURS = (*ARRAYS, "javascript")  # the last in a process of its own
REPEATS = 15
COPY = "a plain copy of as many bytes"
LAMBDIFY, JAX, HEYOKA = "lambdify, cse", "JAX jit", "heyoka cfunc"


@dataclass(frozen=True, slots=True)
class Outcome:
    """Seconds of each repeat of one case, by side."""

    quantity: str
    size: int
    bytes: int  # read and written, each once
    seconds: Mapping[str, Sequence[float]]

    @property
    def name(self) -> str:
        return f"{QUANTITIES[self.quantity]} at {self.size:.0e}".replace("e+0", "e")

    def ratio(self, above: str, below: str) -> Spread | None:
        """Times of one side over those of another, turn by turn; None where one is missing."""
        if above not in self.seconds or below not in self.seconds:
            return None
        return ratios(self.seconds[above], self.seconds[below])

    def nanoseconds(self, side: str) -> float | None:
        return (
            Spread.of(self.seconds[side]).middle / self.size * 1e9 if side in self.seconds else None
        )


def run(settings: Settings) -> Report:
    """Every case and every part; a line of each that takes long on standard error."""
    sizes = (settings.size, settings.size // 10)
    repeats = settings.repeats or REPEATS
    with on_one_core():
        outcomes = [measure(q, size, repeats) for size in sizes for q in QUANTITIES]
        tables, found = calls(motion(), modules(), repeats)
        grown = chains(repeats, settings.size // 10)
    parts = [
        (tables, found),
        threads(modules(), settings.size, repeats),
        memory(modules(), settings.size),
        generation(motion(), present()),
        grown,
        errors(present(), settings.samples),
        sizes_of_targets(),
    ]
    return report(outcomes, parts)


@cache
def motion() -> Motion:
    return derive(SEQUENCE)


def present() -> list[str]:
    """The targets on arrays that can be loaded here."""
    return [name for name in ARRAYS if name in TARGETS and not TARGETS[name].missing]


@cache
def modules() -> Mapping[str, ModuleType]:
    found = {}
    for name in present():
        progress(f"loading {name}")
        found[name] = motion().kernels(name).load()
    return found


def sides(quantity: str, size: int) -> tuple[dict[str, Side], int]:
    """All sides of one case, and the bytes that it reads and writes."""
    symbols, plain = in_plain_symbols(motion(), quantity)
    points = np.random.default_rng(0).uniform(-3.0, 3.0, (size, len(symbols)))
    task = Task(symbols, plain, points, SEQUENCE)
    found = {name: _ours(module, quantity, points) for name, module in modules().items()}
    if not TARGETS["javascript"].missing:
        batches = np.split(points, points.shape[1] // 3, 1)
        module = motion().kernels("javascript").source
        found["javascript"] = node_side(module, quantity, batches, len(plain))
    for name, peer in PEERS.items():
        if peer.is_there and (quantity == "rotation_matrix" or peer.package != "scipy"):
            progress(f"preparing {name}")
            found[name] = peer.make(task)
    moved = 8 * size * (len(symbols) + len(plain))
    source, target = np.ones(moved // 16), np.ones(moved // 16)
    found[COPY] = Side(lambda: np.copyto(target, source), lambda: target)
    return found, moved


def _ours(module: ModuleType, quantity: str, points: Array) -> Side:
    """A target's function, on (N, 3) arrays and with an `out` where it takes one."""
    batches = [np.ascontiguousarray(part) for part in np.split(points, points.shape[1] // 3, 1)]
    function = getattr(module, quantity)
    if module.__name__.endswith("_jax"):
        return jitted(function, batches)
    out = function(*batches)
    return Side(lambda: function(*batches, out=out), lambda: out.reshape(len(points), -1))


def measure(quantity: str, size: int, repeats: int) -> Outcome:
    """Times of one case; raises where a side differs in value from the first of ours."""
    found, moved = sides(quantity, size)
    first = next(iter(found.values())).values()
    for name, side in found.items():
        side.call()
        if name != COPY and not np.allclose(side.values(), first, rtol=1e-9, atol=1e-9):
            raise ArithmeticError(f"{quantity}: {name} differs from ours")
    actions = {name: partial(timed, side.call) for name, side in found.items()}
    return Outcome(quantity, size, moved, interleaved(actions, repeats, warm_up=2))


Part = tuple[Sequence[Table], Sequence[Figure]]


def report(outcomes: Sequence[Outcome], parts: Sequence[Part] = ()) -> Report:
    """Times, ratios and figures; the first table is that of the documentation."""
    tables = [_table(outcomes), _ratios(outcomes), _bandwidths(outcomes)]
    figures = [*_figures(outcomes)]
    for more, found in parts:
        tables += more
        figures += found
    absent = [name for name, peer in PEERS.items() if not peer.is_there]
    notes = [f"NumPy's vector instructions here: {_vector_instructions()}"]
    notes += [f"not installed, and so not beside: {', '.join(absent)}"] if absent else []
    return Report(
        title="Kernels: one core, float64, ZXZ",
        tables=tuple(tables),
        figures=(*figures, *figures_of_parts(absent)),
        notes=tuple(notes),
        documented=tables[0],
    )


def _table(outcomes: Sequence[Outcome]) -> Table:
    """A side a line, a case a column: medians in nanoseconds an orientation."""
    names = [*OURS, *PEERS, COPY]
    there = [name for name in names if any(name in o.seconds for o in outcomes)]
    ours = {name: f"rigidsym {name}" for name in OURS}
    rows = tuple(
        (ours.get(name, name), *(outcome.nanoseconds(name) for outcome in outcomes))
        for name in there
    )
    columns = (Column("ns an orientation"), *(Column(o.name, ".1f") for o in outcomes))
    return Table("Medians, one core", columns, rows)


def _ratios(outcomes: Sequence[Outcome]) -> Table:
    rows: list[tuple[Cell, ...]] = []
    for outcome in outcomes:
        for below in ("numpy", "c"):
            for above in (*PEERS, *OURS):
                spread = outcome.ratio(above, below)
                if above != below and spread is not None:
                    rows.append((outcome.name, above, below, *spread.in_order()))
    columns = (Column("case"), Column("time of"), Column("over ours"), *spread_columns("ratio", 2))
    return Table("Ratios, turn by turn", columns, tuple(rows))


def _bandwidths(outcomes: Sequence[Outcome]) -> Table:
    rows: list[tuple[Cell, ...]] = []
    for outcome in outcomes:
        limit = outcome.nanoseconds(COPY)
        for name in OURS:
            taken = outcome.nanoseconds(name)
            if taken is not None and limit is not None:
                per = outcome.bytes / outcome.size
                rows.append((outcome.name, name, per / taken, per / limit, taken / limit))
    columns = (
        Column("case"),
        Column("target"),
        Column("GB/s", ".1f"),
        Column("plain copy GB/s", ".1f"),
        Column("times the copy's time", ".1f"),
    )
    return Table("Bytes read and written, each once, a second", columns, tuple(rows))


def _figures(outcomes: Sequence[Outcome]) -> Iterator[Figure]:
    for outcome in outcomes:
        is_large = outcome is outcomes[0] or outcome.size == outcomes[0].size
        if is_large:
            yield _figure(outcome, "numpy", LAMBDIFY, 3.0)
            yield _figure(outcome, "numpy", JAX, 1.0)
        yield _figure(outcome, "c", HEYOKA, 1.0 if is_large else 1.3)


def _figure(outcome: Outcome, ours: str, peer: str, least: float) -> Figure:
    spread = outcome.ratio(peer, ours)
    name, reach = f"{outcome.name}: {ours} against {peer}", f"at least {least:g} times as fast"
    if spread is None:
        return Figure(name, reach, "one of the two is not here", False)
    low, middle, high = spread.in_order()
    found = f"{middle:.2f} times ({low:.2f} to {high:.2f})"
    return Figure(name, reach, found, middle >= least)


def _vector_instructions() -> str:
    """NumPy's sine and tangent are many times faster with some of them."""
    found: Any = np.show_config(mode="dicts")  # typed differently from one NumPy to the next
    extensions = found.get("SIMD Extensions", {})
    return ", ".join([*extensions.get("baseline", []), *extensions.get("found", [])]) or "unknown"
