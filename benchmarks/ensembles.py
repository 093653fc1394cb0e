"""Many free bodies at once, beside heyoka's two modes of an ensemble, with the error of each."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from importlib.util import find_spec
from time import perf_counter
from typing import Any

import numpy as np
import sympy as sp

import rigidsym as rs
from benchmarks.measure import Spread, interleaved, progress, ratios
from benchmarks.report import Column, Table

MOMENTS = {"A": 1.0, "B": 1.5, "C": 2.1}
STEPS, STEP = 1000, 0.05  # number, s
OURS, LONGER = f"rigidsym, steps of {STEP} s", f"rigidsym, steps of {2 * STEP} s"
ENSEMBLE, BATCHES = "heyoka, ensemble", "heyoka, ensemble of batches"
ONE_BY_ONE = 5000  # bodies of heyoka's ensemble, which keeps an integrator for each
SOME = 50  # bodies whose exact orientation is known
Timed = tuple[float, Any]  # seconds, final quaternions


def ensembles(bodies: int, repeats: int) -> Table:
    """Bodies that turn at 1 rad/s about random axes; preparation is not timed."""
    omega = np.random.default_rng(2).normal(size=(bodies, 3))
    omega /= np.linalg.norm(omega, axis=1)[:, None]
    free = rs.derive(
        "unit_quaternion", ["energy"], body=rs.principal_moments(*sp.symbols("A B C")), potential=0
    )
    found = interleaved(dict(_actions(free, omega)), repeats)
    exact = np.array([_exact(free, each) for each in omega[:SOME]])
    ours = [seconds for seconds, _ in found[OURS]]
    rows = []
    for name, results in found.items():
        times = [seconds for seconds, _ in results]
        some = results[0][1][:SOME]
        sign = np.sign(np.sum(some * exact, axis=1))[:, None]
        error = float(2 * np.abs(sign * some - exact).max())
        rows.append((name, *Spread.of(times).in_order(), *ratios(times, ours).in_order(), error))
    progress()
    return Table(
        f"{bodies:,} free bodies for {STEP * STEPS:g} s, {STEPS:,} steps of {STEP} s: seconds, "
        f"ratios to these, and the largest error of {min(SOME, bodies)} orientations, in radians",
        (
            *(Column("by"), Column("least s", ".2f"), Column("s", ".2f"), Column("most s", ".2f")),
            *(Column("least ratio", ".1f"), Column("ratio", ".1f"), Column("most", ".1f")),
            Column("error", ".1e"),
        ),
        tuple(rows),
    )


def _exact(free: rs.Motion, omega: Any) -> Any:
    start = {"w": 1, "x": 0, "y": 0, "z": 0, "angular_velocity_body": omega}
    return free.simulate(start, MOMENTS, STEP * STEPS, method="exact", samples=2).q[-1]


def _actions(free: rs.Motion, omega: Any) -> Iterator[tuple[str, Callable[[], Timed]]]:
    yield OURS, lambda: _ours(free, omega, STEP)
    yield LONGER, lambda: _ours(free, omega, 2 * STEP)
    if find_spec("heyoka") is not None:
        yield ENSEMBLE, _heyoka_ensemble(omega)
        yield BATCHES, _heyoka_batches(omega)


def _ours(free: rs.Motion, omega: Any, step: float) -> Timed:
    """In C, less the time of one step, in which the kernels are loaded."""
    start = {"w": 1, "x": 0, "y": 0, "z": 0, "angular_velocity_body": omega}
    spent = []
    for end in (step, STEP * STEPS):
        begun = perf_counter()
        found = free.simulate_many(
            start, MOMENTS, end, samples=2, step=step * (1 + 1e-9), target="c"
        )
        spent.append(perf_counter() - begun)
    return spent[1] - spent[0], found.states[-1, :, :4]


def _system() -> Any:
    """Euler's equations and those of the quaternion, as heyoka takes them."""
    import heyoka as hy

    w, x, y, z, a, b, c = held = hy.make_vars("w", "x", "y", "z", "a", "b", "c")
    first, second, third = MOMENTS.values()
    slopes = [-x * a - y * b - z * c, w * a + y * c - z * b, w * b + z * a - x * c]
    slopes = [slope / 2 for slope in (*slopes, w * c + x * b - y * a)]
    slopes += [(second - third) / first * b * c, (third - first) / second * c * a]
    return list(zip(held, [*slopes, (first - second) / third * a * b], strict=True))


def _heyoka_ensemble(omega: Any) -> Callable[[], Timed]:
    """At most ONE_BY_ONE bodies are computed, and the time for all follows in proportion."""
    import heyoka as hy

    made = hy.taylor_adaptive(_system(), [1.0] + [0.0] * 6)
    count = min(len(omega), ONE_BY_ONE)

    def begun(each: Any, k: int) -> Any:
        each.time, each.state[:] = 0.0, [1, 0, 0, 0, *omega[k]]
        return each

    def propagated() -> Timed:
        start = perf_counter()
        found = hy.ensemble_propagate_for(made, STEP * STEPS, count, begun)
        spent = (perf_counter() - start) * len(omega) / count
        return spent, np.array([each[0].state[:4] for each in found])

    return propagated


def _heyoka_batches(omega: Any) -> Callable[[], Timed]:
    """Bodies that fill no whole vector are left out, and their time is added in proportion."""
    import heyoka as hy

    size = hy.recommended_simd_size()
    groups = omega[: len(omega) // size * size].reshape(-1, size, 3)
    made = hy.taylor_adaptive_batch(_system(), np.full((7, size), 0.1))

    def begun(each: Any, k: int) -> Any:
        each.set_time(0.0)
        each.state[:4], each.state[4:] = [[1.0], [0.0], [0.0], [0.0]], groups[k].T
        return each

    def propagated() -> Timed:
        start = perf_counter()
        found = hy.ensemble_propagate_for_batch(made, STEP * STEPS, len(groups), begun)
        spent = (perf_counter() - start) * len(omega) / groups[..., 0].size
        return spent, np.concatenate([each[0].state[:4].T for each in found])

    return propagated
