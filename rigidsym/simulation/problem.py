"""What is integrated: the state of one derivation, its parameters and its kernels."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from types import ModuleType
from typing import Any

import numpy as np
import sympy as sp

from rigidsym.errors import BodyError, ModelError, offer
from rigidsym.kernels.module import generate
from rigidsym.mechanics.derivation import Derivation
from rigidsym.models.example import OMEGA as OMEGA
from rigidsym.models.rotation import TIME, as_typed
from rigidsym.simulation.sampled_motion import Array
from rigidsym.simulation.trajectory import Trajectory

POLE = 1e-3  # of the singularity margin: nearer to a pole, coordinates lose digits
_UNIT = 1e-9  # by which the entries of R Rᵀ − 1 may be off at the start


class Problem:
    """The state y of one derivation, (q, q̇) or (q, Ω′), its parameters and its kernels."""

    def __init__(
        self,
        derivation: Derivation,
        initial: Mapping[str, Any],
        parameters: Mapping[str, float],
        *,
        called: str = "the motion",
    ) -> None:
        """Raises ModelError for names that are missing or unknown, and for an impossible body."""
        self.derivation, self.called = derivation, called
        self.names = {a.name: a.names for a in derivation.arguments}
        self.coordinates = self.names["q"]
        self.count = len(self.coordinates)
        self.is_euler = self.names["y"][self.count :] == self.names["omega_body"]
        self.parameters = self._parameters(parameters)
        acting = derivation.forces
        alone = acting is None or not (acting.parts or acting.frame_rate)
        self.is_alone = alone  # so that a quaternion can take the place of the coordinates
        self.kernels: ModuleType = generate(derivation, "numpy", conversions=alone).load()
        self.constants = self.given("state_derivative")
        self.start = self.state_of(initial)
        self.check_rotations(self.start[None])
        changes = map(abs, self._changes(self.start))
        if max(changes, default=0) > _UNIT * np.abs(self.start).max():
            bounds = " and ".join(f"{as_typed(c)} = 0" for c in derivation.model.constraints)
            raise ModelError(
                f"{derivation.name}: the rates violate {bounds}; expected rates that keep "
                f"these conditions, or "
                f"{OMEGA}"
            )

    def check_rotations(self, states: Array) -> None:
        """Raises ModelError for the first of the states, (m, k), whose R is no rotation."""
        rotation = self.rotation(states)
        left = np.abs(rotation @ np.swapaxes(rotation, 1, 2) - np.eye(3)).max(axis=(1, 2))
        left = np.maximum(left, self._off(states[:, : self.count]))
        for k in np.flatnonzero(left > _UNIT)[:1]:
            which = f"motion {k + 1} of {len(states)}: " if len(states) > 1 else ""
            q = zip(self.coordinates, states[k].tolist(), strict=False)
            values = ", ".join(f"{name} = {value:.15g}" for name, value in q)
            raise ModelError(
                f"{self.derivation.name}: {which}no rotation has the coordinates {values}"
            )

    def _off(self, q: Array) -> Array:
        """How far the conditions on the coordinates are from 0 at most, (m,)."""
        model = self.derivation.model
        found = np.zeros(len(q))
        for condition in model.constraints:
            fixed = condition.xreplace(self._constants)
            if fixed.is_polynomial(*model.coordinates):
                terms = sp.Poly(fixed, *model.coordinates).terms()
                off = sum(float(factor) * np.prod(q**powers, axis=1) for powers, factor in terms)
            else:
                rows = (dict(zip(model.coordinates, row, strict=True)) for row in q.tolist())
                off = np.array([float(fixed.xreplace(row)) for row in rows])
            found = np.maximum(found, np.abs(off))
        return found

    def _changes(self, y: Array) -> list[float]:
        """The rates of the conditions on the coordinates."""
        if self.is_euler:
            return []
        model = self.derivation.model
        state = [*model.coordinates, *(sp.diff(q, TIME) for q in model.coordinates)]
        values = dict(zip(state, y.tolist(), strict=False)) | self._constants
        return [float(sp.diff(c, TIME).xreplace(values)) for c in model.constraints]

    @property
    def _constants(self) -> dict[sp.Basic, float]:
        names = map(sp.Symbol, self.names.get("parameters", ()))
        return dict(zip(names, self.parameters, strict=True))

    def _parameters(self, given: Mapping[str, float]) -> list[float]:
        constants = self.names.get("parameters", ())
        needed = [name for name in constants if sp.Symbol(name) in self._symbols]
        check_names("parameters", given, needed, constants)
        _check_finite("parameters", given)
        values = [float(given.get(name, 1.0)) for name in constants]
        body = self.derivation.body
        if body is not None:  # made with values for its parameters, it checks its moments
            by_name = dict(zip(constants, values, strict=True))
            replace(
                body,
                parameters=tuple(replace(p, value=by_name[p.symbol.name]) for p in body.parameters),
            )
        return values

    def parameters_of(self, members: int, given: Mapping[str, Any]) -> Array:
        """The parameters of many motions, (members, p), from numbers and arrays by name."""
        values = (given.get(name, 1.0) for name in self.names["parameters"])
        return _stacked([np.broadcast_to(value, members) for value in values])

    def check_bodies(self, members: int, given: Mapping[str, Any]) -> None:
        """Raises BodyError for the first of many bodies, given by arrays, that cannot be."""
        body = self.derivation.body
        assert body is not None
        varied = [p for p in body.parameters if np.ndim(given.get(p.symbol.name, 1.0))]
        if not varied:
            return
        doubtful = np.zeros(members, bool)
        for parameter in varied:
            value = np.broadcast_to(given[parameter.symbol.name], members)
            doubtful |= ~(value > 0) if parameter.positive else False
        if self.given("inertia_tensor"):
            tensors = self.kernels.inertia_tensor(self.parameters_of(members, given))
            a, b, c = np.linalg.eigvalsh(tensors).T
            doubtful |= ~((a >= 0) & (c <= a + b))
        for k in np.flatnonzero(doubtful):  # the limits of rounding are those of one body
            try:
                self._parameters({name: v[k] if np.ndim(v) else v for name, v in given.items()})
            except BodyError as error:
                raise BodyError(f"motion {k + 1} of {members}: {error}") from None

    @property
    def _symbols(self) -> set[sp.Basic]:
        """What the motion depends on; the mass of a body about a fixed point may not be in it."""
        body = self.derivation.body
        held = [self.derivation.step(name).expression for name in ("state_derivative", "energy")]
        held += [body.inertia] if body else []
        return set().union(*(expression.free_symbols for expression in held))

    def state_of(self, initial: Mapping[str, Any]) -> Array:
        """The state at t = 0, (..., k), from coordinates and rates by name or the angular velocity.

        Values that are arrays broadcast.
        """
        rates = (OMEGA,) if OMEGA in initial else self.names["q_dot"]
        wanted = (*self.coordinates, *rates)
        known = (*self.coordinates, *self.names["q_dot"], OMEGA)
        check_names("initial values", initial, wanted, wanted if OMEGA in initial else known)
        _check_finite("initial values", initial)
        q = _stacked([initial[name] for name in self.coordinates])
        if OMEGA in initial:
            given = np.asarray(initial[OMEGA], float)
        else:
            given = _stacked([initial[name] for name in rates])
        if OMEGA in initial and given.shape[-1:] != (3,):
            raise ModelError(f"{OMEGA}: expected three components, got {initial[OMEGA]}")
        if OMEGA in initial and not self.is_euler:
            given = self.kernels.rates_from_angular_velocity_body(q, given, *self.angles)
            lost = np.flatnonzero(~np.isfinite(given).all(axis=-1))
            if len(lost):
                which = f"motion {lost[0] + 1} of {len(given)}" if given.ndim > 1 else self.called
                raise ModelError(
                    f"{self.derivation.name}: {which} starts at a pole of the coordinates, "
                    f"where the rates do not follow from {OMEGA}; expected rates, or a rotation "
                    "without this pole, such as unit_quaternion"
                )
        elif OMEGA not in initial and self.is_euler:
            given = self.kernels.angular_velocity_body(q, given, *self.angles)
        many = np.broadcast_shapes(q.shape[:-1], given.shape[:-1])
        parts = [np.broadcast_to(part, (*many, part.shape[-1])) for part in (q, given)]
        return np.concatenate(parts, axis=-1)

    def given(self, function: str) -> list[float]:
        """The parameters, if a function takes them."""
        step = self.derivation.step(function)
        return self.parameters if "parameters" in step.quantity.inputs else []

    @property
    def angles(self) -> list[list[float]]:
        """The parameters as the functions of a rotation with constants take them."""
        return [self.parameters] if self.derivation.model.constants else []

    def slopes(self, t: float, y: Array) -> Array:
        """The derivative of one state."""
        return np.array(self.kernels.state_derivative_scalar(t, *y.tolist(), *self.constants))

    def margin(self, y: Array) -> float:
        """The distance from a pole of the coordinates; 1 if there is none."""
        found = getattr(self.kernels, "singularity_margin_scalar", None)
        if found is None or not self.is_alone:
            return 1.0
        return float(found(*y[: self.count].tolist(), *self.angles[:1]))

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
        found = np.array(self.kernels.rates_from_angular_velocity_body(q, omega, *self.angles))
        lost = np.isnan(found).any(axis=1) & np.isfinite(q).all(axis=1)
        if lost.any():
            each = np.eye(self.count)  # Ω′ for each rate by itself is a column of W′
            rows = self.kernels.angular_velocity_body(q[lost][:, None], each, *self.angles)
            wanted = omega[lost]
            least = np.einsum("nj,njk->nk", wanted, np.linalg.pinv(rows))
            left = np.linalg.norm(np.einsum("nk,nkj->nj", least, rows) - wanted, axis=1)
            far = left > _UNIT * np.linalg.norm(wanted, axis=1)
            found[lost] = np.where(far[:, None], np.nan, least)
        return found

    @cached_property
    def inertia(self) -> Array:
        """I′ in numbers, (3, 3)."""
        body = self.derivation.body
        assert body is not None
        values = dict(zip(self.names.get("parameters", ()), self.parameters, strict=True))
        known = {symbol: values[str(symbol)] for symbol in body.inertia.free_symbols}
        return np.array(body.inertia.xreplace(known).tolist(), float)

    def trajectory(
        self, t: Array, states: Array, ended: str = "", remarks: Sequence[str] = ()
    ) -> Trajectory:
        q, omega = states[:, : self.count], self.omega(states)
        rates, forces = states[:, self.count :], self.derivation.forces
        if self.is_euler:
            rates = self.rates(q, omega)
        return Trajectory(
            name=self.derivation.name,
            coordinates=self.coordinates,
            t=t,
            q=q,
            q_dot=rates,
            angular_velocity_body=omega,
            rotation_matrix=self.rotation(states),
            first_integrals=self.integrals(t, states, self.parameters),
            inertia=self.inertia,
            is_in_angles=set(self.derivation.model.coordinate_units) == {"rad"},
            is_free=forces is None or forces.leave_free(self.derivation.model),
            ended=ended,
            remarks=tuple(remarks),
        )

    def integrals(self, t: Array, states: Array, constants: Any) -> dict[str, Array]:
        """The first integrals by name; times broadcast with the states but for their last axis."""
        names = [integral.name for integral in self.derivation.first_integrals]
        if not names:
            return {}
        known = {"y": states, "t": t, "parameters": constants}
        inputs = self.derivation.step("first_integrals").quantity.inputs
        values = np.asarray(self.kernels.first_integrals(*map(known.get, inputs)))
        return {name: values[..., k] for k, name in enumerate(names)}


def _stacked(values: Sequence[Any]) -> Array:
    """Numbers or arrays as the components of one array."""
    return np.stack(np.broadcast_arrays(*values), axis=-1).astype(float)


def _check_finite(what: str, given: Mapping[str, Any]) -> None:
    for name, value in given.items():
        try:
            numbers = np.asarray(value, float)
        except (TypeError, ValueError):
            numbers = np.array(np.nan)
        if not np.isfinite(numbers).all():
            raise ModelError(f"{what}: {name} is {value}; expected a finite number")


def check_names(
    what: str, given: Mapping[str, Any], wanted: Sequence[str], known: Sequence[str]
) -> None:
    """All that is missing at once, and the first that is unknown."""
    missing = [name for name in wanted if name not in given]
    if missing:
        raise ModelError(f"missing {what}: {', '.join(missing)}")
    for name in given:
        if name not in known:
            raise ModelError(f"unknown {what}: {name}; {offer(name, known)}")
