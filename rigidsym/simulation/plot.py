"""Pictures of a trajectory: coordinates over time, the body axis on the sphere, drift."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from rigidsym.errors import MissingExtra
from rigidsym.simulation.trajectory import Trajectory

_ONE_TURN = 360


def save_plot(trajectory: Trajectory, path: Path) -> Path:
    """One sheet with three pictures, PNG, SVG or PDF by the ending; raises MissingExtra."""
    try:
        from matplotlib.figure import Figure
    except ModuleNotFoundError as error:
        raise MissingExtra("a picture", "plot") from error
    figure = Figure(figsize=(11, 4), layout="constrained")
    angles = figure.add_subplot(1, 3, 1)
    degrees = np.degrees(trajectory.q)
    swinging = [k for k in range(degrees.shape[1]) if np.ptp(degrees[:, k]) < _ONE_TURN]
    for k in swinging or range(degrees.shape[1]):  # an angle that winds on would dwarf the others
        angles.plot(trajectory.t, degrees[:, k], label=trajectory.coordinates[k])
    angles.set(xlabel="t in s", ylabel="degrees", title="Coordinates")
    angles.legend()
    sphere = figure.add_subplot(1, 3, 2, projection="3d")
    _draw_sphere(sphere)
    sphere.plot(*trajectory.rotation_matrix[:, :, 2].T, linewidth=1.2)
    sphere.set(title="Trace of the third body axis", box_aspect=(1, 1, 1))
    sphere.set_axis_off()
    drift = figure.add_subplot(1, 3, 3)
    for name, values in trajectory.first_integrals.items():
        size = abs(float(values[0])) or 1.0
        drift.plot(trajectory.t, (values - values[0]) / size, label=name)
    drift.set(xlabel="t in s", ylabel="relative change", title="First integrals")
    drift.legend(loc="lower left", fontsize="small")
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path)
    return path


def _draw_sphere(axes: object) -> None:
    """A few circles of latitude and longitude."""
    angle = np.linspace(0, 2 * np.pi, 120)
    style = {"color": "0.85", "linewidth": 0.6}
    for height in np.linspace(-0.8, 0.8, 5):
        radius = np.sqrt(1 - height**2)
        axes.plot(radius * np.cos(angle), radius * np.sin(angle), height, **style)  # type: ignore[attr-defined]
    for turn in np.linspace(0, np.pi, 7)[:-1]:
        flat = np.cos(angle)
        axes.plot(flat * np.cos(turn), flat * np.sin(turn), np.sin(angle), **style)  # type: ignore[attr-defined]
