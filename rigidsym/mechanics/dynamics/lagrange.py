"""Lagrange's equations of a body that turns about a fixed point, over one ring.

With Ω′ = W′ q̇ the kinetic energy is T = ½ Ω′ᵀ I′ Ω′, and the equations of motion are

    d/dt ∂T/∂q̇ − ∂T/∂q = W′ᵀ (I′ dΩ′/dt + Ω′ × I′ Ω′)          the left side is Lagrange's, the
    M q̈ + h = Q,  M = W′ᵀ I′ W′,                                right side Euler's
    h = W′ᵀ (I′ dW′/dt q̇ + Ω′ × I′ Ω′) + ∂V/∂q

The first line is proved in the ring; the others follow from it.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import sympy as sp

from rigidsym.algebra.codec import codec_for
from rigidsym.algebra.matrix import RingMatrix, cross
from rigidsym.errors import ModelError
from rigidsym.mechanics.kinematics.workspace import Inverse, Values, encoded, right_inverse
from rigidsym.models.body import RigidBody
from rigidsym.models.forces import Forces
from rigidsym.models.rotation import RotationModel
from rigidsym.models.so3 import TIME


def is_free(model: RotationModel) -> bool:
    """Whether there are three coordinates that nothing binds."""
    return not model.constraints and model.pullback is None and len(model.coordinates) == 3


class Lagrange:
    """T, V, p, M, h and the accelerations of one rotation, one body and one potential."""

    def __init__(
        self,
        model: RotationModel,
        body: RigidBody,
        forces: Forces,
    ) -> None:
        if not is_free(model):
            raise ModelError(
                f"{model.name}: Lagrange's equations need three free coordinates, such as the "
                "Euler angles; expected such a rotation, or Euler's equations"
            )
        fixed = dict.fromkeys(model.coordinates, sp.S.Zero)
        if TIME in forces.potential.xreplace(fixed).free_symbols:
            raise ModelError(f"{model.name}: the potential {forces.potential} depends on t")
        self.model, self.body, self.acting = model, body, forces
        self.potential = forces.potential
        self.rotation = Values(model)
        self.rates = [sp.diff(q, TIME) for q in model.coordinates]
        self.accelerations = [sp.diff(q, TIME, 2) for q in model.coordinates]
        self.forces = [forces.generalised.get(q, sp.S.Zero) for q in model.coordinates]
        self.gradient = [sp.diff(self.potential, q) for q in model.coordinates]
        decode = self.rotation.codec.decode
        matrix = self.rotation.rate_matrix_body
        self.rate_matrix = sp.ImmutableMatrix(3, 3, [decode(e) for e in matrix.entries])
        held = [*self.rate_matrix, *body.inertia, sp.Rational(1, 2), self.potential]
        held += [*self.gradient, *self.forces, *self.rates, *self.accelerations]
        held += [*forces.first_integrals.values()]
        self.codec = codec_for([entry for entry in held if entry != 0])
        self.ring = self.codec.ring

    def column(self, entries: Sequence[sp.Expr]) -> RingMatrix:
        return RingMatrix.column(self.ring, map(self.codec.encode, entries))

    @cached_property
    def W(self) -> RingMatrix:
        return encoded(self.codec, self.rate_matrix)

    @cached_property
    def inertia(self) -> RingMatrix:
        return encoded(self.codec, self.body.inertia)

    @cached_property
    def q_dot(self) -> RingMatrix:
        return self.column(self.rates)

    @cached_property
    def omega(self) -> RingMatrix:
        return self.W @ self.q_dot

    @cached_property
    def momentum_body(self) -> RingMatrix:
        """I′ Ω′."""
        return self.inertia @ self.omega

    @cached_property
    def momenta(self) -> RingMatrix:
        """p = ∂T/∂q̇ = W′ᵀ I′ Ω′."""
        return self.W.T @ self.momentum_body

    @cached_property
    def mass_matrix(self) -> RingMatrix:
        return self.W.T @ self.inertia @ self.W

    @cached_property
    def gyroscopic(self) -> RingMatrix:
        """I′ dW′/dt q̇ + Ω′ × I′ Ω′, what the body's own turning asks of the torque."""
        turning = self.inertia @ (self.W.dt() @ self.q_dot)
        turned = cross(self.ring, self.omega.entries, self.momentum_body.entries)
        return turning + RingMatrix.column(self.ring, turned)

    @cached_property
    def bias(self) -> RingMatrix:
        return self.W.T @ self.gyroscopic + self.column(self.gradient)

    @cached_property
    def solved(self) -> Inverse:
        """(n, d) with q̈ = n/d, from M q̈ = Q − h.

        Raises ModelError if the mass matrix has no inverse.
        """
        inverse = right_inverse(self.mass_matrix, None)
        if inverse is None:
            raise ModelError(f"{self.model.name}: the mass matrix has no inverse")
        above, below = inverse
        return above @ (self.column(self.forces) - self.bias), below
