"""What is integrated: the state of one derivation, its parameters and its kernels.

The state y is (q, q̇) in Lagrange's form and (q, Ω′) in Euler's. Near a pole of the coordinates the
unit quaternion takes their place: the state is then (quaternion, Ω′), the torque N′ is evaluated at
the coordinates of the quaternion, and

    d/dt quaternion = ½ quaternion ⊗ Ω′,  dΩ′/dt = I′⁻¹ (N′ − Ω′ × I′ Ω′).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import cached_property
from types import ModuleType
from typing import Any

import numpy as np
import sympy as sp

from rigidsym.algebra.evaluate import Floats, Unknown, evaluate
from rigidsym.errors import ModelError, QuantityError, offer
from rigidsym.kernels.module import generate
from rigidsym.mechanics.derivation import Derivation, Step
from rigidsym.mechanics.derive import derive
from rigidsym.mechanics.dynamics.euler import EulerEquations
from rigidsym.mechanics.dynamics.lagrange import is_bound
from rigidsym.mechanics.quantities.dynamics import EULER_QUANTITIES, FLOW_QUANTITIES
from rigidsym.models.body import RigidBody, check_moments
from rigidsym.models.forces import OMEGA, OMEGA_COMPONENTS, Forces, initial_values
from rigidsym.models.rotation import RotationModel, as_typed
from rigidsym.simulation.trajectory import Array, Trajectory

# from which a motion is computed
NEEDED = ("rotation_matrix", "angular_velocity_body", "state_derivative", "first_integrals")
_GRAVITY = "m/s^2"  # the unit by which the acceleration in a weight is known
_ORIENTATIONS = 12  # at which a weight is told from other potentials; c has three components
_UNIT = 1e-9  # by which the entries of R Rᵀ − 1 may be off at the start


def with_motion(derivation: Derivation) -> Derivation:
    """The derivation with equations of motion; a body on which nothing acts is free."""
    body = derivation.body
    if body is None:
        raise ModelError(
            f"{derivation.name} has no equations of motion; expected a body and a potential, "
            "as in rs.derive(..., body=..., potential=...)"
        )
    names = {step.quantity.name for step in derivation.steps} | {*derivation.functions}
    names |= {"first_integrals"} if not derivation.first_integrals else set()
    if derivation.forces is None or not names.issuperset(NEEDED):
        return derive(derivation.model, NEEDED, body=body, forces=derivation.forces or Forces())
    return derivation


class Problem:
    """The state y of one derivation, (q, q̇) or (q, Ω′), its parameters and its kernels."""

    def __init__(
        self,
        derivation: Derivation,
        initial: Mapping[str, Any],
        parameters: Mapping[str, float],
    ) -> None:
        """Raises ModelError for names that are missing or unknown, and for an impossible body."""
        self.derivation = derivation
        self.model, self.forces = derivation.model, derivation.forces or Forces()
        self.names = {a.name: a.names for a in derivation.arguments}
        self.coordinates = self.names["q"]
        self.count = len(self.coordinates)
        self.is_euler = self.names["y"][self.count :] == self.names["omega_body"]
        # so that a quaternion can take the place of the coordinates
        self.is_alone = not self.forces.parts
        # three coordinates of a vector have a pole wherever they are, and long equations of motion
        self.is_quaternion = bool(self.model.vector) and self.is_alone and not is_bound(self.model)
        self.parameters = self._parameters(parameters)
        self.kernels: ModuleType = generate(
            self._functions, "numpy", conversions=self.is_alone
        ).load()
        self.start = self._state(initial)
        self._check_rotation(self.start)

    @cached_property
    def _functions(self) -> Derivation:
        """The derivation with the functions that are evaluated."""
        names = ["rotation_matrix", "angular_velocity_body"]
        whole, rates = self.derivation, "rates_from_angular_velocity_body"
        if rates not in {step.quantity.name for step in whole.steps}:
            # few coordinates, or too many, have no such rates
            with suppress(QuantityError):
                kinematics = derive(self.model, (rates,))
                whole = replace(
                    whole,
                    steps=(*whole.steps, *kinematics.steps),
                    singularities=kinematics.singularities,  # the margin that finds the poles
                )
        names += [s.quantity.name for s in whole.steps if s.quantity.name == rates]
        functions = {}
        if not self.is_quaternion:
            functions[self.slopes_step.quantity.name] = self.slopes_step
        if self.derivation.first_integrals:
            functions["first_integrals"] = self.derivation.step("first_integrals")
        return replace(whole.select(names), functions=functions)

    @property
    def slopes_step(self) -> Step:
        """The derivative of the state."""
        return self.derivation.step("state_derivative")

    def _step(
        self, name: str, value: sp.MatrixBase, inputs: tuple[str, ...], **changes: Any
    ) -> Step:
        """A function that no note shows."""
        inputs = (*inputs, "parameters") if "parameters" in self.names else inputs
        quantity = FLOW_QUANTITIES["state_derivative"]._replace(name=name, inputs=inputs, **changes)
        return Step(quantity=quantity, expression=value)

    def _loaded(self, step: Step) -> ModuleType:
        """A kernel of one function."""
        functions = {step.quantity.name: step}
        return generate(replace(self.derivation.select(()), functions=functions)).load()

    def _check_rotation(self, state: Array) -> None:
        """Raises ModelError for a state (k,) whose R is no rotation."""
        rotation = self.rotation(state)
        errors = [np.abs(rotation @ rotation.T - np.eye(3)).max()]
        if self.model.constraints:
            bounds = sp.ImmutableMatrix(self.model.constraints)
            functions = self._loaded(self._step("bounds", bounds, ("q",), shape="matrix"))
            inputs = [self.parameters] if "parameters" in self.names else []
            errors.append(np.abs(functions.bounds(state[: self.count], *inputs)).max())
        if max(errors) > _UNIT:
            q = zip(self.coordinates, state.tolist(), strict=False)
            values = ", ".join(f"{name} = {value:.15g}" for name, value in q)
            raise ModelError(f"{self.derivation.name}: no rotation has the coordinates {values}")

    def _parameters(self, parameters: Mapping[str, float]) -> list[float]:
        constants = self.names.get("parameters", ())
        body = self.derivation.body
        assert body is not None
        # the mass of a body about a fixed point may not matter, nor some moments of parts
        used = body.inertia.free_symbols.union(
            self.model.constants, *(e.free_symbols for e in self.forces.acting)
        )
        if self.forces.parts:
            used |= self.derivation.spelled(self.slopes_step.expression).free_symbols
        names = {str(symbol) for symbol in used}
        missing = [name for name in constants if name in names and name not in parameters]
        if missing:
            raise ModelError(f"missing parameters: {', '.join(missing)}")
        for name in parameters:
            if name not in constants:
                raise ModelError(f"unknown parameters: {name}; {offer(name, constants)}")
        _check_finite("parameters", parameters)
        values = [float(parameters.get(name, 1.0)) for name in constants]
        by_name = dict(zip(constants, values, strict=True))
        described = (replace(p, value=by_name[p.symbol.name]) for p in body.parameters)
        body = replace(body, parameters=tuple(described))  # which checks its moments
        if not body.allow and body.distribution is None and not self.forces.parts:
            self._check_about_centre(body)
        return values

    def _check_about_centre(self, body: RigidBody) -> None:
        """Raises BodyError for moments about the fixed point that leave no body about its centre.

        A weight, V = m g c·e with the third axis e of space in the axes of the body, tells the
        centre of mass c; about it the tensor is less by m (|c|² 1 − c cᵀ). The potential is
        evaluated at some orientations: it is a weight if one c serves for all.
        """
        gravity = [body.values[p.symbol] for p in body.parameters if p.unit == _GRAVITY]
        mass = body.in_numbers(body.mass)
        if len(gravity) != 1 or not gravity[0] or not mass.is_number:
            return
        orientations = np.random.default_rng(1).uniform(-1, 1, (self.count, _ORIENTATIONS))
        values = dict(zip(self.model.coordinates, orientations, strict=True))
        values |= {symbol: float(value) for symbol, value in body.values.items()}
        # a text that no weight is may hold the time, or a function that has no number
        with suppress(Unknown):
            height, *vertical = (
                np.broadcast_to(evaluate(e, Floats(np), values), _ORIENTATIONS)
                for e in (self.forces.potential, *self.model.matrix.row(2))
            )
            height = height / float(mass * gravity[0])
            axis = np.stack(vertical, axis=1)
            centre = np.linalg.lstsq(axis, height)[0].round(12)  # m
            if np.abs(axis @ centre - height).max() <= _UNIT * np.abs(height).max():
                moved = centre @ centre * np.eye(3) - np.outer(centre, centre)
                inertia = np.array(body.in_numbers(body.inertia).tolist(), float)
                at = ", ".join(f"{part:.6g}" for part in centre)
                where = f"{body.name}, about its centre of mass at ({at}) m"
                check_moments(where, inertia - float(mass) * moved)

    def _state(self, initial: Mapping[str, Any]) -> Array:
        """The state at t = 0, (k,), from coordinates and rates by name or the angular velocity.

        What is omitted is 0, and without any coordinate R = 1.
        """
        rates = self.names["q_dot"]
        known = (*self.coordinates, *rates, OMEGA, *OMEGA_COMPONENTS)
        for name in initial:
            if name not in known:
                raise ModelError(f"unknown initial values: {name}; {offer(name, known)}")
        _check_finite("initial values", initial)
        turning = {OMEGA, *OMEGA_COMPONENTS}.intersection(initial)
        if turning and not initial.keys().isdisjoint(rates):
            raise ModelError(f"initial values: expected rates or {OMEGA}, not both")
        values = initial_values(self.model, {n: v for n, v in initial.items() if n != OMEGA})
        q = np.array([values[name] for name in self.coordinates], float)
        if not turning:
            velocity = np.array([values[name] for name in rates], float)
            if self.is_euler:
                velocity = self.kernels.angular_velocity_body(q, velocity, *self.angles)
        else:
            velocity = np.asarray(initial.get(OMEGA, [0.0] * 3), float)
            if velocity.shape != (3,):
                raise ModelError(f"{OMEGA}: expected three components, got {initial[OMEGA]}")
            if OMEGA not in initial:
                velocity = np.array([values[name] for name in OMEGA_COMPONENTS], float)
            if not self.is_euler:
                velocity = self._rates_at_start(q, velocity)
        return np.concatenate([q, velocity])

    def _rates_at_start(self, q: Array, omega: Array) -> Array:
        solved = getattr(self.kernels, "rates_from_angular_velocity_body", None)
        if solved is None:
            raise ModelError(
                f"{self.derivation.name}: the rates do not follow from {OMEGA}; expected rates"
            )
        rates = np.asarray(solved(q, omega, *self.angles))
        if not np.isfinite(rates).all():
            raise ModelError(
                f"{self.derivation.name}: the motion starts at a pole of the coordinates, "
                f"where the rates do not follow from {OMEGA}; expected rates, or a rotation "
                "without this pole, such as unit_quaternion"
            )
        return rates

    @property
    def angles(self) -> list[list[float]]:
        """The parameters as the functions of a rotation with constants take them."""
        return [self.parameters] if self.model.constants else []

    # --- the motion in coordinates

    def slopes(self, t: float, y: Array) -> Array:
        """The derivative of one state."""
        takes_parameters = "parameters" in self.slopes_step.quantity.inputs
        inputs = (t, *y.tolist(), *(self.parameters if takes_parameters else ()))
        return np.array(self.kernels.state_derivative_scalar(*inputs))

    def is_near_pole(self, y: Array, limit: float) -> bool:
        """Whether the singularity margin of the coordinates, if there is one, is small."""
        margin = getattr(self.kernels, "singularity_margin_scalar", None)
        return margin is not None and not margin(*y[: self.count].tolist(), *self.angles) > limit

    def rotation(self, y: Array) -> Array:
        return np.asarray(self.kernels.rotation_matrix(y[..., : self.count], *self.angles))

    def omega(self, y: Array) -> Array:
        """Ω′ of states, (..., 3)."""
        q, rest = y[..., : self.count], y[..., self.count :]
        if self.is_euler:
            return rest
        return np.asarray(self.kernels.angular_velocity_body(q, rest, *self.angles))

    def rates(self, q: Array, omega: Array) -> Array:
        """q̇ from Ω′, (n, k); at a pole the smallest rates with this Ω′, NaN if there are none."""
        rates = np.array(self.kernels.rates_from_angular_velocity_body(q, omega, *self.angles))
        lost = np.isnan(rates).any(axis=1) & np.isfinite(q).all(axis=1)
        if lost.any():
            each = np.eye(self.count)  # Ω′ for each rate by itself is a column of W′
            rows = self.kernels.angular_velocity_body(q[lost][:, None], each, *self.angles)
            least = np.einsum("nj,njk->nk", omega[lost], np.linalg.pinv(rows))
            error = np.linalg.norm(np.einsum("nk,nkj->nj", least, rows) - omega[lost], axis=1)
            far = error > _UNIT * np.linalg.norm(omega[lost], axis=1)
            rates[lost] = np.where(far[:, None], np.nan, least)
        return rates

    # --- the motion as a quaternion

    @cached_property
    def _euler(self) -> EulerEquations:
        assert self.derivation.body is not None
        forces = replace(self.forces, method="euler", first_integrals={})
        return EulerEquations(self.model, self.derivation.body, forces)

    @cached_property
    def torque(self) -> sp.ImmutableMatrix:
        """N′ in q, Ω′ and t, every common factor cancelled."""
        return self._euler.present.matrix(*self._euler.torque)

    @cached_property
    def no_quaternion(self) -> str:
        """Why a quaternion cannot take the place of the coordinates; empty if it can."""
        if not self.is_alone:
            return "several bodies move in these coordinates only"
        if not hasattr(self.kernels, "from_quaternion"):
            return "the coordinates do not follow from the rotation"
        if not _has_limits(self.torque, self._euler.divisor, self.model):
            names = ", ".join(as_typed(q) for q in self.forces.generalised)
            acting = f"forces on {names}" if names else "potential"
            return f"the torque of the {acting} has no limit there"
        return ""

    @cached_property
    def _torque(self) -> Callable[..., Sequence[float]] | None:
        """N′ as a function of the time, the coordinates, Ω′ and the parameters."""
        if self.torque.is_zero_matrix:
            return None
        step = self._step(
            "torque_body", self.torque, ("t", *EULER_QUANTITIES["torque_body"].inputs)
        )
        scalar: Callable[..., Sequence[float]] = self._loaded(step).torque_body_scalar
        return scalar

    def quaternion(self, y: Array) -> Array:
        """(quaternion, Ω′) of a state."""
        q = self.kernels.quaternion(y[: self.count], *self.angles)
        return np.concatenate([q, self.omega(y)])

    def quaternion_slopes(self, t: float, state: Array) -> Array:
        w, x, y, z, a, b, c = state.tolist()
        turning = (
            -x * a - y * b - z * c,
            w * a + y * c - z * b,
            w * b + z * a - x * c,
            w * c + x * b - y * a,
        )
        p, q, r = (self.inertia @ state[4:]).tolist()
        torque = np.array([q * c - r * b, r * a - p * c, p * b - q * a])  # L′ × Ω′
        if self._torque is not None:
            unit = state[:4] / np.linalg.norm(state[:4])
            coordinates = self.kernels.from_quaternion_scalar(*unit.tolist())
            torque += self._torque(t, *coordinates, a, b, c, *self.parameters)
        return np.array([*(rate / 2 for rate in turning), *(self._inverse_inertia @ torque)])

    @cached_property
    def _inverse_inertia(self) -> Array:
        return np.asarray(np.linalg.inv(self.inertia), float)

    def states(self, before: Array, quaternions: Array) -> Array:
        """States, continuous after those `before`, from (quaternion, Ω′)."""
        unit = quaternions[:, :4] / np.linalg.norm(quaternions[:, :4], axis=1)[:, None]
        q = self.kernels.from_quaternion(unit)
        if hasattr(self.kernels, "unwrap"):
            q = self.kernels.unwrap(np.concatenate([before[:, : self.count], q]))[len(before) :]
        velocity = quaternions[:, 4:] if self.is_euler else self.rates(q, quaternions[:, 4:])
        return np.concatenate([q, velocity], axis=1)

    @cached_property
    def inertia(self) -> Array:
        """I′ in numbers, (3, 3)."""
        body = self.derivation.body
        assert body is not None
        values = dict(zip(self.names.get("parameters", ()), self.parameters, strict=True))
        known = {symbol: values[str(symbol)] for symbol in body.inertia.free_symbols}
        return np.array(body.inertia.xreplace(known).tolist(), float)

    # --- results

    def trajectory(
        self, t: Array, states: Array, ended: str = "", remarks: Sequence[str] = ()
    ) -> Trajectory:
        q, omega = states[:, : self.count], self.omega(states)
        return Trajectory(
            name=self.derivation.name,
            coordinates=self.coordinates,
            t=t,
            q=q,
            q_dot=self.rates(q, omega) if self.is_euler else states[:, self.count :],
            angular_velocity_body=omega,
            rotation_matrix=self.rotation(states),
            first_integrals=self._integrals(t, states),
            inertia=self.inertia,
            is_in_angles={*self.model.coordinate_units} == {"rad"},
            ended=ended,
            remarks=tuple(remarks),
        )

    def _integrals(self, t: Array, states: Array) -> dict[str, Array]:
        """The first integrals by name, (n,) each."""
        names = [integral.name for integral in self.derivation.first_integrals]
        if not names:
            return {}
        arguments = {"y": states, "t": t, "parameters": self.parameters}
        inputs = self.derivation.step("first_integrals").quantity.inputs
        values = np.asarray(self.kernels.first_integrals(*map(arguments.get, inputs)))
        return dict(zip(names, values.T, strict=True))


def _has_limits(torque: sp.ImmutableMatrix, divisor: sp.Expr, model: RotationModel) -> bool:
    """Whether the torque divides by nothing that vanishes where the divisor of W′⁻¹ does.

    Common factors are cancelled already: the torque of m g l cos θ in ZXZ divides by nothing. A
    force −k φ̇ leaves 1/sin² θ, since φ̇ has no limit at θ = 0.
    """
    below = {d for entry in torque for d in _divisors(entry) if d.has(*model.coordinates)}
    if not below:
        return True
    if model.vector or not model.turns:
        # the pole of a vector is at infinity or at a whole turn, and a unit quaternion gives
        # coordinates far from a whole turn
        return True
    waves = divisor.atoms(sp.sin, sp.cos)
    if len(waves) != 1:  # where it vanishes is not that easily told
        return not divisor.has(*model.coordinates)
    (angle,) = waves.pop().args
    zeros = [k * sp.pi / 2 for k in range(4)]
    poles = [at for at in zeros if divisor.subs(angle, at) == 0]
    return not any(d.subs(angle, at) == 0 for d in below for at in poles)


def _divisors(value: sp.Expr) -> Iterator[sp.Expr]:
    for node in sp.preorder_traversal(value):
        if isinstance(node, sp.Pow) and node.exp.could_extract_minus_sign():
            yield node.base
        elif isinstance(node, sp.tan | sp.sec):
            yield sp.cos(node.args[0])
        elif isinstance(node, sp.cot | sp.csc):
            yield sp.sin(node.args[0])


def _check_finite(what: str, values: Mapping[str, Any]) -> None:
    for name, value in values.items():
        try:
            numbers = np.asarray(value, float)
        except (TypeError, ValueError):
            numbers = np.array(np.nan)
        if not np.isfinite(numbers).all():
            raise ModelError(f"{what}: {name} is {value}; expected a finite number")
