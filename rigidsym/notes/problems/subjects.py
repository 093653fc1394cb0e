"""The subjects of problem sheets, and the kinds of problems of each."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from rigidsym.notes.problems import body_problems as bodies, euler_problems as euler
from rigidsym.notes.problems.exercise import Subject

_EULER = (euler.which_convention, euler.angular_velocity, euler.gimbal_lock, euler.identify)
_BODIES = (bodies.parallel_axis, bodies.drilled_block, bodies.rotational_energy)
SUBJECTS: Mapping[str, Subject] = MappingProxyType(
    {
        "euler": ("Euler angles", _EULER),
        "bodies": ("Moments of inertia", _BODIES),
        "all": ("Rotations and rigid bodies", (*_EULER, *_BODIES)),
    }
)
