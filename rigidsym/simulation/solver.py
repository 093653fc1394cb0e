"""A derivation with equations of motion, integrated in time on its own kernels."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import nullcontext
from typing import Any, NamedTuple

import numpy as np

from rigidsym.errors import DerivationError, MissingExtra, ModelError, offer
from rigidsym.mechanics.derivation import Derivation, remark
from rigidsym.simulation.free_body import free_motion
from rigidsym.simulation.problem import Problem, with_motion
from rigidsym.simulation.trajectory import Array, Trajectory
from rigidsym.system.processes import time_limit

METHODS = ("DOP853", "Radau", "exact")
_POLE = 1e-3  # of twice the ratio of singular values of W′: nearer, coordinates lose digits
# A motion comes to an end where the steps become a millionth of the longest one and stay so: at a
# regular motion the error control never shortens them by more than some thousand times.
_SHORT, _MANY = 1e-6, 300

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
    timeout: float | None = None,
    progress: Progress | None = None,
) -> Trajectory:
    """Integrate the motion from t = 0 to `t_end`; a body without forces is free.

    Near a pole of the coordinates the integration continues with a unit quaternion and Ω′, and the
    report says so.

    Parameters
    ----------
    derivation : Derivation
        A rotation, a body, and what acts on it.
    initial : mapping
        Coordinates by name (theta), in rad, and their rates (theta_dot) or the body components of
        the angular velocity (angular_velocity_body of shape (3,), or angular_velocity_body_1, _2,
        _3), in rad/s; what it omits is 0.
    parameters : mapping
        The constants by name, in SI units.
    t_end : float
        In s.
    samples : int, optional
        Number of times.
    method : str, optional
        An integrator of SciPy, with the tolerances `rtol` and `atol`; "exact" computes the motion
        of a free body in elliptic functions.
    timeout : float, optional
        Limit of the computation time, in s.
    progress : callable, optional
        Called with the share of the time that has been integrated.

    Returns
    -------
    Trajectory
        Times (n,), coordinates (n, k), rotation matrices (n, 3, 3) from body to space components,
        Ω′ (n, 3), and the drift of each first integral.

    Raises
    ------
    ModelError
        For names that are missing or unknown, and a derivation without equations of motion.
    MissingExtra
        Without SciPy.
    LimitReached
        When the time is up.

    Examples
    --------
    >>> import rigidsym as rs
    >>> flywheel = rs.derive("z(phi)", body=rs.principal_moments(1, 1, 2), torque=[0, 0, "u"])
    >>> motion = flywheel.simulate({"phi_dot": 1.0}, {"u": 4.0}, 3.0, samples=4)
    >>> motion.q_dot[:, 0].round(9).tolist()
    [1.0, 3.0, 5.0, 7.0]
    """
    if method not in METHODS:
        raise ModelError(f"no method {method!r}; {offer(method, METHODS)}")
    if not (np.isfinite(t_end) and t_end > 0):
        raise ModelError(f"the end time is {t_end}; expected a positive number of seconds")
    try:
        import scipy.integrate  # noqa: F401
    except ModuleNotFoundError as error:
        raise MissingExtra("a simulation", "simulate") from error
    with nullcontext() if timeout is None else time_limit(timeout):
        problem = Problem(with_motion(derivation), initial, parameters)
        times = np.linspace(0.0, t_end, samples)
        if method == "exact":
            return _exact(problem, times)
        return _integrated(problem, times, progress, {"method": method, "rtol": rtol, "atol": atol})


def _integrated(
    problem: Problem, times: Array, progress: Progress | None, options: Mapping[str, Any]
) -> Trajectory:
    """In coordinates, and from a pole on as a quaternion, if nothing forbids it."""

    def is_pole(y: Array) -> bool:
        """Nearer only if no quaternion can take over, as another motion may pass the pole."""
        if not problem.is_near_pole(y, _POLE):
            return False
        return not problem.no_quaternion or problem.is_near_pole(y, _POLE / 10)

    states, at, state, ended = problem.start[None], 0.0, problem.start, ""
    starts_as_quaternion = is_pole(state) and not problem.no_quaternion
    if not (problem.is_quaternion or starts_as_quaternion):
        course = _solved(problem.slopes, state, times, at, is_pole, progress, options)
        states, at, state, ended = course
        if is_pole(state) and problem.no_quaternion and len(states) < len(times):
            ended = remark("stopped_at_pole", t=at, reason=problem.no_quaternion)
    rest = times[len(states) :]
    if ended or not len(rest):
        return problem.trajectory(times[: len(states)], states, ended)
    how = "integrated_as_quaternion" if problem.is_quaternion else "continued_as_quaternion"
    start = problem.quaternion(state)
    course = _solved(problem.quaternion_slopes, start, rest, at, None, progress, options)
    # The last state in coordinates belongs to no sample time, but it is the nearest one from which
    # the angles of the quaternion can be continued.
    before = np.concatenate([states, state[None]])
    states = np.concatenate([states, problem.states(before, course.states)])
    return problem.trajectory(times[: len(states)], states, course.ended, [remark(how, t=at)])


class _Course(NamedTuple):
    states: Array  # at the times that were reached
    t: float  # where the integration ended
    y: Array
    ended: str  # why, if that was not planned


def _solved(
    slopes: Callable[[float, Array], Array],
    start: Array,
    times: Array,
    at: float,
    is_end: Callable[[Array], bool] | None,
    progress: Progress | None,
    options: Mapping[str, Any],
) -> _Course:
    """States at the times, by one of SciPy's integrators, step by step until `is_end`."""
    from scipy import integrate

    with np.errstate(over="ignore", invalid="ignore"):
        if not np.isfinite(np.square([*start, *slopes(at, start)])).all():
            raise DerivationError(  # SciPy would look for a first step for ever
                f"the equations of motion give no finite rates at t = {at:.6g} s; expected a state "
                "away from poles of the coordinates, and rates whose squares do not overflow"
            )
        # The steps are taken one by one, not by solve_ivp, because the end of the motion in
        # coordinates, the progress and motions that become ever faster must be seen between steps.
        kind = getattr(integrate, options["method"])
        solver = kind(slopes, at, start, times[-1], rtol=options["rtol"], atol=options["atol"])
        count = int(np.searchsorted(times, at, side="right"))  # times reached so far
        states = [np.repeat(start[None], count, axis=0)]
        longest, short, ended = 0.0, 0, ""
        while solver.status == "running" and not ended:
            solver.step()
            if not np.isfinite(solver.y).all():
                ended = remark("rates_overflow")
                break
            longest = max(longest, solver.step_size)
            short = short + 1 if solver.step_size < _SHORT * longest else 0
            if short >= _MANY or solver.status == "failed":
                ended = remark("steps_too_short")
            reached = int(np.searchsorted(times, solver.t, side="right"))
            if reached > count:
                states.append(solver.dense_output()(times[count:reached]).T)
                count = reached
            if progress is not None:
                progress(solver.t / times[-1])
            if is_end is not None and is_end(solver.y):
                break
    if ended:
        ended = remark("stopped", t=solver.t, reason=ended)
    return _Course(np.concatenate(states), float(solver.t), solver.y, ended)


def _exact(problem: Problem, times: Array) -> Trajectory:
    """The free body in elliptic functions."""
    if not problem.forces.leave_free(problem.model) or problem.no_quaternion:
        name = problem.derivation.name
        raise ModelError(f"{name}: expected a free body on three turns, or a quaternion, for exact")
    from scipy.spatial.transform import Rotation

    start = problem.start
    omega, rotation = free_motion(
        problem.inertia, problem.omega(start), problem.rotation(start), times
    )
    # SciPy returns (x, y, z, w).
    quaternions = Rotation.from_matrix(rotation).as_quat()[:, [3, 0, 1, 2]]
    states = problem.states(start[None], np.concatenate([quaternions, omega], axis=1))
    return problem.trajectory(times, states)
