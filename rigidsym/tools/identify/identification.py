"""Which convention do these numbers follow? The entry to this folder, and its report."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from math import degrees
from pathlib import Path
from textwrap import fill
from typing import Any

from numpy.typing import ArrayLike

from rigidsym.data.columns import counted
from rigidsym.system.records import Record
from rigidsym.system.resources import environment
from rigidsym.tools.identify.fit import Answer, Tolerance, fit
from rigidsym.tools.identify.readings import ANGLE_NAMES, VELOCITIES, Reading, distinct
from rigidsym.tools.identify.samples import Columns, Samples, from_arrays, from_file

SCHEMA = "rigidsym.identification"
SCHEMA_VERSION = 4
_NEAR = 0.2  # radians; no tolerance is suggested for a nearest reading further off


class Identification(Record, kw_only=True):
    """Every reading that fits, the plainest first; if none does, the nearest."""

    answers: tuple[Answer, ...]
    nearest: Answer | None  # if nothing fits
    tolerance: Tolerance
    samples: int
    tried: int  # readings that differ as functions of the data
    columns: Columns
    has_velocity: bool  # rates and Ω were given

    @property
    def fits(self) -> bool:
        return bool(self.answers)

    @property
    def distance(self) -> float:
        """The largest residual of the nearest reading, if nothing fits."""
        nearest = self.nearest
        return max(nearest.residual, nearest.velocity_residual or 0) if nearest else 0

    @property
    def is_near(self) -> bool:
        """Whether noise could be why nothing fits."""
        return self.distance <= _NEAR

    @property
    def contradicted(self) -> tuple[str, ...]:
        """The units in the names of the columns, if no answer agrees with them."""
        stated = self.columns.stated
        parts = [answer.reading.disagreeing(stated) for answer in self.answers] or [set()]
        wrong = set.intersection(*parts)
        return tuple(f"{part} in {unit}" for part, unit in stated.items() if part in wrong)

    def text(self, *, everything: bool = False) -> str:
        """The report of `rigidsym identify`; with `everything`, that of --all.

        Its lines have 80 columns unless the names of the angles are long.
        """
        template = environment().get_template("identify/report.txt.jinja")
        return template.render(
            result=self,
            columns=self.columns,
            names=self.columns.names,
            everything=everything,
            wrapped=_wrapped,
            counted=counted,
            degrees=degrees,
        ).rstrip()

    def record(self) -> dict[str, Any]:
        """The report of `rigidsym identify --json`: dictionaries, lists, texts and numbers."""
        names = self.columns.names
        return {
            "schema": SCHEMA,
            "schema_version": SCHEMA_VERSION,
            "fits": self.fits,
            "samples": self.samples,
            "tried": self.tried,
            "angle_names": list(names),
            "tolerance": self.tolerance._asdict(),
            "contradicted": list(self.contradicted),
            "answers": [_answer(answer, names) for answer in self.answers],
            "nearest": self.nearest and _answer(self.nearest, names),
        }

    def __str__(self) -> str:
        return self.text()


def _wrapped(words: str, head: str = "") -> str:
    """Words after a head, in lines of 79 characters."""
    margin = " " * len(head)
    return fill(words, 79, initial_indent=head, subsequent_indent=margin, break_long_words=False)


def _answer(answer: Answer, names: Sequence[str]) -> dict[str, Any]:
    return {
        **asdict(answer),
        "reading": _reading(answer.reading, names),
        "aliases": [_reading(reading, names) for reading in answer.aliases],
        "calls": answer.calls,
    }


def _reading(reading: Reading, names: Sequence[str]) -> dict[str, Any]:
    return {"words": reading.words(names), "product": reading.product(names), **asdict(reading)}


def identify(
    angles: ArrayLike,
    *,
    matrix: ArrayLike | None = None,
    quaternion: ArrayLike | None = None,
    rates: ArrayLike | None = None,
    omega: ArrayLike | None = None,
    names: Sequence[str] = ANGLE_NAMES,
    tolerance: float | None = None,
) -> Identification:
    """Every convention that reproduces these samples.

    The attitude must be between the frames of the angles: convert from NED to ENU, or from FRD to
    FLU, before.

    Parameters
    ----------
    angles : array_like, (n, 3) or (3,), or data frame
        In any order and unit. Instead, one table with named columns for all parts.
    matrix : array_like, (n, 3, 3) or (n, 9), or a Rotation of SciPy, optional
        The attitude; R or its transpose.
    quaternion : array_like, (n, 4), or a Rotation of SciPy, optional
        The attitude, scalar first or last, in place of `matrix`.
    rates, omega : array_like, (n, 3), optional
        Rates of the angles, and components of the angular velocity; give both or neither.
    names : sequence of str, optional
        Names of the angles, for the report.
    tolerance : float, optional
        In radians, and a fraction of the largest |Ω|; by default from the digits of the data
        or, if it is more, from how far the attitude is from a rotation.

    Returns
    -------
    Identification
        `answers`, the plainest first. If there are none, `fits` is false, and `nearest` is the
        nearest reading.

    Raises
    ------
    SampleError
        For samples that are not finite, not rotations, or of the wrong shape.

    Examples
    --------
    >>> import rigidsym as rs
    >>> result = rs.identify([10, 20, 30], quaternion=[0.9515, 0.0381, 0.1893, 0.2393])
    >>> result.answers[0].reading.words()
    'xyz extrinsic, active, degrees, columns (a1, a2, a3), scalar first'
    """
    parts = {"angles": angles, "matrix": matrix, "quaternion": quaternion}
    parts |= {"rates": rates, "omega": omega}
    return identified(from_arrays(parts, names), tolerance)


def identify_file(
    path: str | Path,
    *,
    columns: Sequence[str] | None = None,
    tolerance: float | None = None,
    drops_missing: bool = False,
) -> Identification:
    """The same for an NPY, Parquet or text file, which is read as a whole.

    `columns` names the columns if the file does not, with `-` for a column to leave out. A sample
    that lacks a number is an error, unless `drops_missing`.
    """
    return identified(from_file(Path(path), columns, drops_missing=drops_missing), tolerance)


def identified(samples: Samples, tolerance: float | None) -> Identification:
    """The same for samples that were read."""
    answers, chosen = fit(samples, tolerance)
    best = answers[0]
    has_velocity = "omega" in samples.parts
    return Identification(
        answers=answers if best.fits else (),
        nearest=None if best.fits else best,
        tolerance=chosen,
        samples=best.samples,
        tried=len(distinct(samples.columns.layouts)) * (len(VELOCITIES) if has_velocity else 1),
        columns=samples.columns,
        has_velocity=has_velocity,
    )
