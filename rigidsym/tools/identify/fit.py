"""The readings that fit: all are tried on a few rows, and the remaining ones on every row."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache
from math import pi, sqrt

import numpy as np

from rigidsym.system.resources import environment
from rigidsym.tools.identify.readings import (
    VELOCITIES,
    Reading,
    distinct,
)
from rigidsym.tools.identify.samples import SLACK, SampleError, Samples
from rigidsym.tools.identify.turns import (
    Array,
    ReadingTable,
)

FLOOR = 1e-6  # the least tolerance, since data may have been in single precision
_EXACT = 1e-9  # a matrix this close to orthogonal was not rounded
_FEW = 64  # samples that are looked at first
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


def tolerances(asked: float | None, block: Samples, scale: float) -> Iterator[Tolerance]:
    """Tolerances to try, one after the other, until a reading fits.

    If the user asks for none, first the angles are taken to be exact, then to be rounded as
    they are printed. `scale` is the largest |Ω|.
    """
    if asked is not None:
        yield Tolerance(radians=asked, degrees=asked, velocity=asked, because="as asked")
        return
    floor = max(FLOOR, 64 * block.eps)  # computing in a precision below double leaves that open
    attitude = max(floor, _attitude(block))
    velocity = floor
    if block.omega is not None and scale:
        # Three components, each off by half a unit, make a vector off by √3 halves.
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


def _attitude(block: Samples) -> float:
    """The largest rotation by which rounding has moved one of the matrices or quaternions."""
    defects = block.defects()
    rounding = np.where(
        defects <= _EXACT, 0.0, np.maximum(rounding_of(block.attitude), defects / 2)
    )
    return (4 if block.matrices is None else 3) * _largest(rounding)


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


@dataclass(frozen=True, kw_only=True, slots=True)
class Answer:
    """One reading in its plainest words, and how well it fits all of the data."""

    reading: Reading
    residual: float  # the largest angle between the reading and the data, in radians
    velocity_residual: float | None  # the largest |difference of Ω|, over the largest |Ω|
    worst: str  # where the data are furthest from it: "sample 3", "line 17"
    share: float  # of the tolerance that is reached there
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


def fit(samples: Samples, asked: float | None = None) -> tuple[tuple[Answer, ...], Tolerance]:
    """The readings that fit the samples or, if none does, the nearest; in the order of plainness.

    Also the tolerance for that; `asked` is the user's. Raises SampleError for samples that are not
    finite or not rotations.
    """
    if asked is not None and not 0 < asked < pi:
        raise SampleError([f"the tolerance is an angle between 0 and π radians, got {asked:g}"])
    samples.check(max(SLACK, 2 * (asked or 0)))
    scale = 1.0
    if samples.omega is not None and samples.rates is not None:
        sizes = [float(np.linalg.norm(p, axis=1).max()) for p in (samples.omega, samples.rates)]
        scale = next(filter(None, sizes), 1.0)  # the largest |Ω|, or rate if all Ω are zero
    tolerance, candidates = _narrowed(samples.some(_FEW), asked, scale)
    answers = sorted(
        (_answer(reading, samples, tolerance, scale) for reading in candidates),
        key=lambda answer: (-answer.fitting, answer.share),
    )
    answers = [each for each in answers if each.fits] or answers[:1]
    return tuple(sorted(answers, key=lambda answer: answer.reading.plainness())), tolerance


@cache
def _everything(layouts: tuple[bool | None, ...]) -> ReadingTable:
    return ReadingTable(sorted(distinct(layouts), key=Reading.plainness))


def _narrowed(few: Samples, asked: float | None, scale: float) -> tuple[Tolerance, list[Reading]]:
    """The readings that fit a few samples, or only the nearest, and the tolerance for the rest."""
    # Orientations are narrowed first: only with the few that fit, all conventions for Ω are tried.
    table = _everything(few.columns.layouts)
    angles = table.residuals(few.angles, few.orientation())
    readings = np.array(table.readings)
    in_degrees = np.array([reading.degrees for reading in readings])
    for tolerance in tolerances(asked, few, scale):
        off = angles > tolerance.of(in_degrees)
        orientations = readings[~off.any(axis=0)].tolist()
        if candidates := _with_velocities(orientations, few, scale, tolerance.velocity):
            return tolerance, candidates
    if not orientations:
        orientations = [readings[np.lexsort((angles.max(axis=0), off.sum(axis=0)))[0]]]
    return tolerance, _with_velocities(orientations[:1], few, scale, None)


def _with_velocities(
    orientations: Sequence[Reading], few: Samples, scale: float, tolerance: float | None
) -> list[Reading]:
    """Each reading of the orientation with every reading of Ω that fits, or with the nearest."""
    if few.omega is None or not orientations:
        return list(orientations)
    candidates = ReadingTable([replace(r, velocity=v) for r in orientations for v in VELOCITIES])
    worst = _slips(candidates, few, scale).max(axis=0)
    chosen = np.flatnonzero(worst <= tolerance) if tolerance is not None else [worst.argmin()]
    return [candidates.readings[k] for k in chosen]


def _slips(table: ReadingTable, samples: Samples, scale: float) -> Array:
    """|difference of Ω| over the scale, (n, readings)."""
    if samples.rates is None or samples.omega is None:
        return np.zeros((len(samples), len(table.readings)))
    omega = table.angular_velocities(samples.angles, samples.rates)
    return np.asarray(np.linalg.norm(omega - samples.omega.T[..., None], axis=0) / scale)


def _answer(reading: Reading, samples: Samples, tolerance: Tolerance, scale: float) -> Answer:
    table = ReadingTable([reading])
    angles = table.residuals(samples.angles, samples.orientation())[:, 0]
    slips = _slips(table, samples, scale)[:, 0]
    allowed = tolerance.degrees if reading.degrees else tolerance.radians
    shares = np.maximum(angles / allowed, slips / tolerance.velocity)
    return Answer(
        reading=reading,
        residual=float(angles.max()),
        velocity_residual=float(slips.max()) if reading.velocity else None,
        worst=samples.place(int(samples.rows[shares.argmax()])),
        share=float(shares.max()),
        fitting=int((shares <= 1).sum()),
        samples=len(samples),
    )
