"""Lagrange's equations of bodies that turn about a fixed point, over one ring.

Each moving part has a velocity v = J q̇ + j and an inertia I: of a body v is its angular velocity
Ω′ and J its rate matrix W′, of a particle its velocity in space. With T = ½ Σ vᵀ I v,

    d/dt ∂T/∂q̇ − ∂T/∂q = Σ Jᵀ (I dv/dt + v × I v)      the cross product for bodies only,
    M q̈ + h = Q,  M = Σ Jᵀ I J,
    h = Σ Jᵀ (I (dJ/dt q̇ + dj/dt) + v × I v) + ∂V/∂q

The first line is proved in the ring; the others follow from it. It fails for velocities that no
coordinates have (rolling); the other lines are then those of d'Alembert's principle. j is what a
turning frame of reference adds.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property, reduce
from operator import add
from typing import NamedTuple

import sympy as sp
from sympy.polys.rings import PolyElement

from rigidsym.algebra.codec import codec_for
from rigidsym.algebra.matrix import Inverse, RingMatrix
from rigidsym.errors import ModelError
from rigidsym.mechanics.dynamics.flow import turned
from rigidsym.mechanics.kinematics.workspace import Values
from rigidsym.models.body import RigidBody
from rigidsym.models.forces import OMEGA_BODY, Forces, MovingPart
from rigidsym.models.rotation import TIME, RotationModel, as_typed


class Moving(NamedTuple):
    """One moving part: v = J q̇ + j, and its inertia."""

    jacobian: sp.ImmutableMatrix  # J, (3, n)
    shift: sp.ImmutableMatrix  # j, (3, 1)
    inertia: sp.ImmutableMatrix  # (3, 3)
    turns: bool  # a body, else a particle


class Lagrange:
    """T, V, p, M, h and the accelerations of one rotation, its body, and what moves with it."""

    def __init__(self, model: RotationModel, body: RigidBody, forces: Forces) -> None:
        self.is_bound = is_bound(model)
        self.back = self._inverse_rates(model, forces) if self.is_bound else None
        self.model, self.body, self.acting = model, body, forces
        self.potential = forces.potential
        self.rates = [sp.diff(q, TIME) for q in model.coordinates]
        self.accelerations = [sp.diff(q, TIME, 2) for q in model.coordinates]
        self.moving = tuple(self._moving())
        main = self.moving[0]
        omega = main.jacobian * sp.Matrix(self.rates) + main.shift
        torque = sp.Matrix(forces.torque or [0, 0, 0])
        in_rates = dict(zip(OMEGA_BODY, omega, strict=True))
        acting = main.jacobian.T * torque.xreplace(in_rates)
        self.forces = [
            forces.generalised.get(q, sp.S.Zero).xreplace(in_rates) + part
            for q, part in zip(model.coordinates, acting, strict=True)
        ]
        self.gradient = [sp.diff(self.potential, q) for q in model.coordinates]
        held = [e for part in self.moving for m in part[:3] for e in m]
        held += [*omega, sp.Rational(1, 2), self.potential]
        held += [*self.gradient, *self.forces, *self.rates]
        held += [*forces.first_integrals.values()]
        held += self.accelerations if self.back is None else [*self.back[0], self.back[1]]
        order = 1 if self.is_bound else 2
        bounds = model.constraints
        self.codec = codec_for([e for e in held if e != 0], constraints=bounds, order=order)
        self.ring = self.codec.ring

    @staticmethod
    def _inverse_rates(model: RotationModel, forces: Forces) -> tuple[sp.ImmutableMatrix, sp.Expr]:
        """U and its divisor, with q̇ = U Ω′, which spans the motions that are possible.

        Raises ModelError if there is no U, and for other parts.
        """
        values = Values(model)
        is_free = model.pullback is None and not forces.parts
        inverse = values.inverse("body") if is_free else None
        if inverse is None:
            raise ModelError(
                f"{model.name}: Lagrange's equations need independent coordinates, such as Euler "
                "angles, or one body whose angular velocity determines the rates; expected such a "
                'rotation, or method = "euler"'
            )
        above, below = inverse
        short = values.present.matrix(above, below)
        if all(sp.denom(entry).is_number for entry in short):
            return short, sp.S.One
        return values.codec.decoded(above), values.codec.decode(below)

    def _moving(self) -> Iterator[Moving]:
        """The body itself first."""
        yield self._turning(self.model, self.body.inertia)
        for part in self.acting.parts:
            if part.rotation is not None:
                yield self._turning(part.rotation, sp.ImmutableMatrix(sp.diag(*part.inertia)))
            else:
                yield self._particle(part)

    def _turning(self, model: RotationModel, inertia: sp.ImmutableMatrix) -> Moving:
        """A body that turns so; its rate matrix has a column for each coordinate of all."""
        values = Values(model)
        entries = values.codec.decoded(values.rate_matrix("body"))
        columns = [
            entries.col(model.coordinates.index(q)) if q in model.coordinates else sp.zeros(3, 1)
            for q in self.model.coordinates
        ]
        frame = sp.Matrix(self.acting.frame_rate or [0, 0, 0])
        shift = sp.ImmutableMatrix(model.matrix.T * frame)
        return Moving(sp.ImmutableMatrix.hstack(*columns), shift, inertia, turns=True)

    def _particle(self, part: MovingPart) -> Moving:
        velocity = sp.ImmutableMatrix(part.velocity)
        jacobian = sp.ImmutableMatrix(
            [[sp.diff(entry, rate) for rate in self.rates] for entry in velocity]
        )
        at_rest = velocity.xreplace(dict.fromkeys(self.rates, sp.S.Zero))
        if jacobian.has(*self.rates) or any(at_rest):
            raise ModelError(
                f"the velocity ({', '.join(map(as_typed, velocity))}) is not linear in the rates"
            )
        zero = sp.ImmutableMatrix.zeros(3, 1)
        return Moving(jacobian, zero, sp.ImmutableMatrix(sp.diag(*part.inertia)), turns=False)

    def slopes(self, element: PolyElement) -> RingMatrix:
        """The derivatives by q, a column, by the chain rule over the generators of the ring."""
        ring, rates = self.ring, [self.ring.index[rate] for rate in self.rates]
        last = {*rates, *(ring.index[a] for a in self.accelerations)}
        moving = [k for k in range(len(ring.generators)) if k not in last]
        parts = [(ring.partial(element, k), ring.dt(ring.generator(k))) for k in moving]
        return RingMatrix.column(
            ring,
            [
                ring.dot((part, ring.partial(rate, k)) for part, rate in parts if part)
                for k in rates
            ],
        )

    @cached_property
    def terms(self) -> tuple[tuple[RingMatrix, RingMatrix, RingMatrix, bool], ...]:
        """J, j, I of each moving part over the ring, and whether it turns."""
        return tuple(
            (*map(self.codec.matrix, part[:3]), part.turns)  # type: ignore[misc]
            for part in self.moving
        )

    @cached_property
    def q_dot(self) -> RingMatrix:
        return self.codec.column(self.rates)

    @cached_property
    def omega(self) -> RingMatrix:
        """Ω′ of the body."""
        jacobian, shift, _, _ = self.terms[0]
        return jacobian @ self.q_dot + shift

    @cached_property
    def momenta(self) -> RingMatrix:
        """p = ∂T/∂q̇ = Σ Jᵀ I v."""
        return reduce(add, (j.T @ (i @ (j @ self.q_dot + s)) for j, s, i, _ in self.terms))

    @cached_property
    def mass_matrix(self) -> RingMatrix:
        return reduce(add, (j.T @ i @ j for j, _, i, _ in self.terms))

    @cached_property
    def gyroscopic(self) -> RingMatrix:
        """Σ Jᵀ (I (dJ/dt q̇ + dj/dt) + v × I v)"""
        parts = []
        for j, s, i, turns in self.terms:
            inner = i @ (j.dt() @ self.q_dot + s.dt())
            parts.append(j.T @ (inner + turned(i, j @ self.q_dot + s) if turns else inner))
        return reduce(add, parts)

    @cached_property
    def bias(self) -> RingMatrix:
        return self.gyroscopic + self.codec.column(self.gradient)

    @cached_property
    def applied(self) -> RingMatrix:
        """Q − ∂V/∂q."""
        return self.codec.column(self.forces) - self.codec.column(self.gradient)

    @cached_property
    def solved(self) -> Inverse:
        """(n, d) with q̈ = n/d, from M q̈ = Q − h.

        Raises ModelError if the mass matrix has no inverse.
        """
        if self.is_bound:
            above, below = self._solved_in_bounds()
        elif len(self.terms) == 1 and len(self.rates) == 3:
            above, below = self._solved_by_euler()
        else:
            above = self.mass_matrix.adjugate() @ (self.codec.column(self.forces) - self.bias)
            below = self.mass_matrix.det()
        if not below:
            raise ModelError(
                f"{self.model.name}: the mass matrix has no inverse; expected coordinates that "
                "move the body in different ways"
            )
        return above, below

    def _solved_by_euler(self) -> Inverse:
        """The same for one body and three coordinates: J q̈ = dΩ′/dt − dJ/dt q̇ − dj/dt."""
        ((jacobian, shift, tensor, _),) = self.terms
        back, below, size = jacobian.adjugate(), jacobian.det(), tensor.det()
        slopes = jacobian.dt() @ self.q_dot + shift.dt()
        inner = tensor.adjugate() @ turned(tensor, self.omega) + slopes.scale(size)
        if self.applied.is_zero():
            return back @ inner.scale(-self.ring.one), self.ring.reduce(size * below)
        torque = tensor.adjugate() @ (back.T @ self.applied)
        return back @ (torque - inner.scale(below)), self.ring.reduce(size * below * below)

    @cached_property
    def possible(self) -> tuple[RingMatrix, PolyElement]:
        """U and its divisor; the equations of motion hold for the displacements U δθ.

        Raises ModelError for forces on what does not matter, such as the length of a quaternion.
        """
        assert self.back is not None
        back, below = self.codec.matrix(self.back[0]), self.codec.encode(self.back[1])
        seen = self.terms[0][0].T @ (back.T @ self.applied)
        if not self.model.constraints and not (seen - self.applied.scale(below)).is_zero():
            raise ModelError(
                f"{self.model.name}: the potential or a force depends on coordinates that R does "
                "not determine, such as the length of a quaternion; expected one that does not, "
                "or unit_quaternion"
            )
        return back, below

    def _solved_in_bounds(self) -> Inverse:
        """q̈ from W′ q̈ = dΩ′/dt − dj/dt − dW′/dt q̇ and q̇ = U W′ q̇, differentiated.

        dΩ′/dt follows from Euler's equations with the torque Uᵀ (Q − ∂V/∂q).
        """
        back, below = self.possible
        ((jacobian, shift, tensor, _),) = self.terms
        size, turning = tensor.det(), jacobian @ self.q_dot
        torque = back.T @ self.applied - turned(tensor, self.omega).scale(below)
        slopes = (shift.dt() + jacobian.dt() @ self.q_dot).scale(size * below)
        within = back @ (tensor.adjugate() @ torque - slopes)  # over det I d²
        moving = (back.dt().scale(below) - back.scale(self.ring.dt(below))) @ turning  # over d²
        across = moving.scale(below) - back @ (jacobian @ moving)  # over d³
        above = within.scale(below) + across.scale(size)
        return above, self.ring.reduce(size * below**3)


def is_bound(model: RotationModel) -> bool:
    """Whether coordinates depend on one another, or do not matter, as the length of q."""
    is_spare = not model.turns and len(model.coordinates) > 3
    return bool(model.constraints) or model.pullback is not None or is_spare
