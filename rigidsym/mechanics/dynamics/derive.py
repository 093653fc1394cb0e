"""Equations of motion of a body that turns about a fixed point: Lagrange's and Euler's.

The body has its inertia tensor about the fixed point; a potential V(q, t) and generalised forces
act on it. What does not depend on a coordinate, or on time, is conserved, and proved to be.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cached_property
from types import MappingProxyType

import sympy as sp

from rigidsym.algebra.codec import codec_for
from rigidsym.algebra.matrix import RingMatrix, cross
from rigidsym.algebra.present import presenter_for
from rigidsym.algebra.squares import half_form
from rigidsym.mechanics.derivation import FirstIntegral, Found, Step
from rigidsym.mechanics.dynamics.flow import flow_functions
from rigidsym.mechanics.dynamics.lagrange import Lagrange
from rigidsym.mechanics.kinematics.workspace import encoded
from rigidsym.mechanics.prove import Prover
from rigidsym.mechanics.quantities import dynamics as claims
from rigidsym.mechanics.quantities.arguments import (
    arguments_of,
    arguments_of_flow,
    arguments_of_motion,
)


class EquationsOfMotion:
    """The steps of one rotation, one body and the forces on it."""

    def __init__(self, work: Lagrange) -> None:
        self.work = work
        self.present = presenter_for(work.codec)
        self.prove = Prover(work.model, work.codec)
        self.arguments = {a.name: a for a in arguments_of(work.model)}
        self.added = arguments_of_motion(work.model)  # by the equations of motion
        self.added += arguments_of_flow([self.arguments["q"], self.arguments["q_dot"]])
        self.arguments |= {a.name: a for a in self.added}

    def steps(self, wanted: Sequence[str]) -> Iterator[tuple[str, Found]]:
        """(name, what was found) of the quantities of motion that are wanted."""
        yield from ((name, _STEPS[name](self)) for name in wanted)

    @cached_property
    def kinetic(self) -> sp.Expr:
        """T = ½ Ω′ᵀ I′ Ω′, the squares kept."""
        return half_form(self.present, self.work.inertia, self.work.omega)

    def _scalar(self, expression: sp.Expr) -> RingMatrix:
        return self.work.column([expression])

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

    def angular_acceleration_from_torque(self) -> Found:
        """I′⁻¹ (N′ − Ω′ × I′ Ω′) for free Ω′ and N′, in a ring of their own."""
        omega, torque = self.arguments["omega_body"].symbols, self.arguments["torque"].symbols
        inertia = self.work.body.inertia
        codec = codec_for([e for e in (*inertia, *omega, *torque) if e != 0], order=0)
        w, n = (RingMatrix.column(codec.ring, map(codec.encode, v)) for v in (omega, torque))
        tensor = encoded(codec, inertia)
        turned = cross(codec.ring, w.entries, (tensor @ w).entries)
        left = n - RingMatrix.column(codec.ring, turned)
        above, below = tensor.adjugate() @ left, tensor.det()
        residual = tensor @ above - left.scale(below)
        proof = Prover(self.work.model, codec).vanishes(residual, claims.EULER, divided_by=below)
        return Found(
            presenter_for(codec).matrix(above, below),
            "Euler's equations: the torque changes the angular momentum, which is written along "
            "the axes of the body.",
            (proof,),
        )

    def functions(self) -> Mapping[str, Step]:
        """What kernels take beside the steps: the derivative of the state y = (q, q̇)."""
        accelerations = self.present.matrix(*self.work.solved)
        integrals = [integral.expression for integral in self.first_integrals]
        state = self.arguments["y"]
        return flow_functions(state, [*self.work.rates, *accelerations], integrals)

    @cached_property
    def first_integrals(self) -> tuple[FirstIntegral, ...]:
        """What is constant along every motion, with its proof."""
        return tuple(self._first_integrals())

    def _first_integrals(self) -> Iterator[FirstIntegral]:
        work = self.work
        if not any(work.forces):
            yield FirstIntegral(
                name="energy",
                symbol=claims.ENERGY,
                expression=self.kinetic + work.potential,
                proof=self.prove.vanishes(self._energy_rate, claims.ENERGY_IS_CONSTANT),
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


_STEPS: Mapping[str, Callable[[EquationsOfMotion], Found]] = MappingProxyType(
    {name: getattr(EquationsOfMotion, name) for name in claims.DYNAMICS_QUANTITIES}
)
