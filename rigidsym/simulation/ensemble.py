"""Many motions at once: one kernel call a stage, for all initial states and parameters."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from rigidsym.errors import MissingExtra, ModelError
from rigidsym.mechanics.derivation import Derivation
from rigidsym.simulation.problem import OMEGA, Problem
from rigidsym.simulation.samples import Array, relative_changes
from rigidsym.simulation.solver import with_motion

_ANGLE = 0.05  # radians that the fastest body turns in a step


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
    y = np.array([first.state_of(_of(k, initial, {})[0]) for k in range(members)])
    if first.constants:
        names = first.names["parameters"]
        known = {name: np.broadcast_to(parameters.get(name, 1.0), members) for name in names}
        constants = np.stack([known[name] for name in names], axis=1).astype(float)

    def slopes(t: float, y: Array) -> Array:
        given = (constants,) if first.constants else ()
        return np.asarray(first.kernels.state_derivative(t, y, *given))

    times = np.linspace(0.0, t_end, samples)
    speed = float(np.linalg.norm(first.omega(y), axis=1).max()) or 1.0
    count = max(1, int(np.ceil(times[1] / (step or _ANGLE / speed))))
    found = [y]
    for start, end in zip(times[:-1].tolist(), times[1:].tolist(), strict=True):
        h = (end - start) / count
        for k in range(count):
            y = _stepped(DOP853, slopes, start + k * h, y, h)
        found.append(y)
        if progress is not None:
            progress(end / t_end)
    states = np.array(found)
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


def _stepped(
    method: Any, slopes: Callable[[float, Array], Array], t: float, y: Array, h: float
) -> Array:
    """One step of an explicit Runge-Kutta method with the tableau (A, B, C)."""
    stages: list[Array] = []
    for node, weights in zip(method.C[: method.n_stages], method.A, strict=False):
        moved = sum((w * s for w, s in zip(weights, stages, strict=False) if w), start=0 * y)
        stages.append(slopes(t + node * h, y + h * moved))
    return y + h * sum((b * s for b, s in zip(method.B, stages, strict=True) if b), start=0 * y)
