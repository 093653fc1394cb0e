"""A simulated motion with its pictures."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from rigidsym.simulation.animation import save_animation
from rigidsym.simulation.plot import save_plot
from rigidsym.simulation.sampled_motion import Samples


class Trajectory(Samples):
    """A motion at n times, of k coordinates; SI units, angles in radians."""

    def plot(self, path: str | Path) -> Path:
        """Draw the motion into a PNG, SVG or PDF file. Needs Matplotlib."""
        return save_plot(Path(path), self)

    def animate(self, path: str | Path, progress: Callable[[float], None] | None = None) -> Path:
        """Animate the motion as GIF, which needs Matplotlib, or MP4, which also needs ffmpeg."""
        return save_animation(Path(path), self, progress)

    def __repr__(self) -> str:
        return self.report()
