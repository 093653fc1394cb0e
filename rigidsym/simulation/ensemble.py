"""Many motions at once, in blocks of states whose stages stay in the processor's cache.

The blocks are computed in threads.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial
from importlib.util import find_spec
from typing import Any

import numpy as np

from rigidsym.errors import MissingExtra, ModelError
from rigidsym.mechanics.derivation import Derivation
from rigidsym.models.forces import OMEGA
from rigidsym.simulation.problem import Problem, with_motion
from rigidsym.simulation.trajectory import Array, relative_changes

_ANGLE = 0.05  # radians that the fastest body turns in a step
_BLOCK = 512  # motions whose stages stay in the cache
_NAMED = 5  # motions in a message


@dataclass(frozen=True, kw_only=True, slots=True)
class Ensemble:
    """m motions at n times, of states with k components; SI units, angles in radians."""

    name: str  # of the derivation
    names: tuple[str, ...]  # of the components of the state
    t: Array  # (n,), s
    states: Array  # (n, m, k)
    drift: Mapping[str, Array]  # (m,) of each first integral: the largest relative change
    varied: Mapping[str, Array]  # (m,) of each parameter or initial value beside the state

    def __repr__(self) -> str:
        return self.report()

    @property
    def ended(self) -> str:
        """Why motions have no state at the end, and which, if some have none."""
        lost = np.flatnonzero(~np.isfinite(self.states[-1]).all(axis=1)) + 1
        members = self.states.shape[1]
        named = ", ".join(map(str, lost[:_NAMED])) + (", ..." if len(lost) > _NAMED else "")
        why = "reached a pole of the coordinates or overflowed"
        if len(lost) == 1:
            return f"motion {named} of {members} {why}"
        return f"{len(lost)} of {members} motions {why}: {named}" if len(lost) else ""

    def report(self) -> str:
        """How many motions there are, and the largest drift of each first integral."""
        lines = [f"{self.name}: {self.states.shape[1]} motions from 0 to {self.t[-1]:g} s"]
        lines += [self.ended] if self.ended else []
        width = max(map(len, self.drift), default=0)
        known = {name: values[np.isfinite(values)] for name, values in self.drift.items()}
        lines += [
            f"  {name:{width}}  largest drift {values.max():.1e}"
            for name, values in known.items()
            if len(values)
        ]
        return "\n".join(lines)

    def columns(self) -> dict[str, Array]:
        """What was varied, the first and the last state of each motion, and its drift."""
        columns = dict(self.varied)
        columns |= {f"{name}_start": self.states[0, :, k] for k, name in enumerate(self.names)}
        columns |= {f"{name}_end": self.states[-1, :, k] for k, name in enumerate(self.names)}
        return columns | {f"drift_{name}": values for name, values in self.drift.items()}


def simulate_ensemble(
    derivation: Derivation,
    initial: Mapping[str, Any],
    parameters: Mapping[str, Any],
    t_end: float,
    *,
    samples: int = 101,
    step: float | None = None,
    progress: Callable[[float], None] | None = None,
) -> Ensemble:
    """Integrate m motions from t = 0 to `t_end`, in steps of order 8 of one length.

    Parameters
    ----------
    derivation : Derivation
        A rotation, a body, and what acts on it.
    initial, parameters : mapping
        As for `simulate`; each value may be an array, (m,), and angular_velocity_body (m, 3).
    t_end : float
        In s.
    samples : int, optional
        Number of times.
    step : float, optional
        In s. By default, the fastest body turns 0.05 rad in a step; the drift shows whether this
        was short enough.
    progress : callable, optional
        Called with the share of the work that is done.

    Returns
    -------
    Ensemble
        Times (n,), states (n, m, k), and the drift (m,) of each first integral.

    Raises
    ------
    ModelError
        As `simulate` does, and for arrays whose lengths differ.

    Examples
    --------
    >>> import rigidsym as rs
    >>> flywheel = rs.derive("z(phi)", body=rs.principal_moments(1, 1, 2), torque=[0, 0, "u"])
    >>> motions = flywheel.simulate_many({"phi_dot": [1.0, 2.0]}, {"u": 4.0}, 3.0, samples=2)
    >>> motions.states[-1].round(9).tolist()
    [[12.0, 7.0], [15.0, 8.0]]
    """
    if not (np.isfinite(t_end) and t_end > 0):
        raise ModelError(f"the end time is {t_end}; expected a positive number of seconds")
    if find_spec("scipy") is None:
        raise MissingExtra("a simulation", "simulate")
    members = _members(initial, parameters)
    called = f"motion 1 of {members}"
    first = Problem(with_motion(derivation), *_of(0, initial, parameters), called=called)
    first.check_bodies(members, parameters)
    start = first.state_of(initial)
    start = np.broadcast_to(start, (members, start.shape[-1]))
    first.check_rotations(start)
    constants = np.array(first.parameters, float)
    if first.parameters and any(map(np.ndim, parameters.values())):
        constants = first.parameters_of(members, parameters)
    times = np.linspace(0.0, t_end, samples)
    speed = float(np.linalg.norm(first.omega(start), axis=1).max()) or 1.0
    count = max(1, int(np.ceil(times[1] / (step or _ANGLE / speed))))
    states = np.empty((samples, *start.shape))
    blocks = range(0, members, _BLOCK)
    done = 0

    def moved(at: int) -> None:
        nonlocal done
        own = constants if constants.ndim < 2 else constants[at : at + _BLOCK]
        slopes = partial(first.slopes_of_many, constants=own)
        y = states[0, at : at + _BLOCK] = start[at : at + _BLOCK]
        for k, t in enumerate(times[:-1]):
            y = states[k + 1, at : at + _BLOCK] = _stepped(slopes, y, t, times[1] / count, count)
            done += 1
            if progress is not None:
                progress(min(1.0, done / (len(blocks) * (samples - 1))))

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        list(pool.map(moved, blocks))
    momentum = np.linalg.norm(first.omega(states[0]) @ first.inertia, axis=1)
    changes = relative_changes(first.integrals(times[:, None], states, constants), momentum)
    return Ensemble(
        name=derivation.name,
        names=first.names["y"],
        t=times,
        states=states,
        drift={name: values.max(axis=0) for name, values in changes.items()},
        varied={
            name: np.broadcast_to(value, members).astype(float)
            for name, value in {**initial, **parameters}.items()
            if name not in (OMEGA, *first.names["y"]) and np.ndim(value)
        },
    )


def _members(*arguments: Mapping[str, Any]) -> int:
    """The common length of the arrays."""
    lengths = {
        len(value)
        for values in arguments
        for name, value in values.items()
        if np.ndim(value) > (1 if name == OMEGA else 0)
    }
    if len(lengths) > 1:
        raise ModelError(
            f"expected arrays of one length, got {' and '.join(map(str, sorted(lengths)))}"
        )
    return lengths.pop() if lengths else 1


def _of(k: int, *arguments: Mapping[str, Any]) -> list[dict[str, Any]]:
    """The values of one member."""
    return [
        {
            name: value[k] if np.ndim(value) > (1 if name == OMEGA else 0) else value
            for name, value in values.items()
        }
        for values in arguments
    ]


def _stepped(
    slopes: Callable[[float, Array], Array], y: Array, t: float, h: float, count: int
) -> Array:
    """The states (m, k) after `count` steps of length h from the time t, by DOP853's order 8."""
    from scipy.integrate import DOP853

    nodes, sums = DOP853.C[: DOP853.n_stages], DOP853.B
    stages, lost = np.empty((len(nodes), *y.shape)), np.zeros_like(y)
    flat = stages.reshape(len(stages), -1)
    for step in range(count):
        for k, node in enumerate(nodes):
            inner = y + h * (DOP853.A[k, :k] @ flat[:k]).reshape(y.shape)
            stages[k] = slopes(t + (step + node) * h, inner)
        added = h * (sums @ flat).reshape(y.shape) + lost
        before, y = y, y + added
        lost = added - (y - before)  # by rounding (Kahan)
    return y
