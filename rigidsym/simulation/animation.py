"""An animation of a trajectory: a brick with the moments of the body, and the trace of its axis."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from rigidsym.errors import MissingTool
from rigidsym.simulation.plot import SPHERE, check_picture, draw_trace, figure_class
from rigidsym.simulation.sampled_motion import Array, Samples

WRITERS = {".gif": "pillow", ".mp4": "ffmpeg"}
_FRAMES_PER_SECOND = 15
_LENGTHS = (4.0, 12.0)  # seconds, of the shortest and the longest animation
_LEAST = 0.1  # of the longest edge: a plate is drawn with some thickness
_FACES = ((0, 1, 3, 2), (4, 5, 7, 6), (0, 1, 5, 4), (2, 3, 7, 6), (0, 2, 6, 4), (1, 3, 7, 5))
_COLOURS = ("C1", "C1", "C2", "C2", "C0", "C0")  # of opposite faces, so that spins are seen


def save_animation(
    path: Path, motion: Samples, progress: Callable[[float], None] | None = None
) -> Path:
    """GIF or MP4 by the ending, in real time if it takes 4 to 12 seconds.

    Raises ModelError for another ending, MissingExtra without Matplotlib, and MissingTool for MP4
    without ffmpeg, which the extra `video` brings.
    """
    check_picture(path, WRITERS)
    writer = WRITERS[path.suffix]
    figure = figure_class()(figsize=(5, 5), layout="constrained")
    from matplotlib import rc_context
    from matplotlib.animation import FuncAnimation, writers

    with rc_context({"animation.ffmpeg_path": _ffmpeg()}):
        if not writers.is_available(writer):
            raise MissingTool(
                f"{path.suffix} needs ffmpeg, which is not installed: pip install '.[video]' in "
                "the clone, or apt install ffmpeg on Debian; .gif does not need it"
            )
        return _saved(path, motion, progress, figure, FuncAnimation)


def _ffmpeg() -> str:
    """The program, by its name if it is on the path, else the one of imageio-ffmpeg."""
    if shutil.which("ffmpeg") is None and find_spec("imageio_ffmpeg") is not None:
        from imageio_ffmpeg import get_ffmpeg_exe

        return str(get_ffmpeg_exe())
    return "ffmpeg"


def _saved(
    path: Path,
    motion: Samples,
    progress: Callable[[float], None] | None,
    figure: Any,
    animation: Any,
) -> Path:
    seconds = float(np.clip(motion.t[-1], *_LENGTHS))
    places = np.linspace(0, len(motion.t) - 1, round(seconds * _FRAMES_PER_SECOND))
    shown = np.unique(places.round().astype(int))
    axes = figure.add_subplot(projection="3d")
    draw_trace(axes, motion.rotation_matrix[:1, :, 2], SPHERE)
    (trace,) = axes.plot([], [], [], color="C3", linewidth=1.2)
    corners = _corners(motion.inertia)
    faces = _brick(axes)

    def frame(k: int) -> list[Any]:
        rotation = motion.rotation_matrix[k]
        faces.set_verts([corners[list(face)] @ rotation.T for face in _FACES])
        trace.set_data_3d(*motion.rotation_matrix[: k + 1, :, 2].T)
        axes.set_title(f"t = {motion.t[k]:.2f} s")
        return [faces, trace]

    def advanced(k: int, count: int) -> None:
        if progress is not None:
            progress((k + 1) / count)

    made = animation(figure, frame, frames=shown.tolist())
    path.parent.mkdir(parents=True, exist_ok=True)
    fps: Any = len(shown) / seconds  # Matplotlib takes fractions, its types say whole numbers
    made.save(path, writer=WRITERS[path.suffix], fps=fps, dpi=90, progress_callback=advanced)
    return path


def _corners(inertia: Array) -> Array:
    """Of the brick with these principal moments, (8, 3), in a sphere of radius 0.8."""
    moments, axes = np.linalg.eigh(inertia)
    half = np.sqrt(np.maximum(moments.sum() / 2 - moments, 0))  # in proportion to the edges
    half = np.maximum(half, _LEAST * half.max())
    signs = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    return np.asarray(0.8 * signs * half / np.linalg.norm(half) @ axes.T)


def _brick(axes: Any) -> Any:
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection  # type: ignore[import-untyped]

    faces = Poly3DCollection(np.zeros((6, 4, 3)), facecolors=_COLOURS, edgecolors="k", alpha=0.9)
    axes.add_collection3d(faces)
    return faces
