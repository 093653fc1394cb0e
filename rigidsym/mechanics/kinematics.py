"""R → dR/dt → dR/dt Rᵀ → Ω → Ω′, rate matrices and their inverses, angular accelerations.

One algorithm for every rotation model, in the model's ring (lecture, eq. 15 and 16).
"""

from __future__ import annotations

from collections.abc import Iterable

import sympy as sp
from sympy.polys.rings import PolyElement

from rigidsym.algebra.codec import codec_for
from rigidsym.algebra.matrix import RingMatrix
from rigidsym.algebra.present import presenter_for
from rigidsym.mechanics import claims
from rigidsym.mechanics.arguments import arguments_of
from rigidsym.mechanics.derivation import Derivation, Proof, Singularities, Step
from rigidsym.mechanics.prove import Prover
from rigidsym.mechanics.quantities import (
    ALPHA,
    ALPHA_BODY,
    BODY,
    COSINES,
    RATES,
    ROTATION,
    SPACE,
    Frame,
    quantities,
)
from rigidsym.mechanics.singularities import singularities_of
from rigidsym.models.rotation import RotationModel


def derive(model: RotationModel) -> Derivation:
    """The kinematics of a rotation model, each step proved.

    Raises NotARotation for a matrix with R Rᵀ ≠ 1 or det R ≠ 1, showing what is left over, and
    AlgebraError for expressions that the ring cannot hold.
    """
    work = _Kinematics(model)
    work.rotation()
    work.angular_velocity()
    for frame, omega in ((SPACE, work.omega), (BODY, work.omega_body)):
        work.rates(frame, omega)
    work.accelerations()
    return Derivation(
        name=model.name,
        title=model.title,
        model=model,
        arguments=tuple(work.arguments.values()),
        steps=tuple(work.steps),
        singularities=work.singularities(),
    )


class _Kinematics:
    """The derivation under way: ring values so far, and the steps that were taken."""

    def __init__(self, model: RotationModel) -> None:
        self.model = model
        self.arguments = {argument.name: argument for argument in arguments_of(model)}
        inputs = [s for name, a in self.arguments.items() if name != "q" for s in a.symbols]
        self.codec = codec_for([*model.matrix, *inputs], constraints=model.constraints, order=2)
        self.ring = self.codec.ring
        self.present = presenter_for(self.codec)
        self.prove = Prover(model, self.codec)
        self.quantities = quantities(passive=model.passive)
        self.steps: list[Step] = []
        self.one = RingMatrix.identity(self.ring, 3)
        self.R = self._encoded(model.matrix)
        self.R_dot = self.R.dt()
        self.spin = self.R_dot @ self.R.T
        self.shown_spin = self.R_dot.T @ self.R if model.passive else self.spin
        self.omega = _unhat(self.spin)
        self.omega_body = self.R.T @ self.omega

    def rotation(self) -> None:
        """R, or its transpose A, and its derivative."""
        passive = self.model.passive
        symbol = COSINES if passive else ROTATION
        shown, shown_dot = (self.R.T, self.R_dot.T) if passive else (self.R, self.R_dot)
        self._add(
            "rotation_matrix",
            self.present.matrix(shown),
            _first_sentence(self.model),
            self.prove.is_rotation(shown @ shown.T - self.one, claims.orthogonal(symbol)),
            self.prove.is_rotation(self._column([shown.det() - 1]), claims.proper(symbol)),
        )
        self._add(
            "rotation_rate",
            self.present.matrix(shown_dot),
            "The matrix is differentiated entry by entry, by the chain rule.",
            self.prove.vanishes(
                self.shown_spin + self.shown_spin.T, claims.stays_orthogonal(symbol)
            ),
        )

    def angular_velocity(self) -> None:
        """The spin matrix, Ω read off from it, and Ω′ = RᵀΩ (lecture, eq. 7 and 16)."""
        self._spin_step()
        self._add(
            "angular_velocity_space",
            self.present.matrix(self.omega),
            "The vector of a skew matrix stands in its entries (3,2), (1,3) and (2,1).",
            self.prove.vanishes(
                self.spin - _hat(self.omega),
                claims.is_operator(SPACE.omega, claims.spin_of(ROTATION)),
            ),
        )
        self._add(
            "angular_velocity_body",
            self.present.matrix(self.omega_body),
            "The components along the axes of the body follow by the transposed rotation.",
            self.prove.vanishes(
                self.R @ self.omega_body - self.omega,
                claims.rotates(ROTATION, BODY.omega, SPACE.omega),
            ),
        )

    def _spin_step(self) -> None:
        spin, passive = self.shown_spin, self.model.passive
        symbol = claims.spin_of(COSINES if passive else ROTATION)
        proofs = [self.prove.vanishes(spin + spin.T, claims.skew(symbol))]
        if passive:
            operator = claims.is_operator(BODY.omega, symbol, "-")
            proofs.append(self.prove.vanishes(spin + _hat(self.omega_body), operator))
        self._add(
            "spin_matrix",
            self.present.matrix(spin),
            "The derivative is multiplied by the transpose; the product is skew"
            + (", and it is the operator of −Ω′, not of Ω." if passive else "."),
            *proofs,
        )

    def rates(self, frame: Frame, omega: RingMatrix) -> None:
        """W with Ω = W q̇ in one frame and, where W is square, its inverse and q̇ from Ω."""
        q_dot = self._column(map(self.codec.encode, self.arguments["q_dot"].symbols))
        matrix = self._jacobian(omega)
        self._add(
            f"rate_matrix_{frame.name}",
            self.present.matrix(matrix),
            "The angular velocity is linear in the rates; their coefficients are the columns.",
            self.prove.vanishes(
                matrix @ q_dot - omega, claims.maps_rates(frame.matrix, RATES, frame.omega)
            ),
        )
        if matrix.shape == (3, 3) and matrix.det():
            self._solve(frame, matrix)

    def _solve(self, frame: Frame, matrix: RingMatrix) -> None:
        adjugate, determinant = matrix.adjugate(), matrix.det()
        self._add(
            f"inverse_rate_matrix_{frame.name}",
            self.present.matrix(adjugate, determinant),
            "The adjugate is divided by the determinant.",
            self.prove.vanishes(
                matrix @ adjugate - self.one.scale(determinant),
                claims.inverse_of(frame.matrix, frame.inverse),
                divided_by=determinant,
            ),
        )
        symbols = self.arguments[f"omega_{frame.name}"].symbols
        given = self._column(map(self.codec.encode, symbols))
        rates = adjugate @ given
        self._add(
            f"rates_from_angular_velocity_{frame.name}",
            self.present.matrix(rates, determinant),
            "The inverse rate matrix is applied to a given angular velocity.",
            self.prove.vanishes(
                matrix @ rates - given.scale(determinant),
                claims.solves(frame.matrix, frame.inverse, frame.omega),
                divided_by=determinant,
            ),
        )

    def accelerations(self) -> None:
        """dΩ/dt, and its body components, which are the derivatives of those of Ω′."""
        space = self.omega.dt()
        body = self.omega_body.dt()
        self._add(
            "angular_acceleration_space",
            self.present.matrix(space),
            "The space components of the angular velocity are differentiated.",
            self.prove.vanishes(
                self.spin.dt() - _hat(space),
                claims.is_operator(ALPHA, claims.rate_of_whole(claims.spin_of(ROTATION))),
            ),
        )
        self._add(
            "angular_acceleration_body",
            self.present.matrix(body),
            "Its body components are the derivatives of those of the angular velocity, since "
            "Ω × Ω vanishes.",
            self.prove.vanishes(self.R @ body - space, claims.rotates(ROTATION, ALPHA_BODY, ALPHA)),
        )

    def singularities(self) -> Singularities | None:
        """Where the rate matrix loses rank; None where it is not square or never has full rank."""
        matrix = self._jacobian(self.omega)
        if matrix.shape != (3, 3) or not matrix.det():
            return None
        return singularities_of(
            matrix, self.R, self.present, self.codec, self.arguments["q"].symbols
        )

    def _encoded(self, matrix: sp.MatrixBase) -> RingMatrix:
        rows = matrix.tolist()
        return RingMatrix.of(self.ring, [[self.codec.encode(e) for e in row] for row in rows])

    def _column(self, entries: Iterable[PolyElement]) -> RingMatrix:
        return RingMatrix.column(self.ring, entries)

    def _jacobian(self, omega: RingMatrix) -> RingMatrix:
        """∂Ω/∂q̇, by the generators of the rates themselves: a constraint may relate them."""
        ring = self.ring
        rates = [ring.generator(ring.index[rate]) for rate in self.arguments["q_dot"].symbols]
        return RingMatrix.of(self.ring, [[o.diff(rate) for rate in rates] for o in omega.entries])

    def _add(self, name: str, expression: sp.ImmutableMatrix, because: str, *proofs: Proof) -> None:
        self.steps.append(
            Step(
                number=len(self.steps) + 1,
                quantity=self.quantities[name],
                expression=expression,
                because=because,
                proofs=proofs,
            )
        )


def _unhat(skew: RingMatrix) -> RingMatrix:
    """C⁻¹: the vector of a skew matrix, from its entries below the diagonal (lecture, 3.2)."""
    return RingMatrix.column(skew.ring, [skew[2, 1], skew[0, 2], skew[1, 0]])


def _hat(vector: RingMatrix) -> RingMatrix:
    """C(u), the matrix of u ×, over the ring (lecture, section 3.2)."""
    x, y, z = vector.entries
    zero = vector.ring.zero
    return RingMatrix.of(vector.ring, [[zero, -z, y], [z, zero, -x], [-y, x, zero]])


def _first_sentence(model: RotationModel) -> str:
    if model.turns:
        return "The turns are multiplied from left to right."
    return "The rotation is given."
