"""Many motions at once: one kernel call a stage, for all initial states and parameters."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from rigidsym.errors import MissingExtra, ModelError
from rigidsym.mechanics.derivation import Derivation
from rigidsym.simulation.problem import OMEGA, Problem
from rigidsym.simulation.sampled_motion import Array, relative_changes
from rigidsym.simulation.solver import with_motion

_ANGLE = 0.05  # radians that the fastest body turns in a step
_BLOCK = 1000  # motions whose stages stay in the cache


@dataclass(frozen=True, kw_only=True, slots=True)
class Ensemble:
    """m motions at n moments, of states with k components; SI units, angles in radians."""

    name: str  # of the derivation
    names: tuple[str, ...]  # of the components of the state
    t: Array  # (n,), s
    states: Array  # (n, m, k)
    drift: Mapping[str, Array]  # (m,) of each first integral: the largest relative change

    def report(self) -> str:
        """How many motions there are, and the largest drift of each first integral."""
        lost = int(np.count_nonzero(~np.isfinite(self.states[-1]).all(axis=1)))
        lines = [f"{self.name}: {self.states.shape[1]} motions from 0 to {self.t[-1]:g} s"]
        if lost:
            lines.append(f"{lost} of them came to a pole of the coordinates or left the numbers")
        width = max(map(len, self.drift), default=0)
        lines += [
            f"  {name:{width}}  largest drift {np.nanmax(values):.1e}"
            for name, values in self.drift.items()
        ]
        return "\n".join(lines)

    def columns(self) -> dict[str, Array]:
        """The first and the last state of each motion, and its drift."""
        found = {f"{name}_start": self.states[0, :, k] for k, name in enumerate(self.names)}
        found |= {f"{name}_end": self.states[-1, :, k] for k, name in enumerate(self.names)}
        return found | {f"drift_{name}": values for name, values in self.drift.items()}


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
    """Motions from t = 0 to `t_end` seconds, by steps of order 8 and of the same length for all.

    `initial` and `parameters` are those of `simulate`; each value may be an array, (m,), or for
    angular_velocity_body (m, 3). Without a `step` in seconds, the fastest body turns 0.05 rad in
    one. The drift shows whether this was short enough. Raises ModelError as `simulate` does, and
    for arrays whose lengths differ.
    """
    if not (np.isfinite(t_end) and t_end > 0):
        raise ModelError(f"the end time is {t_end}; expected a positive number of seconds")
    try:
        from scipy.integrate import DOP853
    except ModuleNotFoundError as error:
        raise MissingExtra("a simulation", "simulate") from error
    members = _members(initial, parameters)
    first = Problem(with_motion(derivation), *_of(0, initial, parameters))
    constants = np.array(first.constants, float)
    start = first.state_of(initial)
    start = np.broadcast_to(start, (members, start.shape[-1]))
    if first.constants and any(map(np.ndim, parameters.values())):
        names = first.names["parameters"]
        known = [np.broadcast_to(parameters.get(name, 1.0), members) for name in names]
        constants = np.stack(known, axis=1).astype(float)
    times = np.linspace(0.0, t_end, samples)
    speed = float(np.linalg.norm(first.omega(start), axis=1).max()) or 1.0
    count = max(1, int(np.ceil(times[1] / (step or _ANGLE / speed))))
    states = np.empty((samples, *start.shape))
    blocks = range(0, members, _BLOCK)
    for done, at in enumerate(blocks):
        these = slice(at, at + _BLOCK)
        given = (constants if constants.ndim < 2 else constants[these],) if len(constants) else ()
        method = _RungeKutta(DOP853, first.kernels.state_derivative, given)
        states[0, these] = start[these]
        for k in range(1, samples):
            states[k, these] = method.moved(states[k - 1, these], times[k - 1], times[k], count)
            if progress is not None:
                progress((done + k / (samples - 1)) / len(blocks))
    momentum = np.linalg.norm(first.omega(states[0]) @ first.inertia, axis=1)
    changes = relative_changes(first.integrals(times[:, None], states, constants), momentum)
    return Ensemble(
        name=derivation.name,
        names=first.names["y"],
        t=times,
        states=states,
        drift={name: values.max(axis=0) for name, values in changes.items()},
    )


def _members(*given: Mapping[str, Any]) -> int:
    """The common length of the arrays."""
    lengths = {
        len(value)
        for values in given
        for name, value in values.items()
        if np.ndim(value) > (1 if name == OMEGA else 0)
    }
    if len(lengths) > 1:
        raise ModelError(f"arrays of {' and '.join(map(str, sorted(lengths)))} motions")
    return lengths.pop() if lengths else 1


def _of(k: int, *given: Mapping[str, Any]) -> list[dict[str, Any]]:
    """The values of one member."""
    return [
        {
            name: value[k] if np.ndim(value) > (1 if name == OMEGA else 0) else value
            for name, value in values.items()
        }
        for values in given
    ]


class _RungeKutta:
    """Steps of an explicit method with the tableau (A, B, C) of one of SciPy's."""

    def __init__(self, method: Any, slopes: Callable[..., Array], given: tuple[Array, ...]) -> None:
        count = method.n_stages
        self.sums, self.nodes, self.weights = method.A[:count, :count], method.C[:count], method.B
        self.slopes, self.given = slopes, given

    def moved(self, y: Array, start: float, end: float, count: int) -> Array:
        """The states at `end`, after `count` steps."""
        h = (end - start) / count
        stages = np.empty((len(self.nodes), *y.shape))
        flat = stages.reshape(len(stages), -1)
        for step in range(count):
            for k, node in enumerate(self.nodes):
                moved = y + h * (self.sums[k, :k] @ flat[:k]).reshape(y.shape)
                stages[k] = self.slopes(start + (step + node) * h, moved, *self.given)
            y = y + h * (self.weights @ flat).reshape(y.shape)
        return y
