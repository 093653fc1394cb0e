"""R → dR/dt → dR/dt Rᵀ → Ω → Ω′, rate matrices and their inverses, angular accelerations.

One algorithm for every rotation model, in the model's ring (lecture, eq. 15 and 16).
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping
from types import MappingProxyType

from sympy.polys.rings import PolyElement

from rigidsym.algebra.matrix import RingMatrix, hat
from rigidsym.formula.tree import Formula
from rigidsym.mechanics.derivation import Found, Proof
from rigidsym.mechanics.kinematics.vector_forms import applied_form, matrix_form, vector_form
from rigidsym.mechanics.kinematics.workspace import Inverse, Values
from rigidsym.mechanics.quantities import claims
from rigidsym.mechanics.quantities.kinematics import (
    ALPHA,
    ALPHA_BODY,
    BODY,
    COSINES,
    RATES,
    ROTATION,
    SPACE,
    Frame,
)


def steps(values: Values, only: Collection[str] = ()) -> Iterator[tuple[str, Found]]:
    """(name, what was found) of the quantities that are wanted and that the model has.

    The matrix is proved to be a rotation in any case: all else rests on it. Raises NotARotation
    if R Rᵀ ≠ 1 or det R ≠ 1, showing what is left over.
    """
    work = _Kinematics(values)
    rotation = work.rotation_matrix()
    for name, find in _STEPS.items():
        if not only or name in only:
            found = rotation if name == "rotation_matrix" else find(work)
            if found is not None:
                yield name, found


class _Kinematics:
    """The steps of one derivation; each is worked out by its own method."""

    def __init__(self, values: Values) -> None:
        self.values = values
        self.model = values.model
        self.present, self.prove = values.present, values.prove

    def rotation_matrix(self) -> Found:
        values, symbol = self.values, self._shown_symbol
        residual = self._shown(values.R).gram() - values.one
        determinant = values.column([values.R.det() - 1])
        proofs = (
            self.prove.is_rotation(residual, claims.orthogonal(symbol)),
            self.prove.is_rotation(determinant, claims.proper(symbol)),
        )
        return self._matrix(
            self._shown(values.R),
            self._given_as(),
            *proofs,
            symbol=symbol,
        )

    def _given_as(self) -> str:
        """Where the matrix that is shown comes from."""
        if self.model.passive:
            if not self.model.turns:
                return "The rotation matrix is given; the direction cosine matrix is its transpose."
            return "The direction cosine matrix is the transpose of the product of the turns."
        match len(self.model.turns):
            case 0:
                return "The rotation matrix is given."
            case 1:
                return "The rotation is a single turn."
        return "Multiplying the matrices of the turns gives the rotation matrix."

    def rotation_rate(self) -> Found:
        spin = self._shown_spin
        return Found(
            self.present.matrix(self._shown(self.values.R_dot)),
            "The chain rule gives the time derivative of each entry.",
            (self.prove.vanishes(spin + spin.T, claims.stays_orthogonal(self._shown_symbol)),),
        )

    def spin_matrix(self) -> Found:
        spin, symbol = self._shown_spin, claims.spin_of(self._shown_symbol)
        proofs = [self.prove.vanishes(spin + spin.T, claims.skew(symbol))]
        because = "Multiplying the derivative by the transpose gives a skew matrix"
        if self.model.passive:
            operator = claims.is_operator(BODY.omega, symbol, "-")
            proofs.append(self.prove.vanishes(spin + hat(self.values.omega_body), operator))
            because += ", and it is the operator of −Ω′, not of Ω"
        return Found(self.present.matrix(spin), f"{because}.", tuple(proofs))

    def angular_velocity_space(self) -> Found:
        values = self.values
        because = "The components of Ω are the entries (3,2), (1,3) and (2,1) of this skew matrix."
        if self.model.passive:
            because = (
                "The derivative of the transpose times the matrix is the operator of Ω, as "
                "the transpose is R. " + because
            )
        claim = claims.is_operator(SPACE.omega, claims.spin_of(ROTATION))
        proof = self.prove.vanishes(values.spin - hat(values.omega_space), claim)
        return self._vector(SPACE, values.omega_space, because, proof)

    def angular_velocity_body(self) -> Found:
        values = self.values
        return self._vector(
            BODY,
            values.omega_body,
            f"Multiplying by {'A' if self.model.passive else 'Rᵀ'} gives the components along the "
            "axes of the body.",
            self.prove.vanishes(
                values.R @ values.omega_body - values.omega_space,
                claims.rotates(ROTATION, BODY.omega, SPACE.omega),
            ),
        )

    def rate_matrix(self, frame: Frame, matrix: RingMatrix, omega: RingMatrix) -> Found:
        residual = matrix @ self.values.argument("q_dot") - omega
        claim = claims.maps_rates(frame.matrix, RATES, frame.omega)
        return self._matrix(
            matrix,
            self._columns_in_words(frame)
            if len(self.model.coordinates) > 1
            else "The angular velocity is the rate times the axis of the turn.",
            self.prove.vanishes(residual, claim),
            symbol=frame.matrix,
        )

    def _columns_in_words(self, frame: Frame) -> str:
        turns = [turn.angle for turn in self.model.turns]
        if turns and all(a == q for a, q in zip(turns, self.model.coordinates, strict=False)):
            where = "in space" if frame is SPACE else "in the body"
            return (
                "The angular velocity depends linearly on the rates; the columns of the rate "
                f"matrix are the axes of the turns, with their components {where}."
            )
        return (
            "The angular velocity depends linearly on the rates; the columns of the rate matrix "
            "are their coefficients."
        )

    def inverse(self, frame: Frame, matrix: RingMatrix, inverse: Inverse | None) -> Found | None:
        if inverse is None:
            return None
        above, below = inverse
        proof = self.prove.vanishes(
            matrix @ above - self.values.one.scale(below),
            claims.inverse_of(frame.matrix, self._inverse_symbol(frame)),
            divided_by=below,
        )
        return self._matrix(
            above,
            "The inverse gives the rates for a known angular velocity, for example one measured by "
            "gyroscopes; it is the adjugate divided by the determinant."
            if matrix.shape == (3, 3)
            else self._of_all_rates(),
            proof,
            symbol=self._inverse_symbol(frame),
            below=below,
        )

    def _of_all_rates(self) -> str:
        is_bound = self.values.bound is not None
        if is_bound:
            return "The rates that satisfy the conditions on the coordinates are unique."
        return (
            "The rates are not unique, since there are more coordinates than components of the "
            "angular velocity; we choose the smallest."
        )

    def rates(self, frame: Frame, matrix: RingMatrix, inverse: Inverse | None) -> Found | None:
        if inverse is None:
            return None
        above, below = inverse
        given = self.values.argument(f"omega_{frame.name}")
        rates = above @ given
        proof = self.prove.vanishes(
            matrix @ rates - given.scale(below),
            claims.solves(frame.matrix, self._inverse_symbol(frame), frame.omega),
            divided_by=below,
        )
        form = applied_form(
            self.prove, self.model.vector, above, below, RATES, to=(frame.omega, given)
        )
        return Found(
            self.present.matrix(rates, below),
            "It takes a given angular velocity to the rates, which can then be integrated.",
            (proof,) if form is None else (proof, form.proof),
            form,
        )

    def angular_acceleration_space(self) -> Found:
        space = self.values.omega_space.dt()
        claim = claims.is_operator(ALPHA, claims.rate_of_whole(claims.spin_of(ROTATION)))
        return Found(
            self.present.matrix(space),
            "The angular acceleration is the time derivative of the angular velocity.",
            (self.prove.vanishes(self.values.spin.dt() - hat(space), claim),),
        )

    def angular_acceleration_body(self) -> Found:
        values = self.values
        body = values.omega_body.dt()
        residual = values.R @ body - values.omega_space.dt()
        claim = claims.rotates(ROTATION, ALPHA_BODY, ALPHA)
        return Found(
            self.present.matrix(body),
            "In the body frame it is enough to differentiate the components of Ω′, since "
            "Ω × Ω vanishes.",
            (self.prove.vanishes(residual, claim),),
        )

    def _matrix(
        self,
        matrix: RingMatrix,
        because: str,
        *proofs: Proof,
        symbol: Formula,
        below: PolyElement | None = None,
    ) -> Found:
        """A matrix over `below`, also as a function of the vector if it is one."""
        over = self.values.ring.one if below is None else below
        form = matrix_form(self.prove, self.model.vector, matrix, over, symbol)
        proved = proofs if form is None else (*proofs, form.proof)
        return Found(self.present.matrix(matrix, below), because, proved, form)

    def _vector(self, frame: Frame, omega: RingMatrix, because: str, proof: Proof) -> Found:
        form = vector_form(self.prove, self.model.vector, omega, frame.omega)
        proofs = (proof,) if form is None else (proof, form.proof)
        return Found(self.present.matrix(omega), because, proofs, form)

    @property
    def _shown_symbol(self) -> Formula:
        return COSINES if self.model.passive else ROTATION

    def _shown(self, matrix: RingMatrix) -> RingMatrix:
        return matrix.T if self.model.passive else matrix

    @property
    def _shown_spin(self) -> RingMatrix:
        return self.values.spin_of_transpose if self.model.passive else self.values.spin

    def _inverse_symbol(self, frame: Frame) -> Formula:
        return frame.inverse if len(self.model.coordinates) == 3 else frame.right_inverse


_STEPS: Mapping[str, Callable[[_Kinematics], Found | None]] = MappingProxyType(
    {
        "rotation_matrix": _Kinematics.rotation_matrix,
        "rotation_rate": _Kinematics.rotation_rate,
        "spin_matrix": _Kinematics.spin_matrix,
        "angular_velocity_space": _Kinematics.angular_velocity_space,
        "angular_velocity_body": _Kinematics.angular_velocity_body,
        "rate_matrix_space": lambda work: work.rate_matrix(
            SPACE, work.values.rate_matrix_space, work.values.omega_space
        ),
        "inverse_rate_matrix_space": lambda work: work.inverse(
            SPACE, work.values.rate_matrix_space, work.values.inverse_space
        ),
        "rates_from_angular_velocity_space": lambda work: work.rates(
            SPACE, work.values.rate_matrix_space, work.values.inverse_space
        ),
        "rate_matrix_body": lambda work: work.rate_matrix(
            BODY, work.values.rate_matrix_body, work.values.omega_body
        ),
        "inverse_rate_matrix_body": lambda work: work.inverse(
            BODY, work.values.rate_matrix_body, work.values.inverse_body
        ),
        "rates_from_angular_velocity_body": lambda work: work.rates(
            BODY, work.values.rate_matrix_body, work.values.inverse_body
        ),
        "angular_acceleration_space": _Kinematics.angular_acceleration_space,
        "angular_acceleration_body": _Kinematics.angular_acceleration_body,
    }
)
