"""The readings that fit: all are tried on a few rows, and those that fit them on every row."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from rigidsym.data.text import MOST_SHOWN
from rigidsym.system.progress import Progress
from rigidsym.tools.identify.align import aligned
from rigidsym.tools.identify.calls import calls
from rigidsym.tools.identify.readings import VELOCITIES, Reading, Velocity, distinct
from rigidsym.tools.identify.samples import SLACK, Block, SampleError, check
from rigidsym.tools.identify.sources import Source
from rigidsym.tools.identify.tolerance import Tolerance, check_tolerance, tolerances
from rigidsym.tools.identify.turns import Array, Table
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


@dataclass(frozen=True, kw_only=True, slots=True)
class Outcome:
    """The readings that fit every row, and the tolerance for that."""

    answers: tuple[Answer, ...]  # in the order of plainness; only the nearest if none fits
    tolerance: Tolerance
    scale: float  # the largest |Ω| of the rows tried first


def fit(
    source: Source, tolerance: float | None = None, progress: Progress | None = None
) -> Outcome:
    """The readings that fit the samples or, if none does, the nearest.

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
    return Outcome(answers=tally.answers(source), tolerance=chosen, scale=scale)


def _good(source: Source, slack: float) -> Iterator[Block]:
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


def _scale(block: Block) -> float:
    """The largest |Ω|, or the largest rate if all Ω are zero."""
    if block.omega is None or block.rates is None:
        return 1.0
    lengths = [float(np.linalg.norm(part, axis=1).max()) for part in (block.omega, block.rates)]
    return next((length for length in lengths if length), 1.0)


class _Candidates:
    """A grid of readings: of the orientation down, of Ω across."""

    def __init__(self, orientations: Sequence[Reading], velocities: Sequence[Velocity]) -> None:
        self.table = Table(orientations)
        self.velocities = tuple(velocities)  # none if the data have no Ω

    def __len__(self) -> int:
        return len(self.table) * max(1, len(self.velocities))

    def grid(self) -> list[list[Reading]]:
        """Rows of readings; one column if the data have no Ω."""
        velocities = self.velocities or (None,)
        return [[replace(r, velocity=v) for v in velocities] for r in self.table.readings]

    def angles(self, block: Block) -> Array:
        """Between each reading and the data, in radians: (n, readings of the orientation)."""
        return self.table.residuals(block.angles, block.orientation())

    def velocity_residuals(self, block: Block, scale: float) -> Array:
        """|difference of Ω| over the scale: (n, readings of the orientation, readings of Ω)."""
        if block.rates is None or block.omega is None:
            return np.zeros((len(block), len(self.table), 1))
        omega = angular_velocities(self.table.readings, block.angles, block.rates)
        difference = as_given(omega, self.velocities) - block.omega[:, None, None]
        return np.asarray(np.linalg.norm(difference, axis=-1) / scale)


@cache
def _everything(layouts: tuple[bool | None, ...]) -> Table:
    return Table(sorted(distinct(layouts), key=Reading.plainness))


def _narrowed(
    source: Source, block: Block, asked: float | None, scale: float
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
    return tolerance, _nearest_velocity(left, block, scale)


def _with_velocities(
    orientations: Sequence[Reading], block: Block, scale: float, tolerance: float
) -> list[Reading]:
    """Each reading of the orientation with every reading of Ω that fits."""
    if block.omega is None:
        return list(orientations)
    candidates = _Candidates(orientations, VELOCITIES)
    fits = candidates.velocity_residuals(block, scale).max(axis=0) <= tolerance
    grid = candidates.grid()
    return [grid[row][column] for row, column in np.argwhere(fits)]


def _nearest_velocity(orientations: Sequence[Reading], block: Block, scale: float) -> list[Reading]:
    if block.omega is None:
        return [orientations[0]]
    candidates = _Candidates(orientations, VELOCITIES)
    worst = candidates.velocity_residuals(block, scale).max(axis=0)
    row, column = np.unravel_index(worst.argmin(), worst.shape)
    return [candidates.grid()[row][column]]


class _Tally:
    """The largest residuals so far of each candidate of a grid."""

    def __init__(self, readings: Sequence[Reading], tolerance: Tolerance, scale: float) -> None:
        orientations = list(dict.fromkeys(r.orientation for r in readings))
        velocities = list(dict.fromkeys(r.velocity for r in readings if r.velocity))
        self._candidates = _Candidates(orientations, velocities)
        self._readings = frozenset(readings)
        self._allowed = tolerance.of(np.array([r.degrees for r in orientations]))
        self._allowed_velocity, self._scale = tolerance.velocity, scale
        shape = (len(orientations), max(1, len(velocities)))
        self._angle, self._velocity = np.zeros(len(orientations)), np.zeros(shape)
        self._share, self._row = np.full(shape, -1.0), np.zeros(shape, np.intp)
        self._fitting, self._samples = np.zeros(shape, np.intp), 0

    def add(self, block: Block) -> None:
        """Take these rows into account, a few at a time if there are many candidates."""
        at_once = max(1, _AT_ONCE // len(self._candidates))
        for start in range(0, len(block), at_once):
            self._add(block.at(slice(start, start + at_once)))
        self._samples += len(block)

    def _add(self, block: Block) -> None:
        angles = self._candidates.angles(block)
        velocities = self._candidates.velocity_residuals(block, self._scale)
        shares = np.maximum(
            (angles / self._allowed)[..., None], velocities / self._allowed_velocity
        )
        self._fitting += (shares <= 1).sum(axis=0)
        self._angle = np.maximum(self._angle, angles.max(axis=0))
        self._velocity = np.maximum(self._velocity, velocities.max(axis=0))
        worse = shares.max(axis=0) > self._share
        self._row = np.where(worse, block.rows[shares.argmax(axis=0)], self._row)
        self._share = np.maximum(self._share, shares.max(axis=0))

    def answers(self, source: Source) -> tuple[Answer, ...]:
        """The candidates that fit every row, or only the nearest."""
        found = [
            (self._answer(row, column, reading, source), float(self._share[row, column]))
            for row, readings in enumerate(self._candidates.grid())
            for column, reading in enumerate(readings)
            if reading in self._readings
        ]
        fitting = [answer for answer, _ in found if answer.fits]
        nearest, _ = min(found, key=lambda pair: (-pair[0].fitting, pair[1]))
        return tuple(sorted(fitting, key=lambda a: a.reading.plainness())) or (nearest,)

    def _answer(self, row: int, column: int, reading: Reading, source: Source) -> Answer:
        return Answer(
            reading=reading,
            residual=float(self._angle[row]),
            velocity_residual=float(self._velocity[row, column]) if reading.velocity else None,
            worst=source.place(int(self._row[row, column])),
            fitting=int(self._fitting[row, column]),
            samples=self._samples,
        )
