"""R → dR/dt → dR/dt Rᵀ → Ω → Ω′, rate matrices and their inverses, angular accelerations.

What is claimed of each is the same however it is worked out: multiplied out in the model's ring, by
one algorithm for every rotation model (`Expanded`; lecture, eq. 15 and 16), or turn by turn.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Collection, Iterator
from functools import cached_property

from sympy.polys.rings import PolyElement

from rigidsym.algebra.matrix import RingMatrix, hat
from rigidsym.formula.tree import Formula
from rigidsym.mechanics.derivation import Found, Proof, VectorForm
from rigidsym.mechanics.kinematics.vector_forms import matrix_form, vector_form
from rigidsym.mechanics.kinematics.workspace import Values
from rigidsym.mechanics.quantities.kinematics import (
    BODY,
    COSINES,
    QUANTITY_NAMES,
    RATES,
    ROTATION,
    SPACE,
    Frame,
    laws,
)
from rigidsym.models.rotation import RotationModel

FRAMES = {"space": SPACE, "body": BODY}


class Kinematics(ABC):
    """The steps of one rotation, worked out in one of two ways."""

    def __init__(self, model: RotationModel) -> None:
        self.model = model
        self.symbol = COSINES if model.passive else ROTATION
        self.is_square = len(model.coordinates) == 3
        self.laws = laws(model.passive, self.is_square)

    def steps(self, only: Collection[str] = ()) -> Iterator[tuple[str, Found]]:
        """(name, what was found) of the quantities that are wanted and that the model has.

        The matrix is proved to be a rotation in any case: all else rests on it. Raises NotARotation
        if R Rᵀ ≠ 1 or det R ≠ 1, showing what is left over.
        """
        for name in QUANTITY_NAMES:
            if not only or name in ("rotation_matrix", *only):
                found = self.find(name)
                if found is not None and (not only or name in only):
                    yield name, found

    @abstractmethod
    def find(self, name: str) -> Found | None:
        """One quantity with its proofs; None if the model does not have it."""

    def inverse_symbol(self, frame: Frame) -> Formula:
        return frame.inverse if self.is_square else frame.right_inverse


def kind_and_frame(name: str) -> tuple[str, str]:
    """A quantity or a law without its frame, and the frame; "" if it has none."""
    kind, _, frame = name.rpartition("_")
    return (kind, frame) if frame in FRAMES else (name, "")


class Expanded(Kinematics):
    """The steps multiplied out, in the ring of the model."""

    def __init__(self, values: Values) -> None:
        super().__init__(values.model)
        self.values = values

    def find(self, name: str) -> Found | None:
        found = self._value(name)
        if found is None:
            return None
        matrix, below = found
        proofs = [self._holds(law, claim, matrix, below) for law, claim in self.laws[name]]
        form = self._form(name, matrix, below) if self.model.vector else None
        if form is not None:
            proofs.append(form.proof)
        shown = self.values.present.matrix(matrix, below)
        return Found(shown, self._because(name), tuple(proofs), form)

    def _value(self, name: str) -> tuple[RingMatrix, PolyElement] | None:
        """The quantity as a matrix over a divisor."""
        values, (kind, frame) = self.values, kind_and_frame(name)
        if kind == "inverse_rate_matrix":
            return values.inverse(frame)
        if kind == "rates_from_angular_velocity":
            inverse = values.inverse(frame)
            return inverse and (inverse[0] @ values.argument(f"omega_{frame}"), inverse[1])
        match kind:
            case "rotation_matrix":
                matrix = self._shown(values.R)
            case "rotation_rate":
                matrix = self._shown(values.R_dot)
            case "spin_matrix":
                matrix = self._spin
            case "angular_velocity":
                matrix = values.omega(frame)
            case "rate_matrix":
                matrix = values.rate_matrix(frame)
            case "angular_acceleration":
                matrix = values.alpha_space if frame == "space" else values.omega_body.dt()
            case _:
                raise LookupError(f"no rule finds {kind}")
        return matrix, values.ring.one

    def _holds(self, law: str, claim: Formula, matrix: RingMatrix, below: PolyElement) -> Proof:
        prove, residual = self.values.prove, self._residual(law, matrix, below)
        if law in ("orthogonal", "proper"):
            return prove.is_rotation(residual, claim)
        return prove.vanishes(residual, claim, divided_by=below)

    def _residual(self, law: str, found: RingMatrix, below: PolyElement) -> RingMatrix:
        """What vanishes if a law of a quantity, found / below, holds."""
        values, (kind, frame) = self.values, kind_and_frame(law)
        match law:
            case "orthogonal":
                return self._shown(values.R).gram() - values.one
            case "proper":
                return values.column([values.R.det() - 1])
            case "skew":
                return self._spin + self._spin.T
            case "passive_operator":
                return self._spin + hat(values.omega_body)
            case "angular_velocity_space":
                return values.spin - hat(values.omega_space)
            case "angular_velocity_body":
                return values.R @ values.omega_body - values.omega_space
            case "angular_acceleration_space":
                return values.spin.dt() - hat(found)
            case "angular_acceleration_body":
                return values.R @ found - values.alpha_space
        if kind == "rate_matrix":
            return found @ values.argument("q_dot") - values.omega(frame)
        whole = values.one if kind == "inverse_rate_matrix" else values.argument(f"omega_{frame}")
        return values.rate_matrix(frame) @ found - whole.scale(below)

    def _form(self, name: str, matrix: RingMatrix, below: PolyElement) -> VectorForm | None:
        """The quantity as a function of the vector of the coordinates, if it is one."""
        prove, vector, (kind, where) = self.values.prove, self.model.vector, kind_and_frame(name)
        if kind == "rotation_matrix":
            return matrix_form(prove, vector, matrix, below, self.symbol)
        frame = FRAMES.get(where, SPACE)
        if kind == "angular_velocity":
            return vector_form(prove, vector, matrix, frame.omega)
        if kind == "rate_matrix":
            return matrix_form(prove, vector, matrix, below, frame.matrix)
        if kind == "inverse_rate_matrix":
            return matrix_form(prove, vector, matrix, below, self.inverse_symbol(frame))
        inverse = self.values.inverse(where) if kind == "rates_from_angular_velocity" else None
        if inverse is None:
            return None
        given = frame.omega, self.values.argument(f"omega_{where}")
        return matrix_form(prove, vector, *inverse, RATES, to=given)

    def _shown(self, matrix: RingMatrix) -> RingMatrix:
        return matrix.T if self.model.passive else matrix

    @cached_property
    def _spin(self) -> RingMatrix:
        """dR/dt Rᵀ, or dA/dt Aᵀ of A = Rᵀ."""
        values = self.values
        return values.R_dot.T @ values.R if self.model.passive else values.spin

    # How each follows, in words

    def _because(self, name: str) -> str:
        kind, frame = kind_and_frame(name)
        if kind == "rotation_matrix":
            return self._given_as()
        if kind == "rate_matrix":
            return self._columns_in_words(frame)
        if kind == "inverse_rate_matrix":
            return self._inverse_in_words(frame)
        words = _PASSIVE_WORDS if self.model.passive and name in _PASSIVE_WORDS else WORDS
        return words[name]

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

    def _columns_in_words(self, frame: str) -> str:
        coordinates = self.model.coordinates
        if len(coordinates) == 1:
            if frame == "body":
                return "The column of W′ is the same axis, with its components in the body."
            return "The angular velocity is the rate times the axis of the turn."
        turns = [turn.angle for turn in self.model.turns]
        if len(turns) == len(coordinates) and set(turns) == set(coordinates):
            if frame == "body":
                return WORDS["rate_matrix_body"]
            return (
                "The angular velocity depends linearly on the rates; the columns of W are the axes "
                "of the turns, with their components in space."
            )
        if frame == "body":
            return "The coefficients of its body components are those of W′."
        return "The angular velocity depends linearly on the rates, with the coefficients W."

    def _inverse_in_words(self, frame: str) -> str:
        if frame == "body":
            kind = "inverse" if self.is_square else "right inverse"
            return f"The {kind} of W′ is found in the same way."
        if self.is_square:
            return (
                "The inverse of W, its adjugate over its determinant, gives the rates for a known "
                "angular velocity."
            )
        if self.values.bound is not None:
            return (
                "W has more columns than rows; its right inverse gives the rates that satisfy the "
                "conditions on the coordinates, which are unique."
            )
        if self.model.vector:
            return (
                "The rates are not unique, since the length of the quaternion is irrelevant; the "
                "right inverse of W gives the rates for which it stays constant."
            )
        return (
            "The rates are not unique, since there are more coordinates than components of the "
            "angular velocity; we choose the smallest."
        )


_COMPONENTS = "The components of Ω are the entries (3,2), (1,3) and (2,1) of this skew matrix."
WORDS = {
    "rate_matrix_body": "The columns of W′ are the same axes, with their components in the body.",
    "rotation_rate": "The chain rule gives the time derivative of each entry.",
    "spin_matrix": "Multiplying the derivative by the transpose gives a skew matrix.",
    "angular_velocity_space": _COMPONENTS,
    "angular_velocity_body": "Multiplying by Rᵀ gives the components along the axes of the body.",
    "rates_from_angular_velocity_space": "The rates follow from the space components of the "
    "angular velocity.",
    "rates_from_angular_velocity_body": "Gyroscopes fixed in the body measure Ω′; integrating the "
    "rates that follow gives the orientation.",
    "angular_acceleration_space": "The angular acceleration is the time derivative of the angular "
    "velocity.",
    "angular_acceleration_body": "Its components in the body are the derivatives of those of Ω′, "
    "since Ω × Ω vanishes.",
}
_PASSIVE_WORDS = {
    "spin_matrix": "Multiplying the derivative by the transpose gives a skew matrix, the operator "
    "of −Ω′ and not of Ω.",
    "angular_velocity_space": "Since Aᵀ = R, the derivative of the transpose times the matrix is "
    f"the operator of Ω. {_COMPONENTS}",
    "angular_velocity_body": "The direction cosine matrix gives the components along the axes of "
    "the body.",
}
