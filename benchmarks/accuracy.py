"""Largest errors of R, Ω and Ω′ in units of eps, against mpmath at 50 digits.

The witness multiplies elementary turns and adds up their axes; it shares no formula with the
kernels. An error is taken relative to the largest entry of the exact value.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from types import ModuleType
from typing import Any

import mpmath as mp
import numpy as np
from numpy.typing import NDArray

from benchmarks.measure import Settings, progress
from benchmarks.report import Cell, Column, Figure, Report, Table
from rigidsym.models.parametrisations import EULER_SEQUENCES, EulerAngles
from rigidsym.motion import derive

DIGITS = 50
MOST = 4.0  # eps of the largest entry
SYMBOLS = {"rotation_matrix": "R", "angular_velocity_space": "Ω", "angular_velocity_body": "Ω′"}

Array = NDArray[Any]
Vector = list[Any]  # of mpmath numbers
Rows = list[Vector]


@dataclass(frozen=True, slots=True)
class Way:
    """One way to call a kernel: an array of some precision, or the scalar twin."""

    name: str
    dtype: type[np.floating[Any]]
    is_scalar: bool = False


WAYS = (
    Way("arrays, float64", np.float64),
    Way("arrays, float32", np.float32),
    Way("scalar twins, float64", np.float64, is_scalar=True),
)


def angle_groups(dtype: type[np.floating[Any]], size: int) -> dict[str, Array]:
    """Angles by kind, each (size, 3): what is special is rounded to the type first."""
    random = np.random.default_rng(0)
    limits = np.finfo(dtype)
    quarters = np.arange(-8, 9) * (np.pi / 2)
    tiny = np.array([0.0, limits.tiny, -limits.tiny, limits.eps, -np.sqrt(limits.eps)])
    return {
        "random in ±π": random.uniform(-np.pi, np.pi, (size, 3)).astype(dtype),
        "multiples of π/2": random.choice(quarters, (size, 3)).astype(dtype),
        "tiny": random.choice(tiny, (size, 3)).astype(dtype),
        "random in ±1e4": random.uniform(-1e4, 1e4, (size, 3)).astype(dtype),
        "random in ±1e6": random.uniform(-1e6, 1e6, (size, 3)).astype(dtype),
        "random in ±1e15": random.uniform(-1e15, 1e15, (size, 3)).astype(dtype),
    }


def exact(sequence: str, q: Sequence[float], q_dot: Sequence[float]) -> dict[str, Vector]:
    """R, Ω and Ω′ to 50 digits, entries row by row, from floats taken as they are."""
    with mp.workdps(DIGITS):
        turns = [("xyz".index(a), mp.mpf(x), mp.mpf(v)) for a, x, v in _turns(sequence, q, q_dot)]
        R: Rows = [[mp.mpf(i == j) for j in range(3)] for i in range(3)]
        omega: Vector = [mp.mpf(0)] * 3
        for axis, angle, rate in turns:
            omega = [o + rate * row[axis] for o, row in zip(omega, R, strict=True)]
            R = _product(R, _elementary(axis, angle))
        body = [mp.fdot(column, omega) for column in zip(*R, strict=True)]
    return {
        "rotation_matrix": [entry for row in R for entry in row],
        "angular_velocity_space": omega,
        "angular_velocity_body": body,
    }


def _turns(
    sequence: str, q: Sequence[float], q_dot: Sequence[float]
) -> Iterable[tuple[str, float, float]]:
    """Axis, angle and rate, left to right as the turns are multiplied."""
    turns = list(zip(sequence.lower(), map(float, q), map(float, q_dot), strict=True))
    return turns if sequence.isupper() else reversed(turns)


def _elementary(axis: int, angle: Any) -> Rows:
    """The right-handed turn about one coordinate axis."""
    rows: Rows = [[mp.mpf(i == j) for j in range(3)] for i in range(3)]
    j, k = (axis + 1) % 3, (axis + 2) % 3
    rows[j][j] = rows[k][k] = mp.cos(angle)
    rows[k][j] = mp.sin(angle)
    rows[j][k] = -rows[k][j]
    return rows


def _product(left: Rows, right: Rows) -> Rows:
    columns = list(zip(*right, strict=True))
    return [[mp.fdot(row, column) for column in columns] for row in left]


def evaluated(module: ModuleType, way: Way, quantity: str, arguments: Sequence[Array]) -> Array:
    """The kernel's values, (size, entries)."""
    size = len(arguments[0])
    if not way.is_scalar:
        values: Array = getattr(module, quantity)(*arguments)
        return values.reshape(size, -1)
    function: Callable[..., Any] = getattr(module, f"{quantity}_scalar")
    rows = zip(*(argument.tolist() for argument in arguments), strict=True)
    return np.array([function(*(x for part in row for x in part)) for row in rows]).reshape(
        size, -1
    )


def largest_error(values: Array, truths: Sequence[Vector]) -> float:
    """In eps of the values' type, relative to the largest entry of each exact value."""
    eps = float(np.finfo(values.dtype).eps)
    return max(_error(row, truth) for row, truth in zip(values.tolist(), truths, strict=True)) / eps


def _error(row: Sequence[float], truth: Vector) -> float:
    with mp.workdps(DIGITS):
        scale = max(map(abs, truth))
        return float(max(abs(mp.mpf(x) - y) for x, y in zip(row, truth, strict=True)) / scale)


Errors = dict[tuple[str, str, str], float]  # way, group, quantity


def errors(sequence: str, samples: int) -> Errors:
    """The largest errors of one convention."""
    motion = derive(EulerAngles(sequence))
    module = motion.kernels("numpy").load()
    inputs = {name: motion.step(name).quantity.inputs for name in SYMBOLS}
    found: Errors = {}
    for dtype in (np.float64, np.float32):
        rates = np.random.default_rng(1).normal(size=(samples, 3)).astype(dtype)
        for group, q in angle_groups(dtype, samples).items():
            truths = [exact(sequence, *both) for both in zip(q, rates, strict=True)]
            for way in (way for way in WAYS if way.dtype is dtype):
                for name in SYMBOLS:
                    given = [q, rates][: len(inputs[name])]
                    values = evaluated(module, way, name, given)
                    truth = [exact_value[name] for exact_value in truths]
                    found[way.name, group, name] = largest_error(values, truth)
    return found


def run(settings: Settings) -> Report:
    """All 24 conventions."""
    found: dict[str, Errors] = {}
    for sequence in EULER_SEQUENCES:
        progress(f"errors of {sequence}")
        found[sequence] = errors(sequence, settings.samples)
    progress()
    return report(found)


def report(found: Mapping[str, Errors]) -> Report:
    """The largest errors over the conventions."""
    groups = dict.fromkeys(group for e in found.values() for _, group, _ in e)
    rows: list[tuple[Cell, ...]] = []
    for way in WAYS:
        for group in groups:
            largest = (max(e[way.name, group, name] for e in found.values()) for name in SYMBOLS)
            rows.append((way.name, group, *largest))
    columns = (
        Column("kernels"),
        Column("angles"),
        *(Column(f"{symbol}, eps", ".2f") for symbol in SYMBOLS.values()),
    )
    return Report(
        title=f"Accuracy: largest error against {DIGITS} digits, {len(found)} conventions",
        tables=(Table("In eps of the type, relative to the largest entry", columns, tuple(rows)),),
        figures=_figures(found),
    )


def _figures(found: Mapping[str, Errors]) -> tuple[Figure, ...]:
    """The largest error of each quantity over conventions, ways and angles."""
    figures = []
    for name, symbol in SYMBOLS.items():
        error, sequence, way, group = max(
            (error, sequence, way, group)
            for sequence, errors in found.items()
            for (way, group, quantity), error in errors.items()
            if quantity == name
        )
        figures.append(
            Figure(
                f"error of {symbol} against {DIGITS} digits, the worst case",
                f"at most {MOST:g} eps of the largest entry",
                f"{error:.2f} eps, {sequence}, {way}, {group}",
                error <= MOST,
            )
        )
    return tuple(figures)
