"""A derivation with equations of motion, integrated in time by SciPy on its own kernels."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from types import ModuleType
from typing import Any

import numpy as np
import sympy as sp

from rigidsym.errors import DerivationError, MissingExtra, ModelError, offer
from rigidsym.kernels.module import generate
from rigidsym.mechanics.derivation import Derivation
from rigidsym.simulation.trajectory import Array, Trajectory

METHODS = ("DOP853", "RK45", "Radau", "LSODA")
_POLE = 1e-6  # of the singularity margin: nearer to a pole no digits are left

Progress = Callable[[float], None]


def simulate(
    derivation: Derivation,
    initial: Mapping[str, float],
    parameters: Mapping[str, float],
    t_end: float,
    *,
    samples: int = 1001,
    method: str = "DOP853",
    rtol: float = 1e-11,
    atol: float = 1e-12,
    progress: Progress | None = None,
) -> Trajectory:
    """The motion from t = 0 to `t_end`, in seconds.

    `initial` holds the coordinates and rates by name (theta, theta_dot), and `parameters` the
    constants. A motion that stops at a pole of the coordinates ends there, and says so; one that
    goes straight through it goes on.
    Raises ModelError for names that are missing or unknown, for a start at a pole, and if the
    derivation has no equations of motion; MissingExtra without SciPy.
    """
    problem = _Problem(derivation, initial, parameters)
    if method not in METHODS:
        raise ModelError(f"no method {method!r}; {offer(method, METHODS)}")
    if not (np.isfinite(t_end) and t_end > 0):
        raise ModelError(f"the end time is {t_end}; expected a positive number of seconds")
    try:
        from scipy.integrate import solve_ivp
    except ModuleNotFoundError as error:
        raise MissingExtra("a simulation", "simulate") from error

    def slopes(t: float, y: Array) -> Array:
        if progress is not None:
            progress(t / t_end)
        return problem.slopes(t, y)

    solved = solve_ivp(
        slopes,
        (0.0, t_end),
        problem.start,
        method=method,
        t_eval=np.linspace(0.0, t_end, samples),
        rtol=rtol,
        atol=atol,
        events=problem.margin,
    )
    if solved.t.size == 0:
        raise DerivationError(f"{derivation.name}: no step could be taken: {solved.message}")
    ended = ""
    if solved.status == 1:
        ended = (
            f"ended at t = {solved.t_events[0][0]:.6g} s, at a pole of the coordinates; other "
            "coordinates, such as another sequence of axes, go on"
        )
    elif solved.status != 0:
        ended = f"ended at t = {solved.t[-1]:.6g} s: {solved.message}"
    return problem.trajectory(solved.t, solved.y.T, ended)


class _Problem:
    """The state y = (q, q̇) of one derivation, its parameters and its kernels."""

    def __init__(
        self,
        derivation: Derivation,
        initial: Mapping[str, float],
        parameters: Mapping[str, float],
    ) -> None:
        if "accelerations" not in {step.quantity.name for step in derivation.steps}:
            raise ModelError(
                f"{derivation.name} has no equations of motion; expected a body and a potential, "
                "as in rs.derive(..., body=..., potential=...)"
            )
        self.derivation = derivation
        names = {a.name: a.names for a in derivation.arguments}
        self.coordinates = names["q"]
        self.count = len(self.coordinates)
        constants = names.get("parameters", ())
        wanted = (*names["q"], *names["q_dot"])
        _check_names("initial values", initial, wanted, wanted)
        needed = [name for name in constants if sp.Symbol(name) in self._symbols]
        _check_names("parameters", parameters, needed, constants)
        self.parameters = [float(parameters.get(name, 1.0)) for name in constants]
        self.start = np.array([float(initial[name]) for name in wanted])
        self._check_body(dict(zip(constants, self.parameters, strict=True)))
        self.kernels: ModuleType = generate(derivation, "numpy").load()
        self.margin: Any = self._margin_event()
        self._slopes = self.kernels.state_derivative_scalar
        self._constants = [v for given in self._given("state_derivative") for v in given]
        if self.margin(0.0, self.start) <= 0:
            raise ModelError(
                f"{derivation.name}: the motion starts at a pole of the coordinates, where the "
                "rates do not follow from the angular velocity"
            )

    @property
    def _symbols(self) -> set[sp.Basic]:
        """What the motion depends on; the mass of a body about a fixed point may not be in it."""
        body = self.derivation.body
        held = [self.derivation.step(name).expression for name in ("accelerations", "energy")]
        held += [body.inertia] if body else []
        return set().union(*(expression.free_symbols for expression in held))

    def _check_body(self, values: Mapping[str, float]) -> None:
        """A body with values for its parameters checks its moments when it is made."""
        body = self.derivation.body
        if body is not None:
            known = (replace(p, value=values[p.symbol.name]) for p in body.parameters)
            replace(body, parameters=tuple(known))

    def _given(self, name: str) -> list[list[float]]:
        """The parameters, if a function takes them."""
        step = self.derivation.step(name)
        return [self.parameters] if "parameters" in step.quantity.inputs else []

    def slopes(self, t: float, y: Array) -> Array:
        """The derivative of one state."""
        return np.array(self._slopes(t, *y.tolist(), *self._constants))

    def _margin_event(self) -> Any:
        """The distance from a pole, for the integrator to stop at; never if there is none."""
        found = getattr(self.kernels, "singularity_margin_scalar", None)

        def margin(_: float, y: Array) -> float:
            return 1.0 if found is None else found(*y[: self.count].tolist()) - _POLE

        margin.terminal = True  # type: ignore[attr-defined]  # how SciPy is told to stop there
        return margin

    def trajectory(self, t: Array, states: Array, ended: str) -> Trajectory:
        q, q_dot = states[:, : self.count], states[:, self.count :]
        return Trajectory(
            name=self.derivation.name,
            coordinates=self.coordinates,
            t=t,
            q=q,
            q_dot=q_dot,
            angular_velocity_body=self.kernels.angular_velocity_body(q, q_dot),
            rotation_matrix=self.kernels.rotation_matrix(q),
            first_integrals=self._integrals(states),
            ended=ended,
        )

    def _integrals(self, states: Array) -> dict[str, Array]:
        names = [integral.name for integral in self.derivation.first_integrals]
        if not names:
            return {}
        values = self.kernels.first_integrals(states, *self._given("first_integrals"))
        return dict(zip(names, values.T, strict=True))


def _check_names(
    what: str, given: Mapping[str, float], wanted: Sequence[str], known: Sequence[str]
) -> None:
    """All that is missing at once, and the first that is unknown."""
    missing = [name for name in wanted if name not in given]
    if missing:
        raise ModelError(f"missing {what}: {', '.join(missing)}")
    for name in given:
        if name not in known:
            raise ModelError(f"unknown {what}: {name}; {offer(name, known)}")
