"""Every rotation by name, and chains of one to ten turns beside sympy.physics.vector."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial, reduce
from math import exp, log
from time import perf_counter
from typing import Any, TypeVar

import sympy as sp
from sympy.physics.vector import ReferenceFrame, dynamicsymbols

from benchmarks.measure import Settings
from benchmarks.report import Cell, Column, Figure, Report, Table
from rigidsym.models.euler_angles import EULER_SEQUENCES
from rigidsym.models.library import PARAMETRISATIONS, PRESETS
from rigidsym.models.rotation_text import rotation_from
from rigidsym.motion import Motion, derive

MOST_SECONDS = 10.0
MOST_SECONDS_FOR_EIGHT = 1.0
AXES = "zxzyxzyxzy"
VELOCITIES = ("angular_velocity_space", "angular_velocity_body")


def run(settings: Settings) -> Report:
    """The tables of the catalogue and of the chains. `settings` changes nothing here."""
    del settings
    named, total, is_proved = _named()
    chains = tuple(_chain(turns) for turns in range(1, len(AXES) + 1))
    eight = chains[7]
    return Report(
        title="Every rotation",
        tables=(
            Table(
                "all quantities, each proved, in one process",
                (
                    Column("rotation"),
                    Column("seconds", ".3f"),
                    Column("quantities"),
                    Column("Ω, ops"),
                ),
                named,
            ),
            Table(
                "chains of turns: Ω and Ω′, and their operations",
                (
                    Column("turns"),
                    Column("seconds", ".3f"),
                    Column("Ω, ops"),
                    Column("Ω′, ops"),
                    Column("SymPy seconds", ".3f"),
                    Column("SymPy Ω, ops"),
                    Column("SymPy Ω′, ops"),
                ),
                chains,
            ),
        ),
        figures=(
            Figure(
                name="the whole catalogue with all quantities",
                target=f"at most {MOST_SECONDS:g} s, each result proved",
                found=f"{total:.2f} s, {'all' if is_proved else 'not all'} proved",
                met=total <= MOST_SECONDS and is_proved,
            ),
            Figure(
                name="Ω and Ω′ of eight turns",
                target=f"under {MOST_SECONDS_FOR_EIGHT:g} s",
                found=f"{eight[1]:.3f} s",
                met=float(eight[1] or 0) < MOST_SECONDS_FOR_EIGHT,
            ),
        ),
        notes=(
            "From five turns to ten, each turn multiplies "
            f"the operations of Ω by {_growth(chains, _OURS):.2f}, those of SymPy's by "
            f"{_growth(chains, _SYMPY):.2f}, the seconds by {_growth(chains, _SECONDS):.2f}, "
            f"SymPy's by {_growth(chains, _SYMPY_SECONDS):.2f}: the growth is exponential, since "
            "the last axis is turned by all angles before it, each of which doubles its terms "
            "where it does not find the axis at rest.",
            "SymPy: ang_vel_in to components, as they come, with no trigsimp.",
        ),
    )


_SECONDS, _OURS, _SYMPY_SECONDS, _SYMPY = 1, 2, 4, 5  # columns of the table of chains


def _growth(chains: Sequence[tuple[Cell, ...]], column: int) -> float:
    """By what each turn multiplies a column, from five turns to ten."""
    first, last = (float(chains[turns - 1][column] or 1) for turns in (5, 10))
    return exp(log(last / first) / 5)


T = TypeVar("T")


def _timed(function: Callable[[], T]) -> tuple[float, T]:
    """Seconds of one call, and its result."""
    start = perf_counter()
    result = function()
    return perf_counter() - start, result


def _named() -> tuple[tuple[tuple[Cell, ...], ...], float, bool]:
    rows: list[tuple[Cell, ...]] = []
    total, is_proved = 0.0, True
    for name in (*EULER_SEQUENCES, *PARAMETRISATIONS, *PRESETS):
        seconds, motion = _timed(partial(_derived, name))
        total += seconds
        is_proved = is_proved and motion.is_proved
        operations = int(sp.count_ops(motion.angular_velocity_space))
        rows.append((name, seconds, len(motion.steps), operations))
    return tuple(rows), total, is_proved


def _derived(name: str) -> Motion:
    return derive(rotation_from(name))


def _chain(turns: int) -> tuple[Cell, ...]:
    text = " ".join(f"{axis}(a_{k})" for k, axis in enumerate(AXES[:turns], start=1))
    seconds, motion = _timed(lambda: derive(rotation_from(text), only=VELOCITIES))
    ours = [int(sp.count_ops(getattr(motion, name))) for name in VELOCITIES]
    theirs_seconds, theirs = _timed(lambda: _sympy_velocities(turns))
    return turns, seconds, *ours, theirs_seconds, *(int(sp.count_ops(vector)) for vector in theirs)


def _sympy_velocities(turns: int) -> tuple[Any, Any]:
    """Ω and Ω′ by sympy.physics.vector, as they come."""
    space = ReferenceFrame("N")
    angles = dynamicsymbols(f"a_1:{turns + 1}") if turns > 1 else [dynamicsymbols("a_1")]
    pairs = list(enumerate(zip(AXES[:turns], angles, strict=True)))
    body = reduce(
        lambda frame, pair: frame.orientnew(
            f"F{pair[0]}", "Axis", [pair[1][1], getattr(frame, pair[1][0])]
        ),
        pairs,
        space,
    )
    omega = body.ang_vel_in(space)
    return omega.to_matrix(space), omega.to_matrix(body)
