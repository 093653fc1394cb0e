"""A simulated motion: arrays over time, and how well its first integrals were kept."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True, slots=True)
class Trajectory:
    """A motion at n moments, of k coordinates; SI units, angles in radians."""

    name: str  # of the derivation
    coordinates: tuple[str, ...]
    t: Array  # (n,), s
    q: Array  # (n, k)
    q_dot: Array  # (n, k)
    angular_velocity_body: Array  # (n, 3), rad/s
    rotation_matrix: Array  # (n, 3, 3), body to space components
    first_integrals: Mapping[str, Array]  # (n,) each
    inertia: Array  # (3, 3), kg m², about the fixed point in the axes of the body
    ended: str = ""  # why the motion ends before its time, if it does
    is_in_angles: bool = True  # the coordinates, in radians
    remarks: tuple[str, ...] = ()  # such as a pole that was passed

    @property
    def drift(self) -> Mapping[str, float]:
        """The largest change of each first integral, relative to its size where that is not 0."""
        return {name: _drift(values) for name, values in self.first_integrals.items()}

    def columns(self) -> dict[str, Array]:
        """All of it as named columns: t, the coordinates, their rates, Ω′ and the integrals."""
        found: dict[str, Array] = {"t": self.t}
        for k, name in enumerate(self.coordinates):
            found |= {name: self.q[:, k], f"{name}_dot": self.q_dot[:, k]}
        for k in range(3):
            found[f"angular_velocity_body_{k + 1}"] = self.angular_velocity_body[:, k]
        return found | dict(self.first_integrals)

    def report(self) -> str:
        """How long it is, and the drift of each first integral."""
        lines = [f"{self.name}: {len(self.t)} moments from 0 to {self.t[-1]:g} s"]
        lines += [text for text in (*self.remarks, self.ended) if text]
        width = max(map(len, self.first_integrals), default=0)
        lines += [f"  {name:{width}}  drift {value:.1e}" for name, value in self.drift.items()]
        return "\n".join(lines)

    def plot(self, path: str | Path) -> Path:
        """A picture of the motion: PNG, SVG or PDF by the ending. Needs Matplotlib."""
        from rigidsym.simulation.plot import save_plot

        angles = {name: self.q[:, k] for k, name in enumerate(self.coordinates)}
        axis = self.rotation_matrix[:, :, 2]
        return save_plot(
            Path(path),
            *(self.t, angles, axis, self.first_integrals, self._polhode()),
            in_degrees=self.is_in_angles,
        )

    def _polhode(self) -> tuple[Array, Array] | None:
        """Ω′ along the principal axes and the semi-axes √(2E/I_k), if the body is free."""
        if "angular_momentum_squared" not in self.first_integrals:
            return None
        moments, axes = np.linalg.eigh(self.inertia)
        omega = self.angular_velocity_body @ axes
        return omega, np.sqrt(np.sum(moments * omega[0] ** 2) / moments)

    def _repr_pretty_(self, printer: Any, _: bool) -> None:
        printer.text(self.report())


def _drift(values: Array) -> float:
    size = abs(float(values[0])) or 1.0
    changes = np.abs(values - values[0])
    return float(np.nanmax(changes)) / size  # NaN where rates are not defined, at a pole
