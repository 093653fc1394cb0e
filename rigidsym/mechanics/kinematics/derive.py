"""R → dR/dt → dR/dt Rᵀ → Ω → Ω′, rate matrices and their inverses, angular accelerations.

What is claimed of each is the same however it is worked out: multiplied out in the model's ring, by
one algorithm for every rotation model (`Expanded`; lecture, eq. 15 and 16), or turn by turn.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Collection, Iterator, Sequence
from functools import cached_property
from typing import NamedTuple

import sympy as sp
from sympy.polys.rings import PolyElement

from rigidsym.algebra.matrix import RingMatrix, hat
from rigidsym.errors import DerivationError, NotARotation
from rigidsym.formula.tree import Formula
from rigidsym.mechanics.derivation import Found, VectorForm
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
_CLOSED_FORM = 3  # turns whose inverse rates and singular places textbooks write out


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
        rotation, *others = QUANTITY_NAMES
        found = self.find([rotation])
        found |= self.find([name for name in others if not only or name in only])
        yield from ((name, step) for name, step in found.items() if not only or name in only)

    @abstractmethod
    def find(self, names: Sequence[str]) -> dict[str, Found]:
        """Quantities with their proofs, but for those that the model does not have."""

    def inverse_symbol(self, frame: Frame) -> Formula:
        return frame.inverse if self.is_square else frame.right_inverse


def is_shorter(model: RotationModel) -> bool:
    """Whether a product of more than three turns is shorter turn by turn than multiplied out."""
    return len(model.turns) > _CLOSED_FORM and _composed(model) < _expanded(model)


def _expanded(model: RotationModel) -> int:
    """About how many operations R takes multiplied out: a product and a sum for each term."""
    terms = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]
    for turn in model.turns:
        own = [
            [len(sp.Add.make_args(e)) * int(e != 0) for e in row] for row in turn.matrix.tolist()
        ]
        terms = [[sum(row[j] * own[j][k] for j in range(3)) for k in range(3)] for row in terms]
    return 2 * sum(map(sum, terms)) - 9


def _composed(model: RotationModel) -> int:
    """How many operations R takes turn by turn; the product of two turns has hardly any sums."""
    return sum(45 if turn.components else 18 for turn in model.turns[2:]) + 4


def kind_and_frame(name: str) -> tuple[str, str]:
    """A quantity or a law without its frame, and the frame; "" if it has none."""
    kind, _, frame = name.rpartition("_")
    return (kind, frame) if frame in FRAMES else (name, "")


_INVERSE = ("inverse_rate_matrix", "rates_from_angular_velocity")


class WorkedOut(NamedTuple):
    """A quantity over a divisor, and the residuals of its laws: what vanishes if they hold."""

    matrix: RingMatrix
    below: PolyElement
    residuals: list[RingMatrix]


class Expanded(Kinematics):
    """The steps multiplied out, in the ring of the model."""

    def __init__(self, values: Values) -> None:
        super().__init__(values.model)
        self.values = values

    def find(self, names: Sequence[str]) -> dict[str, Found]:
        found = self._worked_out(names)
        if not found:
            return {}
        matrices, divisors, _ = zip(*found.values(), strict=True)
        claimed = [
            (residual, claim, (quantity.below,))
            for name, quantity in found.items()
            for residual, (_, claim) in zip(quantity.residuals, self.laws[name], strict=True)
        ]
        is_rotation = "rotation_matrix" in found
        prove, matrix = self.values.prove.vanish, self.values.present.matrix
        proofs = iter(prove(claimed, error=NotARotation if is_rotation else DerivationError))
        shown = list(map(matrix, matrices, divisors))
        steps: dict[str, Found] = {}
        for (name, quantity), expression in zip(found.items(), shown, strict=True):
            proved = [next(proofs) for _ in quantity.residuals]
            form = self._form(name, quantity) if self.model.vector else None
            proved += [form.proof] if form else []
            steps[name] = Found(expression, self._because(name), tuple(proved), form)
        return steps

    def _worked_out(self, names: Sequence[str]) -> dict[str, WorkedOut]:
        """The quantities, each with what vanishes if its laws hold, in their order."""
        kinds = [kind_and_frame(name) for name in names]
        values, passive, spin = self.values, self.model.passive, self._spin
        R, R_dot, active, omega_space, omega_body = values.turning
        omegas = {"space": omega_space, "body": omega_body}
        rates = values.rate_matrices
        inverses = {f: values.inverse(f) for kind, f in kinds if kind in _INVERSE}
        given, column = values.arguments, values.codec.column
        one, unit = values.codec.ring.one, RingMatrix.identity(values.codec.ring, 3)
        found: dict[str, WorkedOut] = {}
        for name, (kind, frame) in zip(names, kinds, strict=True):
            omega, below = omegas.get(frame, omega_space), one
            match kind:
                case "rotation_matrix":
                    matrix = R.T if passive else R
                    left = [matrix.gram() - unit, RingMatrix.column(R.ring, [R.det() - 1])]
                case "rotation_rate":
                    matrix, left = R_dot.T if passive else R_dot, [spin + spin.T]
                case "spin_matrix":
                    matrix, left = spin, [spin + spin.T]
                    left += [spin + hat(omega_body)] if passive else []
                case "angular_velocity":
                    matrix = omega
                    left = [active - hat(omega) if frame == "space" else R @ omega - omega_space]
                case "rate_matrix":
                    matrix = rates[frame]
                    left = [matrix @ column(given["q_dot"].symbols) - omega]
                case "angular_acceleration":
                    matrix = omega.dt()
                    if frame == "space":
                        left = [active.dt() - hat(matrix)]
                    else:
                        left = [R @ matrix - omega_space.dt()]
                case "inverse_rate_matrix" | "rates_from_angular_velocity":
                    inverse = inverses[frame]
                    if inverse is None:
                        continue
                    matrix, below = inverse
                    whole = unit
                    if kind == "rates_from_angular_velocity":
                        whole = column(given[f"omega_{frame}"].symbols)
                        matrix = matrix @ whole
                    left = [rates[frame] @ matrix - whole.scale(below)]
                case _:
                    raise LookupError(f"no rule for {name}; add one in {__name__}")
            found[name] = WorkedOut(matrix, below, left)
        return found

    def _form(self, name: str, quantity: WorkedOut) -> VectorForm | None:
        """The quantity as a function of the vector of the coordinates, if it is one."""
        prove, vector, (kind, where) = self.values.prove, self.model.vector, kind_and_frame(name)
        matrix, below = quantity.matrix, quantity.below
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

    @cached_property
    def _spin(self) -> RingMatrix:
        """dR/dt Rᵀ, or dA/dt Aᵀ of A = Rᵀ."""
        turning = self.values.turning
        return turning.R_dot.T @ turning.R if self.model.passive else turning.spin

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
