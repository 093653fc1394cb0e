"""Equations of motion of a body that turns about a fixed point: Lagrange's and Euler's.

The body has its inertia tensor about the fixed point; a potential V(q, t) and generalised forces
act on it. What does not depend on a coordinate, or on time, is conserved, and proved to be.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property

import sympy as sp

from rigidsym.algebra.codec import codec_for
from rigidsym.algebra.matrix import RingMatrix
from rigidsym.algebra.present import presenter_for
from rigidsym.algebra.squares import half_form
from rigidsym.mechanics.derivation import FirstIntegral, Found
from rigidsym.mechanics.dynamics.euler import EulerEquations
from rigidsym.mechanics.dynamics.flow import Flow, StateBlock
from rigidsym.mechanics.dynamics.lagrange import Lagrange, is_free
from rigidsym.mechanics.kinematics.workspace import encoded
from rigidsym.mechanics.quantities import dynamics as claims
from rigidsym.models.body import RigidBody
from rigidsym.models.forces import OMEGA_BODY, Forces
from rigidsym.models.rotation import RotationModel


def equations_of_motion(model: RotationModel, body: RigidBody, forces: Forces) -> Flow:
    """Lagrange's equations if the coordinates are free, else Euler's, unless one is asked for."""
    method = forces.method or ("lagrange" if is_free(model) else "euler")
    if method == "euler":
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

    @cached_property
    def kinetic(self) -> sp.Expr:
        """T = ½ Ω′ᵀ I′ Ω′, the squares kept."""
        return half_form(self.present, self.work.inertia, self.work.omega)

    def _scalar(self, expression: sp.Expr) -> RingMatrix:
        return self.column([expression])

    @property
    def _left_side(self) -> RingMatrix:
        """M q̈ + h."""
        work = self.work
        return work.mass_matrix @ work.column(work.accelerations) + work.bias

    def potential_energy(self) -> Found:
        return Found(sp.ImmutableMatrix([[self.work.potential]]), "The potential energy is given.")

    def lagrangian(self) -> Found:
        return Found(
            sp.ImmutableMatrix([[self.kinetic - self.work.potential]]),
            "One point is fixed, so that all kinetic energy belongs to the rotation about it.",
        )

    def energy(self) -> Found:
        return Found(
            sp.ImmutableMatrix([[self.kinetic + self.work.potential]]),
            "The energy changes at the power of the generalised forces.",
            (self.prove.vanishes(self._energy_rate, claims.ENERGY_RATE),),
        )

    @cached_property
    def _energy_rate(self) -> RingMatrix:
        """dE/dt − q̇·(M q̈ + h)."""
        work = self.work
        whole = self._scalar(self.kinetic + work.potential)
        return whole.dt() - work.q_dot.T @ self._left_side

    def generalised_momenta(self) -> Found:
        slopes = self.work.column([sp.diff(self.kinetic, rate) for rate in self.work.rates])
        residual = slopes - self.work.momenta
        return Found(
            self.present.matrix(self.work.momenta),
            "The generalised momenta are the derivatives of the kinetic energy by the rates.",
            (self.prove.vanishes(residual, claims.MOMENTA_ARE_SLOPES),),
        )

    def mass_matrix(self) -> Found:
        work = self.work
        twice = work.q_dot.T @ work.mass_matrix @ work.q_dot
        residual = twice - self._scalar(2 * self.kinetic)
        return Found(
            self.present.matrix(work.mass_matrix),
            "The kinetic energy is a quadratic form in the rates.",
            (self.prove.vanishes(residual, claims.TWICE_ENERGY),),
        )

    def bias_vector(self) -> Found:
        work = self.work
        slopes = work.column([sp.diff(self.kinetic, q) for q in work.model.coordinates])
        turning = work.W @ work.column(work.accelerations)
        euler = work.W.T @ (work.inertia @ turning + work.gyroscopic)
        residual = work.momenta.dt() - slopes - euler
        return Found(
            self.present.matrix(work.bias),
            "What remains of Lagrange's equations without the accelerations and the forces.",
            (self.prove.vanishes(residual, claims.LAGRANGE_IS_EULER),),
        )

    def accelerations(self) -> Found:
        work = self.work
        above, below = work.solved
        residual = work.mass_matrix @ above + (work.bias - work.column(work.forces)).scale(below)
        return Found(
            self.present.matrix(above, below),
            "The equations of motion are solved for the accelerations.",
            (self.prove.vanishes(residual, claims.EQUATIONS, divided_by=below),),
        )

    def hamiltonian(self) -> Found:
        """H(q, p), with the momenta as inputs in a ring of their own."""
        work = self.work
        momenta = self.arguments["momenta"].symbols
        held = [*work.rate_matrix, *work.body.inertia, sp.Rational(1, 2), work.potential, *momenta]
        codec = codec_for([entry for entry in held if entry != 0], order=0)
        rates, inertia = (encoded(codec, m) for m in (work.rate_matrix, work.body.inertia))
        own = rates.T @ inertia @ rates
        p = RingMatrix.column(codec.ring, map(codec.encode, momenta))
        twice = p.T @ own.adjugate() @ p
        half = presenter_for(codec).matrix(twice, codec.encode(sp.Integer(2)) * own.det())
        residual = work.momenta.T @ work.mass_matrix.adjugate() @ work.momenta
        residual -= self._scalar(2 * self.kinetic).scale(work.mass_matrix.det())
        proof = self.prove.vanishes(
            residual, claims.HAMILTONIAN_IS_ENERGY, divided_by=work.mass_matrix.det()
        )
        return Found(
            sp.ImmutableMatrix([[half[0] + work.potential]]),
            "The Hamiltonian is the energy in terms of the momenta.",
            (proof,),
        )

    def in_state(self, value: sp.Expr) -> sp.Expr:
        """Ω′ = W′ q̇."""
        return value.xreplace(
            dict(zip(OMEGA_BODY, self.present.matrix(self.work.omega), strict=True))
        )

    def own_integrals(self) -> Iterator[FirstIntegral]:
        work = self.work
        if not any(work.forces):
            yield FirstIntegral(
                name="energy",
                symbol=claims.ENERGY,
                expression=self.kinetic + work.potential,
                proof=self.prove.vanishes(self._energy_rate, claims.is_constant(claims.ENERGY)),
            )
        momenta = self.present.matrix(work.momenta)
        for k, q in enumerate(work.model.coordinates):
            if work.forces[k] == 0 and not sp.diff(work.potential, q):
                slope = self._scalar(sp.diff(self.kinetic, q))
                if slope.is_zero():
                    yield FirstIntegral(
                        name=f"momentum_{q.func.__name__}",
                        symbol=self.arguments["momenta"].notation[k],
                        expression=momenta[k],
                        proof=self.prove.vanishes(slope, claims.momentum_is_constant(k + 1)),
                    )
