"""Bodies: every solid integrated and proved; millions of particles, against plain NumPy."""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Callable, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any

import mpmath
import numpy as np
from numpy.typing import NDArray

from benchmarks.measure import Settings, Spread, interleaved, ratios, run_process
from benchmarks.report import Cell, Column, Figure, Report, Table
from rigidsym.data.mass.point_masses import inertia_of

PARTICLES = 10_000_000
MOST_SECONDS = 5.0  # for all solids together
MOST_MEGABYTES = 200  # above the interpreter with NumPy
REPEATS = 5
_PIECE = 500_000
_EPS = float(np.finfo(float).eps)
Array = NDArray[Any]

SOLIDS = """
import sys, time
import rigidsym as rs
from rigidsym.models.solids import SHAPES
steps = ("centre_of_mass", "inertia_tensor")
for name in SHAPES:
    start = time.perf_counter()
    found = rs.derive("ZXZ", steps, body=rs.solid(name))
    print(name, time.perf_counter() - start, found.is_proved)
"""
MEASURED = """
import sys, time
import numpy as np
path, name = sys.argv[1:]
from benchmarks.bodies import FORMULAS
from rigidsym.data.mass.point_masses import inertia_of
def peak():  # of this process alone; what getrusage says is taken over from its parent
    with open("/proc/self/status") as status:
        return next(int(line.split()[1]) for line in status if line.startswith("VmHWM"))
before = peak()
start = time.perf_counter()
inertia_of(path) if name == "rigidsym" else FORMULAS[name](np.load(path, mmap_mode="r"))
print(time.perf_counter() - start, peak() - before)
"""


def textbook(table: Array) -> Array:
    """I = Σ m (r² 1 − r rᵀ) about the centre, as it is printed: with arrays of all particles."""
    m, x = table[:, 0], table[:, 1:]
    r = x - (m[:, None] * x).sum(axis=0) / m.sum()
    square = (m * (r * r).sum(axis=1)).sum()
    return np.asarray(square * np.eye(3) - np.einsum("i,ij,ik->jk", m, r, r))


def products(table: Array) -> Array:
    """The same by matrix products."""
    m, x = table[:, 0], table[:, 1:]
    r = x - m @ x / m.sum()
    second = (r * m[:, None]).T @ r
    return np.asarray(np.trace(second) * np.eye(3) - second)


def about_origin(table: Array) -> Array:
    """About the origin in one pass, then moved to the centre by parallel axes."""
    m, x = table[:, 0], table[:, 1:]
    centre, second = m @ x / m.sum(), (x * m[:, None]).T @ x
    second = second - m.sum() * np.outer(centre, centre)
    return np.asarray(np.trace(second) * np.eye(3) - second)


FORMULAS: Mapping[str, Callable[[Array], Array]] = MappingProxyType(
    {
        "NumPy, as printed": textbook,
        "NumPy, matrix products": products,
        "NumPy, about the origin": about_origin,
    }
)
OURS = "rigidsym"


def run(settings: Settings) -> Report:
    """The tables of solids, of particles, and of errors."""
    count = PARTICLES if settings.size >= Settings().size else settings.size
    solids, seconds, is_proved = _solids()
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "particles.npy"
        _write(path, count)
        found = _measured(path, settings.repeats or REPEATS)
    rows, least, memory = _particles(found)
    errors, worst = _errors()
    return Report(
        title="Bodies",
        tables=(
            Table(
                "every solid: mass, centre and inertia tensor, integrated and proved",
                (Column("solid"), Column("seconds", ".3f"), Column("proved")),
                solids,
            ),
            Table(
                f"M, centre and I of {count} particles from a mapped file, each in a fresh process",
                (
                    Column("way"),
                    Column("seconds, least", ".2f"),
                    Column("middle", ".2f"),
                    Column("most", ".2f"),
                    Column("memory above the interpreter, MB", ".0f"),
                ),
                rows,
            ),
            Table(
                "largest error of I over its largest entry, against 50 digits, in eps",
                (Column("cloud"), *(Column(name, ".3g") for name in (OURS, *FORMULAS))),
                errors,
            ),
        ),
        figures=(
            Figure(
                "every shipped solid derived and proved",
                f"at most {MOST_SECONDS:.0f} s together",
                f"{seconds:.2f} s" + ("" if is_proved else ", not all proved"),
                seconds <= MOST_SECONDS and is_proved,
            ),
            Figure(
                "memory for many particles",
                f"at most {MOST_MEGABYTES} MB above the interpreter",
                f"{memory:.0f} MB",
                memory <= MOST_MEGABYTES,
            ),
            Figure(
                "time beside the textbook formula in NumPy",
                "faster",
                f"{least:.1f} times, at the least",
                least > 1,
            ),
            Figure("error of I", "what the data hold", f"{worst:.1f} eps", worst < 64),
        ),
    )


def _solids() -> tuple[tuple[tuple[Cell, ...], ...], float, bool]:
    lines = [line.split() for line in run_process([sys.executable, "-c", SOLIDS]).splitlines()]
    rows = tuple((name, float(seconds), proved) for name, seconds, proved in lines)
    total = sum(float(seconds) for _, seconds, _ in lines)
    return rows, total, all(proved == "True" for _, _, proved in lines)


def _write(path: Path, count: int) -> None:
    """Masses and places of particles around a place a thousand metres away."""
    random = np.random.default_rng(8)
    table = np.lib.format.open_memmap(path, mode="w+", dtype=float, shape=(count, 4))
    for start in range(0, count, _PIECE):
        rows = table[start : start + _PIECE]
        rows[:, 0] = random.uniform(0.5, 1.5, len(rows))
        rows[:, 1:] = random.normal(size=(len(rows), 3)) + 1000
    table.flush()


def _measured(path: Path, repeats: int) -> dict[str, list[tuple[float, float]]]:
    """{way: [(seconds, megabytes)]}."""

    def once(name: str) -> Callable[[], tuple[float, float]]:
        command = [sys.executable, "-c", MEASURED, str(path), name]

        def action() -> tuple[float, float]:
            seconds, kilobytes = map(float, run_process(command).split())
            return seconds, kilobytes / 1000

        return action

    return interleaved({name: once(name) for name in (OURS, *FORMULAS)}, repeats)


def _particles(
    found: Mapping[str, list[tuple[float, float]]],
) -> tuple[tuple[tuple[Cell, ...], ...], float, float]:
    """Rows, the least of the ratios to any formula, and our memory."""
    times = {name: [seconds for seconds, _ in pairs] for name, pairs in found.items()}
    memory = {name: max(megabytes for _, megabytes in pairs) for name, pairs in found.items()}
    rows = tuple(
        (name, *Spread.of(seconds).in_order(), memory[name]) for name, seconds in times.items()
    )
    least = min(ratios(times[name], times[OURS]).least for name in FORMULAS)
    return rows, least, memory[OURS]


def _errors() -> tuple[tuple[tuple[Cell, ...], ...], float]:
    """Clouds that are badly conditioned: far away, tiny, with an outlier."""
    random = np.random.default_rng(9)
    masses = random.uniform(0.1, 2, 2000)

    def cloud(far: float, size: float) -> Array:
        places = random.normal(size=(2000, 3)) * size * (1.0, 2.0, 0.5)
        return np.column_stack([masses, places + np.array([far, -far, 2 * far])])

    clouds = {
        "1 m, at the origin": cloud(0, 1),
        "1 m, 10 km away": cloud(1e4, 1),
        "1 m, 100 000 km away": cloud(1e8, 1),
        "1 mm, 1000 km away": cloud(1e6, 1e-3),
        "1 m, 100 000 km away, a gram at the origin": np.vstack([[1e-3, 0, 0, 0], cloud(1e8, 1)]),
    }
    rows: list[tuple[Cell, ...]] = []
    for name, table in clouds.items():
        exact = _exact(table)
        values = [inertia_of(table).inertia, *(way(table) for way in FORMULAS.values())]
        rows.append((name, *(_error(value, exact) for value in values)))
    return tuple(rows), max(float(row[1] or 0) for row in rows)


def _error(value: Array, exact: Array) -> float:
    return float(max(abs((value - exact).ravel())) / max(abs(exact.ravel()))) / _EPS


def _exact(table: Array) -> Array:
    """I about the centre with 50 digits."""
    with mpmath.workdps(50):
        m, *x = (np.array([mpmath.mpf(float(v)) for v in column]) for column in table.T)
        centre = [sum(m * axis) / sum(m) for axis in x]
        x = [axis - c for axis, c in zip(x, centre, strict=True)]
        square = sum(axis * axis for axis in x)
        return np.array(
            [[sum(m * ((i == j) * square - x[i] * x[j])) for j in range(3)] for i in range(3)]
        )
