"""The readings that fit: all are tried on a few rows, and the remaining ones on every row."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache
from math import ceil, log10, pi, sqrt

import numpy as np

from rigidsym.data.tables import MOST_SHOWN
from rigidsym.system.processes import Progress
from rigidsym.system.resources import environment
from rigidsym.tools.identify.readings import (
    VELOCITIES,
    Reading,
    distinct,
)
from rigidsym.tools.identify.samples import SLACK, SampleBlock, SampleError, SampleSource, check
from rigidsym.tools.identify.turns import (
    Array,
    ReadingTable,
    angular_velocities,
)

FLOOR = 1e-6  # the least tolerance, since data may have been in single precision
_EXACT = 1e-9  # a matrix this close to orthogonal was not rounded
_MOST_FOR_ANGLES = 0.05  # radians; angles as coarse as that are taken to be exact


@dataclass(frozen=True, kw_only=True, slots=True)
class Tolerance:
    """Radians for orientations, by the unit of the angles; a share of the largest |Ω| for Ω."""

    radians: float  # if a reading takes the angles to be radians
    degrees: float  # if it takes them to be degrees; in radians too
    velocity: float
    because: str  # in words

    @property
    def orientation(self) -> float:
        return max(self.radians, self.degrees)

    def of(self, in_degrees: np.ndarray) -> Array:
        return np.where(in_degrees, self.degrees, self.radians)


def tolerances(
    asked: float | None, block: SampleBlock, coarseness: float, scale: float
) -> Iterator[Tolerance]:
    """Tolerances to try, one after the other, until a reading fits.

    If the user asks for none, first the angles are taken to be exact, then to be rounded as
    they are printed. `scale` is the largest |Ω|.
    """
    if asked is not None:
        yield Tolerance(radians=asked, degrees=asked, velocity=asked, because="as asked")
        return
    floor = max(FLOOR, coarseness)
    attitude = max(floor, _attitude(block))
    velocity = floor
    if block.omega is not None and scale:
        velocity = max(floor, sqrt(3) * _largest(rounding_of(block.omega)) / scale)
    yield Tolerance(
        radians=attitude,
        degrees=attitude,
        velocity=velocity,
        because="from the digits of the data"
        if max(attitude, velocity) > FLOOR
        else "for exact data",
    )
    rounding = 3 * _largest(rounding_of(block.angles))
    slow = 0.0 if block.rates is None else 3 * _largest(rounding_of(block.rates))
    in_radians, in_degrees = (
        attitude + extra if extra <= _MOST_FOR_ANGLES else attitude
        for extra in (rounding, rounding * pi / 180)
    )
    if max(in_radians, in_degrees) > attitude:
        more = max(in_radians, in_degrees) - attitude
        yield Tolerance(
            radians=in_radians,
            degrees=in_degrees,
            velocity=velocity + more + min(slow / scale if scale else 0.0, _MOST_FOR_ANGLES),
            because="from the digits of the data and of the angles",
        )


def check_tolerance(asked: float | None) -> None:
    """Raises SampleError for a tolerance that is not between 0 and π."""
    if asked is not None and not 0 < asked < pi:
        raise SampleError([f"the tolerance is an angle between 0 and π radians, got {asked:g}"])


def _attitude(block: SampleBlock) -> float:
    """The largest rotation by which rounding has moved one of the matrices or quaternions."""
    defects = block.defects()
    rounding = np.where(
        defects <= _EXACT, 0.0, np.maximum(rounding_of(block.attitude), defects / 2)
    )
    return (3 if block.is_matrix else 4) * _largest(rounding)


def _largest(rounding: Array) -> float:
    return float(rounding.max(initial=0.0))


def rounding_of(rows: Array) -> Array:
    """Half a unit in the last place of the numbers of each row, as they print; 0 for integers."""
    return np.array([_rounding(row) for row in rows.tolist()])


def _rounding(row: list[float]) -> float:
    """By the numbers of the largest size: with %.4g, small ones have more decimal places."""
    least = max(map(abs, row)) / 10
    places = max(_places(number) for number in row if abs(number) >= least)
    if places <= 0:  # such as the ones of a turn about one axis
        places = max(map(_places, row))
    return 0.5 * 10.0**-places if places > 0 else 0.0


def _places(number: float) -> int:
    """Decimal places of a number as Python prints it: 1.25e-05 has 7, 3.0 has none."""
    digits, _, exponent = repr(number).partition("e")
    fraction = digits.partition(".")[2].rstrip("0")
    return len(fraction) - int(exponent or 0) if fraction or exponent else 0


_CLEAR = 3.0  # tolerances; two readings less than two apart might fit one sample
# At these angles the closest two of all readings are 0.05 rad or more apart: of some hundred
# triples of round numbers, the best for matrices and for quaternions.
_TELLING = {"degrees": (15.0, 20.0, 50.0), "radians": (0.3, 0.4, 0.9)}


@dataclass(frozen=True, kw_only=True, slots=True)
class FurtherSample:
    """Values for the angle columns and, if Ω is given, for their rates."""

    angles: tuple[float, float, float]
    rates: tuple[float, float, float] | None = None


def further_sample(
    readings: Sequence[Reading], tolerance: Tolerance, scale: float
) -> FurtherSample | None:
    """A sample that tells these readings apart.

    None if there is only one, and if the tolerance is too wide. `scale` is the largest |Ω|.
    """
    orientations = list(dict.fromkeys(reading.orientation for reading in readings))
    in_degrees = any(reading.degrees for reading in orientations)
    angles = _TELLING["degrees" if in_degrees else "radians"]
    (values,) = ReadingTable(orientations).as_given(np.array([angles]))
    closeness = np.abs(values @ values.T) - np.eye(len(orientations))  # |cos| of half the angle
    least = 2 * np.arccos(min(1.0, float(closeness.max())))
    if len(readings) < 2 or least <= _CLEAR * tolerance.orientation:
        return None
    if readings[0].velocity is None:
        return FurtherSample(angles=angles)
    speed = 10.0 ** max(0, ceil(log10(scale)))  # about as fast as the data
    return FurtherSample(angles=angles, rates=(speed, 2 * speed, 3 * speed))


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
        """Python statements by library (SciPy, rigidsym) that reproduce the data."""
        return calls(self.reading)


def calls(reading: Reading) -> dict[str, str]:
    """Statements that end in `matrix` or `quaternion`, and perhaps in `omega`, by library.

    They start from NumPy as np and from `angles` (and `rates`): the columns of one sample in the
    order of the data, (3,); SciPy and rigidsym take (..., 3) too.
    """
    template = environment().get_template("identify/calls.py.jinja")
    libraries = ("SciPy", "rigidsym")
    return {name: template.render(library=name, reading=reading).rstrip() for name in libraries}


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
        place = source.place if len(faults) < MOST_SHOWN else str  # finding a line takes time
        good, wrong, more = check(block, place, slack)
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


def _residuals(table: ReadingTable, block: SampleBlock, scale: float) -> tuple[Array, Array]:
    """Angles to the data in radians, and |difference of Ω| over the scale: (n, readings)."""
    angles = table.residuals(block.angles, block.orientation())
    if block.rates is None or block.omega is None:
        return angles, np.zeros_like(angles)
    omega = angular_velocities(table.readings, block.angles, block.rates)
    return angles, np.linalg.norm(omega - block.omega[:, None], axis=-1) / scale


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
    trials = list(tolerances(asked, block, source.coarseness, scale))
    for tolerance in trials:
        off = angles > tolerance.of(in_degrees)
        orientations = readings[~off.any(axis=0)].tolist()
        if candidates := _with_velocities(orientations, block, scale, tolerance.velocity):
            return tolerance, candidates
    if not orientations:
        orientations = [readings[np.lexsort((angles.max(axis=0), off.sum(axis=0)))[0]]]
    return tolerance, _with_velocities(orientations[:1], block, scale, None)


def _with_velocities(
    orientations: Sequence[Reading], block: SampleBlock, scale: float, tolerance: float | None
) -> list[Reading]:
    """Each reading of the orientation with every reading of Ω that fits, or with the nearest."""
    if block.omega is None or not orientations:
        return list(orientations)
    candidates = ReadingTable([replace(r, velocity=v) for r in orientations for v in VELOCITIES])
    worst = _residuals(candidates, block, scale)[1].max(axis=0)
    chosen = np.flatnonzero(worst <= tolerance) if tolerance is not None else [worst.argmin()]
    return [candidates.readings[k] for k in chosen]


class _Tally:
    """The largest residuals so far of each candidate."""

    def __init__(self, readings: Sequence[Reading], tolerance: Tolerance, scale: float) -> None:
        self._candidates = ReadingTable(readings)
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
        angles, velocities = _residuals(self._candidates, block, self._scale)
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
