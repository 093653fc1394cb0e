"""Pictures of a trajectory: coordinates over time, traces on spheres and ellipsoids, drift."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rigidsym.errors import MissingExtra

Array = NDArray[np.float64]

_ONE_TURN = 360
_VIEW = (25, -60)  # elevation and azimuth of the eye, degrees
_SMALLEST = 1e-17  # of a relative change in the picture of the drift


def save_plot(
    path: Path,
    t: Array,
    coordinates: Mapping[str, Array],
    axis: Array,
    first_integrals: Mapping[str, Array],
    polhode: tuple[Array, Array] | None = None,
    *,
    in_degrees: bool = True,
) -> Path:
    """One sheet of pictures, PNG, SVG or PDF by the ending; raises MissingExtra.

    Coordinates are in radians, (n,) each; `axis` is the third body axis in space, (n, 3). Of a
    free body, `polhode` is Ω′, (n, 3), and the semi-axes of the ellipsoid of energy, (3,).
    """
    try:
        from matplotlib.figure import Figure
    except ModuleNotFoundError as error:
        raise MissingExtra("a picture", "plot") from error
    count = 3 if polhode is None else 4
    figure = Figure(figsize=(4 * count, 4), layout="constrained")
    _draw_coordinates(figure.add_subplot(1, count, 1), t, coordinates, in_degrees=in_degrees)
    sphere = figure.add_subplot(1, count, 2, projection="3d")
    _draw_trace(sphere, axis, np.ones(3), "Trace of the third body axis")
    if polhode is not None:
        ellipsoid = figure.add_subplot(1, count, 3, projection="3d")
        _draw_trace(ellipsoid, *polhode, "Polhode on the ellipsoid of energy")
    _draw_drift(figure.add_subplot(1, count, count), t, first_integrals)
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=150)
    return path


def _draw_coordinates(
    axes: Any, t: Array, coordinates: Mapping[str, Array], *, in_degrees: bool
) -> None:
    """All of them; of angles, those that wind on are left out, since they would dwarf others."""
    shown = {n: np.degrees(v) if in_degrees else v for n, v in coordinates.items()}
    swinging = {n: v for n, v in shown.items() if np.ptp(v) < _ONE_TURN}
    for name, values in (swinging or shown).items():
        axes.plot(t, values, label=name)
    axes.set(xlabel="t in s", ylabel="degrees" if in_degrees else "", title="Coordinates")
    axes.legend(fontsize="small")


def _draw_trace(axes: Any, points: Array, size: Array, title: str) -> None:
    """A curve on an ellipsoid of circles; what is behind it is pale."""
    angle = np.linspace(0, 2 * np.pi, 181)
    flat = np.cos(angle), np.sin(angle)
    circles = [
        (flat[0] * np.sqrt(1 - h * h), flat[1] * np.sqrt(1 - h * h), angle * 0 + h)
        for h in np.linspace(-0.8, 0.8, 5)
    ]
    circles += [
        (flat[0] * np.cos(turn), flat[0] * np.sin(turn), flat[1])
        for turn in np.linspace(0, np.pi, 7)[:-1]
    ]
    elevation, azimuth = np.radians(_VIEW)
    eye = np.array(
        [
            np.cos(elevation) * np.cos(azimuth),
            np.cos(elevation) * np.sin(azimuth),
            np.sin(elevation),
        ]
    )
    for circle in circles:
        _draw_curve(axes, np.array(circle).T * size, eye, size, "0.75", 0.6)
    _draw_curve(axes, points, eye, size, "C0", 1.4)
    axes.scatter(*points[:1].T, color="C3", s=18)
    for k, name in enumerate("xyz"):
        axes.text(*(1.25 * size[k] * np.eye(3)[k]), name, color="0.4", ha="center", va="center")
    axes.view_init(*_VIEW)
    axes.set_box_aspect(size / size.max(), zoom=1.25)
    axes.set(xlim=(-size[0], size[0]), ylim=(-size[1], size[1]), zlim=(-size[2], size[2]))
    axes.set_title(title)
    axes.set_axis_off()


def _draw_curve(
    axes: Any, points: Array, eye: Array, size: Array, color: str, width: float
) -> None:
    """In front of the ellipsoid opaque, behind it pale."""
    is_front = (points / size**2) @ eye >= 0
    for shown, alpha in ((is_front, 1.0), (~is_front, 0.25)):
        part = np.where(shown[:, None], points, np.nan)
        axes.plot(*part.T, color=color, linewidth=width, alpha=alpha)


def _draw_drift(axes: Any, t: Array, first_integrals: Mapping[str, Array]) -> None:
    """The largest change so far."""
    for name, values in first_integrals.items():
        size = abs(float(values[0])) or 1.0
        changes = np.nan_to_num(np.abs(values - values[0])) / size
        axes.semilogy(t, np.maximum(np.maximum.accumulate(changes), _SMALLEST), label=name)
    axes.set(xlabel="t in s", ylabel="largest relative change", title="Drift of first integrals")
    if first_integrals:
        axes.legend(loc="lower right", fontsize="x-small")
