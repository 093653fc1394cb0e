"""A product of turns in space: the axes with their names, and an arc for each turn.

The turns are taken as the product is read from left to right, each about an axis that the turns
before it have moved. Turn k has its axis u_k; its arc leads from where the next axis u_{k+1} stands
before the turn to where it stands after it, and that of the last turn from the axis before.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from rigidsym.mechanics.derivation import Markup
from rigidsym.models.so3 import AXES
from rigidsym.notes.figure.camera import (
    STANDARD,
    Frame,
    Vector,
    combined,
    dot,
    is_same,
    scaled,
    sweep,
    turned,
)
from rigidsym.notes.figure.drawing import Kind
from rigidsym.notes.prose.words import equal

BODY = tuple(Markup(f"{axis}'", f"{axis}′") for axis in AXES)

_SPACE = tuple(Markup(axis, axis) for axis in AXES)
_NODE_NAMES = tuple(Markup(f"N_{k}", f"N{'₀₁₂₃₄₅'[k]}") for k in range(1, 6))
_RADII = (0.6, 0.78, 0.46, 0.7, 0.38)  # of the arcs, so that neighbours do not run together
_ARC_STEPS = 16


@dataclass(frozen=True, kw_only=True, slots=True)
class Arc:
    """One turn in space."""

    axis: Vector
    start: Vector
    angle: float  # radians
    radius: float
    name: Markup
    start_name: Markup | str  # of the axis that is taken along
    end: Vector

    def path(self, scale: float) -> Iterator[Vector]:
        start = scaled(scale * self.radius, self.start)
        return sweep(start, self.axis, self.angle, _ARC_STEPS)


@dataclass(frozen=True, kw_only=True, slots=True)
class Ray:
    """A direction that bears a name."""

    kind: Kind
    name: Markup
    direction: Vector


@dataclass(frozen=True, kw_only=True, slots=True)
class Names:
    """What is written beside the lines."""

    angles: tuple[Markup, ...]
    body: tuple[Markup, ...] = BODY  # its axes
    between: Markup | None = None  # the only axis that is neither of space nor of the body
    is_vector: bool = False  # whether that axis is a vector, with a point


@dataclass(frozen=True, kw_only=True, slots=True)
class Scene:
    """All that is shown, in space."""

    rays: tuple[Ray, ...]
    arcs: tuple[Arc, ...]

    def named(self, direction: Vector) -> Ray | None:
        return next((ray for ray in self.rays if is_same(ray.direction, direction)), None)


def scene_of(
    axes: Sequence[Vector],
    angles: Sequence[float],
    names: Names,
) -> Scene:
    """The turns by these angles."""
    frames = list(_frames(axes, angles))
    arcs = tuple(
        Arc(
            axis=combined(axis, frames[k]),
            start=combined(_start(axes, k), frames[k]),
            end=combined(_start(axes, k), frames[k + 1]),
            start_name=_name_of(_start(axes, k)),
            angle=angle,
            radius=_RADII[k],
            name=name,
        )
        for k, (axis, angle, name) in enumerate(zip(axes, angles, names.angles, strict=True))
    )
    return Scene(rays=tuple(_rays(frames[-1], names, arcs)), arcs=arcs)


def _frames(axes: Sequence[Vector], angles: Sequence[float]) -> Iterator[Frame]:
    """The frame of space, and where it stands after each turn."""
    frame = STANDARD
    yield frame
    for axis, angle in zip(axes, angles, strict=True):
        about = combined(axis, frame)
        x, y, z = (turned(a, about, angle) for a in frame)
        frame = (x, y, z)
        yield frame


def _name_of(axis: Vector) -> Markup | str:
    """The letter of a coordinate axis; any other is an axis."""
    names = (name for name, other in zip(_SPACE, STANDARD, strict=True) if is_same(axis, other))
    return next(names, "axis")


def _start(axes: Sequence[Vector], k: int) -> Vector:
    """What turn k takes from one drawn place to another: the next axis, or that before the last."""
    wished = [axes[k + 1]] if k + 1 < len(axes) else [axes[k - 1]] if k else []
    for candidate in (*wished, *STANDARD):
        if abs(dot(candidate, axes[k])) < 0.9:
            return candidate
    return STANDARD[0]


def _rays(body: Frame, names: Names, arcs: Sequence[Arc]) -> Iterator[Ray]:
    """The axes of space, those of the body that stand elsewhere, and the axes between."""
    axes = [*zip(_SPACE, STANDARD, strict=True), *zip(names.body, body, strict=True)]
    found: list[Vector] = []
    for name, direction in axes:
        if any(is_same(direction, other) for other in found):
            continue
        shared = [other for other, same in axes if is_same(same, direction)]
        kind: Kind = "space" if len(found) < len(_SPACE) else "body"
        found.append(direction)
        yield Ray(kind=kind, name=equal(*shared) if len(shared) > 1 else name, direction=direction)
    nodes: list[Vector] = []
    for arc in arcs:
        if not any(is_same(arc.axis, other) for other in (*found, *nodes)):
            nodes.append(arc.axis)
    for place, direction in enumerate(nodes):
        name = _NODE_NAMES[place] if len(nodes) > 1 else names.between or Markup("N", "N")
        kind = "vector" if names.is_vector else "node"
        yield Ray(kind=kind, name=name, direction=direction)
