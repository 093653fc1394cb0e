"""What is known of a simulated motion: arrays over time, and how first integrals were kept."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True, slots=True)
class Samples:
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
    is_free: bool = False  # nothing acts on the body
    ended: str = ""  # why the motion ends before its time, if it does
    is_in_angles: bool = True  # the coordinates, in radians
    remarks: tuple[str, ...] = ()  # such as a pole that was passed

    @property
    def drift(self) -> Mapping[str, float]:
        """The largest change of each first integral, relative to its size.

        Of a momentum the size is at least that of the angular momentum, since it may begin at 0.
        """
        return {name: float(np.nanmax(values)) for name, values in self.changes.items()}

    @property
    def changes(self) -> Mapping[str, Array]:
        """The relative change of each first integral, (n,); NaN at a pole, where rates are."""
        momentum = self.inertia @ self.angular_velocity_body[0]
        return relative_changes(self.first_integrals, np.array(np.linalg.norm(momentum)))

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
        lines = [f"{self.name}: {len(self.t)} times from 0 to {self.t[-1]:g} s"]
        lines += [text for text in (*self.remarks, self.ended) if text]
        width = max(map(len, self.first_integrals), default=0)
        lines += [f"  {name:{width}}  drift {value:.1e}" for name, value in self.drift.items()]
        return "\n".join(lines)


def relative_changes(integrals: Mapping[str, Array], momentum: Array) -> dict[str, Array]:
    """Of values over time, (n, ...), by name; `momentum` is |L| at the beginning, (...)."""
    found = {}
    for name, values in integrals.items():
        size = np.abs(values[0])
        if "momentum_" in name and "squared" not in name:
            size = np.maximum(size, momentum)
        found[name] = np.abs(values - values[0]) / np.where(size == 0, 1.0, size)
    return found
