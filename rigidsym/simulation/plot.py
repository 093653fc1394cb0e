"""Pictures of a trajectory: coordinates, traces on spheres and ellipsoids, herpolhodes, drift."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from rigidsym.errors import MissingExtra, ModelError
from rigidsym.simulation.sampled_motion import Array, Samples

PICTURES = (".png", ".svg", ".pdf")
SPHERE = np.ones(3)  # its semi-axes
_ONE_TURN = 360
_VIEW = (25, -60)  # elevation and azimuth of the eye, degrees
_GREEK = ["alpha", "beta", "gamma", "delta", "theta", "phi", "psi", "sigma", "chi", "omega"]
_SMALLEST = 1e-17  # of a relative change in the picture of the drift


def save_plot(path: Path, motion: Samples) -> Path:
    """One sheet of pictures, PNG, SVG or PDF by the ending; raises MissingExtra.

    Of a free body it shows the polhode on the ellipsoid of energy, and the herpolhode in the
    invariable plane.
    """
    check_picture(path, PICTURES)
    rows = [["q", "axis", "drift"] if motion.first_integrals else ["q", "axis"]]
    if motion.is_free:
        rows = [["q", "q", "axis"], ["polhode", "herpolhode", "drift"]]
    size = (4 * len(rows[0]), 4 * len(rows))
    figure = figure_class()(figsize=size, layout="constrained")
    panels = figure.subplot_mosaic(
        rows, per_subplot_kw={("axis", "polhode")[: len(rows)]: {"projection": "3d"}}
    )
    angles = {name: motion.q[:, k] for k, name in enumerate(motion.coordinates)}
    _draw_coordinates(panels["q"], motion.t, angles, in_degrees=motion.is_in_angles)
    draw_trace(panels["axis"], motion.rotation_matrix[:, :, 2], SPHERE)
    panels["axis"].set_title("Trace of the third body axis")
    if motion.is_free:
        _draw_poinsot(panels["polhode"], panels["herpolhode"], motion)
    if motion.first_integrals:
        _draw_drift(panels["drift"], motion.t, motion.changes)
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=150)
    return path


def check_picture(path: Path, endings: Collection[str]) -> None:
    """Raises ModelError for a file with another ending."""
    if path.suffix not in endings:
        raise ModelError(f"{path}: expected a file that ends in {', '.join(endings)}")


def figure_class() -> Any:
    """Matplotlib's Figure; raises MissingExtra."""
    try:
        from matplotlib.figure import Figure
    except ModuleNotFoundError as error:
        raise MissingExtra("a picture", "plot") from error
    return Figure


def _draw_poinsot(solid: Any, plane: Any, motion: Samples) -> None:
    """Ω′ along the principal axes on the ellipsoid of energy, and Ω seen along L."""
    moments, axes = np.linalg.eigh(motion.inertia)
    polhode = motion.angular_velocity_body @ axes
    draw_trace(solid, polhode, np.sqrt(np.sum(moments * polhode[0] ** 2) / moments), "123")
    solid.set_title("Polhode on the energy ellipsoid,\naxes in the order of the moments")
    rotation, omega = motion.rotation_matrix, motion.angular_velocity_body
    momentum = rotation[0] @ motion.inertia @ omega[0]
    across = np.linalg.svd(momentum[None])[2][1:]  # two unit vectors normal to L
    herpolhode = np.einsum("nij,nj->ni", rotation, omega) @ across.T
    plane.plot(*herpolhode.T, linewidth=0.8)
    plane.plot(*herpolhode[0], "o", color="C3", markersize=4)
    plane.plot(0, 0, "+", color="0.4")
    plane.set(aspect="equal", xlabel="rad/s", title="Herpolhode in the invariable plane")


def _draw_coordinates(
    axes: Any, t: Array, coordinates: Mapping[str, Array], *, in_degrees: bool
) -> None:
    """All of them; of angles, those that wind on are left out, since they would dwarf others."""
    shown = {n: np.degrees(v) if in_degrees else v for n, v in coordinates.items()}
    swinging = {n: v for n, v in shown.items() if np.ptp(v) < _ONE_TURN} or shown
    for name, values in swinging.items():
        axes.plot(t, values, label=_symbol(name))
    winding = ", ".join(_symbol(name) for name in shown if name not in swinging)
    title = f"Coordinates\n({winding}: more than a turn, not shown)" if winding else "Coordinates"
    axes.set(xlabel="t in s", ylabel="degrees" if in_degrees else "", title=title)
    axes.legend(fontsize="small")


def _symbol(name: str) -> str:
    """Greek letters by their names, as Matplotlib writes them."""
    return f"$\\{name}$" if name in _GREEK else name


def draw_trace(axes: Any, points: Array, size: Array, names: str = "xyz") -> None:
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
    for k, name in enumerate(names):
        end = size[k] * np.eye(3)[k]
        pale = 0.4 if end @ eye < 0 else 1.0
        axes.plot(*np.array([end, 1.15 * end]).T, color="0.4", linewidth=1, alpha=pale)
        axes.text(*(1.28 * end), name, color="0.4", ha="center", va="center", alpha=pale)
    axes.view_init(*_VIEW)
    axes.set_box_aspect(size / size.max(), zoom=1.1)
    axes.set(xlim=(-size[0], size[0]), ylim=(-size[1], size[1]), zlim=(-size[2], size[2]))
    axes.set_axis_off()


def _draw_curve(
    axes: Any, points: Array, eye: Array, size: Array, color: str, width: float
) -> None:
    """In front of the ellipsoid opaque, behind it pale."""
    is_front = (points / size**2) @ eye >= 0
    for shown, alpha in ((is_front, 1.0), (~is_front, 0.25)):
        part = np.where(shown[:, None], points, np.nan)
        axes.plot(*part.T, color=color, linewidth=width, alpha=alpha)


def _draw_drift(axes: Any, t: Array, changes: Mapping[str, Array]) -> None:
    """The largest change so far."""
    for name, values in changes.items():
        largest = np.maximum.accumulate(np.nan_to_num(values))
        shown = name.replace("_", " ")
        axes.semilogy(t, np.maximum(largest, _SMALLEST), label=shown)
    axes.set(xlabel="t in s", ylabel="largest relative change", title="Drift of first integrals")
    axes.legend(loc="lower right", fontsize="x-small")
