"""Euler's equations of one body on any rotation, with the state y = (q, Ω′).

    q̇ = W′⁻¹ Ω′,  dΩ′/dt = I′⁻¹ (N′ − Ω′ × I′ Ω′),  N′ = N′_given + W′⁻ᵀ (Q − ∂V/∂q)

The torque of a potential follows from its power, N′·Ω′ = −dV/dt. No coordinate has to be free, so
that quaternions and rotation vectors will do.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property

import sympy as sp
from sympy.polys.rings import PolyElement

from rigidsym.algebra.codec import codec_for
from rigidsym.algebra.matrix import RingMatrix
from rigidsym.algebra.present import half_form
from rigidsym.errors import ModelError
from rigidsym.formula.reader import formula
from rigidsym.mechanics.derivation import FirstIntegral
from rigidsym.mechanics.dynamics.flow import Flow, StateBlock, slopes_of, solved_euler
from rigidsym.mechanics.kinematics.workspace import Values
from rigidsym.mechanics.quantities import dynamics as claims
from rigidsym.models.body import RigidBody
from rigidsym.models.forces import Forces
from rigidsym.models.rotation import OMEGA_BODY, TIME, RotationModel, hat


class EulerEquations(Flow):
    """The steps of one rotation, one body and the torque on it."""

    table = claims.EULER_QUANTITIES
    second = "omega_body"
    kind = ("euler",)
    lacking = ()

    def __init__(self, model: RotationModel, body: RigidBody, forces: Forces) -> None:
        """Raises ModelError for parts, and if there is no q̇ = U Ω′."""
        if forces.parts:
            raise ModelError(
                f"{model.name}: Euler's equations hold for one body; expected independent "
                'coordinates, such as Euler angles, and method = "lagrange"'
            )
        rotation = Values(model)
        solved = rotation.inverse("body")
        if solved is None:
            raise ModelError(
                f"{model.name}: Euler's equations need coordinates whose rates follow from the "
                "angular velocity"
            )
        inverse, divisor = solved
        self._inverse = rotation.codec.decoded(inverse)
        self.divisor = rotation.codec.decode(divisor)
        self._matrix = rotation.model.matrix
        q = model.coordinates
        # Rates in given forces are replaced by q̇ = W′⁻¹ Ω′, as they are not part of this state.
        turning = self._inverse * sp.Matrix(OMEGA_BODY) / self.divisor
        rates = {sp.diff(x, TIME): rate for x, rate in zip(q, turning, strict=True)}
        self._gradient = [sp.diff(forces.potential, x) for x in q]
        self._forces = [forces.generalised.get(x, sp.S.Zero).xreplace(rates) for x in q]
        # On more turns than degrees of freedom, one attitude has many coordinates, of which forces
        # may depend otherwise.
        is_spare = len(model.turns) > 3 and any((*self._gradient, *self._forces))
        self._rate_matrix = rotation.codec.decoded(rotation.rate_matrix("body")) if is_spare else ()
        self._torque = [n.xreplace(rates) for n in forces.torque or (sp.S.Zero,) * 3]
        entries = [*self._inverse, self.divisor, *self._matrix, *self._rate_matrix, *body.inertia]
        entries += [forces.potential, *self._gradient, *self._forces, *self._torque]
        entries += [*OMEGA_BODY, *forces.first_integrals.values()]
        codec = codec_for([e for e in entries if e != 0], constraints=model.constraints, order=1)
        super().__init__(model, body, forces, codec)

    @cached_property
    def omega(self) -> RingMatrix:
        return self.codec.column(OMEGA_BODY)

    @cached_property
    def torque(self) -> tuple[RingMatrix, sp.Expr]:
        """N′ as a numerator and its divisor."""
        given = self.codec.column(self._torque)
        acting = [q - v for q, v in zip(self._forces, self._gradient, strict=True)]
        if not any(acting):
            return given, self.codec.ring.one
        # The powers are equal for every Ω′, N′·Ω′ = (Q − ∂V/∂q)·q̇ = (Q − ∂V/∂q)·W′⁻¹ Ω′, so
        # N′ = W′⁻ᵀ (Q − ∂V/∂q).
        below = self.codec.encode(self.divisor)
        turning = self.codec.matrix(self._inverse).T @ self.codec.column(acting)
        if self._rate_matrix:
            generalised = self.codec.matrix(self._rate_matrix).T @ turning
            if not (generalised - self.codec.column(acting).scale(below)).is_zero():
                raise ModelError(
                    f"{self.model.name}: the potential or the generalised forces depend on more "
                    "than the attitude of the body, which has many coordinates on "
                    f"{len(self.model.turns)} turns; expected a potential of the attitude, such "
                    "as a weight, or `torque`"
                )
        return given.scale(below) + turning, below

    @cached_property
    def blocks(self) -> tuple[StateBlock, StateBlock]:
        rates = self.codec.matrix(self._inverse) @ self.omega
        slopes, below = solved_euler(self.inertia, self.omega, *self.torque)
        turning = (self.model.coordinates, rates, self.codec.encode(self.divisor))
        return turning, (OMEGA_BODY, slopes, below)

    @cached_property
    def whole(self) -> sp.Expr:
        return half_form(self.present, self.inertia, self.omega) + self.forces.potential

    def energy_rate(self, value: sp.Expr) -> tuple[RingMatrix, PolyElement]:
        """dE/dt less ∂V/∂t and the power of what the potential does not account for."""
        rate, divisor = self.rate(value)
        below = self.codec.encode(self.divisor)
        # The gradient of V is left out: its power is part of dE/dt through V itself.
        forced = self.codec.matrix(self._inverse).T @ self.codec.column(self._forces)
        power = self.omega.T @ (self.codec.column(self._torque).scale(below) + forced)
        left = (rate - self.driving.scale(divisor)).scale(below) - power.scale(divisor)
        return left, divisor

    @property
    def error_state_jacobian(self) -> sp.ImmutableMatrix:
        """dδθ/dt = δΩ′ − Ω′ × δθ, and of dΩ′/dt the slopes by q, with δq = W′⁻¹ δθ, and by Ω′."""
        q, y = self.model.coordinates, self.arguments["y"].symbols
        slopes = self.state_derivative[len(q) :]
        by_q, by_omega = (
            sp.ImmutableMatrix([slopes_of(slope, part, y) for slope in slopes])
            for part in (q, OMEGA_BODY)
        )
        # The error state (δθ, δΩ′) has no redundant component: δθ is a small turn in the body. From
        # dδθ/dt + Ω′ × δθ = δΩ′, the first rows are (−C(Ω′), 1).
        turned = by_q * self._inverse / self.divisor
        upper = sp.Matrix.hstack(-hat(sp.ImmutableMatrix(OMEGA_BODY)), sp.eye(3))
        return sp.ImmutableMatrix(upper.col_join(sp.Matrix.hstack(turned, by_omega)))

    def own_integrals(self) -> Iterator[FirstIntegral]:
        """Those of the energy and the angular momentum, in space and along the body's axes, that
        do not change.
        """
        # L = R I′ Ω′ in space is constant without a torque. The components along the axes of the
        # body are constant only by symmetry, as L′₃ of a symmetric top.
        momentum = self.inertia @ self.omega
        in_body = self.present.matrix(momentum)
        squared = sp.Add(*(entry**2 for entry in in_body))
        candidates = [
            ("energy", claims.ENERGY, self.whole),
            ("angular_momentum_squared", claims.MOMENTUM_SQUARED, squared),
        ]
        along = [("angular_momentum_body", "L'_{}", in_body)]
        if self.model.pullback is None:  # else R and its derivatives are long in this ring
            in_space = self.present.matrix(self.codec.matrix(self._matrix) @ momentum)
            along.insert(0, ("angular_momentum", "L_{}", in_space))
        for name, typed, entries in along:
            for k, entry in enumerate(entries, start=1):
                candidates.append((f"{name}_{k}", formula(typed.format(k)), entry))
        for name, symbol, value in candidates:
            residual, divisor = self.rate(value)
            if residual.is_zero():
                proof = self.prove.vanishes(residual, claims.is_constant(symbol), divisor)
                yield FirstIntegral(name=name, symbol=symbol, expression=value, proof=proof)
