"""Time to derive: all quantities of all 24 conventions, beside SymPy giving only Ω and Ω′.

Each repeat is a fresh process, so that nothing is remembered from the one before; imports are
not counted. `python -m benchmarks.derivation WORK` is that process, WORK a key of `WORK`.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from itertools import accumulate
from typing import Any

import sympy as sp

# SymPy's first sum imports this; on neither side are imports counted.
import sympy.tensor.tensor

from benchmarks.measure import Settings, Spread, interleaved, ratios, run_process, timed
from benchmarks.report import Column, Figure, Report, Table, spread_columns
from benchmarks.sympy_forms import frames
from rigidsym.algebra.codec import codec_for
from rigidsym.algebra.matrix import RingMatrix
from rigidsym.algebra.present import presenter_for
from rigidsym.models.parametrisations import AXIS_SEQUENCES, EULER_SEQUENCES, EulerAngles
from rigidsym.models.rotation import TIME
from rigidsym.motion import derive

ALL_12, ALL_24 = len(AXIS_SEQUENCES), len(EULER_SEQUENCES)
MOST_SECONDS = 2.0
LEAST_RATIO = 110.0
REPEATS = 3

Totals = list[float]  # seconds after the first, the second, ... convention


def everything(sequence: str) -> object:
    """All quantities, each step proved, and the singular angles."""
    return derive(EulerAngles(sequence))


def velocities(sequence: str) -> tuple[Any, ...]:
    """Ω and Ω′ alone, in the same ring and the same form, without the proofs of the steps."""
    model = EulerAngles(sequence)
    codec = codec_for([*model.matrix, *(q.diff(TIME) for q in model.coordinates)])
    rows = model.matrix.tolist()
    R = RingMatrix.of(codec.ring, [[codec.encode(entry) for entry in row] for row in rows])
    spin = R.dt() @ R.T
    omega = RingMatrix.column(codec.ring, [spin[2, 1], spin[0, 2], spin[1, 0]])
    return tuple(presenter_for(codec).matrix(vector) for vector in (omega, R.T @ omega))


def sympy_velocities(sequence: str) -> tuple[Any, ...]:
    """Ω and Ω′ by sympy.physics.vector, made readable by trigsimp."""
    space, body = frames(sequence)
    omega = body.ang_vel_in(space)
    return tuple(omega.to_matrix(frame).applyfunc(sp.trigsimp) for frame in (space, body))


WORK: dict[str, Callable[[str], object]] = {
    "rigidsym, all quantities": everything,
    "rigidsym, Ω and Ω′ alone": velocities,
    "SymPy with trigsimp, Ω and Ω′ alone": sympy_velocities,
}
EVERYTHING, VELOCITIES, SYMPY = WORK


def in_this_process(work: str, sequences: Iterable[str]) -> Totals:
    """Seconds from the start until each convention is done, one after the other."""
    return list(accumulate(timed(partial(WORK[work], s)) for s in sequences))


def in_fresh_process(work: str) -> Totals:
    """The same over all 24 conventions, intrinsic first, in a process of its own."""
    totals: Totals = json.loads(run_process([sys.executable, "-m", "benchmarks.derivation", work]))
    return totals


def run(settings: Settings) -> Report:
    """Interleaved fresh processes: ours, ours with Ω and Ω′ alone, SymPy's."""
    actions = {work: partial(in_fresh_process, work) for work in WORK}
    return report(interleaved(actions, settings.repeats or REPEATS, warm_up=0))


def report(measured: Mapping[str, Sequence[Totals]]) -> Report:
    """Tables and figures of the totals of each repeat."""
    seconds = {(work, n): [t[n - 1] for t in measured[work]] for work in WORK for n in _COUNTS}
    spreads = {key: Spread.of(values) for key, values in seconds.items()}
    compared = {pair: ratios(seconds[pair[0]], seconds[pair[1]]) for pair in _PAIRS}
    return Report(
        title="Derivation: time, imports excluded, each repeat in a fresh process",
        tables=(
            Table(
                "Time in one process",
                (Column("work"), Column("conventions"), *spread_columns("s")),
                tuple((*key, *spread.in_order()) for key, spread in spreads.items()),
            ),
            Table(
                "Ratios, repeat by repeat",
                (Column("time of"), Column("over time of"), *spread_columns("ratio", 1)),
                tuple((*map(_words, pair), *s.in_order()) for pair, s in compared.items()),
            ),
        ),
        figures=_figures(spreads, compared),
    )


Key = tuple[str, int]  # work, number of conventions
_COUNTS = (ALL_12, ALL_24)
_PAIRS: tuple[tuple[Key, Key], ...] = (
    ((SYMPY, ALL_24), (EVERYTHING, ALL_24)),
    ((SYMPY, ALL_12), (EVERYTHING, ALL_12)),
    ((SYMPY, ALL_12), (EVERYTHING, ALL_24)),
    ((SYMPY, ALL_24), (VELOCITIES, ALL_24)),
    ((SYMPY, ALL_12), (VELOCITIES, ALL_12)),
)


def _words(key: Key) -> str:
    work, conventions = key
    return f"{work}, {conventions}"


def _figures(
    spreads: Mapping[Key, Spread], compared: Mapping[tuple[Key, Key], Spread]
) -> tuple[Figure, ...]:
    seconds = spreads[EVERYTHING, ALL_24].middle
    faster = {
        "all our quantities against SymPy's Ω and Ω′ alone": EVERYTHING,
        "Ω and Ω′ alone on both sides": VELOCITIES,
    }
    return (
        Figure(
            "all quantities, 24 conventions",
            f"at most {MOST_SECONDS:g} s",
            f"{seconds:.2f} s",
            seconds <= MOST_SECONDS,
        ),
        *(
            Figure(
                f"{name}, 24 conventions each",
                f"at least {LEAST_RATIO:g} times faster",
                f"{ratio:.1f} times",
                ratio >= LEAST_RATIO,
            )
            for name, work in faster.items()
            for ratio in [compared[(SYMPY, ALL_24), (work, ALL_24)].middle]
        ),
    )


if __name__ == "__main__":
    print(json.dumps(in_this_process(sys.argv[1], EULER_SEQUENCES)))
