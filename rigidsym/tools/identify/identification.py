"""Which convention do these numbers follow? The entry to this folder."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from numpy.typing import ArrayLike

from rigidsym.system.processes import Progress
from rigidsym.tools.identify.fit import fit
from rigidsym.tools.identify.readings import ANGLE_NAMES, VELOCITIES, distinct
from rigidsym.tools.identify.report import Identification
from rigidsym.tools.identify.separate import separation
from rigidsym.tools.identify.sources import SampleSource, from_arrays, from_file


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

    `angles` (n, 3) or (3,) are in any order and unit; `matrix` is (n, 3, 3), or `quaternion`
    (n, 4), scalar first or last; `rates` (n, 3) of the angles go with `omega` (n, 3), the angular
    velocity. `names` are names of the angles, for the report. `tolerance` is in radians, and a
    fraction of the largest |Ω|; by default it follows from the digits of the data. A memory map is
    read in chunks. `matrix` and `quaternion` may be a Rotation of SciPy.

    If no reading of the data as they are fits, the axes of space and body are permuted and reversed
    (NED and ENU, FRD and FLU), and constant misalignments are tried. If nothing fits, `fits` is
    false and `nearest` is the nearest reading.
    Raises SampleError for samples that are not finite, not rotations, or of the wrong shape.
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
        has_velocity=has_velocity,
        further=separation([answer.reading for answer in answers], chosen, scale),
    )
