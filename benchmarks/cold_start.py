"""Time of whole processes: `rigidsym --help`, and `rigidsym derive ZXZ` beside `import sympy`."""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path

from benchmarks.measure import Settings, Spread, interleaved, ratios, run_process, timed
from benchmarks.report import Column, Figure, Report, Table, spread_columns

HELP, DERIVE, IMPORT = "rigidsym --help", "rigidsym derive ZXZ", 'python -c "import sympy"'
EMPTY = 'python -c ""'
MOST_SECONDS = 0.150
MOST_RATIO = 1.5
REPEATS = 10

_MAIN = (
    "import sys; from rigidsym.commands.cli import main; sys.argv[0] = 'rigidsym'; sys.exit(main())"
)


def rigidsym_command() -> list[str]:
    """The installed command where there is one, else the function that it calls."""
    installed = Path(sys.executable).with_name("rigidsym")
    return [str(installed)] if installed.exists() else [sys.executable, "-c", _MAIN]


def commands(out: str) -> dict[str, list[str]]:
    """What is timed; `out` receives the files of `derive`."""
    return {
        EMPTY: [sys.executable, "-c", ""],
        HELP: [*rigidsym_command(), "--help"],
        IMPORT: [sys.executable, "-c", "import sympy"],
        DERIVE: [*rigidsym_command(), "derive", "ZXZ", "--out", out],
    }


def run(settings: Settings) -> Report:
    """Interleaved processes, one after the other."""
    with tempfile.TemporaryDirectory() as out:
        actions = {
            name: partial(timed, partial(run_process, command))
            for name, command in commands(out).items()
        }
        return report(interleaved(actions, settings.repeats or REPEATS))


def report(seconds: Mapping[str, Sequence[float]]) -> Report:
    """Times of each command, and the ratio turn by turn."""
    spreads = {name: Spread.of(times) for name, times in seconds.items()}
    ratio = ratios(seconds[DERIVE], seconds[IMPORT])
    return Report(
        title="Cold start: a whole process, from its start to its end",
        tables=(
            Table(
                "Wall time",
                (Column("command"), *spread_columns("ms", 0)),
                tuple((name, *spread.in_order(1000)) for name, spread in spreads.items()),
            ),
            Table(
                "Ratio, turn by turn",
                (Column("time of"), Column("over time of"), *spread_columns("ratio", 2)),
                ((DERIVE, IMPORT, *ratio.in_order()),),
            ),
        ),
        figures=_figures(spreads[HELP], ratio),
        notes=(f"rigidsym is run as {' '.join(rigidsym_command()[:2])}",),
    )


def _figures(start: Spread, ratio: Spread) -> tuple[Figure, ...]:
    return (
        Figure(
            HELP,
            f"at most {MOST_SECONDS * 1000:g} ms",
            f"{start.middle * 1000:.0f} ms",
            start.middle <= MOST_SECONDS,
        ),
        Figure(
            f"{DERIVE} against {IMPORT}",
            f"at most {MOST_RATIO:g} times",
            f"{ratio.middle:.2f} times",
            ratio.middle <= MOST_RATIO,
        ),
    )
