"""`rigidsym identify`: from texts and files to findings, with progress."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from rigidsym.system.progress import bar
from rigidsym.tools.identify.identify import Identification, identify_file, identify_source
from rigidsym.tools.identify.readings import ANGLE_NAMES
from rigidsym.tools.identify.samples import OptionError, SampleError
from rigidsym.tools.identify.sources import from_arrays, parts_missing

_COUNTS = {"angles": 3, "matrix": 9, "quaternion": 4, "rates": 3, "omega": 3}
_BRACKETS = str.maketrans("[](){};", "      ,")


def identified(
    path: Path | None,
    texts: Mapping[str, Sequence[str]],
    *,
    columns: str | None = None,
    tolerance: float | None = None,
) -> Identification:
    """What is in a file, or in the texts of the options.

    `texts` has the samples of each part, in their order; `columns` names those of the file.
    Raises OptionError for neither, for both and for texts that do not read, and SampleError for
    a file that does not.
    """
    if path is None and any(texts.values()):
        try:
            return _from_options(texts, tolerance)
        except SampleError as error:
            raise OptionError(error.faults, count=error.count) from None
    if path is None or any(texts.values()):
        raise OptionError(["expected a file, or --angles with --matrix or --quaternion"])
    return _from_path(path, columns, tolerance)


def _from_options(texts: Mapping[str, Sequence[str]], tolerance: float | None) -> Identification:
    faults: list[str] = []
    names: Sequence[str] = ANGLE_NAMES
    given: dict[str, ArrayLike | None] = {}
    for name, samples in texts.items():
        read = [_numbers(name, text, faults) for text in samples]
        if not faults and read:
            given[name] = np.array([numbers for _, numbers in read])
        if name == "angles" and read:
            names = read[0][0] or names
    if faults:
        raise SampleError([*faults, *parts_missing({name for name in texts if texts[name]})])
    return identify_source(from_arrays(given, names), tolerance=tolerance)


def _numbers(name: str, text: str, faults: list[str]) -> tuple[list[str], list[float]]:
    """The names and the numbers of `roll=10, pitch=20, yaw=30` or `10,20,30` or `[10 20 30]`."""
    fields = text.translate(_BRACKETS).replace(",", " ").replace("=", " = ").split()
    words = " ".join(fields).replace(" = ", "=").split()
    pairs = [word.rpartition("=") for word in words]
    numbers = []
    for _, _, number in pairs:
        try:
            numbers.append(float(number))
        except ValueError:
            faults.append(f"--{name}: {number!r} is not a number")
    if len(words) != _COUNTS[name]:
        faults.append(f"--{name}: expected {_COUNTS[name]} numbers, got {len(words)}")
    return [label for label, _, _ in pairs if label], numbers


def _from_path(path: Path, columns: str | None, tolerance: float | None) -> Identification:
    """Samples from a file, with a bar on standard error where that is a terminal."""
    names = None if columns is None else [name.strip() for name in columns.split(",")]
    with bar(path.name) as progress:
        try:
            return identify_file(path, columns=names, tolerance=tolerance, progress=progress)
        except SampleError as error:
            raise error.of(path) from None
