"""Times and memory: interleaved repeats, pair by pair ratios, each with its spread."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from time import perf_counter
from typing import TypeVar

T = TypeVar("T")

ROOT = Path(__file__).resolve().parent.parent


@dataclass(frozen=True, slots=True)
class Spread:
    """Least, middle and largest of some repeats."""

    least: float
    middle: float
    most: float

    @classmethod
    def of(cls, values: Sequence[float]) -> Spread:
        return cls(min(values), median(values), max(values))

    def in_order(self, scale: float = 1.0) -> tuple[float, float, float]:
        """The three for a row of a table, in another unit where `scale` says so."""
        return self.least * scale, self.middle * scale, self.most * scale


@dataclass(frozen=True, slots=True)
class Settings:
    """What the command line may change."""

    repeats: int | None = None  # None: each benchmark's own
    size: int | None = None  # orientations in the largest batch, likewise
    samples: int = 40  # orientations of each kind whose errors are taken
    fresh: bool = False  # survey SymPy's forms anew


def interleaved(
    actions: Mapping[str, Callable[[], T]], repeats: int, *, warm_up: int = 1
) -> dict[str, list[T]]:
    """Each action in turn, `repeats` times over: the results, mostly times, of each.

    Taking turns spreads what else the machine does over all of them alike. The first `warm_up`
    rounds fill caches and are left out.
    """
    results: dict[str, list[T]] = {name: [] for name in actions}
    for turn in range(warm_up + repeats):
        for name, action in actions.items():
            progress(f"{turn + 1} of {warm_up + repeats}: {name}")
            result = action()
            if turn >= warm_up:
                results[name].append(result)
    progress()
    return results


def ratios(above: Sequence[float], below: Sequence[float]) -> Spread:
    """above / below, turn by turn."""
    return Spread.of([a / b for a, b in zip(above, below, strict=True)])


def timed(function: Callable[[], object]) -> float:
    """Seconds of one call."""
    start = perf_counter()
    function()
    return perf_counter() - start


@contextmanager
def on_one_core() -> Iterator[None]:
    """Let no library spread over more, where the system can say so."""
    if not hasattr(os, "sched_setaffinity"):
        yield
        return
    before = os.sched_getaffinity(0)
    os.sched_setaffinity(0, {max(before)})
    try:
        yield
    finally:
        os.sched_setaffinity(0, before)


def run_process(command: Sequence[str]) -> str:
    """Standard output of a fresh process that finds this checkout; raises where it fails."""
    done = subprocess.run(
        command, env=environment(), capture_output=True, text=True, check=False, cwd=ROOT
    )
    if done.returncode:
        raise RuntimeError(f"{' '.join(command)} failed:\n{done.stderr}")
    return done.stdout


def environment() -> dict[str, str]:
    """This process's environment, with the checkout first among the places for modules.

    Bytecode is kept, as it is where the package is installed.
    """
    kept = {key: v for key, v in os.environ.items() if key != "PYTHONDONTWRITEBYTECODE"}
    places = [str(ROOT), *filter(None, [os.environ.get("PYTHONPATH")])]
    return {**kept, "PYTHONPATH": os.pathsep.join(places)}


def progress(text: str = "") -> None:
    """One line that is written over by the next; in a terminal alone."""
    if sys.stderr.isatty():
        print(f"\r\033[K{text}", end="", file=sys.stderr, flush=True)
