"""The readings that fit: all are tried on a few rows, and the remaining ones on every row."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from rigidsym.data.text import MOST_SHOWN
from rigidsym.system.processes import Progress
from rigidsym.tools.identify.align import aligned
from rigidsym.tools.identify.calls import calls
from rigidsym.tools.identify.readings import VELOCITIES, Reading, distinct
from rigidsym.tools.identify.samples import SLACK, SampleBlock, SampleError, check
from rigidsym.tools.identify.sources import SampleSource
from rigidsym.tools.identify.tolerance import Tolerance, check_tolerance, tolerances
from rigidsym.tools.identify.turns import Array, ReadingTable
from rigidsym.tools.identify.velocity import angular_velocities, as_given

_AT_ONCE = 1 << 17  # rows times readings


@dataclass(frozen=True, kw_only=True, slots=True)
class Answer:
    """One reading in its plainest words, and how well it fits all of the data."""

    reading: Reading
    residual: float  # the largest angle between the reading and the data, in radians
    velocity_residual: float | None  # the largest |difference of Ω|, over the largest |Ω|
    worst: str  # where the data are furthest from it: "sample 3", "line 17"
    fitting: int  # number of samples within the tolerance
    samples: int

    @property
    def fits(self) -> bool:
        return self.fitting == self.samples

    @property
    def aliases(self) -> tuple[Reading, ...]:
        """Other readings that are the same function of the data."""
        return self.reading.aliases()

    @property
    def calls(self) -> dict[str, str]:
        """Python statements by library (SciPy, SymPy, rigidsym) that reproduce the data."""
        return calls(self.reading)


def fit(
    source: SampleSource, tolerance: float | None = None, progress: Progress | None = None
) -> tuple[tuple[Answer, ...], Tolerance, float]:
    """The readings that fit the samples or, if none does, the nearest; in the order of plainness.

    Also the tolerance for that, and the largest |Ω| of the rows tried first.
    Raises SampleError for samples that are not finite or not rotations, after reading them all.
    """
    check_tolerance(tolerance)
    slack = max(SLACK, 2 * (tolerance or 0))
    block, faults, _ = check(source.spread(), source.place, slack)
    if not len(block):
        deque(_good(source, slack), maxlen=0)  # raises, and names all of them
        raise SampleError(faults or ["no samples"])
    scale = _scale(block)
    chosen, candidates = _narrowed(source, block, tolerance, scale)
    tally = _Tally(candidates, chosen, scale)
    for block in _good(source, slack):
        tally.add(block)
        if progress:
            progress(block.done)
    return tally.answers(source), chosen, scale


def _good(source: SampleSource, slack: float) -> Iterator[SampleBlock]:
    """Every block; raises SampleError after the last if one of them had faults."""
    faults: list[str] = []
    count = 0
    for block in source.blocks():
        good, wrong, more = check(block, source.place, slack)
        count += more
        faults += wrong[: MOST_SHOWN - len(faults)]
        if not count:
            yield good
    if faults:
        raise SampleError(faults, count=count)


def _scale(block: SampleBlock) -> float:
    """The largest |Ω|, or the largest rate if all Ω are zero."""
    if block.omega is None or block.rates is None:
        return 1.0
    lengths = [float(np.linalg.norm(part, axis=1).max()) for part in (block.omega, block.rates)]
    return next((length for length in lengths if length), 1.0)


class _Candidates:
    """Readings whose orientations, and whose Ω, are each computed once."""

    def __init__(self, readings: Sequence[Reading]) -> None:
        self.readings = tuple(readings)
        orientations = list(dict.fromkeys(reading.orientation for reading in readings))
        velocities = list(dict.fromkeys(r.velocity for r in readings if r.velocity))
        self._table, self._velocities = ReadingTable(orientations), velocities
        numbers = {reading: number for number, reading in enumerate(orientations)}
        self._orientation = np.array([numbers[reading.orientation] for reading in readings])
        self._velocity = [velocities.index(r.velocity) for r in readings if r.velocity]

    def residuals(self, block: SampleBlock, scale: float) -> tuple[Array, Array]:
        """Angles to the data in radians, and |difference of Ω| over the scale: (n, readings)."""
        angles = self._table.residuals(block.angles, block.orientation())[:, self._orientation]
        if block.rates is None or block.omega is None:
            return angles, np.zeros_like(angles)
        omega = angular_velocities(self._table.readings, block.angles, block.rates)
        difference = as_given(omega, self._velocities) - block.omega[:, None, None]
        off = np.linalg.norm(difference, axis=-1) / scale
        return angles, off[:, self._orientation, self._velocity]


@cache
def _everything(layouts: tuple[bool | None, ...]) -> ReadingTable:
    return ReadingTable(sorted(distinct(layouts), key=Reading.plainness))


def _narrowed(
    source: SampleSource, block: SampleBlock, asked: float | None, scale: float
) -> tuple[Tolerance, list[Reading]]:
    """The readings that fit a few rows, or only the nearest, and the tolerance for the rest."""
    table = _everything(source.columns.layouts)
    angles = table.residuals(block.angles, block.orientation())
    readings = np.array(table.readings)
    in_degrees = np.array([reading.degrees for reading in readings])
    for tolerance in tolerances(asked, block, source.coarseness, scale):
        off = angles > tolerance.of(in_degrees)
        left = readings[~off.any(axis=0)].tolist()
        if left:
            found = _with_velocities(left, block, scale, tolerance.velocity)
            if found:
                return tolerance, found
    if not left:
        for tolerance in tolerances(asked, block, source.coarseness, scale):
            framed = aligned(table, block, tolerance)
            found = _with_velocities(framed, block, scale, tolerance.velocity) if framed else []
            if found:
                return tolerance, found
        left = [readings[np.lexsort((angles.max(axis=0), off.sum(axis=0)))[0]]]
    return tolerance, _with_velocities(left[:1], block, scale, None)


def _with_velocities(
    orientations: Sequence[Reading], block: SampleBlock, scale: float, tolerance: float | None
) -> list[Reading]:
    """Each reading of the orientation with every reading of Ω that fits, or with the nearest."""
    if block.omega is None:
        return list(orientations)
    candidates = _Candidates([replace(r, velocity=v) for r in orientations for v in VELOCITIES])
    worst = candidates.residuals(block, scale)[1].max(axis=0)
    chosen = np.flatnonzero(worst <= tolerance) if tolerance is not None else [worst.argmin()]
    return [candidates.readings[k] for k in chosen]


class _Tally:
    """The largest residuals so far of each candidate."""

    def __init__(self, readings: Sequence[Reading], tolerance: Tolerance, scale: float) -> None:
        self._candidates = _Candidates(readings)
        self._allowed = tolerance.of(np.array([reading.degrees for reading in readings]))
        self._allowed_velocity, self._scale = tolerance.velocity, scale
        self._angle, self._velocity = np.zeros((2, len(readings)))
        self._share, self._row = np.full(len(readings), -1.0), np.zeros(len(readings), np.intp)
        self._fitting, self._samples = np.zeros(len(readings), np.intp), 0

    def add(self, block: SampleBlock) -> None:
        """Take these rows into account, a few at a time if there are many candidates."""
        at_once = max(1, _AT_ONCE // len(self._share))
        for start in range(0, len(block), at_once):
            self._add(block.at(slice(start, start + at_once)))
        self._samples += len(block)

    def _add(self, block: SampleBlock) -> None:
        angles, velocities = self._candidates.residuals(block, self._scale)
        shares = np.maximum(angles / self._allowed, velocities / self._allowed_velocity)
        self._fitting += (shares <= 1).sum(axis=0)
        self._angle = np.maximum(self._angle, angles.max(axis=0))
        self._velocity = np.maximum(self._velocity, velocities.max(axis=0))
        worse = shares.max(axis=0) > self._share
        self._row = np.where(worse, block.rows[shares.argmax(axis=0)], self._row)
        self._share = np.maximum(self._share, shares.max(axis=0))

    def answers(self, source: SampleSource) -> tuple[Answer, ...]:
        """The candidates that fit every row, or only the nearest."""
        fitting = np.flatnonzero(self._fitting == self._samples)
        if not len(fitting):
            fitting = np.lexsort((self._share, -self._fitting))[:1]
        places = {row: source.place(row) for row in set(self._row[fitting].tolist())}
        answers = (self._answer(k, places[int(self._row[k])]) for k in fitting.tolist())
        return tuple(sorted(answers, key=lambda answer: answer.reading.plainness()))

    def _answer(self, number: int, worst: str) -> Answer:
        reading = self._candidates.readings[number]
        return Answer(
            reading=reading,
            residual=float(self._angle[number]),
            velocity_residual=float(self._velocity[number]) if reading.velocity else None,
            worst=worst,
            fitting=int(self._fitting[number]),
            samples=self._samples,
        )
