"""A derivation with equations of motion, integrated in time on its own kernels."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from rigidsym.errors import DerivationError, MissingExtra, ModelError, offer
from rigidsym.mechanics.derivation import Derivation
from rigidsym.mechanics.derive import derive
from rigidsym.models.forces import Forces
from rigidsym.models.rotation import RotationModel
from rigidsym.simulation.attitude import Attitude, quaternions_of
from rigidsym.simulation.free_body import free_motion
from rigidsym.simulation.problem import OMEGA as OMEGA, POLE, Problem
from rigidsym.simulation.sampled_motion import Array
from rigidsym.simulation.trajectory import Trajectory

METHODS = ("DOP853", "RK45", "Radau", "LSODA", "lie", "exact")
_NEEDED = ("rotation_matrix", "angular_velocity_body", "energy", "inertia_tensor")
_PREFERRED = ("rates_from_angular_velocity_body", "torque_body")

Progress = Callable[[float], None]


def simulate(
    derivation: Derivation,
    initial: Mapping[str, Any],
    parameters: Mapping[str, float],
    t_end: float,
    *,
    samples: int = 1001,
    method: str = "DOP853",
    rtol: float = 1e-11,
    atol: float = 1e-12,
    progress: Progress | None = None,
) -> Trajectory:
    """The motion from t = 0 to `t_end`, in seconds; without forces, that of the free body.

    `initial` contains the coordinates by name (theta), with their rates (theta_dot) or the body
    components of the angular velocity (angular_velocity_body), and `parameters` the constants.
    `method` is an integrator of SciPy, "lie" for steps in the rotation group, which conserve the
    angular momentum of a free body up to rounding, or "exact" for a free body in elliptic
    functions. Near a pole of the coordinates the integration continues with a quaternion, and the
    report says so.
    Raises ModelError for names that are missing or unknown, and if the derivation has no
    equations of motion; MissingExtra without SciPy.
    """
    if method not in METHODS:
        raise ModelError(f"no method {method!r}; {offer(method, METHODS)}")
    if not (np.isfinite(t_end) and t_end > 0):
        raise ModelError(f"the end time is {t_end}; expected a positive number of seconds")
    try:
        import scipy.integrate  # noqa: F401
    except ModuleNotFoundError as error:
        raise MissingExtra("a simulation", "simulate") from error
    problem = Problem(with_motion(derivation), initial, parameters)
    times = np.linspace(0.0, t_end, samples)
    if method == "exact":
        return _exact(problem, times)
    if method == "lie":
        attitude = Attitude(problem)
        states = attitude.states(problem.start[None], attitude.in_group(times, progress))
        times = times[: len(states)]
        is_whole = len(states) == samples
        why = f"the integration stopped at t = {times[-1]:.6g} s: the body turns too fast"
        return problem.trajectory(times, states, "" if is_whole else why)
    return _integrated(problem, times, progress, {"method": method, "rtol": rtol, "atol": atol})


def with_motion(derivation: Derivation) -> Derivation:
    """The quantities that a simulation needs; a body on which nothing acts is free."""
    body = derivation.body
    if body is None:
        raise ModelError(
            f"{derivation.name} has no equations of motion; expected a body and a potential, "
            "as in rs.derive(..., body=..., potential=...)"
        )
    names = {step.quantity.name for step in derivation.steps} | {*derivation.functions}
    if derivation.forces is None or not names.issuperset((*_NEEDED, "state_derivative")):
        forces = derivation.forces or Forces()
        return derive(derivation.model, needed(derivation.model), body=body, forces=forces)
    return derivation.select([n for n in (*_NEEDED, *_PREFERRED) if n in names])


def needed(model: RotationModel) -> tuple[str, ...]:
    """The quantities from which a motion is computed."""
    has_rates = len(model.coordinates) >= 3  # else they do not follow from Ω′
    rates = ("rates_from_angular_velocity_body",) if has_rates else ()
    return (*_NEEDED, "state_derivative", "first_integrals", "torque_body", *rates)


def _integrated(
    problem: Problem, times: Array, progress: Progress | None, options: Mapping[str, Any]
) -> Trajectory:
    """By one of SciPy's integrators, as a quaternion from where a pole comes near."""
    found: list[Array] = []
    remarks: list[str] = []
    at, state, ended = 0.0, problem.start, ""
    if problem.margin(state) > POLE:
        solved = _solve(problem.slopes, state, times, progress, options, problem.margin)
        found.append(solved.y.T)
        if solved.status == 1:
            at, state = float(solved.t_events[0][0]), solved.y_events[0][0]
        else:
            at, ended = times[-1], _ending(solved)
    rest = times[len(found[0]) if found else 0 :]
    if not ended and len(rest):
        attitude = Attitude(problem)
        remarks.append(
            f"near a pole of the coordinates at t = {at:.6g} s; continued as a quaternion"
        )
        start = attitude.start(state)
        solved = _solve(attitude.slopes, start, rest, progress, options, None, at)
        before = np.concatenate([*found, state[None]])
        found.append(attitude.states(before, solved.y.T))
        if at == 0:
            found[-1][0] = problem.start  # its rates are known, even at the pole
        ended = _ending(solved)
    states = np.concatenate(found)
    return problem.trajectory(times[: len(states)], states, ended, remarks)


def _solve(
    slopes: Callable[[float, Array], Array],
    start: Array,
    times: Array,
    progress: Progress | None,
    options: Mapping[str, Any],
    margin: Callable[[Array], float] | None,
    at: float = 0.0,
) -> Any:
    from scipy.integrate import solve_ivp

    def reported(t: float, y: Array) -> Array:
        if progress is not None:
            progress(t / times[-1])
        return slopes(t, y)

    def pole(_: float, y: Array) -> float:
        return margin(y) - POLE if margin else 1.0

    with np.errstate(over="ignore"):
        squares = np.square([*start, *slopes(at, start)])
    if not np.isfinite(squares).all():  # SciPy would look for a first step for ever
        raise DerivationError(
            f"the equations of motion give no finite rates at t = {at:.6g} s; expected a state "
            "away from poles of the coordinates, and rates whose squares do not overflow"
        )
    pole.terminal = True  # type: ignore[attr-defined]  # how SciPy is told to stop there
    solved = solve_ivp(reported, (at, times[-1]), start, t_eval=times, events=pole, **options)
    if solved.status < 0 and not len(solved.t):
        raise DerivationError(f"no step could be taken: {solved.message}")
    return solved


def _ending(solved: Any) -> str:
    """Why a motion ends before its time."""
    if solved.status >= 0:
        return ""
    return f"the integration stopped at t = {solved.t[-1]:.6g} s: {solved.message}"


def _exact(problem: Problem, times: Array) -> Trajectory:
    """The free body in elliptic functions."""
    attitude = Attitude(problem)
    if not attitude.is_free:
        raise ModelError(f"{problem.derivation.name}: expected a free body for the exact solution")
    start = problem.start
    omega, rotation = free_motion(
        problem.inertia, problem.omega(start), problem.rotation(start), times
    )
    found = np.concatenate([quaternions_of(rotation), omega], axis=1)
    return problem.trajectory(times, attitude.states(start[None], found))
