"""A simulated motion: arrays over time, and the drift of its first integrals."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from rigidsym.system.records import Record

Array = NDArray[np.float64]


class Trajectory(Record, kw_only=True):
    """A motion at n times, of k coordinates; SI units, angles in radians."""

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
    remarks: tuple[str, ...] = ()  # such as a pole that was passed

    @property
    def drift(self) -> Mapping[str, float]:
        """The largest relative change of each first integral, a measure of the error.

        A momentum may begin at 0, so its size is taken to be at least |L| at the beginning. Values
        are NaN at a pole, where rates are.
        """
        momentum = np.linalg.norm(self.inertia @ self.angular_velocity_body[0])
        drift = {}
        for name, values in self.first_integrals.items():
            size = abs(values[0])
            if "momentum_" in name and "squared" not in name:
                size = max(size, momentum)
            drift[name] = float(np.nanmax(np.abs(values - values[0])) / (size or 1.0))
        return drift

    def columns(self) -> dict[str, Array]:
        """All of it as named columns: t, the coordinates, their rates, Ω′ and the integrals."""
        columns: dict[str, Array] = {"t": self.t}
        for k, name in enumerate(self.coordinates):
            columns |= {name: self.q[:, k], f"{name}_dot": self.q_dot[:, k]}
        for k in range(3):
            columns[f"angular_velocity_body_{k + 1}"] = self.angular_velocity_body[:, k]
        return columns | dict(self.first_integrals)

    def report(self) -> str:
        """How long it is, and the drift of each first integral."""
        lines = [f"{self.name}: {len(self.t)} times from 0 to {self.t[-1]:g} s"]
        lines += [text for text in (*self.remarks, self.ended) if text]
        width = max(map(len, self.first_integrals), default=0)
        lines += [f"  {name:{width}}  drift {value:.1e}" for name, value in self.drift.items()]
        return "\n".join(lines)

    def __repr__(self) -> str:
        return self.report()
