"""What is integrated: the state of one derivation, its parameters and its kernels.

The state y is (q, q̇) in Lagrange's form and (q, Ω′) in Euler's. Near a pole of the coordinates the
unit quaternion takes their place: the state is then (quaternion, Ω′), the torque N′ is evaluated at
the coordinates of the quaternion, and

    d/dt quaternion = ½ quaternion ⊗ Ω′,  dΩ′/dt = I′⁻¹ (N′ − Ω′ × I′ Ω′).
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import cached_property
from types import ModuleType
from typing import Any

import numpy as np
import sympy as sp
from sympy.simplify.fu import TR1, TR2

from rigidsym.algebra.evaluate import Floats, evaluate
from rigidsym.data.columns import in_both_units
from rigidsym.errors import ModelError, offer
from rigidsym.kernels.module import generate
from rigidsym.mechanics.derivation import Derivation, Step, remark
from rigidsym.mechanics.derive import derive
from rigidsym.mechanics.dynamics.euler import EulerEquations
from rigidsym.mechanics.dynamics.lagrange import is_bound
from rigidsym.mechanics.quantities.dynamics import EULER_QUANTITIES, FLOW_QUANTITIES
from rigidsym.models.body import RigidBody, check_moments
from rigidsym.models.forces import OMEGA, OMEGA_COMPONENTS, Forces, initial_values
from rigidsym.models.rotation import as_typed, depends_on_time
from rigidsym.simulation.trajectory import Array, Trajectory

NEEDED = ("rotation_matrix", "angular_velocity_body", "state_derivative", "first_integrals")
_RATES = "rates_from_angular_velocity_body"
_MASS = "mass_matrix"
_GRAVITY = "m/s^2"  # the unit by which the acceleration in a weight is known
_ORIENTATIONS = 12  # at which a weight is told from other potentials; c has three components
_NO_DIVISOR = (0, sp.zoo, sp.nan)
_UNIT = 1e-9  # by which the entries of R Rᵀ − 1 may be off at the start


def needed(parts: Any) -> tuple[str, ...]:
    """The quantities from which a motion is computed: of several bodies, M for their poles too."""
    return (*NEEDED, _MASS) if parts else NEEDED


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
    forces = derivation.forces or Forces(fixed_point=())
    if derivation.forces is None or not names.issuperset(needed(forces.parts)):
        return derive(derivation.model, needed(forces.parts), body=body, forces=forces)
    return derivation


class Problem:
    """The state y of one derivation, (q, q̇) or (q, Ω′), its parameters and its kernels."""

    def __init__(
        self, derivation: Derivation, initial: Mapping[str, Any], parameters: Mapping[str, float]
    ) -> None:
        """Raises ModelError for names that are missing or unknown, and for an impossible body."""
        self.derivation = derivation
        self.remarks: list[str] = []  # on the initial values
        self.model, self.forces = derivation.model, derivation.forces or Forces()
        self.arguments = {argument.name: argument for argument in derivation.arguments}
        self.names = {argument.name: argument.names for argument in derivation.arguments}
        self.coordinates = self.names["q"]
        self.count = len(self.coordinates)
        # The state of Euler's equations ends in Ω′, that of Lagrange's equations in q̇.
        self.is_euler = self.names["y"][self.count :] == self.names["omega_body"]
        # so that a quaternion can take the place of the coordinates
        self.is_alone = not self.forces.parts
        # three coordinates of a vector have a pole wherever they are, and long equations of motion
        self.is_quaternion = bool(self.model.vector) and self.is_alone and not is_bound(self.model)
        self.body, self.parameters = self._with_values(parameters)
        self.inertia = np.array(self.body.in_numbers(self.body.inertia).tolist(), float)  # I′
        if not self.body.allow and self.body.distribution is None and self.is_alone:
            self._check_about_centre()
        names = ["rotation_matrix", "angular_velocity_body", *([] if self.is_alone else [_MASS])]
        of_state = [] if self.is_quaternion else ["state_derivative"]
        of_state += ["first_integrals"] if derivation.first_integrals else []
        functions = {name: derivation.step(name) for name in of_state}
        evaluated = replace(derivation.select(names), functions=functions)
        self.kernels: ModuleType = generate(evaluated, "numpy", conversions=self.is_alone).load()
        self.start = self._state(initial)
        self._check_rotation()

    def _with_values(self, parameters: Mapping[str, float]) -> tuple[RigidBody, list[float]]:
        """The body with its values, and the values of all parameters."""
        body, constants = self.derivation.body, self.names.get("parameters", ())
        assert body is not None
        # the mass of a body about a fixed point may not matter
        own = {str(symbol): float(value) for symbol, value in body.values.items()}
        parameters = own | {**parameters}
        acting = (e.free_symbols for e in self.forces.expressions)
        names = {str(symbol) for symbol in body.inertia.free_symbols.union(*acting)}
        names |= {*map(str, self.model.constants)}
        missing = [name for name in constants if name in names - parameters.keys()]
        if missing:
            raise ModelError(f"missing parameters: {', '.join(missing)}")
        _check("parameters", parameters, constants)
        values = {name: float(parameters.get(name, 1.0)) for name in constants}
        described = (replace(p, value=values[p.symbol.name]) for p in body.parameters)
        return replace(body, parameters=tuple(described)), [*values.values()]

    def _check_about_centre(self) -> None:
        """Raises BodyError for moments about the fixed point that leave no body about its centre.

        A weight, V = m g c·e with the third axis e of space in the axes of the body, tells the
        centre of mass c; about it the tensor is less by m (|c|² 1 − c cᵀ). The potential is
        evaluated at some orientations: it is a weight if one c serves for all.
        """
        body, potential = self.body, self.body.in_numbers(self.forces.potential)
        gravity = [body.values[p.symbol] for p in body.parameters if p.unit == _GRAVITY]
        mass = body.in_numbers(body.mass)
        if len(gravity) != 1 or not gravity[0] or not mass.is_number or depends_on_time(potential):
            return
        some = np.random.default_rng(1).uniform(-1, 1, (self.count, _ORIENTATIONS))
        values = dict(zip(self.model.coordinates, some, strict=True))
        rows = (body.in_numbers(e) for e in (potential, *self.model.matrix.row(2)))
        with np.errstate(invalid="ignore"):  # the root of a negative number is NaN
            height, *axes = (evaluate(e, Floats(np), values) + 0 * some[0] for e in rows)
        height = height / float(mass * gravity[0])  # c·e
        if not np.isfinite([height, *axes]).all():
            return
        centre = np.linalg.lstsq(np.transpose(axes), height)[0].round(12) + 0.0  # m, no -0
        if np.abs(centre @ axes - height).max() <= _UNIT * np.abs(height).max():
            moved = centre @ centre * np.eye(3) - np.outer(centre, centre)
            at = ", ".join(f"{part:.6g}" for part in centre)
            where = f"{body.name}, about its centre of mass at ({at}) m"
            check_moments(where, self.inertia - float(mass) * moved)

    def _check_rotation(self) -> None:
        """Raises ModelError if R of the start is no rotation."""
        rotation, q = self.rotation(self.start), self.start[: self.count].tolist()
        values = dict(zip(self.model.coordinates, q, strict=True))
        if "parameters" in self.arguments:
            values |= zip(self.arguments["parameters"].symbols, self.parameters, strict=True)
        errors = [rotation @ rotation.T - np.eye(3)]
        errors += [evaluate(c, Floats(np), values) for c in self.model.constraints]
        if max(np.abs(error).max() for error in errors) > _UNIT:
            pairs = zip(self.coordinates, q, strict=True)
            place = ", ".join(f"{name} = {value:.15g}" for name, value in pairs)
            raise ModelError(f"{self.derivation.name}: no rotation has the coordinates {place}")

    def _state(self, initial: Mapping[str, Any]) -> Array:
        """The state at t = 0, (k,), from coordinates and rates by name or the angular velocity.

        What is omitted is 0, and without any coordinate R = 1.
        """
        names = self.names["q_dot"]
        _check("initial values", initial, (*self.coordinates, *names, OMEGA, *OMEGA_COMPONENTS))
        given = dict(initial)
        if OMEGA in given:
            omega = np.ravel(given.pop(OMEGA)).tolist()
            if len(omega) != 3:
                raise ModelError(f"{OMEGA}: expected three components, got {initial[OMEGA]}")
            given |= dict(zip(OMEGA_COMPONENTS, omega, strict=True))
        is_turning = not given.keys().isdisjoint(OMEGA_COMPONENTS)
        if is_turning and not given.keys().isdisjoint(names):
            raise ModelError(f"initial values: expected rates or {OMEGA}, not both")
        values = initial_values(self.model, given)
        q, velocity = (
            np.array([values[name] for name in each], float)
            for each in (self.coordinates, OMEGA_COMPONENTS if is_turning else names)
        )
        for name, value, unit in zip(self.coordinates, q, self.model.coordinate_units, strict=True):
            if unit == "rad" and abs(value) > 2 * np.pi:
                self.remarks.append(f"{name} begins at {in_both_units(value)}")
        if self.is_euler and not is_turning:
            rates, velocity = velocity, self._at("angular_velocity_body", q, velocity)
            least = self.rates(q[None], velocity[None])[0]
            if not np.allclose(rates, least):
                start = ", ".join(map("{} = {:.6g}".format, names, least))
                self.remarks.append(remark("rates_replaced", rates=start))
        if is_turning and not self.is_euler:
            velocity = self.rates(q[None], velocity[None])[0]
            if not np.isfinite(velocity).all():
                raise ModelError(
                    f"{self.derivation.name}: the rates at the start cannot be computed from "
                    f"{OMEGA}: the coordinates are at a pole, or are too few for every {OMEGA}; "
                    "expected rates, or another rotation, such as unit_quaternion"
                )
        return np.concatenate([q, velocity])

    def _at(self, function: str, *inputs: Array) -> Array:
        """A function of the rotation, which takes the parameters if the rotation has constants."""
        constants = [self.parameters] if self.model.constants else []
        return np.array(getattr(self.kernels, function)(*inputs, *constants))

    def _of_state(self, name: str, t: float | Array, y: Array) -> Array:
        """A quantity of the equations of motion, in states (..., k) at times."""
        arguments = {"t": t, "y": y, "q": y[..., : self.count], "parameters": self.parameters}
        inputs = self.derivation.step(name).quantity.inputs
        return np.asarray(getattr(self.kernels, name)(*map(arguments.get, inputs)))

    # --- the motion in coordinates

    def slopes(self, t: float, y: Array) -> Array:
        """The derivative of one state."""
        inputs = self.derivation.step("state_derivative").quantity.inputs
        values = (t, *y.tolist(), *(self.parameters if "parameters" in inputs else ()))
        return np.array(self.kernels.state_derivative_scalar(*values))

    def is_near_pole(self, y: Array, limit: float) -> bool:
        """Whether W′ nearly loses rank, or M of several bodies, by the ratio of singular values.

        Frames with inertia have no pole in gimbal lock.
        """
        q = y[: self.count]
        if self.is_alone:
            sizes = np.linalg.svd(self._axes(q), compute_uv=False)
        else:
            mass = self._of_state(_MASS, 0.0, y)
            unit = np.sqrt(mass.diagonal())  # coordinates of different inertia are no pole
            # M = Jᵀ I J, so its eigenvalues are the squares of the singular values of √I J.
            sizes = np.sqrt(np.linalg.eigvalsh(mass / np.outer(unit, unit)))
        # Near a pole of Euler angles, sin θ → 0, the ratio is half the distance from it.
        return not 2 * sizes.min() > limit * sizes.max()

    def _axes(self, q: Array) -> Array:
        """W′ᵀ: Ω′ for the rate of each coordinate by itself, (..., k, 3)."""
        return self._at("angular_velocity_body", q[..., None, :], np.eye(self.count))

    def rotation(self, y: Array) -> Array:
        """R of states, from body to space components, (..., 3, 3)."""
        matrix = self._at("rotation_matrix", y[..., : self.count])
        return np.swapaxes(matrix, -1, -2) if self.model.passive else matrix

    def omega(self, y: Array) -> Array:
        """Ω′ of states, (..., 3)."""
        q, velocity = y[..., : self.count], y[..., self.count :]
        return velocity if self.is_euler else self._at("angular_velocity_body", q, velocity)

    def rates(self, q: Array, omega: Array) -> Array:
        """q̇ from Ω′, (n, k); at a pole the smallest rates with this Ω′, NaN if there are none."""
        rates = np.full(q.shape, np.nan)
        if self.is_euler and not self.is_quaternion:
            # which keep the conditions on the coordinates
            states = np.concatenate([q, omega], axis=1)
            rates = self._of_state("state_derivative", 0.0, states)[:, : self.count]
        lost = np.isnan(rates).any(axis=1) & np.isfinite(q).all(axis=1)
        if lost.any():
            rows = self._axes(q[lost])
            # q̇ᵀ rows = Ω′ᵀ; the pseudoinverse gives the solution of least norm, or the nearest to
            # one.
            least = np.einsum("nj,njk->nk", omega[lost], np.linalg.pinv(rows))
            error = np.linalg.norm(np.einsum("nk,nkj->nj", least, rows) - omega[lost], axis=1)
            far = error > _UNIT * np.linalg.norm(omega[lost], axis=1)
            rates[lost] = np.where(far[:, None], np.nan, least)
        return rates

    # --- the motion as a quaternion

    @cached_property
    def torque(self) -> sp.ImmutableMatrix:
        """N′ in q, Ω′ and t, every common factor cancelled."""
        forces = replace(self.forces, method="euler", first_integrals={})
        assert self.derivation.body is not None
        euler = EulerEquations(self.model, self.derivation.body, forces)
        return euler.present.matrix(*euler.torque)

    @cached_property
    def no_quaternion(self) -> str:
        """Why a quaternion cannot take the place of the coordinates; empty if it can."""
        if not self.is_alone:
            return remark("several_bodies")
        if not hasattr(self.kernels, "from_quaternion"):
            return remark("no_coordinates")
        # Common factors are cancelled: the torque of m g l cos θ in ZXZ divides by nothing, and a
        # force −k φ̇ leaves 1/sin² θ, since φ̇ has no limit at θ = 0. The pole of a vector is at
        # infinity or at a whole turn, from which a unit quaternion gives coordinates far away.
        if not self.model.turns or self.model.vector:
            return ""
        poles = derive(self.model, (_RATES,)).singularities
        assert poles is not None
        divisors = [sp.denom(sp.together(TR2(TR1(entry)))) for entry in self.torque]
        if not poles.is_solved and any(e.has(*self.model.coordinates) for e in divisors):
            return remark("perhaps_no_limit")
        there = [
            {place.coordinate: place.value + k * place.period for place in point.places}
            for point in poles.points
            for k in (0, 1)
        ]
        if any(divisor.subs(at) in _NO_DIVISOR for divisor in divisors for at in there):
            names = ", ".join(as_typed(q) for q in self.forces.generalised)
            acting = f"forces on {names}" if names else "potential"
            return remark("no_limit", acting=acting)
        return ""

    @cached_property
    def _torque(self) -> Callable[..., Sequence[float]] | None:
        """N′ as a function of the time, the coordinates, Ω′ and the parameters."""
        if self.torque.is_zero_matrix:
            return None
        inputs = ("t", *EULER_QUANTITIES["torque_body"].inputs)
        inputs += ("parameters",) if "parameters" in self.names else ()
        quantity = FLOW_QUANTITIES["state_derivative"]._replace(name="torque_body", inputs=inputs)
        functions = {"torque_body": Step(quantity=quantity, expression=self.torque)}
        module = generate(replace(self.derivation.select(()), functions=functions)).load()
        scalar: Callable[..., Sequence[float]] = module.torque_body_scalar
        return scalar

    def quaternion(self, y: Array) -> Array:
        """(quaternion, Ω′) of a state."""
        return np.concatenate([self._at("quaternion", y[: self.count]), self.omega(y)])

    def quaternion_slopes(self, t: float, state: Array) -> Array:
        w, x, y, z, a, b, c = state.tolist()
        turning = (
            -x * a - y * b - z * c,
            w * a + y * c - z * b,
            w * b + z * a - x * c,
            w * c + x * b - y * a,
        )
        # The torque of the equation is L′ × Ω′ = −Ω′ × I′ Ω′.
        p, q, r = (self.inertia @ state[4:]).tolist()
        torque = np.array([q * c - r * b, r * a - p * c, p * b - q * a])  # L′ × Ω′
        if self._torque is not None:
            # The errors of the integrator change |q| a little; only the torque needs a unit
            # quaternion here.
            unit = state[:4] / np.linalg.norm(state[:4])
            coordinates = self.kernels.from_quaternion_scalar(*unit.tolist())
            torque += self._torque(t, *coordinates, a, b, c, *self.parameters)
        return np.array([*(rate / 2 for rate in turning), *(self._inverse_inertia @ torque)])

    @cached_property
    def _inverse_inertia(self) -> Array:
        return np.asarray(np.linalg.inv(self.inertia))

    def states(self, before: Array, quaternions: Array) -> Array:
        """States, continuous after those `before`, from (quaternion, Ω′)."""
        unit = quaternions[:, :4] / np.linalg.norm(quaternions[:, :4], axis=1)[:, None]
        # The conversion takes principal values; unwrap continues them from the states before.
        q = self.kernels.from_quaternion(unit)
        if hasattr(self.kernels, "unwrap"):
            q = self.kernels.unwrap(np.concatenate([before[:, : self.count], q]))[len(before) :]
        velocity = quaternions[:, 4:] if self.is_euler else self.rates(q, quaternions[:, 4:])
        return np.concatenate([q, velocity], axis=1)

    # --- results

    def trajectory(
        self, t: Array, states: Array, ended: str = "", remarks: Sequence[str] = ()
    ) -> Trajectory:
        q, omega = states[:, : self.count], self.omega(states)
        integrals: Mapping[str, Array] = {}
        if self.derivation.first_integrals:
            values = self._of_state("first_integrals", t, states)
            names = (integral.name for integral in self.derivation.first_integrals)
            integrals = dict(zip(names, values.T, strict=True))
        return Trajectory(
            name=self.derivation.name,
            coordinates=self.coordinates,
            t=t,
            q=q,
            q_dot=self.rates(q, omega) if self.is_euler else states[:, self.count :],
            angular_velocity_body=omega,
            rotation_matrix=self.rotation(states),
            first_integrals=integrals,
            inertia=self.inertia,
            ended=ended,
            remarks=(*self.remarks, *remarks),
        )


def _check(what: str, values: Mapping[str, Any], known: Collection[str]) -> None:
    """Raises ModelError for an unknown name and for a value that is no finite number."""
    for name, value in values.items():
        if name not in known:
            raise ModelError(f"unknown {what}: {name}; {offer(name, known)}")
        numbers = np.array(np.nan)
        with suppress(TypeError, ValueError):
            numbers = np.asarray(value, float)
        if not np.isfinite(numbers).all():
            raise ModelError(f"{what}: {name} is {value}; expected a finite number")
