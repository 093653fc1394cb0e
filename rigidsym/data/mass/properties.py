"""Mass, centre and inertia tensor of a body in numbers, and how they are shown."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rigidsym.data.columns import counted
from rigidsym.data.mass.principal_axes import PrincipalAxes, principal_axes_of

Array = NDArray[np.float64]
_ROUNDING = 1e-14  # relative to the largest moment: smaller numbers are rounding errors


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
            "principal axes, one a column, right-handed",
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
