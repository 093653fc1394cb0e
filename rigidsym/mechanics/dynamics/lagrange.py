r"""Equations of motion of one body about a fixed point: Lagrange's, over one ring.

With the rate matrix W′ of the body, Ω′ = W′ q̇ and T = ½ Ω′ᵀ I′ Ω′,

    d/dt ∂T/∂q̇ − ∂T/∂q = W′ᵀ (I′ dΩ′/dt + Ω′ × I′ Ω′)
    M q̈ + h = Q,  M = W′ᵀ I′ W′,
    h = W′ᵀ (I′ dW′/dt q̇ + Ω′ × I′ Ω′) + ∂V/∂q

The first line is proved in the ring; the others follow from it. What does not depend on a
coordinate, or on time, is conserved. Several bodies are in `dynamics.tree`.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cached_property

import sympy as sp
from sympy.polys.rings import PolyElement

from rigidsym.algebra.codec import codec_for
from rigidsym.algebra.matrix import Inverse, RingMatrix
from rigidsym.algebra.present import half_form, presenter_for
from rigidsym.errors import ModelError
from rigidsym.mechanics.derivation import Consequence, FirstIntegral
from rigidsym.mechanics.dynamics.consequences import Reduced
from rigidsym.mechanics.dynamics.euler import EulerEquations
from rigidsym.mechanics.dynamics.flow import Flow, StateBlock, turned
from rigidsym.mechanics.dynamics.tree import TreeEquations
from rigidsym.mechanics.kinematics.chain import Chain
from rigidsym.mechanics.kinematics.workspace import Values
from rigidsym.mechanics.quantities import dynamics as claims
from rigidsym.models.body import RigidBody
from rigidsym.models.forces import OMEGA_BODY, Forces
from rigidsym.models.rotation import TIME, RotationModel


def equations_of_motion(
    model: RotationModel, body: RigidBody, forces: Forces, chain: Chain | None = None
) -> Flow:
    """Lagrange's equations for free coordinates, else Euler's, unless one is asked for.

    Those of a `chain`, or of a body that other parts move with, are in names.
    """
    is_dependent = is_bound(model)
    if (forces.method or ("euler" if is_dependent else "lagrange")) == "euler":
        return EulerEquations(model, body, forces)
    if is_dependent:
        raise ModelError(
            f"{model.name}: Lagrange's equations need independent coordinates, such as Euler "
            'angles; expected such a rotation, or method = "euler"'
        )
    if chain is not None or forces.parts:
        return TreeEquations(model, body, forces, chain or Chain(model))
    return LagrangeEquations(model, body, forces)


def is_bound(model: RotationModel) -> bool:
    """Whether coordinates depend on one another, or do not matter, as the length of q."""
    is_spare = not model.turns and len(model.coordinates) > 3
    return bool(model.constraints) or model.pullback is not None or is_spare


class LagrangeEquations(Flow):
    """The steps of a rotation, a body and the forces on it, in Lagrange's form."""

    table = claims.DYNAMICS_QUANTITIES
    second = "q_dot"

    def __init__(self, model: RotationModel, body: RigidBody, forces: Forces) -> None:
        self.potential = forces.potential
        self.rates = [sp.diff(q, TIME) for q in model.coordinates]
        self.accelerations = [sp.diff(q, TIME, 2) for q in model.coordinates]
        values = Values(model)
        self._jacobian = values.codec.decoded(values.rate_matrix("body"))
        omega = self._jacobian * sp.Matrix(self.rates)
        torque = sp.Matrix(forces.torque or [0, 0, 0])
        in_rates = dict(zip(OMEGA_BODY, omega, strict=True))
        acting = self._jacobian.T * torque.xreplace(in_rates)
        self.generalised = [
            forces.generalised.get(q, sp.S.Zero).xreplace(in_rates) + part
            for q, part in zip(model.coordinates, acting, strict=True)
        ]
        self.gradient = [sp.diff(self.potential, q) for q in model.coordinates]
        entries = [*self._jacobian, *body.inertia, *omega, sp.Rational(1, 2), self.potential]
        entries += [*self.gradient, *self.generalised, *self.rates]
        entries += [*forces.first_integrals.values()]
        entries += self.accelerations
        codec = codec_for([e for e in entries if e != 0], order=2)
        super().__init__(model, body, forces, codec)
        self.ring = codec.ring

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
    def jacobian(self) -> RingMatrix:
        """W′."""
        return self.codec.matrix(self._jacobian)

    @cached_property
    def inertia(self) -> RingMatrix:
        return self.codec.matrix(self.body.inertia)

    @cached_property
    def q_dot(self) -> RingMatrix:
        return self.codec.column(self.rates)

    @cached_property
    def omega(self) -> RingMatrix:
        """Ω′ of the body."""
        return self.jacobian @ self.q_dot

    @cached_property
    def momenta(self) -> RingMatrix:
        """p = ∂T/∂q̇ = W′ᵀ I′ Ω′."""
        return self.jacobian.T @ (self.inertia @ self.omega)

    @cached_property
    def mass_matrix(self) -> RingMatrix:
        return self.jacobian.T @ self.inertia @ self.jacobian

    @cached_property
    def gyroscopic(self) -> RingMatrix:
        """W′ᵀ (I′ dW′/dt q̇ + Ω′ × I′ Ω′)."""
        inner = self.inertia @ (self.jacobian.dt() @ self.q_dot)
        return self.jacobian.T @ (inner + turned(self.inertia, self.omega))

    @cached_property
    def bias(self) -> RingMatrix:
        return self.gyroscopic + self.codec.column(self.gradient)

    @cached_property
    def applied(self) -> RingMatrix:
        """Q − ∂V/∂q."""
        return self.codec.column(self.generalised) - self.codec.column(self.gradient)

    @cached_property
    def needed(self) -> RingMatrix:
        """Q − h."""
        return self.codec.column(self.generalised) - self.bias

    @cached_property
    def solved(self) -> Inverse:
        """(n, d) with q̈ = n/d, from M q̈ = Q − h.

        Raises ModelError if the mass matrix has no inverse.
        """
        if len(self.rates) == 3:
            # by Euler's equations: W′ q̈ = dΩ′/dt − dW′/dt q̇
            jacobian, tensor = self.jacobian, self.inertia
            back, divisor, size = jacobian.adjugate(), jacobian.det(), tensor.det()
            slopes = jacobian.dt() @ self.q_dot
            inner = tensor.adjugate() @ turned(tensor, self.omega) + slopes.scale(size)
            if self.applied.is_zero():
                above = back @ inner.scale(-self.ring.one)
                below = self.ring.reduce(size * divisor)
            else:
                torque = tensor.adjugate() @ (back.T @ self.applied)
                above = back @ (torque - inner.scale(divisor))
                below = self.ring.reduce(size * divisor * divisor)
        else:
            above = self.mass_matrix.adjugate() @ self.needed
            below = self.mass_matrix.det()
        if not below:
            raise ModelError(
                f"{self.model.name}: the mass matrix has no inverse; expected coordinates that "
                "move the body in different ways"
            )
        return above, below

    @cached_property
    def blocks(self) -> tuple[StateBlock, StateBlock]:
        return (
            StateBlock(self.model.coordinates, self.q_dot, self.ring.one),
            StateBlock(self.rates, *self.solved),
        )

    @cached_property
    def kinetic(self) -> sp.Expr:
        """T = ½ Ω′ᵀ I′ Ω′, the squares kept."""
        return half_form(self.present, self.inertia, self.omega)

    @cached_property
    def whole(self) -> sp.Expr:
        """E = T + V."""
        return self.kinetic + self.potential

    def _scalar(self, expression: sp.Expr) -> RingMatrix:
        return self.codec.column([expression])

    @cached_property
    def of_lagrange(self) -> RingMatrix:
        """d/dt ∂T/∂q̇ − ∂T/∂q − (M q̈ + h − ∂V/∂q)."""
        turning = self.mass_matrix @ self.codec.column(self.accelerations)
        return self.momenta.dt() - self._slopes - turning - self.gyroscopic

    @cached_property
    def _slopes(self) -> RingMatrix:
        """∂T/∂q."""
        return self.slopes(self.codec.encode(self.kinetic))

    @cached_property
    def traits(self) -> frozenset[str]:
        return frozenset(self._shared_traits)

    def energy_rate(self, value: sp.Expr) -> RingMatrix:
        """dE/dt − q̇·(M q̈ + h) − ∂V/∂t."""
        left = self.mass_matrix @ self.codec.column(self.accelerations) + self.bias  # M q̈ + h
        return self._scalar(value).dt() - self.q_dot.T @ left - self.driving

    @cached_property
    def coriolis(self) -> RingMatrix:
        """C q̇ = h − ∂V/∂q with the skew Ṁ − 2C, by Christoffel's symbols of M."""
        places = range(len(self.rates))
        half = self.ring.one / 2
        slope = {(i, j): self.slopes(self.mass_matrix[i, j]) for i in places for j in places}
        rows = [
            [
                self.ring.dot(
                    (
                        slope[i, j][k, 0] + slope[i, k][j, 0] - slope[j, k][i, 0],
                        half * self.q_dot[k, 0],
                    )
                    for k in places
                )
                for j in places
            ]
            for i in places
        ]
        return RingMatrix.of(self.ring, rows)

    @property
    def hamiltonian(self) -> sp.Expr:
        """H(q, p), with the momenta as inputs in a ring of their own."""
        return self._in_momenta(self.arguments["momenta"].symbols)

    @property
    def energy_by_momenta(self) -> RingMatrix:
        """(pᵀ M⁻¹ p − 2T) det M."""
        above = self.momenta.T @ self.mass_matrix.adjugate() @ self.momenta
        return above - self._scalar(2 * self.kinetic).scale(self.mass_matrix.det())

    def _in_momenta(self, momenta: Sequence[sp.Expr]) -> sp.Expr:
        """½ pᵀ M⁻¹ p + V."""
        entries = [*self._jacobian, *self.body.inertia, sp.Rational(1, 2), self.potential, *momenta]
        codec = codec_for([entry for entry in entries if entry != 0], order=0)
        jacobian = codec.matrix(self._jacobian)
        own = jacobian.T @ codec.matrix(self.body.inertia) @ jacobian
        p = codec.column(momenta)
        twice = p.T @ own.adjugate() @ p
        half = presenter_for(codec).matrix(twice, codec.encode(sp.Integer(2)) * own.det())
        return half[0] + self.potential

    @cached_property
    def single(self) -> int | None:
        """The position of the only coordinate that moves if the others are ignorable."""
        constant = {integral.name for integral in self.own_integrals()}
        names = [q.func.__name__ for q in self.model.coordinates]
        moving = [k for k, name in enumerate(names) if f"momentum_{name}" not in constant]
        if len(moving) != 1:
            return None
        (k,) = moving
        others = [q for j, q in enumerate(self.model.coordinates) if j != k]
        if self.potential.has(*others):  # it is written with them, though it does not depend
            return None
        is_apart = not any(self.mass_matrix[k, j] for j in range(len(names)) if j != k)
        return k if is_apart and len(names) > 1 else None  # p_k = 0 means that it is at rest

    @cached_property
    def effective(self) -> sp.Expr:
        momenta = self.arguments["momenta"].symbols
        return self._in_momenta(
            [sp.S.Zero if j == self.single else p for j, p in enumerate(momenta)]
        )

    def consequences(self) -> Iterator[Consequence]:
        yield from super().consequences()
        k = self.single
        if k is None or self.forces.leave_free(self.model) or not self.driving.is_zero():
            return  # the free body is known; in a driving potential the energy is not constant
        q = self.model.coordinates
        momenta = self.present.matrix(self.momenta)
        others = [j for j in range(len(q)) if j != k]
        reduced = Reduced(
            name=self.model.name,
            coordinate=q[k],
            ignorable=tuple(q[j] for j in others),
            mass=self.present.matrix(self.mass_matrix)[k, k],
            potential=self.effective,
            symbols=tuple(self.arguments["momenta"].symbols[j] for j in others),
            momenta=tuple(momenta[j] for j in others),
            energy=self.whole,
            acceleration=self.present.matrix(*self.solved)[k],
        )
        yield from reduced.consequences()

    def in_state(self, value: sp.Expr) -> sp.Expr:
        """Ω′ = W′ q̇."""
        return value.xreplace(dict(zip(OMEGA_BODY, self.present.matrix(self.omega), strict=True)))

    def own_integrals(self) -> Iterator[FirstIntegral]:
        power = self.q_dot.T @ self.codec.column(self.generalised)  # 0 of gyroscopic forces as well
        if power.is_zero() and self.driving.is_zero():
            residual = self.energy_rate(self.whole) + power
            yield FirstIntegral(
                name="energy",
                symbol=claims.ENERGY,
                expression=self.whole,
                proof=self.prove.vanishes(residual, claims.is_constant(claims.ENERGY)),
            )
        momenta = self.present.matrix(self.momenta)
        for k, q in enumerate(self.model.coordinates):
            applied = RingMatrix.of(self.ring, [self.applied.rows[k]])
            slope = RingMatrix.of(self.ring, [self._slopes.rows[k]])
            if applied.is_zero() and slope.is_zero():
                claim = claims.momentum_is_constant(k + 1)
                yield FirstIntegral(
                    name=f"momentum_{q.func.__name__}",
                    symbol=self.arguments["momenta"].notation[k],
                    expression=momenta[k],
                    proof=self.prove.vanishes(slope + applied, claim),
                )
