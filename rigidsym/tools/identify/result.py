"""What the detective found, as data."""

from __future__ import annotations

from dataclasses import dataclass

from rigidsym.tools.identify.calls import calls
from rigidsym.tools.identify.fit import Match
from rigidsym.tools.identify.readings import Reading
from rigidsym.tools.identify.separate import Separation
from rigidsym.tools.identify.tolerance import Tolerance


@dataclass(frozen=True, kw_only=True)
class Answer(Match):
    """One reading in its plainest words, how well it fits, and its other words."""

    @property
    def aliases(self) -> tuple[Reading, ...]:
        """The readings that are the same function of the data."""
        return self.reading.aliases()

    @property
    def calls(self) -> dict[str, str]:
        """Python statements by library (SciPy, SymPy, rigidsym) that reproduce the data."""
        return calls(self.reading)


@dataclass(frozen=True, kw_only=True)
class Findings:
    """Every reading that fits, the plainest first; where none does, the nearest."""

    answers: tuple[Answer, ...]
    nearest: Answer | None  # where nothing fits
    tolerance: Tolerance
    samples: int
    tried: int  # readings that differ as functions of the data
    names: tuple[str, ...]  # of the angle columns
    has_velocity: bool  # rates and Ω were given
    further: Separation | None  # None where one reading is left, and where nothing separates them

    @property
    def fits(self) -> bool:
        return bool(self.answers)
