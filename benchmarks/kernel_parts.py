"""What there is to measure of kernels beside their speed on large batches, each a table or two."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from hashlib import sha256
from pathlib import Path
from time import perf_counter
from types import ModuleType
from typing import Any

import numpy as np
import sympy as sp

import rigidsym
from benchmarks.accuracy import SYMBOLS, angle_groups, exact, largest_error
from benchmarks.measure import Spread, interleaved, peak_memory, progress, ratios, timed
from benchmarks.peers import PEERS, Array, Task, in_plain_symbols
from benchmarks.report import Cell, Column, Figure, Table, spread_columns
from rigidsym.kernels.lowering.lower import lower
from rigidsym.kernels.targets import TARGETS
from rigidsym.kernels.targets.text.remarks import count
from rigidsym.motion import Motion, derive
from rigidsym.system.resources import folder

BODY = "angular_velocity_body"
CALLS = 500  # of a small function, timed together
TURNS = 8
GROWN = ("lambdify, cse", "JAX jit", "heyoka cfunc")
SEQUENCES = ("ZXZ", "ZYX", "xyz")  # whose errors are taken
MEGABYTE = 1e6
GROUPS = ("random in ±π", "multiples of π/2", "tiny", "random in ±1e4")

CONTROL = 1 << 26  # bytes that the controls of threads work on

Part = tuple[list[Table], list[Figure]]


def calls(motion: Motion, modules: Mapping[str, ModuleType], repeats: int) -> Part:
    """One orientation: scalar twins, the array interface, and what peers take for it."""
    point = [0.3, 0.7, -0.4, 0.1, 0.2, 0.5]
    q, q_dot = np.array(point[:3]), np.array(point[3:])
    actions: dict[str, Callable[[], Any]] = {}
    for name, module in modules.items():
        if hasattr(module, f"{BODY}_scalar"):
            actions[f"{name}, scalar twin"] = partial(getattr(module, f"{BODY}_scalar"), *point)
            actions[f"{name}, arrays"] = partial(getattr(module, BODY), q, q_dot)
    symbols, entries = in_plain_symbols(motion, BODY)
    actions["lambdify math, cse"] = partial(
        sp.lambdify(symbols, entries, modules="math", cse=True), *point
    )
    task = Task(symbols, entries, np.array([point]))
    for name in ("heyoka cfunc", "CasADi map"):
        if PEERS[name].is_there:
            actions[name] = PEERS[name].make(task).call
    if PEERS["SciPy from_euler"].is_there:
        from scipy.spatial.transform import Rotation

        actions["SciPy from_euler, R"] = lambda: Rotation.from_euler("ZXZ", q).as_matrix()
    times = interleaved({name: partial(_many, call) for name, call in actions.items()}, repeats)
    rows = tuple((name, *Spread.of(t).in_order(1e6)) for name, t in times.items())
    table = Table("One call, one orientation, Ω′", (Column("side"), *spread_columns("µs", 2)), rows)
    figures = []
    for name in modules:
        if f"{name}, arrays" in times:
            twin = ratios(times[f"{name}, scalar twin"], times["lambdify math, cse"]).middle
            single = Spread.of(times[f"{name}, arrays"]).middle * 1e6
            figures += [
                _most(f"scalar twin of {name} over lambdify math, cse", twin, 1.2, "times"),
                _most(f"one call through the arrays of {name}", single, 5.0, "µs"),
            ]
    return [table], figures


def _many(call: Callable[[], Any]) -> float:
    """Seconds of one call, from many."""
    start = perf_counter()
    for _ in range(CALLS):
        call()
    return (perf_counter() - start) / CALLS


def threads(modules: Mapping[str, ModuleType], size: int, repeats: int) -> Part:
    """Two threads beside one, and what two processors gain here at arithmetic and at memory."""
    random = np.random.default_rng(0)
    q, q_dot = random.uniform(-3.0, 3.0, (2, size, 3))
    rows: list[tuple[Cell, ...]] = []
    figures = []
    (hashing, _), (copying, copied) = _gain(_hashed, repeats), _gain(_copied, repeats)
    for name, module in modules.items():
        if name == "jax":
            continue
        for quantity, given in ((BODY, [q, q_dot]), ("rotation_matrix", [q])):
            function = getattr(module, quantity)
            out = function(*given)
            actions = {
                str(n): partial(timed, partial(function, *given, out=out, threads=n))
                for n in (1, 2)
            }
            times = interleaved(actions, repeats)
            gain = ratios(times["1"], times["2"])
            moved = (sum(a.nbytes for a in given) + out.nbytes) / Spread.of(times["2"]).middle
            rows.append((name, quantity, *gain.in_order(), moved / 1e9))
            if name in ("numpy", "c"):
                title = f"two threads over one, {name}, {quantity}"
                beside = (
                    f"times, by {moved / 1e9:.0f} GB/s; a plain copy by two threads gains "
                    f"{copying.middle:.2f}, to {copied / 1e9:.0f} GB/s"
                )
                figures.append(_least(title, gain.middle, 1.7, "times", beside))
    rows += [
        ("none", "hashing: the most there is to gain at arithmetic", *hashing.in_order(), None),
        ("none", "a plain copy: what moving gains", *copying.in_order(), copied / 1e9),
    ]
    rate = Column("GB/s by two", ".1f")
    columns = (Column("target"), Column("quantity"), *spread_columns("gain", 2), rate)
    return [Table(f"Two threads, {size:,} orientations", columns, tuple(rows))], figures


def _hashed(content: Array) -> None:
    sha256(content.data)


def _copied(content: Array) -> None:
    np.copyto(content[: len(content) // 2], content[len(content) // 2 :])


def _gain(work: Callable[[Array], None], repeats: int) -> tuple[Spread, float]:
    """What a second thread gains at work on two halves of an array; bytes a second by both."""
    halves = np.split(np.ones(CONTROL // 8), 2)

    def alone() -> None:
        for half in halves:
            work(half)

    with ThreadPoolExecutor(1) as pool:

        def both() -> None:
            other = pool.submit(work, halves[1])
            work(halves[0])
            other.result()

        times = interleaved({"1": partial(timed, alone), "2": partial(timed, both)}, repeats)
    return ratios(times["1"], times["2"]), CONTROL / Spread.of(times["2"]).middle


def memory(modules: Mapping[str, ModuleType], size: int) -> Part:
    """Bytes beyond the outputs at the worst moment of a call."""
    q, q_dot = np.random.default_rng(0).uniform(-3.0, 3.0, (2, size, 3))
    rows: list[tuple[Cell, ...]] = []
    for name, module in modules.items():
        if name != "jax":  # whose memory is not Python's
            for quantity, given in ((BODY, [q, q_dot]), ("rotation_matrix", [q])):
                call = partial(getattr(module, quantity), *given)
                outputs = call().nbytes
                rows.append((name, quantity, (peak_memory(call) - outputs) / MEGABYTE))
    largest = max(float(row[2] or 0) for row in rows if row[0] == "numpy")
    columns = (Column("target"), Column("quantity"), Column("MB beyond the outputs", ".2f"))
    figure = _most("memory of numpy beyond the outputs", largest, 2.0, "MB")
    return [Table("Memory", columns, tuple(rows))], [figure]


def generation(motion: Motion, present: Sequence[str], repeats: int = 3) -> Part:
    """Seconds for the source of all kernels of one convention, and for building the C."""
    rows: list[tuple[Cell, ...]] = []
    figures = []
    for name in TARGETS:
        progress(f"printing {name}")
        seconds = min(timed(partial(motion.kernels, name)) for _ in range(repeats))
        rows.append((f"source for {name}", seconds))
        figures.append(_most(f"source of all kernels, {name}", seconds, 0.3, "s"))
    if "c" in present:
        kernels = motion.kernels("c")
        seconds = min(timed(kernels.load) for _ in range(repeats))
        rows.append(("building the Python module of c", seconds))
        figures.append(_most("building the Python module of c", seconds, 5.0, "s"))
    progress()
    columns = (Column("what"), Column("least s", ".3f"))
    return [Table("Generation, all kernels of ZXZ", columns, tuple(rows))], figures


def chains(repeats: int, size: int) -> Part:
    """Ω′ of chains of 1 to 8 turns: operations, and time beside the peers'."""
    rows: list[tuple[Cell, ...]] = []
    for turns in range(1, TURNS + 1):
        progress(f"{turns} turns")
        rows.append(_chain(turns, repeats, size))
    progress()
    columns = (
        Column("turns"),
        Column("operations"),
        Column("sympy.cse"),
        *(Column(f"{name} ns", ".1f") for name in ("numpy", "c", *GROWN)),
    )
    return [Table(f"Growth: Ω′ of chains, {size:,} orientations", columns, tuple(rows))], []


def _chain(turns: int, repeats: int, size: int) -> tuple[Cell, ...]:
    names = [f"a{k}" for k in range(1, turns + 1)]
    motion = derive(
        " ".join(f"{'zxy'[k % 3]}({name})" for k, name in enumerate(names)), only=[BODY]
    )
    points = np.random.default_rng(turns).uniform(-3.0, 3.0, (size, 2 * turns))
    symbols, entries = in_plain_symbols(motion, BODY)
    task = Task(symbols, entries, points)
    actions: dict[str, Callable[[], Any]] = {}
    halves = [np.ascontiguousarray(half) for half in np.split(points, 2, axis=1)]
    for name in ("numpy", "c"):
        if not TARGETS[name].missing:
            function = getattr(motion.kernels(name).load(), BODY)
            actions[name] = partial(function, *halves, out=function(*halves))
    actions |= {name: PEERS[name].make(task).call for name in GROWN if PEERS[name].is_there}
    timers = {name: partial(timed, call) for name, call in actions.items()}
    times = interleaved(timers, max(3, repeats // 3))
    found = {name: Spread.of(t).middle / size * 1e9 for name, t in times.items()}
    (kernel,) = (k for k in lower(motion).kernels if k.name == BODY)
    shared, left = sp.cse(entries)
    theirs = sum(sp.count_ops(e) for e in [*(value for _, value in shared), *left])
    times_in_order = (found.get(name) for name in ("numpy", "c", *GROWN))
    return (turns, count(kernel.values).total(), int(theirs), *times_in_order)


def errors(present: Sequence[str], samples: int) -> Part:
    """Largest errors of R, Ω and Ω′ in eps of the largest entry, |angle| ≤ 1e4, every target."""
    found: dict[str, dict[str, float]] = {name: {} for name in present}
    for sequence in SEQUENCES:
        motion = derive(sequence, only=list(SYMBOLS))
        modules = {name: motion.kernels(name).load() for name in present}
        for dtype in (np.float64, np.float32):
            for group in GROUPS:
                progress(f"errors of {sequence}, {group}")
                q = angle_groups(dtype, samples)[group]
                rates = np.random.default_rng(1).normal(size=q.shape).astype(dtype)
                truths = [exact(sequence, *both) for both in zip(q, rates, strict=True)]
                for name, quantity in _pairs(present):
                    given = [q, rates][: len(motion.step(quantity).quantity.inputs)]
                    values = np.asarray(getattr(modules[name], quantity)(*given))
                    worst = largest_error(
                        values.reshape(len(q), -1), [truth[quantity] for truth in truths]
                    )
                    key = f"{SYMBOLS[quantity]} {np.dtype(dtype).name}"
                    found[name][key] = max(worst, found[name].get(key, 0.0))
    progress()
    keys = list(next(iter(found.values()), {}))
    rows: list[tuple[Cell, ...]] = [
        (name, *map(worst.__getitem__, keys)) for name, worst in found.items()
    ]
    columns = (Column("target"), *(Column(f"{key}, eps", ".2f") for key in keys))
    figures = [
        _most(f"error of {name}, |angle| ≤ 1e4", max(worst.values()), 4.0, "eps")
        for name, worst in found.items()
    ]
    return [Table("Largest errors against 50 digits", columns, tuple(rows))], figures


def _pairs(present: Sequence[str]) -> Iterator[tuple[str, str]]:
    return ((name, quantity) for name in present for quantity in SYMBOLS)


def sizes_of_targets() -> Part:
    """Lines of the folder and of the templates that are a target."""
    files = Path(rigidsym.__file__).parent / "kernels" / "targets"
    rows: list[tuple[str, int, int, int, int, int]] = []
    for name in TARGETS:
        own = [path for path in files.glob(f"{name}/*.py") if _lines(path)]
        templates = [*folder("templates").glob(f"{name}/*")]
        lines = [sum(map(_lines, paths)) for paths in (own, templates)]
        rows.append((name, len(own), lines[0], len(templates), lines[1], sum(lines)))
    columns = (
        *(Column(text) for text in ("target", "files", "lines", "templates", "their lines", "all")),
    )
    return [Table("Sizes of the targets", columns, tuple(rows))], []


def _lines(path: Path) -> int:
    return len(path.read_text(encoding="utf-8").splitlines())


def figures_of_parts(absent: Sequence[str]) -> list[Figure]:
    """Whether all peers were there."""
    found = f"without {', '.join(absent)}" if absent else "all are here"
    return [Figure("peers in the run", "all", found, not absent)]


def _most(name: str, found: float, most: float, unit: str) -> Figure:
    return Figure(name, f"at most {most:g} {unit}", f"{_short(found)} {unit}", found <= most)


def _least(name: str, found: float, least: float, unit: str, beside: str = "") -> Figure:
    """`beside`: what else was found that says why it is no more."""
    said = f"{_short(found)} {beside or unit}"
    return Figure(name, f"at least {least:g} {unit}", said, found >= least)


def _short(value: float) -> str:
    return f"{value:.3g}" if math.isfinite(value) else "not finite"
