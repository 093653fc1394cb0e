"""Pictures of a trajectory: coordinates over time, the body axis on the sphere, drift."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from rigidsym.errors import MissingExtra

Array = NDArray[np.float64]

_ONE_TURN = 360


def save_plot(
    path: Path,
    t: Array,
    coordinates: Mapping[str, Array],
    axis: Array,
    first_integrals: Mapping[str, Array],
) -> Path:
    """One sheet with three pictures, PNG, SVG or PDF by the ending; raises MissingExtra.

    Coordinates are in radians, (n,) each; `axis` is the third body axis in space, (n, 3).
    """
    try:
        from matplotlib.figure import Figure
    except ModuleNotFoundError as error:
        raise MissingExtra("a picture", "plot") from error
    figure = Figure(figsize=(11, 4), layout="constrained")
    angles = figure.add_subplot(1, 3, 1)
    degrees = {name: np.degrees(values) for name, values in coordinates.items()}
    swinging = {name: values for name, values in degrees.items() if np.ptp(values) < _ONE_TURN}
    for name, values in (swinging or degrees).items():  # one that winds on would dwarf the others
        angles.plot(t, values, label=name)
    angles.set(xlabel="t in s", ylabel="degrees", title="Coordinates")
    angles.legend()
    sphere = figure.add_subplot(1, 3, 2, projection="3d")
    _draw_sphere(sphere)
    sphere.plot(*axis.T, linewidth=1.2)
    sphere.set(title="Trace of the third body axis", box_aspect=(1, 1, 1))
    sphere.set_axis_off()
    drift = figure.add_subplot(1, 3, 3)
    for name, values in first_integrals.items():
        size = abs(float(values[0])) or 1.0
        drift.plot(t, (values - values[0]) / size, label=name)
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
