"""Which convention do these numbers follow? The entry to this folder, and its report."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from math import degrees
from pathlib import Path
from textwrap import indent
from typing import Any

from numpy.typing import ArrayLike

from rigidsym.data.columns import counted
from rigidsym.system.processes import Progress
from rigidsym.tools.identify.fit import (
    Answer,
    FurtherSample,
    Tolerance,
    fit,
    further_sample,
)
from rigidsym.tools.identify.readings import ANGLE_NAMES, VELOCITIES, Reading, distinct
from rigidsym.tools.identify.samples import SampleSource, from_arrays, from_file

SCHEMA = "rigidsym.identification"
SCHEMA_VERSION = 2
_MOST_SHOWN = 6
_ACCEPTABLE = 0.2  # radians; no tolerance is suggested for a nearest reading further off


@dataclass(frozen=True, kw_only=True)
class Identification:
    """Every reading that fits, the plainest first; if none does, the nearest."""

    answers: tuple[Answer, ...]
    nearest: Answer | None  # if nothing fits
    tolerance: Tolerance
    samples: int
    tried: int  # readings that differ as functions of the data
    names: tuple[str, ...]  # of the angle columns
    converted: tuple[str, ...]  # columns whose unit was converted
    unused: str  # columns of a velocity that say nothing alone, in words
    has_velocity: bool  # rates and Ω were given
    further: FurtherSample | None  # that tells the answers apart, if there is one

    @property
    def fits(self) -> bool:
        return bool(self.answers)

    def text(self, *, everything: bool = False) -> str:
        """The report of `rigidsym identify`; with `everything`, that of --all.

        Its lines have 80 columns unless the names of the angles are long.
        """
        if self.nearest:
            lines = _no_fit(self, self.nearest)
        elif len(self.answers) == 1:
            lines = _single(self, self.answers[0])
        else:
            lines = _several(self, everything=everything)
        unused = [f"not used: {self.unused}"] if self.unused else []
        return "\n".join([*lines, *unused])

    def record(self) -> dict[str, Any]:
        """The report of `rigidsym identify --json`: dictionaries, lists, texts and numbers."""
        tolerance, names, further = self.tolerance, self.names, self.further
        return {
            "schema": SCHEMA,
            "schema_version": SCHEMA_VERSION,
            "fits": self.fits,
            "samples": self.samples,
            "tried": self.tried,
            "angle_names": list(names),
            "tolerance": {
                "orientation_rad": tolerance.orientation,
                "velocity_relative": tolerance.velocity if self.has_velocity else None,
                "because": tolerance.because,
            },
            "answers": [_answer(answer, names) for answer in self.answers],
            "nearest": self.nearest and _answer(self.nearest, names),
            "further": further and asdict(further),
        }

    def __str__(self) -> str:
        return self.text()


def _single(result: Identification, answer: Answer) -> Iterator[str]:
    yield from _wrapped(answer.reading.words(result.names), "")
    same, *others = answer.aliases
    yield from _wrapped("= " + same.brief(result.names), "")
    yield ""
    kind = "matrix =" if answer.reading.scalar_last is None else "quaternion of"
    yield f"{kind} {answer.reading.product(result.names)}"
    yield f"fits {counted(result.samples, 'sample')}: {_residual(answer)}"
    yield f"tolerance {_tolerance(result)}"
    if result.converted:
        yield f"converted to {answer.reading.unit}: {', '.join(result.converted)}"
    if others:
        yield ""
        yield "Equivalent descriptions:"
    for reading in others:
        yield from _wrapped(reading.brief(result.names), "  ")
    yield ""
    yield from _calls(answer)


def _calls(answer: Answer) -> Iterator[str]:
    given = "angles and rates" if answer.reading.velocity else "angles"
    yield f"Calls that reproduce the data (np is NumPy; {given} as in the data):"
    for library, statements in answer.calls.items():
        yield f"  {library}"
        yield indent(statements, "    ")


def _several(result: Identification, *, everything: bool) -> Iterator[str]:
    count = len(result.answers)
    shown = result.answers if everything else result.answers[:_MOST_SHOWN]
    common = _common([answer.reading for answer in result.answers])
    yield f"{count} conventions fit {counted(result.samples, 'sample')}" + (
        f", all {common}" if common else ""
    )
    yield f"tolerance {_tolerance(result)}"
    for number, answer in enumerate(shown, 1):
        yield ""
        yield from _wrapped(answer.reading.words(result.names), f"{number:>2}  ")
        yield f"    {answer.reading.product(result.names)}; {_residual(answer)}"
        if everything:
            for reading in answer.aliases:
                yield from _wrapped("= " + reading.brief(result.names), "    ")
            yield indent("\n".join(_calls(answer)), "    ")
    if not everything:
        more = f"and {count - len(shown)} more; " if count > len(shown) else ""
        yield f"\n{more}--all shows {'them and ' if more else ''}the calls for each."
    yield ""
    yield from _further(result, result.further)


def _common(readings: Sequence[Reading]) -> str:
    """In words, what all readings have in common: unit, order of the quaternion, Ω."""
    said = {
        (reading.unit, reading.scalar_words, reading.velocity.words if reading.velocity else "")
        for reading in readings
    }
    columns = [set(column) for column in zip(*said, strict=True)]
    return ", ".join(word for column in columns if len(column) == 1 for word in column if word)


def _further(result: Identification, further: FurtherSample | None) -> Iterator[str]:
    if further is None:
        yield "The tolerance is too large for one further sample to tell all of them apart."
        return
    if len({answer.reading.orientation for answer in result.answers}) == 1:
        yield "They differ only in Ω; no sample at rest tells them apart."
    yield "To tell them apart, add a sample with these values in the columns:"
    values = ", ".join(f"{n} = {a:g}" for n, a in zip(result.names, further.angles, strict=True))
    rates = ", ".join(f"{rate:g}" for rate in further.rates or ())
    yield f"  {values}" + (f"; rates {rates}" if rates else "")


def _no_fit(result: Identification, nearest: Answer) -> Iterator[str]:
    yield f"No convention fits {counted(result.samples, 'sample')}: {result.tried} were tried,"
    yield "for the axes of the data. If its frames are others than those of the angles (NED and"
    yield "ENU, FRD and FLU), convert the attitude first."
    yield f"tolerance {_tolerance(result)}"
    yield ""
    yield from _wrapped(nearest.reading.words(result.names), "Nearest: ")
    yield f"  {nearest.reading.product(result.names)}"
    yield f"  {_residual(nearest)}, worst at {nearest.worst}"
    if nearest.samples > 1:
        yield f"  {nearest.fitting} of {nearest.samples} samples fit"
    worst = max(nearest.residual, nearest.velocity_residual or 0.0)
    if worst <= _ACCEPTABLE:
        yield f"--tolerance {worst * 1.05:.2g} would accept it."
    else:
        yield f"Even the best match is {degrees(worst):.2g}° off: do the angles and the attitude"
        yield "belong to the same instant and the same body?"


def _residual(answer: Answer) -> str:
    said = f"residual {answer.residual:.2g} rad"
    if answer.residual > 1e-4:
        said += f" ({degrees(answer.residual):.2g}°)"
    if answer.velocity_residual is not None:
        said += f", Ω off by {answer.velocity_residual:.2g} of |Ω|"
    return said


def _tolerance(result: Identification) -> str:
    tolerance = result.tolerance
    said = f"{tolerance.orientation:.2g} rad"
    if result.has_velocity:
        said += f" and {tolerance.velocity:.2g} of |Ω|"
    return f"{said}, {tolerance.because}"


def _wrapped(words: str, head: str, width: int = 80) -> Iterator[str]:
    """Words after a head, broken between the parts of a reading if they are too long."""
    line, margin = head, " " * len(head)
    for part in words.split(", "):
        piece = part if line in (head, margin) else ", " + part
        if len(line + piece) > width - 1 and line not in (head, margin):
            yield line + ","
            line, piece = margin, part
        line += piece
    yield line


def _answer(answer: Answer, names: Sequence[str]) -> dict[str, Any]:
    return {
        "reading": _reading(answer.reading, names),
        "residual_rad": answer.residual,
        "velocity_residual": answer.velocity_residual,
        "worst_at": answer.worst,
        "fitting": answer.fitting,
        "aliases": [_reading(reading, names) for reading in answer.aliases],
        "calls": answer.calls,
    }


def _reading(reading: Reading, names: Sequence[str]) -> dict[str, Any]:
    velocity = reading.velocity
    return {
        "words": reading.words(names),
        "product": reading.product(names),
        "sequence": reading.sequence,
        "manner": "intrinsic" if reading.is_intrinsic else "extrinsic",
        "passive": reading.passive,
        "unit": reading.unit,
        "columns": list(reading.columns),
        "signs": list(reading.signs),
        "scalar_last": reading.scalar_last,
        "velocity": velocity
        and {"frame": velocity.frame, "opposite": velocity.is_opposite, "units": velocity.units},
    }


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
        In radians, and a fraction of the largest |Ω|; by default from the digits of the data.

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
    given = {"angles": angles, "matrix": matrix, "quaternion": quaternion}
    given |= {"rates": rates, "omega": omega}
    return identify_source(from_arrays(given, names), tolerance=tolerance)


def identify_file(
    path: str | Path,
    *,
    columns: Sequence[str] | None = None,
    tolerance: float | None = None,
    drops_missing: bool = False,
    progress: Progress | None = None,
) -> Identification:
    """The same for an NPY, Parquet or text file, which is read in chunks.

    `columns` names the columns if the file does not, with `-` for a column to leave out. A sample
    that lacks a number is an error, unless `drops_missing`. `progress` is called with the fraction
    of the file that is done.
    """
    source = from_file(Path(path), columns, drops_missing=drops_missing)
    return identify_source(source, tolerance=tolerance, progress=progress)


def identify_source(
    source: SampleSource, *, tolerance: float | None = None, progress: Progress | None = None
) -> Identification:
    """The same for any source of samples."""
    answers, chosen, scale = fit(source, tolerance, progress)
    best = answers[0]
    has_velocity = best.reading.velocity is not None
    count = sum(1 for _ in distinct(source.columns.layouts))
    return Identification(
        answers=answers if best.fits else (),
        nearest=None if best.fits else best,
        tolerance=chosen,
        samples=best.samples,
        tried=count * (len(VELOCITIES) if has_velocity else 1),
        names=source.columns.names,
        converted=source.columns.converted,
        unused=source.columns.unused,
        has_velocity=has_velocity,
        further=further_sample([answer.reading for answer in answers], chosen, scale),
    )
