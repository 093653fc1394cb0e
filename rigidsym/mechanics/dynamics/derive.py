"""Equations of motion of a body that turns about a fixed point: Lagrange's and Euler's.

The body has its inertia tensor about the fixed point; a potential V(q, t) and generalised forces
act on it. What does not depend on a coordinate, or on time, is conserved, and proved to be.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cached_property, reduce
from operator import add

import sympy as sp

from rigidsym.algebra.codec import codec_for
from rigidsym.algebra.matrix import RingMatrix
from rigidsym.algebra.present import presenter_for
from rigidsym.algebra.squares import half_form
from rigidsym.formula.tree import Formula
from rigidsym.mechanics.derivation import Consequence, FirstIntegral, Found, Proof
from rigidsym.mechanics.dynamics.cosine import Cosine
from rigidsym.mechanics.dynamics.euler import EulerEquations
from rigidsym.mechanics.dynamics.flow import Flow, StateBlock
from rigidsym.mechanics.dynamics.lagrange import Lagrange, is_bound
from rigidsym.mechanics.dynamics.reduced import Reduced
from rigidsym.mechanics.quantities import dynamics as claims
from rigidsym.mechanics.quantities.energy import ROTATIONAL
from rigidsym.models.body import RigidBody
from rigidsym.models.forces import OMEGA_BODY, Forces
from rigidsym.models.rotation import RotationModel

_NONE = Found(sp.ImmutableMatrix([[0]]), "")  # of a quantity that a system does not have


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

    def steps(self, only: Sequence[str]) -> Iterator[tuple[str, Found]]:
        """What a rolling body has no use for is left out."""
        for name, found in super().steps([n for n in self.table if not only or n in only]):
            if found is not _NONE:
                yield name, found

    def _half(self, *, shifted: bool = True, moved: bool = True) -> sp.Expr:
        """½ Σ vᵀ I v, or its part in J q̇ or in j only, the squares kept."""
        found = []
        for jacobian, shift, inertia, _ in self.work.terms:
            moving = jacobian @ self.work.q_dot
            velocity = (moving + shift if shifted else moving) if moved else shift
            found.append(half_form(self.present, inertia, velocity))
        return sp.Add(*found)

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
    def _of_lagrange(self) -> RingMatrix:
        """d/dt ∂T/∂q̇ − ∂T/∂q − (M q̈ + h − ∂V/∂q); not zero if the body rolls."""
        work = self.work
        turning = work.mass_matrix @ work.codec.column(work.accelerations)
        return work.momenta.dt() - self._slopes - turning - work.gyroscopic

    def _along_possible(self) -> Iterator[Proof]:
        """Uᵀ (M q̈ + h − Q) = 0 and Uᵀ (d/dt ∂L/∂q̇ − ∂L/∂q − Q) = 0 for the accelerations found.

        So says d'Alembert's principle for the displacements U δθ, which are possible.
        """
        work = self.work
        back, (_, below) = work.possible[0].T, work.solved
        equations = back @ self._left_over
        yield self.prove.vanishes(equations, claims.POSSIBLE_EQUATIONS, divided_by=below)
        rates = [self.rate(sp.diff(self.kinetic, rate)) for rate in work.rates]
        divisor = rates[0][1]
        changes = RingMatrix(work.ring, tuple(above.rows[0] for above, _ in rates))
        left = changes - (self._slopes + work.applied).scale(divisor)
        claim = claims.possible_equations_of_lagrange(self._symbol)
        yield self.prove.vanishes(back @ left, claim, divided_by=divisor)

    @cached_property
    def _slopes(self) -> RingMatrix:
        """∂T/∂q; of T as it is written, if the coordinates depend on one another."""
        if self.work.is_bound:
            return self.codec.column([sp.diff(self.kinetic, q) for q in self.model.coordinates])
        return self.work.slopes(self.codec.encode(self.kinetic))

    @cached_property
    def is_holonomic(self) -> bool:
        turn = all(part.turns for part in self.work.moving)
        return turn or self.work.is_bound or self._of_lagrange.is_zero()

    @cached_property
    def _symbol(self) -> Formula:
        """Of the kinetic energy: that of the rotation if nothing else moves."""
        alone = len(self.work.moving) == 1 and not self.work.acting.frame_rate
        return ROTATIONAL if alone else claims.KINETIC

    def lagrangian(self) -> Found:
        if not self.is_holonomic:
            return _NONE
        return Found(
            sp.ImmutableMatrix([[self.kinetic - self.work.potential]]),
            "One point is fixed, so that all kinetic energy belongs to the rotation about it."
            if self._symbol is ROTATIONAL
            else "The kinetic energies of all parts add up.",
            definition=claims.difference(self._symbol, claims.POTENTIAL)
            if self.work.potential
            else self._symbol,
        )

    def energy(self) -> Found:
        return Found(
            sp.ImmutableMatrix([[self.whole]]),
            "The energy changes at the power of the generalised forces."
            if not self.work.acting.frame_rate
            else "In a turning frame the energy is replaced by Jacobi's integral.",
            (self.prove.vanishes(self._energy_rate, self.energy_claim),),
            definition=claims.total(
                self._symbol,
                is_jacobi=bool(self.work.acting.frame_rate),
                has_potential=bool(self.work.potential),
            ),
        )

    @cached_property
    def _energy_rate(self) -> RingMatrix:
        """dE/dt − q̇·(M q̈ + h) − ∂V/∂t; times a divisor if the coordinates depend on one another."""
        if self.work.is_bound:
            rate, divisor = self.rate(self.whole)
            power = self.work.q_dot.T @ self.work.codec.column(self.work.forces)
            return rate - (power + self.driving).scale(divisor)
        work = self.work
        left = work.mass_matrix @ work.codec.column(work.accelerations) + work.bias  # M q̈ + h
        power = work.q_dot.T @ left
        return self._scalar(self.whole).dt() - power - self.driving

    def generalised_momenta(self) -> Found:
        if not self.is_holonomic:
            return _NONE
        slopes = self.codec.column([sp.diff(self.kinetic, rate) for rate in self.work.rates])
        residual = slopes - self.work.momenta
        return Found(
            self.present.matrix(self.work.momenta),
            "The generalised momenta are the derivatives of the kinetic energy by the rates.",
            (self.prove.vanishes(residual, claims.momenta_are_slopes(self._symbol)),),
            definition=None if self._symbol is ROTATIONAL else claims.slopes(self._symbol),
        )

    def mass_matrix(self) -> Found:
        work = self.work
        twice = work.q_dot.T @ work.mass_matrix @ work.q_dot
        residual = twice - self._scalar(2 * self._half(shifted=False))
        is_whole = not work.acting.frame_rate
        return Found(
            self.present.matrix(work.mass_matrix),
            "The kinetic energy is a quadratic form in the rates."
            if is_whole
            else "The part of the kinetic energy that is quadratic in the rates.",
            (self.prove.vanishes(residual, claims.twice_energy(self._symbol, is_whole=is_whole)),),
            definition=None if self._symbol is ROTATIONAL else claims.SUM_OF_PARTS,
        )

    def coriolis_matrix(self) -> Found:
        """By Christoffel's symbols of M."""
        work = self.work
        if not self.is_holonomic or work.acting.frame_rate or work.is_bound:
            return _NONE
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
        matrix = RingMatrix.of(work.ring, rows)
        skew = work.mass_matrix.dt() - matrix - matrix
        of_bias = matrix @ work.q_dot - work.gyroscopic
        return Found(
            self.present.matrix(matrix),
            "Christoffel's symbols of the mass matrix give the terms that are quadratic in the "
            "rates.",
            (
                self.prove.vanishes(of_bias, claims.CORIOLIS),
                self.prove.vanishes(skew + skew.T, claims.SKEW),
            ),
        )

    def bias_vector(self) -> Found:
        work = self.work
        claim = claims.lagrange_is_euler(self._symbol)
        return Found(
            self.present.matrix(work.bias),
            "What remains of Lagrange's equations without the accelerations and the forces."
            if self.is_holonomic
            else "The constraint forces do no work on motions that the rolling allows; so says "
            "d'Alembert's principle.",
            (self.prove.vanishes(self._of_lagrange, claim),)
            if self.is_holonomic and not work.is_bound
            else (),
        )

    def accelerations(self) -> Found:
        work = self.work
        above, below = work.solved
        found = self.present.matrix(above, below)
        if work.is_bound:
            because = (
                "The coordinates depend on one another. The equations of motion hold for the "
                "displacements that are possible, on which constraint forces do no work, and are "
                "solved for the accelerations."
            )
            proofs, definition = tuple(self._along_possible()), claims.ACCELERATIONS_OF_RATES
            return Found(found, because, proofs, definition=definition)
        residual = self._left_over
        return Found(
            found,
            "The equations of motion are solved for the accelerations.",
            (self.prove.vanishes(residual, claims.EQUATIONS, divided_by=below),),
        )

    @property
    def _left_over(self) -> RingMatrix:
        """M q̈ + h − Q for the accelerations found, times their divisor."""
        work = self.work
        above, below = work.solved
        bias = work.bias - work.codec.column(work.forces)
        return work.mass_matrix @ above + bias.scale(below)

    def hamiltonian(self) -> Found:
        """H(q, p), with the momenta as inputs in a ring of their own."""
        work = self.work
        if not self.is_holonomic or work.acting.frame_rate or work.is_bound:
            return _NONE
        residual = work.momenta.T @ work.mass_matrix.adjugate() @ work.momenta
        residual -= self._scalar(2 * self.kinetic).scale(work.mass_matrix.det())
        proof = self.prove.vanishes(
            residual, claims.HAMILTONIAN_IS_ENERGY, divided_by=work.mass_matrix.det()
        )
        return Found(
            sp.ImmutableMatrix([[self._in_momenta(self.arguments["momenta"].symbols)]]),
            "The Hamiltonian is the energy in terms of the momenta.",
            (proof,),
        )

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
    def _single(self) -> int | None:
        """The position of the only coordinate that moves if the others are ignorable."""
        constant = {integral.name for integral in self.own_integrals()}
        names = [q.func.__name__ for q in self.model.coordinates]
        moving = [k for k, name in enumerate(names) if f"momentum_{name}" not in constant]
        if not self.is_holonomic or len(moving) != 1 or self.work.acting.frame_rate:
            return None
        (k,) = moving
        is_apart = not any(self.work.mass_matrix[k, j] for j in range(len(names)) if j != k)
        return k if is_apart and len(names) > 1 else None  # p_k = 0 means that it is at rest

    @cached_property
    def _effective(self) -> sp.Expr:
        momenta = self.arguments["momenta"].symbols
        return self._in_momenta(
            [sp.S.Zero if j == self._single else p for j, p in enumerate(momenta)]
        )

    def effective_potential(self) -> Found:
        """H with the only momentum that changes put to 0, if all the others are constant."""
        if self._single is None:
            return _NONE
        return Found(
            sp.ImmutableMatrix([[self._effective]]),
            "All momenta but one are constant. What remains of the Hamiltonian if this one is 0 "
            "is the effective potential of its coordinate.",
        )

    def consequences(self) -> Iterator[Consequence]:
        yield from super().consequences()
        k = self._single
        if k is None or self.forces.leave_free(self.model) or not self.driving.is_zero():
            return  # the free body is known; in a driving potential the energy is not constant
        q = self.model.coordinates
        momenta = self.present.matrix(self.work.momenta)
        others = [j for j in range(len(q)) if j != k]
        found = Reduced(
            name=self.model.name,
            coordinate=q[k],
            ignorable=tuple(q[j] for j in others),
            mass=self.present.matrix(self.work.mass_matrix)[k, k],
            potential=self._effective,
            symbols=tuple(self.arguments["momenta"].symbols[j] for j in others),
            momenta=tuple(momenta[j] for j in others),
            energy=self.whole,
            acceleration=self.present.matrix(*self.work.solved)[k],
        )
        yield found.one_dimension()
        yield from found.others()
        yield from found.steady()
        yield from Cosine(found).consequences()

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
        if not any(work.forces) and self.driving.is_zero():
            yield FirstIntegral(
                name="energy",
                symbol=claims.ENERGY,
                expression=self.whole,
                proof=self.prove.vanishes(self._energy_rate, claims.is_constant(claims.ENERGY)),
            )
        if work.is_bound:
            return
        if not self.is_holonomic:
            return
        momenta = self.present.matrix(work.momenta)
        for k, q in enumerate(work.model.coordinates):
            if work.forces[k] == 0 and not work.gradient[k]:
                slope = RingMatrix.of(work.ring, [self._slopes.rows[k]])
                if slope.is_zero():
                    yield FirstIntegral(
                        name=f"momentum_{q.func.__name__}",
                        symbol=self.arguments["momenta"].notation[k],
                        expression=momenta[k],
                        proof=self.prove.vanishes(slope, claims.momentum_is_constant(k + 1)),
                    )
