"""Kernels beside `sympy.lambdify(..., modules="numpy", cse=True)` on one batch of orientations.

Both evaluate the same expressions in float64. Ours takes q as one C-contiguous (N, 3) and gives
one (N, ...). lambdify takes and gives a contiguous array a component, the layout it is fastest
in; stacking its results to one array, as ours gives them, is timed beside it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from benchmarks.measure import Settings, Spread, interleaved, peak_memory, ratios, timed
from benchmarks.report import Column, Figure, Report, Table, spread_columns
from rigidsym.api import derive
from rigidsym.models.catalogue import EulerAngles

SEQUENCES = ("ZXZ", "ZYX")
QUANTITIES = (
    "rotation_matrix",
    "angular_velocity_space",
    "angular_velocity_body",
    "rates_from_angular_velocity_space",
    "rates_from_angular_velocity_body",
)
LEAST_RATIO = 1.5
MOST_EXTRA = 2.0  # MB beyond the outputs
REPEATS = 15
MEGABYTE = 1e6

OURS, APART, STACKED = "rigidsym", "lambdify, components apart", "lambdify, stacked"

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Case:
    """One quantity of one convention, ready to be called by each side."""

    sequence: str
    quantity: str
    calls: dict[str, Callable[[], Any]]


@dataclass(frozen=True, slots=True)
class Outcome:
    """Seconds of each repeat and extra bytes, by side."""

    case: Case
    seconds: dict[str, list[float]]
    extra: dict[str, int]

    @property
    def ratio(self) -> Spread:
        """lambdify's time over ours, components apart."""
        return ratios(self.seconds[APART], self.seconds[OURS])


def run(settings: Settings) -> Report:
    """Every case, its sides interleaved."""
    made = [case for sequence in SEQUENCES for case in cases(sequence, settings.size)]
    repeats = settings.repeats or REPEATS
    return report([measure(case, repeats) for case in made], settings.size)


def cases(sequence: str, size: int) -> list[Case]:
    """The quantities of one convention over `size` random orientations."""
    motion = derive(EulerAngles(sequence))
    module = motion.kernels("numpy").load()
    random = np.random.default_rng(0)
    found = []
    for quantity in QUANTITIES:
        step = motion.step(quantity)
        names = step.quantity.inputs
        batches = [random.uniform(-3.0, 3.0, (size, 3)) for _ in names]
        symbols = [symbol for name in names for symbol in motion.argument(name).symbols]
        peer = lambdified(symbols, step.expression)
        found.append(_case(sequence, quantity, getattr(module, quantity), peer, batches))
    return found


def lambdified(symbols: Sequence[Any], expression: Any) -> Callable[..., list[Array]]:
    """SymPy's own way to NumPy: all entries, with common subexpressions taken once."""
    function: Callable[..., list[Array]] = sp.lambdify(
        symbols, list(expression), modules="numpy", cse=True
    )
    return function


def _case(
    sequence: str,
    quantity: str,
    function: Callable[..., Array],
    peer: Callable[..., list[Array]],
    batches: Sequence[Array],
) -> Case:
    components = [np.ascontiguousarray(column) for batch in batches for column in batch.T]
    calls: dict[str, Callable[[], Any]] = {
        OURS: lambda: function(*batches),
        APART: lambda: peer(*components),
        STACKED: lambda: np.stack(peer(*components), axis=-1),
    }
    return Case(sequence, quantity, calls)


def measure(case: Case, repeats: int) -> Outcome:
    """Times and memory of one case; raises where the sides differ in value."""
    ours, stacked = case.calls[OURS](), case.calls[STACKED]()
    if not np.allclose(ours.reshape(stacked.shape), stacked, rtol=1e-9, atol=1e-9):
        raise ArithmeticError(f"{case.sequence} {case.quantity}: ours and lambdify's differ")
    actions = {side: partial(timed, call) for side, call in case.calls.items()}
    extra = {side: peak_memory(call) - ours.nbytes for side, call in case.calls.items()}
    return Outcome(case, interleaved(actions, repeats, warm_up=2), extra)


def report(outcomes: Sequence[Outcome], size: int) -> Report:
    """Times, ratios and memory of each case."""
    return Report(
        title=f"Kernels: {size:,} orientations, float64",
        tables=(_times(outcomes), _ratios(outcomes)),
        figures=_figures(outcomes),
        notes=(f"NumPy's vector instructions here: {_vector_instructions()}",),
    )


def _vector_instructions() -> str:
    """NumPy's sine and tangent are many times faster with some of them."""
    found: Any = np.show_config(mode="dicts")  # typed differently from one NumPy to the next
    extensions = found.get("SIMD Extensions", {})
    return ", ".join([*extensions.get("baseline", []), *extensions.get("found", [])]) or "unknown"


def _times(outcomes: Sequence[Outcome]) -> Table:
    rows = tuple(
        (
            outcome.case.sequence,
            outcome.case.quantity,
            side,
            *Spread.of(seconds).in_order(1000),
            outcome.extra[side] / MEGABYTE,
        )
        for outcome in outcomes
        for side, seconds in outcome.seconds.items()
    )
    columns = (
        Column("convention"),
        Column("quantity"),
        Column("side"),
        *spread_columns("ms", 1),
        Column("MB beyond the outputs", ".2f"),
    )
    return Table("Time of a call, and memory at its worst moment", columns, rows)


def _ratios(outcomes: Sequence[Outcome]) -> Table:
    rows = tuple(
        (
            outcome.case.sequence,
            outcome.case.quantity,
            side,
            *ratios(outcome.seconds[side], outcome.seconds[OURS]).in_order(),
        )
        for outcome in outcomes
        for side in (APART, STACKED)
    )
    columns = (
        Column("convention"),
        Column("quantity"),
        Column("over rigidsym's time"),
        *spread_columns("ratio", 2),
    )
    return Table("Ratios, turn by turn", columns, rows)


def _figures(outcomes: Sequence[Outcome]) -> tuple[Figure, ...]:
    slowest = min(outcomes, key=lambda outcome: outcome.ratio.middle)
    largest = max(outcome.extra[OURS] for outcome in outcomes) / MEGABYTE
    ratio = slowest.ratio.middle
    return (
        Figure(
            "time against lambdify, components apart, the worst case",
            f"at least {LEAST_RATIO:g} times faster",
            f"{ratio:.2f} times, {slowest.case.sequence} {slowest.case.quantity}",
            ratio >= LEAST_RATIO,
        ),
        Figure(
            "memory beyond the outputs, the worst case",
            f"at most {MOST_EXTRA:g} MB",
            f"{largest:.2f} MB",
            largest <= MOST_EXTRA,
        ),
    )
