"""Mass, centre, inertia tensor and principal axes of a body in numbers, and how they are shown."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rigidsym.data.columns import counted
from rigidsym.errors import BodyError

Array = NDArray[np.float64]
_EQUAL_PAIR = "The {} two principal moments are equal: all axes normal to the {} are principal."
_EQUAL = 1e-9  # of the largest moment: closer moments count as equal
_ROUNDING = 1e-14  # relative to the largest moment: smaller numbers are rounding errors


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


@dataclass(frozen=True, kw_only=True, slots=True)
class MassProperties:
    """Mass, centre, inertia tensor and principal axes of a body, in SI units."""

    count: int  # particles, or faces of a mesh
    mass: float  # kg
    centre: Array  # (3,), m
    inertia: Array  # (3, 3), about the centre of mass, kg m²
    principal: PrincipalAxes = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "principal", principal_axes_of(self.inertia))

    @property
    def radii(self) -> Array:
        """Radii of gyration about the principal axes, (3,), m: √(Iₖ/M)."""
        return np.sqrt(np.maximum(self.principal.moments, 0) / self.mass)

    def text(self, noun: str = "particle") -> str:
        """A few lines for a terminal; `noun` is particle or face."""
        return f"{counted(self.count, noun)}\n{self._in_numbers()}"

    def _repr_mimebundle_(self, **_: object) -> dict[str, str]:
        """The text for Jupyter."""
        return {"text/plain": self._in_numbers()}

    def _in_numbers(self) -> str:
        principal = self.principal
        lines = [
            f"mass                 M = {_number(self.mass)} kg",
            f"centre of mass       c = ({_row(self.centre)}) m",
            "inertia tensor about the centre of mass, kg m²",
            *_grid(self.inertia),
            f"principal moments    {_row(principal.moments)} kg m²",
            "principal axes as columns, right-handed",
            *_grid(principal.axes),
            f"radii of gyration    {_row(self.radii)} m",
        ]
        return "\n".join([*lines, *([principal.repeated] if principal.repeated else [])])

    def as_table(self) -> dict[str, object]:
        """The values of [body] in a derivation file, without rounding errors of zeros."""

        def clean(values: Array, scale: float) -> list[float]:
            return [0 if abs(v) <= scale * _ROUNDING else v for v in values.tolist()]

        scale = float(np.abs(self.inertia).max())
        size = float(np.abs(self.centre).max()) + (scale / self.mass) ** 0.5
        return {
            "inertia": [clean(row, scale) for row in self.inertia],
            "mass": self.mass,
            "centre": clean(self.centre, size),
        }

    def record(self) -> dict[str, Any]:
        """The properties as plain data."""
        return {
            **({"count": self.count} if self.count else {}),
            "mass": self.mass,
            "centre_of_mass": self.centre.tolist(),
            "inertia_tensor": self.inertia.tolist(),
            "principal_moments": self.principal.moments.tolist(),
            "principal_axes": self.principal.axes.tolist(),
            "radii_of_gyration": self.radii.tolist(),
            "repeated": self.principal.repeated,
        }


def _number(value: float) -> str:
    return f"{value + 0.0:.15g}"  # −0 + 0 is 0


def _row(values: Iterable[float]) -> str:
    return ", ".join(map(_number, values))


def _grid(matrix: Array) -> list[str]:
    rows = [[f"{entry + 0.0: .12g}" for entry in row] for row in matrix]
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return [
        "  " + "  ".join(e.ljust(width) for e, width in zip(row, widths, strict=True)).rstrip()
        for row in rows
    ]
