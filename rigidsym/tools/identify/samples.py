"""Samples: rows of angles, a matrix or quaternion, rates and angular velocity, checked."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from rigidsym.data.text import MOST_SHOWN
from rigidsym.errors import DataError
from rigidsym.tools.identify.turns import Array, quaternion_of

SLACK = 0.05  # how far M Mᵀ may be from 1, and |q| from 1, before data are refused


class SampleError(DataError):
    """Samples that cannot be read: all faults at once, each with its line or number."""

    def __init__(
        self, faults: Sequence[str], *, count: int | None = None, path: Path | None = None
    ) -> None:
        self.faults = tuple(faults)
        self.count = count or len(faults)
        more = self.count - len(faults[:MOST_SHOWN])
        shown = [*faults[:MOST_SHOWN], *([f"and {more} more"] if more else [])]
        place = "" if path is None or str(path) in shown[0] else f"{path}: "
        super().__init__(
            place + (shown[0] if len(shown) == 1 else "\n  ".join(["bad samples", *shown]))
        )

    def of(self, path: Path) -> SampleError:
        """The same, with the file that the samples are from."""
        return SampleError(self.faults, count=self.count, path=path)


class OptionError(SampleError):
    """Samples in the options of a command that cannot be read, or no samples."""

    exit_code: ClassVar[int] = 2


@dataclass(frozen=True, kw_only=True, slots=True)
class SampleBlock:
    """Some rows of the data, as given."""

    rows: NDArray[np.intp]  # their numbers in the data, (n,)
    angles: Array  # (n, 3)
    attitude: Array  # (n, 9): matrices row by row; (n, 4): quaternions
    rates: Array | None = None  # (n, 3), of the angles
    omega: Array | None = None  # (n, 3)
    done: float = 1.0  # share of the data that is read with this block

    def __len__(self) -> int:
        return len(self.rows)

    @property
    def is_matrix(self) -> bool:
        return self.attitude.shape[1] == 9

    @property
    def parts(self) -> dict[str, Array]:
        """The parts of the data by name."""
        attitude = "matrix" if self.is_matrix else "quaternion"
        named = {"angles": self.angles, attitude: self.attitude}
        if self.rates is not None and self.omega is not None:
            named |= {"rates": self.rates, "omega": self.omega}
        return named

    @property
    def matrices(self) -> Array:
        return self.attitude.reshape(-1, 3, 3)

    def at(self, which: slice | NDArray[np.bool_]) -> SampleBlock:
        """Some of the rows."""
        return SampleBlock(
            rows=self.rows[which],
            angles=self.angles[which],
            attitude=self.attitude[which],
            rates=None if self.rates is None else self.rates[which],
            omega=None if self.omega is None else self.omega[which],
            done=self.done,
        )

    def defects(self) -> Array:
        """How far each matrix is from orthogonal, or each quaternion from unit length: (n,)."""
        if not self.is_matrix:
            return np.asarray(np.abs(np.linalg.norm(self.attitude, axis=1) - 1))
        m = self.matrices
        return np.asarray(np.abs(m @ m.swapaxes(1, 2) - np.eye(3)).max(axis=(1, 2)))

    def orientation(self) -> Array:
        """Unit quaternions (n, 4): of the nearest rotations, or those given, in their order."""
        if self.is_matrix:
            return quaternion_of(self.matrices)
        return np.asarray(self.attitude / np.linalg.norm(self.attitude, axis=1, keepdims=True))


@np.errstate(all="ignore")  # numbers that overflow here are far from a rotation
def check(
    block: SampleBlock, place: Callable[[int], str], slack: float = SLACK
) -> tuple[SampleBlock, list[str], int]:
    """The good rows, the first faults of the others, and the number of faults.

    Faults are numbers that are missing or not finite, matrices that are not rotations, and
    quaternions that are not of unit length; `slack` is how far off the last two may be.
    """
    finite = np.ones(len(block), bool)
    faults: list[tuple[int, str]] = []
    for name, part in block.parts.items():
        good = np.isfinite(part).all(axis=1)
        finite &= good
        faults += [
            (row, f"{name}: a number that is missing or not finite") for row in block.rows[~good]
        ]
    rest = block.at(finite)
    turns = rest.defects() <= slack
    if block.is_matrix:
        turns &= np.linalg.det(rest.matrices) > 0
    wrong = np.flatnonzero(~turns).tolist()
    faults += [(int(rest.rows[k]), _what_is_wrong(rest, k)) for k in wrong]
    said = [f"{place(row)}: {fault}" for row, fault in sorted(faults)[:MOST_SHOWN]]
    return rest.at(turns), said, len(faults)


def _what_is_wrong(block: SampleBlock, k: int) -> str:
    defect = float(block.defects()[k])
    if not block.is_matrix:
        length = float(np.linalg.norm(block.attitude[k]))
        if not length:
            return "quaternion: zero, which is not a rotation"
        return f"quaternion: its length is {length:.4g}, expected 1"
    determinant = float(np.linalg.det(block.matrices[k]))
    if determinant < 0 and defect <= SLACK:
        return f"matrix: not a rotation but a reflection, its determinant is {determinant:.4g}"
    return (
        f"matrix: not a rotation, M Mᵀ differs from 1 by {defect:.2g} in an entry"
        f" (det M = {determinant:.4g})"
    )
