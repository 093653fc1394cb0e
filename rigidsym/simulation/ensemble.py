"""Many motions at once, in blocks of states whose stages stay in the processor's cache.

Large ensembles are computed in C if a compiler is installed, in threads or on a Dask cluster.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from functools import lru_cache, partial
from typing import Any

import numpy as np

from rigidsym.errors import MissingExtra, MissingTool, ModelError
from rigidsym.kernels.module import KernelModule, generate
from rigidsym.kernels.targets.c.compiling import compiler
from rigidsym.kernels.targets.c.stepper import CompiledSteps
from rigidsym.mechanics.derivation import Derivation
from rigidsym.simulation.problem import OMEGA, Problem
from rigidsym.simulation.sampled_motion import Array, relative_changes
from rigidsym.simulation.solver import with_motion

_ANGLE = 0.05  # radians that the fastest body turns in a step
_BLOCK = 512  # motions whose stages stay in the cache
_WORTH_COMPILING = 1_000_000  # steps of a motion
_NAMED = 5  # motions in a message
_FEW = 256  # motions: a step of fewer takes NumPy no less time

Block = tuple[Array, Array | None]  # initial states, and parameters of all or of each
Mapped = Callable[
    [Callable[[Block], Array], Iterable[int], Callable[[int], Block]], Iterable[tuple[int, Array]]
]


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
        found = dict(self.varied)
        found |= {f"{name}_start": self.states[0, :, k] for k, name in enumerate(self.names)}
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
    target: str | None = None,
    mapped: Mapped | None = None,
    progress: Callable[[float], None] | None = None,
) -> Ensemble:
    """Motions from t = 0 to `t_end` seconds, in steps of order 8 of the same length for all.

    `initial` and `parameters` are as for `simulate`, but each value may be an array, (m,), or for
    angular_velocity_body (m, 3). `step` is in seconds; by default, the fastest body turns 0.05 rad
    in a step. The drift shows whether this was short enough. `target` is "numpy" or "c"; by
    default, long simulations use C if there is a compiler. `mapped` applies a function to blocks of
    bodies, for example on a cluster, instead of threads of this process. Raises ModelError as
    `simulate` does, and for arrays whose lengths differ.
    """
    if not (np.isfinite(t_end) and t_end > 0):
        raise ModelError(f"the end time is {t_end}; expected a positive number of seconds")
    members = _members(initial, parameters)
    called = f"motion 1 of {members}"
    first = Problem(with_motion(derivation), *_of(0, initial, parameters), called=called)
    first.check_bodies(members, parameters)
    start = first.state_of(initial)
    start = np.broadcast_to(start, (members, start.shape[-1]))
    first.check_rotations(start)
    constants = np.array(first.constants, float)
    if first.constants and any(map(np.ndim, parameters.values())):
        constants = first.parameters_of(members, parameters)
    times = np.linspace(0.0, t_end, samples)
    speed = float(np.linalg.norm(first.omega(start), axis=1).max()) or 1.0
    count = max(1, int(np.ceil(times[1] / (step or _ANGLE / speed))))
    if target is None:
        is_long = max(members, _FEW) * count * (samples - 1) >= _WORTH_COMPILING
        target = "c" if is_long and _has_compiler() else "numpy"
    name = "state_derivative"
    slopes = replace(first.derivation.select(()), functions={name: first.derivation.step(name)})
    steps = Steps(kernels=generate(slopes, target), times=times, count=count)
    states = np.empty((samples, *start.shape))
    blocks = range(0, members, _BLOCK)

    def block(at: int) -> Block:
        own = constants if constants.ndim < 2 else constants[at : at + _BLOCK]
        return start[at : at + _BLOCK], own if len(constants) else None

    done = 0

    def advanced() -> None:
        nonlocal done
        done += 1
        if progress is not None:
            progress(min(1.0, done / (len(blocks) * (samples - 1))))

    work = steps.of if mapped else partial(steps.of, advanced=advanced)
    for at, found in (mapped or _in_threads)(work, blocks, block):
        states[:, at : at + _BLOCK] = found
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


def _has_compiler() -> bool:
    try:
        return bool(compiler())
    except MissingTool:
        return False


def _in_threads(
    function: Callable[[Block], Array], blocks: Iterable[int], block: Callable[[int], Block]
) -> Iterator[tuple[int, Array]]:
    """Each block with its result, in order."""
    blocks = list(blocks)
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        yield from zip(blocks, pool.map(function, map(block, blocks)), strict=True)


def _members(*given: Mapping[str, Any]) -> int:
    """The common length of the arrays."""
    lengths = {
        len(value)
        for values in given
        for name, value in values.items()
        if np.ndim(value) > (1 if name == OMEGA else 0)
    }
    if len(lengths) > 1:
        raise ModelError(
            f"expected arrays of one length, got {' and '.join(map(str, sorted(lengths)))}"
        )
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


@dataclass(frozen=True, kw_only=True, slots=True)
class Steps:
    """How blocks of states move on: data, so that it can be sent to another machine."""

    kernels: KernelModule  # with state_derivative
    times: Array  # (n,), s
    count: int  # of steps from one time to the next

    def of(self, block: Block, advanced: Callable[[], None] = lambda: None) -> Array:
        """The states at all times, (n, m, k)."""
        start, parameters = block
        states = np.empty((len(self.times), *start.shape))
        states[0] = start
        method = _method(self.kernels.name, self.kernels.target, tuple(self.kernels.files.items()))
        for k, (t, end) in enumerate(zip(self.times[:-1], self.times[1:], strict=True)):
            h = (end - t) / self.count
            states[k + 1] = method.moved(states[k], t, h, self.count, parameters)
            advanced()
        return states


@lru_cache(maxsize=8)
def _method(name: str, target: str, files: tuple[tuple[str, str], ...]) -> Any:
    """Steps of order 8 with the slopes of generated kernels."""
    try:
        from scipy.integrate import DOP853
    except ModuleNotFoundError as error:
        raise MissingExtra("a simulation", "simulate") from error
    kernels = KernelModule(name=name, target=target, files=dict(files)).load()
    n = DOP853.n_stages
    made = CompiledSteps if target == "c" else RungeKutta
    return made(kernels, DOP853.C[:n], DOP853.A[:n, :n], DOP853.B)


class RungeKutta:
    """Steps of an explicit method with these nodes, weights (n, n) and sums (n,)."""

    def __init__(self, kernels: Any, nodes: Array, weights: Array, sums: Array) -> None:
        self.slopes = kernels.state_derivative
        self.nodes, self.weights, self.sums = nodes, weights, sums

    def moved(self, y: Array, t: float, h: float, count: int, parameters: Array | None) -> Array:
        """The states (m, k) after `count` steps of length h from the time t."""
        stages, lost = np.empty((len(self.nodes), *y.shape)), np.zeros_like(y)
        flat = stages.reshape(len(stages), -1)
        given = () if parameters is None else (parameters,)
        for step in range(count):
            for k, node in enumerate(self.nodes):
                moved = y + h * (self.weights[k, :k] @ flat[:k]).reshape(y.shape)
                stages[k] = self.slopes(t + (step + node) * h, moved, *given)
            added = h * (self.sums @ flat).reshape(y.shape) + lost
            before, y = y, y + added
            lost = added - (y - before)  # by rounding (Kahan)
        return y
