"""Equations of motion of a body that turns about a fixed point: Lagrange's and Euler's.

The body has its inertia tensor about the fixed point; a potential V(q, t) and generalised forces
act on it. What does not depend on a coordinate, or on time, is conserved, and proved to be.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cached_property, reduce
from operator import add

import sympy as sp
from sympy.polys.rings import PolyElement

from rigidsym.algebra.codec import codec_for
from rigidsym.algebra.matrix import RingMatrix
from rigidsym.algebra.present import half_form, presenter_for
from rigidsym.mechanics.derivation import Consequence, FirstIntegral
from rigidsym.mechanics.dynamics.cosine import Cosine
from rigidsym.mechanics.dynamics.euler import EulerEquations
from rigidsym.mechanics.dynamics.flow import Flow, StateBlock
from rigidsym.mechanics.dynamics.lagrange import Lagrange, is_bound
from rigidsym.mechanics.dynamics.reduced import Reduced
from rigidsym.mechanics.quantities import dynamics as claims
from rigidsym.models.body import RigidBody
from rigidsym.models.forces import OMEGA_BODY, Forces
from rigidsym.models.rotation import RotationModel


def equations_of_motion(model: RotationModel, body: RigidBody, forces: Forces) -> Flow:
    """Lagrange's equations for free coordinates, else Euler's, unless one is asked for."""
    if (forces.method or ("euler" if is_bound(model) else "lagrange")) == "euler":
        return EulerEquations(model, body, forces)
    return LagrangeEquations(Lagrange(model, body, forces))


class LagrangeEquations(Flow):
    """The steps of one rotation, one body and the forces on it, in Lagrange's form."""

    table = claims.DYNAMICS_QUANTITIES
    second = "q_dot"

    def __init__(self, work: Lagrange) -> None:
        super().__init__(work.model, work.body, work.acting, work.codec)
        self.work = work

    @cached_property
    def blocks(self) -> tuple[StateBlock, StateBlock]:
        work = self.work
        return (
            StateBlock(work.model.coordinates, work.q_dot, work.ring.one),
            StateBlock(work.rates, *work.solved),
        )

    def _half(self, *, shifted: bool = True, moved: bool = True) -> sp.Expr:
        """½ Σ vᵀ I v, or its part in J q̇ or in j only, the squares kept."""
        halves = []
        for jacobian, shift, inertia, _ in self.work.terms:
            moving = jacobian @ self.work.q_dot
            velocity = (moving + shift if shifted else moving) if moved else shift
            halves.append(half_form(self.present, inertia, velocity))
        return sp.Add(*halves)

    @cached_property
    def kinetic(self) -> sp.Expr:
        """T = ½ Σ vᵀ I v."""
        return self._half()

    @cached_property
    def whole(self) -> sp.Expr:
        """E = T + V; in a turning frame Jacobi's integral, T₂ − T₀ + V."""
        if not self.work.acting.frame_rate:
            return self.kinetic + self.work.potential
        return self._half(shifted=False) - self._half(moved=False) + self.work.potential

    def _scalar(self, expression: sp.Expr) -> RingMatrix:
        return self.codec.column([expression])

    @cached_property
    def of_lagrange(self) -> RingMatrix:
        """d/dt ∂T/∂q̇ − ∂T/∂q − (M q̈ + h − ∂V/∂q); not zero if the body rolls."""
        work = self.work
        turning = work.mass_matrix @ work.codec.column(work.accelerations)
        return work.momenta.dt() - self._slopes - turning - work.gyroscopic

    @property
    def lagrange_along_possible(self) -> tuple[RingMatrix, PolyElement]:
        """Uᵀ (d/dt ∂L/∂q̇ − ∂L/∂q − Q) for the accelerations found, and its divisor.

        So says d'Alembert's principle for the displacements U δθ, which are possible.
        """
        work = self.work
        rates = [self.rate(sp.diff(self.kinetic, rate)) for rate in work.rates]
        divisor = rates[0][1]
        changes = RingMatrix(work.ring, tuple(above.rows[0] for above, _ in rates))
        left = changes - (self._slopes + work.applied).scale(divisor)
        return work.possible[0].T @ left, divisor

    @cached_property
    def _slopes(self) -> RingMatrix:
        """∂T/∂q; of T as it is written, if the coordinates depend on one another."""
        if self.work.is_bound:
            return self.codec.column([sp.diff(self.kinetic, q) for q in self.model.coordinates])
        return self.work.slopes(self.codec.encode(self.kinetic))

    @cached_property
    def is_holonomic(self) -> bool:
        turn = all(part.turns for part in self.work.moving)
        return turn or self.work.is_bound or self.of_lagrange.is_zero()

    @cached_property
    def traits(self) -> frozenset[str]:
        turns_frame = bool(self.work.acting.frame_rate)
        traits = {
            "parts": len(self.work.moving) > 1 or turns_frame,  # T is not E_R
            "turning_frame": turns_frame,
            "bound": self.work.is_bound,
            "rolling": not self.is_holonomic,
        }
        return frozenset(self._shared_traits) | {t for t, holds in traits.items() if holds}

    def energy_rate(self, value: sp.Expr) -> RingMatrix:
        """dE/dt − q̇·(M q̈ + h) − ∂V/∂t; times a divisor if the coordinates depend on one another."""
        work = self.work
        if work.is_bound:
            rate, divisor = self.rate(value)
            power = work.q_dot.T @ work.codec.column(work.forces)
            return rate - (power + self.driving).scale(divisor)
        left = work.mass_matrix @ work.codec.column(work.accelerations) + work.bias  # M q̈ + h
        return self._scalar(value).dt() - work.q_dot.T @ left - self.driving

    @property
    def slopes_by_rates(self) -> RingMatrix:
        """∂T/∂q̇ of T as it is written."""
        return self.codec.column([sp.diff(self.kinetic, rate) for rate in self.work.rates])

    def form_of_rates(self, matrix: RingMatrix) -> RingMatrix:
        """q̇ᵀ M q̇."""
        return self.work.q_dot.T @ matrix @ self.work.q_dot

    @property
    def twice_quadratic(self) -> RingMatrix:
        """Twice the part of T that is quadratic in the rates, as it is written."""
        return self._scalar(2 * self._half(shifted=False))

    @cached_property
    def coriolis(self) -> RingMatrix | None:
        """C q̇ = h − ∂V/∂q with the skew Ṁ − 2C, by Christoffel's symbols of M."""
        work = self.work
        if not self.is_holonomic or work.acting.frame_rate or work.is_bound:
            return None
        places = range(len(work.rates))
        half = work.ring.one / 2
        slope = {(i, j): work.slopes(work.mass_matrix[i, j]) for i in places for j in places}
        rows = [
            [
                work.ring.dot(
                    (
                        slope[i, j][k, 0] + slope[i, k][j, 0] - slope[j, k][i, 0],
                        half * work.q_dot[k, 0],
                    )
                    for k in places
                )
                for j in places
            ]
            for i in places
        ]
        return RingMatrix.of(work.ring, rows)

    def skew_part(self, coriolis: RingMatrix) -> RingMatrix:
        """Ṁ − 2C."""
        return self.work.mass_matrix.dt() - coriolis - coriolis

    def left_over(self, above: RingMatrix, below: PolyElement) -> RingMatrix:
        """M q̈ + h − Q for the accelerations above/below, times their divisor."""
        work = self.work
        bias = work.bias - work.codec.column(work.forces)
        return work.mass_matrix @ above + bias.scale(below)

    @property
    def mass_and_forces(self) -> sp.ImmutableMatrix:
        """(M, Q − h), from which q̈ follows by elimination."""
        work = self.work
        forces = work.codec.column(work.forces) - work.bias
        mass = self.present.matrix(work.mass_matrix)
        return sp.ImmutableMatrix.hstack(mass, self.present.matrix(forces))

    @property
    def hamiltonian(self) -> sp.Expr | None:
        """H(q, p), with the momenta as inputs in a ring of their own."""
        work = self.work
        if not self.is_holonomic or work.acting.frame_rate or work.is_bound:
            return None
        return self._in_momenta(self.arguments["momenta"].symbols)

    @property
    def energy_by_momenta(self) -> RingMatrix:
        """(pᵀ M⁻¹ p − 2T) det M."""
        work = self.work
        above = work.momenta.T @ work.mass_matrix.adjugate() @ work.momenta
        return above - self._scalar(2 * self.kinetic).scale(work.mass_matrix.det())

    def _in_momenta(self, momenta: Sequence[sp.Expr]) -> sp.Expr:
        """½ pᵀ M⁻¹ p + V."""
        work = self.work
        held = [e for part in work.moving for m in (part.jacobian, part.inertia) for e in m]
        held += [sp.Rational(1, 2), work.potential, *momenta]
        codec = codec_for([entry for entry in held if entry != 0], order=0)
        own = reduce(
            add,
            (
                codec.matrix(part.jacobian).T
                @ codec.matrix(part.inertia)
                @ codec.matrix(part.jacobian)
                for part in work.moving
            ),
        )
        p = codec.column(momenta)
        twice = p.T @ own.adjugate() @ p
        half = presenter_for(codec).matrix(twice, codec.encode(sp.Integer(2)) * own.det())
        return half[0] + work.potential

    @cached_property
    def single(self) -> int | None:
        """The position of the only coordinate that moves if the others are ignorable."""
        constant = {integral.name for integral in self.own_integrals()}
        names = [q.func.__name__ for q in self.model.coordinates]
        moving = [k for k, name in enumerate(names) if f"momentum_{name}" not in constant]
        if not self.is_holonomic or len(moving) != 1 or self.work.acting.frame_rate:
            return None
        (k,) = moving
        others = [q for j, q in enumerate(self.model.coordinates) if j != k]
        if self.work.potential.has(*others):  # it is written with them, though it does not depend
            return None
        is_apart = not any(self.work.mass_matrix[k, j] for j in range(len(names)) if j != k)
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
        momenta = self.present.matrix(self.work.momenta)
        others = [j for j in range(len(q)) if j != k]
        reduced = Reduced(
            name=self.model.name,
            coordinate=q[k],
            ignorable=tuple(q[j] for j in others),
            mass=self.present.matrix(self.work.mass_matrix)[k, k],
            potential=self.effective,
            symbols=tuple(self.arguments["momenta"].symbols[j] for j in others),
            momenta=tuple(momenta[j] for j in others),
            energy=self.whole,
            acceleration=self.present.matrix(*self.work.solved)[k],
        )
        yield reduced.one_dimension()
        yield from reduced.others()
        yield from reduced.steady()
        yield from Cosine(reduced).consequences()

    def in_state(self, value: sp.Expr) -> sp.Expr:
        """Ω′ = W′ q̇."""
        return value.xreplace(
            dict(zip(OMEGA_BODY, self.present.matrix(self.work.omega), strict=True))
        )

    def own_integrals(self) -> Iterator[FirstIntegral]:
        work = self.work
        if work.is_bound and not work.acting.frame_rate:
            euler = EulerEquations(self.model, self.body, self.forces).own_integrals()
            yield from (self.constant(i.name, i.symbol, i.expression) for i in euler)
            return
        power = work.q_dot.T @ work.codec.column(work.forces)  # 0 of gyroscopic forces as well
        if power.is_zero() and self.driving.is_zero():
            residual = self.energy_rate(self.whole) + power
            yield FirstIntegral(
                name="energy",
                symbol=claims.ENERGY,
                expression=self.whole,
                proof=self.prove.vanishes(residual, claims.is_constant(claims.ENERGY)),
            )
        if work.is_bound:
            return
        if not self.is_holonomic:
            return
        momenta = self.present.matrix(work.momenta)
        for k, q in enumerate(work.model.coordinates):
            applied = RingMatrix.of(work.ring, [work.applied.rows[k]])
            slope = RingMatrix.of(work.ring, [self._slopes.rows[k]])
            if applied.is_zero() and slope.is_zero():
                claim = claims.momentum_is_constant(k + 1)
                yield FirstIntegral(
                    name=f"momentum_{q.func.__name__}",
                    symbol=self.arguments["momenta"].notation[k],
                    expression=momenta[k],
                    proof=self.prove.vanishes(slope + applied, claim),
                )
