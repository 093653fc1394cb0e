"""The readings that fit: all are tried on a few rows, and the remaining ones on every row."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import pi, sqrt
from typing import NamedTuple

import numpy as np

from rigidsym.system.records import Record
from rigidsym.system.resources import environment
from rigidsym.tools.identify.readings import VELOCITIES, Reading, Velocity, distinct
from rigidsym.tools.identify.samples import SLACK, Array, SampleError, Samples

FLOOR = 1e-6  # the least tolerance, since data may have been in single precision
_EXACT = 1e-9  # a matrix this close to orthogonal was not rounded
_FEW = 64  # samples that are looked at first
_MOST_FOR_ANGLES = 0.05  # radians; angles as coarse as that are taken to be exact
_MOST_PLACES = 17  # decimal places that tell one double of size 1 from the next


class Tolerance(NamedTuple):
    """Radians for orientations, by the unit of the angles; a share of the largest |Ω| for Ω."""

    if_radians: float  # if a reading takes the angles to be radians
    if_degrees: float  # if it takes them to be degrees; in radians too
    velocity: float
    because: str  # in words

    @property
    def orientation(self) -> float:
        return max(self.if_radians, self.if_degrees)


def tolerances(asked: float | None, block: Samples, scale: float) -> list[Tolerance]:
    """Tolerances to try, one after the other, until a reading fits.

    If the user asks for none, first the angles are taken to be exact, then to be rounded as
    they are printed. `scale` is the largest |Ω|.
    """
    if asked is not None:
        return [Tolerance(asked, asked, asked, "as asked")]
    floor = max(FLOOR, 64 * block.eps)  # computing in a precision below double leaves that open
    # the largest rotation by which rounding has moved one of the matrices or quaternions
    defects, digits = block.defects(), rounding_of(block.attitude)
    moved = np.where(defects <= _EXACT, 0, np.maximum(digits, defects / 2))
    attitude = max(floor, float(moved.max()) * (3 if "matrix" in block.parts else 4))
    angles, rates, omega = (
        float(rounding_of(block.parts[part]).max()) if part in block.parts else 0.0
        for part in ("angles", "rates", "omega")
    )
    # Three components, each off by half a unit, make a vector off by √3 halves.
    velocity = max(floor, sqrt(3) * omega / scale)
    source = "the digits of the data"
    # Entries off by r each, in rows of unit length, make M Mᵀ differ from 1 by 2 √3 r at most.
    if attitude > floor and (moved > 2 * digits)[moved.argmax()]:
        source = "how far the attitude is from a rotation"
    is_rounded = max(attitude, velocity) > FLOOR
    because = f"from {source}" if is_rounded else "for exact data"
    first = Tolerance(attitude, attitude, velocity, because)
    turned = [3 * angles, 3 * np.radians(angles)]
    extra = [each if each <= _MOST_FOR_ANGLES else 0.0 for each in turned]
    if not any(extra):
        return [first]
    velocity += max(extra) + min(3 * rates / scale, _MOST_FOR_ANGLES)
    because = f"from {source} and from the digits of the angles"
    return [first, Tolerance(attitude + extra[0], attitude + extra[1], velocity, because)]


def rounding_of(rows: Array) -> Array:
    """Half a unit in the last place of the numbers of each row, as they print; 0 for integers."""
    places = np.full(rows.shape, _MOST_PLACES)
    for count in reversed(range(_MOST_PLACES)):
        places[np.round(rows, count) == rows] = count
    # With %.4g, small numbers have more decimal places: those of the largest size tell. If these
    # are integers, such as the ones of a turn about one axis, the others do.
    sizes = np.abs(rows)
    are_large = sizes >= sizes.max(axis=1, keepdims=True) / 10
    most = np.where(are_large, places, 0).max(axis=1)
    most = np.where(most > 0, most, places.max(axis=1))
    return np.where(most > 0, 0.5 * 10.0**-most, 0.0)


class Misfit(NamedTuple):
    """How far readings are from samples: (readings, n) each."""

    angles: Array  # between orientations, in radians
    slips: Array  # |difference of Ω|, over the scale


def misfit(readings: Sequence[Reading], samples: Samples, scale: float) -> Misfit:
    """How far each reading is from each sample.

    A turning frame is a pair (R, Ω). Turning on about a body axis e by the angle a gives the pair
    (R T(e, a), Ω + ȧ R e); three such steps are a reading.
    """
    turns = [(r.in_other_direction() if r.passive else r).intrinsic() for r in readings]
    groups: dict[tuple[str, bool | None, Velocity | None], list[int]] = {}
    for k, turn in enumerate(turns):
        groups.setdefault((turn.sequence, turn.scalar_last, turn.velocity), []).append(k)
    matrices = {each: samples.orientation(each).T[..., None] for each in {key[1] for key in groups}}
    angles, rates = samples.parts["angles"], samples.parts.get("rates", np.zeros((1, 3)))
    result = Misfit(*np.zeros((2, len(turns), len(samples))))
    for (sequence, scalar_last, velocity), group in groups.items():
        columns = np.array([turns[k].columns for k in group]).T
        signs = np.array([turns[k].signs for k in group]).T
        factors = np.array([turns[k].factor for k in group])
        # The columns of R, and Ω: (3, n, readings), or (3, 1, 1) if they are the same for all.
        frame, omega = [*np.eye(3)[..., None, None]], np.zeros((3, 1, 1))
        for axis, column, sign in zip(map("XYZ".index, sequence), columns, signs, strict=True):
            omega = omega + frame[axis] * (rates[:, column] * sign)
            turned = angles[:, column] * (sign * factors)
            cosine, sine = np.cos(turned), np.sin(turned)
            second, third = (axis + 1) % 3, (axis + 2) % 3
            b, c = frame[second], frame[third]
            frame[second], frame[third] = b * cosine + c * sine, c * cosine - b * sine
        # Σ rₖ × mₖ = 2 e sin α and Σ rₖ·mₖ = 1 + 2 cos α for the columns of R and M = T(e, α) R:
        # no digits are lost near α = 0, and rounding of M that keeps it symmetric does not count.
        pairs = [*zip(frame, matrices[scalar_last], strict=True)]
        sine = np.linalg.norm(sum(np.cross(r, m, axis=0) for r, m in pairs), axis=0)
        cosine = sum(np.sum(r * m, axis=0) for r, m in pairs) - 1
        result.angles[group] = np.arctan2(sine, cosine).T
        if velocity:
            if velocity.frame == "body":
                omega = np.stack([np.sum(column * omega, axis=0) for column in frame])
            off = velocity.factor * omega - samples.parts["omega"].T[..., None]
            result.slips[group] = np.linalg.norm(off, axis=0).T / scale
    return result


class Answer(Record, kw_only=True):
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
    if not len(samples):
        raise SampleError([f"{samples.source}: no samples".removeprefix(": ")])
    samples.check(max(SLACK, 2 * (asked or 0)))
    has_velocity = "omega" in samples.parts
    velocities = [samples.parts[part] for part in ("omega", "rates") if has_velocity]
    sizes = (float(np.linalg.norm(each, axis=1).max()) for each in velocities)
    scale = next(filter(None, sizes), 1.0)  # the largest |Ω|, or rate if all Ω are zero
    few = samples.some(_FEW)
    table = distinct(samples.columns.layouts)
    off = misfit(table, few, scale)
    for tolerance in tolerances(asked, few, scale):
        # Orientations first: only with the few that fit, all conventions for Ω are tried.
        candidates, fits = _best(table, off, tolerance)
        if has_velocity:
            candidates = [replace(r, velocity=v) for r in candidates for v in VELOCITIES]
            candidates, is_close = _best(candidates, misfit(candidates, few, scale), tolerance)
            fits = fits and is_close
        if fits:
            break
    plainest = [min((r, *r.aliases()), key=Reading.plainness) for r in candidates]
    answers = [_answer(reading, samples, tolerance, scale) for reading in plainest]
    answers.sort(key=lambda answer: (-answer.fitting, answer.share, answer.reading.plainness()))
    answers = [each for each in answers if each.fits] or answers[:1]
    return tuple(sorted(answers, key=lambda answer: answer.reading.plainness())), tolerance


def _shares(readings: Sequence[Reading], off: Misfit, tolerance: Tolerance) -> Array:
    """How much of the tolerance each reading needs for each sample, (readings, n)."""
    limits = [tolerance.if_degrees if r.degrees else tolerance.if_radians for r in readings]
    return np.maximum(off.angles / np.array(limits)[:, None], off.slips / tolerance.velocity)


def _best(
    readings: Sequence[Reading], off: Misfit, tolerance: Tolerance
) -> tuple[list[Reading], bool]:
    """The readings that fit, or only the nearest ones; and whether any fits."""
    missed = (_shares(readings, off, tolerance) > 1).sum(axis=1)
    worst = off.angles.max(axis=1) + off.slips.max(axis=1)
    is_best = missed == missed.min()
    if missed.any(where=is_best):
        is_best &= worst <= worst.min(where=is_best, initial=np.inf) + _EXACT
    return [readings[k] for k in np.flatnonzero(is_best).tolist()], not missed.min()


def _answer(reading: Reading, samples: Samples, tolerance: Tolerance, scale: float) -> Answer:
    off = misfit([reading], samples, scale)
    (shares,) = _shares([reading], off, tolerance)
    return Answer(
        reading=reading,
        residual=float(off.angles.max()),
        velocity_residual=float(off.slips.max()) if reading.velocity else None,
        worst=samples.place(int(samples.rows[shares.argmax()])),
        share=float(shares.max()),
        fitting=int((shares <= 1).sum()),
        samples=len(samples),
    )
