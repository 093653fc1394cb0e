"""Readings in other frames: the constant rotations that bring them to the data."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from math import pi

import numpy as np

from rigidsym.tools.identify.frames import PERMUTATIONS, Frames, Matrix, multiplied, transposed
from rigidsym.tools.identify.readings import Reading
from rigidsym.tools.identify.samples import SampleBlock
from rigidsym.tools.identify.tolerance import Tolerance
from rigidsym.tools.identify.turns import (
    Array,
    ReadingTable,
    angle_between,
    matrix_of,
    quaternion_of,
)

_BY_CHANCE = 1e-3  # readings that may be expected to fit by chance
_ANGLES = np.array([[0.3, 0.9, -1.4], [20.0, 35.0, 50.0], [-1.1, 0.6, 0.8]])  # in any unit
_MOST_COUNTED = 4  # samples: data of one motion are not independent


def aligned(table: ReadingTable, block: SampleBlock, tolerance: Tolerance) -> list[Reading]:
    """The readings that fit the data of a block in other frames, each in its plainest words.

    Frames whose axes are permuted and reversed go before misalignments, for which at least two
    different samples are needed. None if the tolerance is so wide that some would fit by chance.
    """
    different = len(np.unique(block.angles, axis=0))
    allowed = tolerance.of(np.array([reading.degrees for reading in table.readings]))
    right, left = table.constants(block.angles, block.orientation())
    found: list[Reading] = []
    if _by_chance(len(table) * len(PERMUTATIONS), tolerance, different) < _BY_CHANCE:
        found = list(_permuted(table, right, allowed))
        found = found if block.omega is not None else _different(found)
    if found or _by_chance(2 * len(table), tolerance, different - 1) >= _BY_CHANCE:
        return found
    return [
        *_misaligned(table, right, allowed, is_right=True),
        *_misaligned(table, left, allowed, is_right=False),
    ]


def _by_chance(readings: int, tolerance: Tolerance, samples: int) -> float:
    """How many readings a rotation at random would fit: ε³/6π of all rotations are within ε."""
    share = tolerance.orientation**3 / (6 * pi)
    return readings * share ** min(samples, _MOST_COUNTED) if samples > 0 else float(readings)


def _permuted(table: ReadingTable, right: Array, allowed: Array) -> Iterator[Reading]:
    """Data that are a reading times a permutation of axes, (4, n, readings)."""
    known = quaternion_of(np.array(PERMUTATIONS))
    nearest = np.abs(np.einsum("kc,cr->kr", known, right[:, 0])).argmax(axis=0)
    off = angle_between(right, known[nearest].T[:, None], axis=0)
    for place in np.flatnonzero((off <= allowed).all(axis=0)).tolist():
        yield plainest(table.readings[place], PERMUTATIONS[nearest[place]])


def _different(readings: Sequence[Reading]) -> list[Reading]:
    """The plainest of readings that are one function of the angles.

    A quaternion with its scalar first in some frames is one with its scalar last in others.
    """
    ordered = sorted(readings, key=Reading.plainness)
    if len(ordered) < 2:
        return ordered
    values = ReadingTable(ordered).as_given(_ANGLES)  # (n, readings, 4)
    same = (np.abs(np.einsum("nri,nsi->nrs", values, values)) > 1 - 1e-9).all(axis=0)
    return [reading for k, reading in enumerate(ordered) if not same[k, :k].any()]


def plainest(reading: Reading, constant: Matrix) -> Reading:
    """The words, of all that say the same, for the data of a reading times a permutation.

    R Q = P (Pᵀ R P) (Pᵀ Q), where Pᵀ R P turns about permuted axes.
    """
    turns = reading.active()
    found = [
        replace(
            turns.about_other_axes(transposed(p)),
            frames=Frames(space=p, body=multiplied(transposed(p), constant)),
        )
        for p in PERMUTATIONS
    ]
    return _plainest(found)


def _plainest(readings: Sequence[Reading]) -> Reading:
    both = [each for one in readings for each in (one, one.in_other_direction())]
    return min([*both, *(each.in_other_manner() for each in both)], key=Reading.plainness)


def _misaligned(
    table: ReadingTable, constants: Array, allowed: Array, *, is_right: bool
) -> Iterator[Reading]:
    """Data that are a reading times one rotation, the mean of those of the samples."""
    first = constants[:, :1]
    same = np.where(np.sum(constants * first, axis=0) < 0, -1.0, 1.0)
    mean = (constants * same).sum(axis=1)
    mean /= np.linalg.norm(mean, axis=0)
    off = angle_between(constants, mean[:, None], axis=0)
    for place in np.flatnonzero((off <= allowed).all(axis=0)).tolist():
        matrix: Matrix = tuple(map(tuple, matrix_of(mean[:, place]).tolist()))
        frames = Frames(body=matrix) if is_right else Frames(space=matrix)
        yield _plainest([replace(table.readings[place].active(), frames=frames)])
