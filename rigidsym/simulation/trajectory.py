"""A simulated motion: arrays over time, the drift of its first integrals, and its pictures."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rigidsym.errors import MissingExtra, ModelError

Array = NDArray[np.float64]

PICTURES = (".png", ".svg", ".pdf")
_ONE_TURN = 360
_GREEK = ["alpha", "beta", "gamma", "delta", "theta", "phi", "psi", "sigma", "chi", "omega"]


@dataclass(frozen=True, kw_only=True, slots=True, repr=False)
class Trajectory:
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
    is_in_angles: bool = True  # the coordinates, in radians
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

    def plot(self, path: str | Path) -> Path:
        """Draw the motion into a PNG, SVG or PDF file. Raises MissingExtra without Matplotlib."""
        path = Path(path)
        check_picture(path)
        try:
            from matplotlib.figure import Figure
        except ModuleNotFoundError as error:
            raise MissingExtra("a picture", "plot") from error
        figure = Figure(figsize=(8, 4), layout="constrained")
        self._draw_coordinates(figure.add_subplot(1, 2, 1))
        self._draw_trace(figure.add_subplot(1, 2, 2, projection="3d"))
        path.parent.mkdir(parents=True, exist_ok=True)
        figure.savefig(path, dpi=150)
        return path

    def _draw_coordinates(self, axes: Any) -> None:
        """All of them; angles that wind on are left out, since they would dwarf the others."""
        curves = np.degrees(self.q) if self.is_in_angles else self.q
        winds = np.ptp(curves, axis=0) >= _ONE_TURN
        for name, values, is_long in zip(self.coordinates, curves.T, winds, strict=True):
            if winds.all() or not is_long:
                axes.plot(self.t, values, label=f"$\\{name}$" if name in _GREEK else name)
        hidden = [n for n, is_long in zip(self.coordinates, winds, strict=True) if is_long]
        title = "Coordinates"
        if hidden and not winds.all():
            title += f"\n({', '.join(hidden)}: more than a turn, not shown)"
        axes.set(xlabel="t in s", ylabel="degrees" if self.is_in_angles else "", title=title)
        axes.legend(fontsize="small")

    def _draw_trace(self, axes: Any) -> None:
        """A curve on the unit sphere, its beginning, and the axes of space."""
        points = self.rotation_matrix[:, :, 2].T
        latitude, longitude = np.mgrid[0 : np.pi : 37j, 0 : 2 * np.pi : 73j]
        across = np.sin(latitude)
        sphere = (across * np.cos(longitude), across * np.sin(longitude), np.cos(latitude))
        axes.plot_wireframe(*sphere, rstride=6, cstride=6, color="0.75", linewidth=0.5)
        axes.plot(*points, color="C0", linewidth=1.4)
        axes.scatter(*points[:, :1], color="C3", s=18)
        for name, end in zip("xyz", 1.2 * np.eye(3), strict=True):
            axes.quiver(0, 0, 0, *end, color="0.4", linewidth=1, arrow_length_ratio=0.05)
            axes.text(*end, name, color="0.4", ha="center", va="bottom")
        axes.set(xlim=(-1, 1), ylim=(-1, 1), zlim=(-1, 1), title="Trace of the third body axis")
        axes.set_box_aspect(np.ones(3))
        axes.set_axis_off()


def check_picture(path: Path, endings: Collection[str] = PICTURES) -> None:
    """Raises ModelError for a file with another ending."""
    if path.suffix not in endings:
        raise ModelError(f"{path}: expected a file that ends in {', '.join(endings)}")
