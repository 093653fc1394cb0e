"""Principal moments and right-handed principal axes in numbers."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rigidsym.errors import BodyError

Array = NDArray[np.float64]
_EQUAL_PAIR = "The {} two principal moments are equal: all axes normal to the {} are principal."
_EQUAL = 1e-9  # of the largest moment: closer moments count as equal


@dataclass(frozen=True, kw_only=True, slots=True)
class PrincipalAxes:
    """Moments in ascending order, and their axes."""

    moments: Array  # (3,), kg m²
    axes: Array  # (3, 3), the columns are unit vectors, right-handed

    @property
    def repeated(self) -> str:
        """A sentence on equal moments and the axes they leave free; empty if all differ."""
        low, middle, high = self.moments
        slack = _EQUAL * abs(high)
        if high - low <= slack:
            return "All principal moments are equal: every axis through the centre is principal."
        if middle - low <= slack:
            return _EQUAL_PAIR.format("first", "third")
        if high - middle <= slack:
            return _EQUAL_PAIR.format("last", "first")
        return ""


def principal_axes_of(inertia: ArrayLike) -> PrincipalAxes:
    """The principal axes of an inertia tensor of numbers, (3, 3).

    The largest component of each of the first two axes is positive; the third is their cross
    product. Raises BodyError for a matrix that is not 3x3, finite and symmetric.
    """
    matrix = np.asarray(inertia, dtype=float)
    if matrix.shape != (3, 3) or not np.isfinite(matrix).all():
        raise BodyError(f"expected an inertia tensor of 3x3 finite numbers, got {matrix.tolist()}")
    skew = np.abs(matrix - matrix.T).max()
    if skew > 1e-12 * np.abs(matrix).max():
        raise BodyError(f"the inertia tensor is not symmetric: entries differ by {skew:g} kg m²")
    if not (matrix - np.diag(np.diag(matrix))).any():  # diagonal already
        order = np.argsort(np.diag(matrix), kind="stable")
        moments, axes = np.diag(matrix)[order], np.eye(3)[:, order]
    else:
        moments, axes = np.linalg.eigh((matrix + matrix.T) / 2)
    for k in (0, 1):
        axes[:, k] *= np.sign(axes[np.argmax(np.abs(axes[:, k])), k])
    axes[:, 2] = np.cross(axes[:, 0], axes[:, 1])
    return PrincipalAxes(moments=moments, axes=axes)
