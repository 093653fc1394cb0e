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
from rigidsym.formula.tree import Formula
from rigidsym.mechanics.derivation import Consequence, Proof
from rigidsym.mechanics.dynamics.consequences import OneDimension
from rigidsym.mechanics.dynamics.euler import EulerEquations
from rigidsym.mechanics.dynamics.flow import Flow, LagrangeForm, StateBlock, turned
from rigidsym.mechanics.dynamics.tree import TreeEquations
from rigidsym.mechanics.kinematics.chain import Chain
from rigidsym.mechanics.kinematics.workspace import Values
from rigidsym.models.body import RigidBody
from rigidsym.models.forces import Forces
from rigidsym.models.rotation import OMEGA_BODY, TIME, RotationModel


def equations_of_motion(
    model: RotationModel, body: RigidBody, forces: Forces, chain: Chain | None = None
) -> Flow:
    """Lagrange's equations for free coordinates, else Euler's, unless one is asked for.

    Those of a `chain`, or of a body that other parts move with, are in names.
    """
    # A body has three degrees of freedom; in a tree every joint may carry one.
    is_spare = not forces.parts and len(model.coordinates) > 3
    if is_spare and chain is not None and not forces.method:
        raise ModelError(
            f"{model.name}: {len(model.coordinates)} turns are too many for the three degrees of "
            'freedom of one body; expected `parts` with inertia, or method = "euler"'
        )
    is_dependent = is_spare or is_bound(model)
    if (forces.method or ("euler" if is_dependent else "lagrange")) == "euler":
        return EulerEquations(model, body, forces)
    if is_dependent:
        raise ModelError(
            f"{model.name}: Lagrange's equations need independent coordinates, such as Euler "
            'angles; expected such a rotation, or method = "euler"'
        )
    if chain is not None or forces.parts:
        taken = (parameter.symbol.name for parameter in body.parameters)
        return TreeEquations(model, body, forces, chain or Chain(model, taken))
    return LagrangeEquations(model, body, forces)


def is_bound(model: RotationModel) -> bool:
    """Whether coordinates depend on one another, or do not matter, as the length of q."""
    is_spare = not model.turns and len(model.coordinates) > 3
    return bool(model.constraints) or model.pullback is not None or is_spare


class LagrangeEquations(LagrangeForm):
    """The steps of a rotation, a body and the forces on it, multiplied out over one ring."""

    def __init__(self, model: RotationModel, body: RigidBody, forces: Forces) -> None:
        q, values = model.coordinates, Values(model)
        rates, self.accelerations = ([sp.diff(x, TIME, n) for x in q] for n in (1, 2))
        self._jacobian = values.codec.decoded(values.rate_matrix("body"))
        # The power of a torque is N′·Ω′ = N′·W′ q̇ = (W′ᵀ N′)·q̇, so W′ᵀ N′ is its generalised
        # force.
        omega = self._jacobian * sp.Matrix(rates)
        in_rates = dict(zip(OMEGA_BODY, omega, strict=True))
        torque = sp.Matrix(forces.torque or [0, 0, 0]).xreplace(in_rates)
        generalised = [
            forces.generalised.get(x, sp.S.Zero).xreplace(in_rates) + part
            for x, part in zip(q, self._jacobian.T * torque, strict=True)
        ]
        gradient = [sp.diff(forces.potential, x) for x in q]
        # One ring for everything that the steps below combine.
        entries = [*self._jacobian, *body.inertia, *omega, sp.Rational(1, 2), forces.potential]
        entries += [*gradient, *generalised, *rates]
        entries += [*forces.first_integrals.values(), *self.accelerations]
        codec = codec_for([e for e in entries if e != 0], order=2)
        super().__init__(model, body, forces, codec)
        self.ring = codec.ring
        self.jacobian, self.inertia = codec.matrix(self._jacobian), codec.matrix(body.inertia)
        self.q_dot, self.q_ddot = codec.column(rates), codec.column(self.accelerations)
        self.omega = self.jacobian @ self.q_dot  # Ω′ of the body
        self.gradient = codec.column(gradient)  # ∂V/∂q
        self.generalised = codec.column(generalised)  # Q

    def slopes(self, element: PolyElement) -> RingMatrix:
        """The derivatives by q, a column, by the chain rule over the generators of the ring."""
        # ∂f/∂qₖ = Σ_g (∂f/∂g)(∂g/∂qₖ) over the generators g that depend on q. The ring's derivation
        # gives ġ = Σₖ (∂g/∂qₖ) q̇ₖ, so ∂g/∂qₖ is the coefficient of q̇ₖ in ġ.
        ring, rates = self.ring, [self.ring.index[rate] for rate in self.rates]
        last = {*rates, *(ring.index[a] for a in self.accelerations)}
        moving = [k for k in range(len(ring.generators)) if k not in last]
        parts = [(element.diff(k), ring.dt(ring.generator(k))) for k in moving]
        columns = ([(part, rate.diff(k)) for part, rate in parts if part] for k in rates)
        return RingMatrix.column(ring, map(ring.dot, columns))

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
        # dΩ′/dt = W′ q̈ + Ẇ′ q̇; the first part belongs to M q̈, the second to h.
        inner = self.inertia @ (self.jacobian.dt() @ self.q_dot)
        return self.jacobian.T @ (inner + turned(self.inertia, self.omega))

    @cached_property
    def bias(self) -> RingMatrix:
        return self.gyroscopic + self.gradient

    @cached_property
    def needed(self) -> RingMatrix:
        """Q − h."""
        return self.generalised - self.bias

    @cached_property
    def solved(self) -> Inverse:
        """(n, d) with q̈ = n/d, from M q̈ = Q − h.

        Raises ModelError if the mass matrix has no inverse.
        """
        if len(self.rates) == 3:
            # by Euler's equations: W′ q̈ = dΩ′/dt − dW′/dt q̇
            jacobian, tensor = self.jacobian, self.inertia
            # q̈ = W′⁻¹ (I′⁻¹ (W′⁻ᵀ (Q − ∂V/∂q) − Ω′ × I′ Ω′) − Ẇ′ q̇), each inverse as the
            # adjugate over the determinant.
            back, divisor, size = jacobian.adjugate(), jacobian.det(), tensor.det()
            slopes = jacobian.dt() @ self.q_dot
            inner = tensor.adjugate() @ turned(tensor, self.omega) + slopes.scale(size)
            applied = self.generalised - self.gradient
            # Without forces W′⁻ᵀ does not occur, and one factor det W′ less stands below.
            if applied.is_zero():
                above = back @ inner.scale(-self.ring.one)
                below = self.ring.reduce(size * divisor)
            else:
                torque = tensor.adjugate() @ (back.T @ applied)
                above = back @ (torque - inner.scale(divisor))
                below = self.ring.reduce(size * divisor * divisor)
        else:
            # W′ is not square if fewer than three coordinates turn the body.
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
        return (self.q, self.q_dot, self.ring.one), (self.rates, *self.solved)

    @cached_property
    def kinetic(self) -> sp.Expr:
        """T = ½ Ω′ᵀ I′ Ω′, the squares kept."""
        return half_form(self.present, self.inertia, self.omega)

    @cached_property
    def of_lagrange(self) -> RingMatrix:
        """d/dt ∂T/∂q̇ − ∂T/∂q − (M q̈ + h − ∂V/∂q)."""
        # The left side is taken from T by its definition, the right side from the formulas for M
        # and h.
        turning = self.mass_matrix @ self.q_ddot
        return self.momenta.dt() - self._slopes - turning - self.gyroscopic

    @cached_property
    def _slopes(self) -> RingMatrix:
        """∂T/∂q."""
        return self.slopes(self.codec.encode(self.kinetic))

    def energy_rate(self, value: sp.Expr) -> RingMatrix:
        """dE/dt − q̇·(M q̈ + h) − ∂V/∂t."""
        # dE/dt = q̇·(M q̈ + h) + ∂V/∂t for any q̈, whether or not it obeys the equations of motion.
        moving = self.mass_matrix @ self.q_ddot + self.bias
        return self.codec.column([value]).dt() - self.q_dot.T @ moving - self.driving

    @property
    def hamiltonian(self) -> sp.Expr:
        """H(q, p), with the momenta as inputs in a ring of their own."""
        return self._in_momenta(self.arguments["momenta"].symbols)

    @property
    def energy_by_momenta(self) -> RingMatrix:
        """(pᵀ M⁻¹ p − 2T) det M."""
        # With p = M q̇, pᵀ M⁻¹ p = q̇ᵀ M q̇ = 2T.
        above = self.momenta.T @ self.mass_matrix.adjugate() @ self.momenta
        return above - self.codec.column([2 * self.kinetic]).scale(self.mass_matrix.det())

    def _in_momenta(self, momenta: Sequence[sp.Expr]) -> sp.Expr:
        """½ pᵀ M⁻¹ p + V."""
        potential = self.forces.potential
        entries = [*self._jacobian, *self.body.inertia, sp.Rational(1, 2), potential, *momenta]
        codec = codec_for([entry for entry in entries if entry != 0], order=0)
        jacobian = codec.matrix(self._jacobian)
        own = jacobian.T @ codec.matrix(self.body.inertia) @ jacobian
        p = codec.column(momenta)
        twice = p.T @ own.adjugate() @ p
        half = presenter_for(codec).matrix(twice, codec.encode(sp.Integer(2)) * own.det())
        return half[0] + potential

    @cached_property
    def single(self) -> int | None:
        """The position of the only coordinate that moves if the others are ignorable."""
        # A coordinate whose momentum is constant is ignorable; exactly one other may be left.
        constant = {integral.name for integral in self.own_integrals()}
        moving = [k for k, q in enumerate(self.q) if f"momentum_{q.func.__name__}" not in constant]
        if len(moving) != 1 or len(self.q) == 1:
            return None
        (k,) = moving
        others = [j for j in range(len(self.q)) if j != k]
        if self.forces.potential.has(*(self.q[j] for j in others)):
            return None  # it is written with them, though it does not depend on them
        # p_k = 0 has to mean that it is at rest
        return None if any(self.mass_matrix[k, j] for j in others) else k

    @cached_property
    def effective(self) -> sp.Expr:
        """V_eff, the Hamiltonian with the only coordinate that moves at rest."""
        # H = p_k²/(2m) + V_eff if M does not couple q_k to the others, so V_eff is H at p_k = 0.
        momenta = enumerate(self.arguments["momenta"].symbols)
        return self._in_momenta([sp.S.Zero if j == self.single else p for j, p in momenta])

    def consequences(self) -> Iterator[Consequence]:
        yield from super().consequences()
        k = self.single
        # the free body is known; in a driving potential the energy is not constant
        if k is not None and not self.forces.leave_free(self.model) and self.driving.is_zero():
            yield from OneDimension(self, k).consequences()

    def in_state(self, value: sp.Expr) -> sp.Expr:
        """Ω′ = W′ q̇."""
        return value.xreplace(dict(zip(OMEGA_BODY, self.present.matrix(self.omega), strict=True)))

    @cached_property
    def power(self) -> RingMatrix:
        return self.q_dot.T @ self.generalised

    def energy_is_constant(self, claim: Formula) -> Proof:
        return self.prove.vanishes(self.energy_rate(self.whole) + self.power, claim)

    def momentum_is_constant(self, k: int, claim: Formula) -> Proof | None:
        """If neither T nor what acts depends on the coordinate; they may not cancel each other."""
        # ṗₖ = ∂T/∂qₖ + Qₖ − ∂V/∂qₖ
        applied = self.generalised[k, 0] - self.gradient[k, 0]
        if applied or self._slopes[k, 0]:
            return None
        return self.prove.vanishes(self.scalar(self._slopes[k, 0] + applied), claim)
