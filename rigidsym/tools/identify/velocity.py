"""Angular velocities of readings, by the kernels of the derivation of each sequence."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from types import ModuleType

import numpy as np

from rigidsym.tools.identify.readings import AS_THE_TURNS, Reading, Velocity
from rigidsym.tools.identify.turns import Array

_FRAMES = ("space", "body")


@cache
def _kernels(sequence: str) -> ModuleType:
    # Loaded here, so that identifying orientations does not need SymPy.
    from rigidsym.motion import derive

    wanted = [f"angular_velocity_{frame}" for frame in _FRAMES]
    return derive(sequence).select(wanted).kernels().load()


def angular_velocities(readings: Sequence[Reading], angles: Array, rates: Array) -> Array:
    """Ω and Ω′ of the rotation R of each reading, in the unit of the rates.

    `angles` and `rates` (n, 3) are columns of the data; the result is (n, readings, 2, 3), space
    components first.
    """
    turns = [reading.intrinsic() for reading in readings]
    columns = np.array([turn.columns for turn in turns])
    signs = np.array([turn.signs for turn in turns])
    factors = np.array([[turn.factor] for turn in turns])
    sequences = np.array([turn.sequence for turn in turns])
    q, q_dot = angles[:, columns] * (signs * factors), rates[:, columns] * signs
    omega = np.empty((len(angles), len(turns), 2, 3))
    for sequence in dict.fromkeys(sequences.tolist()):
        here = sequences == sequence
        for k, frame in enumerate(_FRAMES):
            kernel = getattr(_kernels(sequence), f"angular_velocity_{frame}")
            omega[:, here, k] = kernel(q[:, here], q_dot[:, here])
    for k, turn in enumerate(turns):
        if turn.frames != AS_THE_TURNS:  # Ω of S R B is S Ω, and its Ω′ is Bᵀ Ω′
            omega[:, k, 0] = omega[:, k, 0] @ np.array(turn.frames.space).T
            omega[:, k, 1] = omega[:, k, 1] @ np.array(turn.frames.body)
    return omega


def as_given(omega: Array, velocities: Sequence[Velocity]) -> Array:
    """Ω as the data have it under each reading of Ω: (..., 2, 3) to (..., v, 3)."""
    frames = [_FRAMES.index(velocity.frame) for velocity in velocities]
    factors = np.array([[velocity.factor] for velocity in velocities])
    return np.asarray(omega[..., frames, :] * factors)
