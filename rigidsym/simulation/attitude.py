"""Motions without poles: the unit quaternion in place of the coordinates.

The state is (quaternion, Ω′), or for steps in the group (quaternion, L): L is constant for a free
body, and stays so to the last bit. Coordinates are only needed for the torque of a potential; they
are taken from the quaternion.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from math import cos, sin, sqrt, tan

import numpy as np

from rigidsym.errors import ModelError
from rigidsym.mechanics.derive import derive
from rigidsym.models.forces import Forces
from rigidsym.simulation.problem import OMEGA, Problem
from rigidsym.simulation.sampled_motion import Array

_WANTED = ("rotation_matrix", "angular_velocity_body", "torque_body", "energy", "state_derivative")
_ANGLE = 0.05  # radians, of a step in the group
_MOST_STEPS = 100_000  # between two samples
_SMALL = 1e-4  # rad: below it, series to second order are exact in double precision


class Attitude:
    """One problem with the quaternion in place of its coordinates."""

    def __init__(self, problem: Problem) -> None:
        """Raises ModelError if the body does not move alone, so that there are no torques."""
        self.problem = problem
        self.kernels = problem.kernels
        self.torqued = problem if problem.is_euler else _in_euler_form(problem)
        self.is_free = self.torqued.derivation.step("torque_body").expression.is_zero_matrix

    def start(self, y: Array) -> Array:
        """(quaternion, Ω′) of a state."""
        q = y[: self.problem.count]
        quaternion = self.kernels.quaternion(q, *self.problem.angles)
        return np.concatenate([quaternion, self.problem.omega(y)])

    def slopes(self, t: float, state: Array) -> Array:
        w, x, y, z, *omega = state.tolist()
        a, b, c = omega
        turning = (
            -x * a - y * b - z * c,
            w * a + y * c - z * b,
            w * b + z * a - x * c,
            w * c + x * b - y * a,
        )
        return np.array([*(rate / 2 for rate in turning), *self.angular(t, (w, x, y, z), omega)])

    def angular(self, t: float, quaternion: Sequence[float], omega: list[float]) -> list[float]:
        """dΩ′/dt."""
        q = (0.0,) * self.problem.count
        if not self.is_free:
            q = self.kernels.from_quaternion_scalar(*quaternion)
        derivative = self.torqued.kernels.state_derivative_scalar
        return list(derivative(t, *q, *omega, *self.torqued.constants)[-3:])

    def states(self, before: Array, found: Array) -> Array:
        """States of the problem, continuous after those `before`, from (quaternion, Ω′)."""
        problem = self.problem
        q = self.kernels.from_quaternion(found[:, :4])
        if hasattr(self.kernels, "unwrap"):
            q = self.kernels.unwrap(np.concatenate([before[:, : problem.count], q]))[len(before) :]
        if problem.is_euler:
            return np.concatenate([q, found[:, 4:]], axis=1)
        return np.concatenate([q, problem.rates(q, found[:, 4:])], axis=1)

    def in_group(self, times: Array, progress: Callable[[float], None] | None) -> Array:
        """(quaternion, Ω′) at the times, by Runge-Kutta-Munthe-Kaas steps of order 8.

        It ends early if the body turns too fast for this many steps, or if its state overflows.

        H. Munthe-Kaas, High order Runge-Kutta methods on manifolds (1999), with the coefficients
        of DOP853.
        """
        state = self.start(self.problem.start)
        quaternion, omega = state[:4], state[4:]
        tensor = self.problem.inertia
        momentum = _matrix(quaternion) @ (tensor @ omega)
        step = _Step(self)
        found = [state]
        for start, end in zip(times[:-1].tolist(), times[1:].tolist(), strict=True):
            size = float(np.linalg.norm(found[-1][4:]))
            wanted = np.ceil((end - start) * size / _ANGLE)
            if not wanted <= _MOST_STEPS:
                break
            count = max(1, int(wanted))
            h = (end - start) / count
            try:
                for k in range(count):
                    quaternion, momentum = step(start + k * h, h, quaternion, momentum)
            except (ArithmeticError, ValueError):  # the sine of infinity
                break
            found.append(np.concatenate([quaternion, step.omega(quaternion, momentum)]))
            if progress is not None:
                progress(end / times[-1])
        return np.array(found)


def _in_euler_form(problem: Problem) -> Problem:
    """The same motion with the state (q, Ω′); raises ModelError for parts and a turning frame."""
    derivation = problem.derivation
    forces = derivation.forces or Forces()
    if not problem.is_alone:
        raise ModelError(
            f"{derivation.name}: quaternions can replace the coordinates of one body in an "
            "inertial frame only"
        )
    euler = replace(forces, method="euler", first_integrals={})
    made = derive(derivation.model, _WANTED, body=derivation.body, forces=euler)
    names = problem.names.get("parameters", ())
    values = dict(zip(names, problem.parameters, strict=True))
    q = dict(zip(problem.coordinates, problem.start[: problem.count], strict=True))
    return Problem(made, {**q, OMEGA: (0.0, 0.0, 0.0)}, values)


class _Step:
    """One step in the group: the quaternion is multiplied by the exponential of a vector."""

    def __init__(self, motion: Attitude) -> None:
        from scipy.integrate import DOP853

        self.motion = motion
        self.tensor = motion.problem.inertia
        self.inverse = np.linalg.inv(self.tensor)
        self.nodes = DOP853.C[: DOP853.n_stages]
        self.sums = DOP853.B
        self.weights = DOP853.A[: DOP853.n_stages, : DOP853.n_stages]

    def __call__(
        self, t: float, h: float, quaternion: Array, momentum: Array
    ) -> tuple[Array, Array]:
        slopes = np.zeros((len(self.nodes), 3))
        torques = np.zeros((len(self.nodes), 3))
        for k, node in enumerate(self.nodes):
            vector = h * (self.weights[k, :k] @ slopes[:k])
            turned = _times(quaternion, _exponential(vector))
            now = momentum
            if not self.motion.is_free:
                now = momentum + h * (self.weights[k, :k] @ torques[:k])
                torques[k] = self._torque(t + node * h, turned, now)
            slopes[k] = _inverse_slope(vector, self.omega(turned, now))
        found = _times(quaternion, _exponential(h * (self.sums @ slopes)))
        found /= np.linalg.norm(found)
        return found, momentum + h * (self.sums @ torques)

    def omega(self, quaternion: Array, momentum: Array) -> Array:
        """Ω′ = I′⁻¹ Rᵀ L"""
        return np.asarray(self.inverse @ (_matrix(quaternion).T @ momentum))

    def _torque(self, t: float, quaternion: Array, momentum: Array) -> Array:
        """N = R (I′ dΩ′/dt + Ω′ × I′ Ω′)"""
        omega = self.omega(quaternion, momentum)
        slope = np.array(self.motion.angular(t, quaternion.tolist(), omega.tolist()))
        in_body = self.tensor @ slope + np.cross(omega, self.tensor @ omega)
        return np.asarray(_matrix(quaternion) @ in_body)


def _matrix(quaternion: Array) -> Array:
    """R of a unit quaternion."""
    w, x, y, z = quaternion.tolist()
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def _times(left: Array, right: Array) -> Array:
    """The product of two quaternions."""
    a, b = left.tolist(), right.tolist()
    return np.array(
        [
            a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
            a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
            a[0] * b[2] + a[2] * b[0] + a[3] * b[1] - a[1] * b[3],
            a[0] * b[3] + a[3] * b[0] + a[1] * b[2] - a[2] * b[1],
        ]
    )


def _exponential(vector: Array) -> Array:
    """The quaternion of a rotation vector."""
    x, y, z = vector.tolist()
    angle = sqrt(x * x + y * y + z * z)
    scale = sin(angle / 2) / angle if angle > _SMALL else 0.5 - angle * angle / 48
    return np.array([cos(angle / 2), scale * x, scale * y, scale * z])


def _inverse_slope(vector: Array, omega: Array) -> Array:
    """u̇ of q exp u from Ω′: Ω′ + u × Ω′/2 + (1 − n/2 cot n/2)/n² u × (u × Ω′), n = |u|."""
    n = sqrt(float(vector @ vector))
    scale = (1 - n / 2 / tan(n / 2)) / (n * n) if n > _SMALL else 1 / 12 + n * n / 720
    once = _cross(vector, omega)
    return omega + once / 2 + scale * _cross(vector, once)


def _cross(one: Array, other: Array) -> Array:
    a, b, c = one.tolist()
    x, y, z = other.tolist()
    return np.array([b * z - c * y, c * x - a * z, a * y - b * x])


def quaternions_of(rotation: Array) -> Array:
    """Unit quaternions of rotation matrices, (n, 4); SciPy's choice of the larger component."""
    from scipy.spatial.transform import Rotation

    found = Rotation.from_matrix(rotation).as_quat()
    return np.asarray(found[:, [3, 0, 1, 2]])
