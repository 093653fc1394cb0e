"""Coordinates to the unit quaternion and back, and to R: what converts, how, and its proofs.

A quaternion p is scalar first here, (p_0, p_1, p_2, p_3); only the results for a model with a
scalar-last quaternion have its order. It represents R, which turns the body, even if a model
presents the transpose.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache, cached_property, reduce

import sympy as sp

from rigidsym.algebra.codec import Codec, codec_for
from rigidsym.algebra.matrix import RingMatrix
from rigidsym.algebra.present import presenter_for
from rigidsym.errors import AlgebraError
from rigidsym.formula.reader import Sentence, formula, sentence, text_of
from rigidsym.mechanics.conversions.closed_forms import ClosedForm, closed_form
from rigidsym.mechanics.conversions.davenport_angles import DavenportAngles, davenport_angles
from rigidsym.mechanics.conversions.inverse import claim, vanishing
from rigidsym.mechanics.conversions.turn_chain import TurnChain, turn_chain
from rigidsym.mechanics.conversions.unit_quaternions import (
    half_turn,
    outer_product,
    product,
    scalar_last,
)
from rigidsym.mechanics.derivation import Proof, Quantity, Step
from rigidsym.mechanics.derive import derive
from rigidsym.mechanics.prove import Prover
from rigidsym.models.parametrisations import SHUSTER, UnitQuaternion
from rigidsym.models.rotation import RotationModel, rotation_of

LONGEST_CHAIN = 4  # turns whose product is written out: its terms double with each
P = formula(r"\mathbf{p}")
QUATERNION = Quantity(
    name="quaternion",
    symbol=P,
    about="unit quaternion of the rotation, scalar first",
    unit="",
    inputs=("q",),
    shape="vector",
    source=SHUSTER,
)
UNIT = "_unit"  # ends the names of what holds for quaternions of length one
_OF_UNIT_LENGTH = ("rotation_matrix", "angular_velocity_space", "angular_velocity_body")
_FACTORS = sentence(
    r"Each turn by $\beta$ about $\mathbf{e}$ is the quaternion "
    r"$\cos\frac{\beta}{2} + \mathbf{e}\sin\frac{\beta}{2}$; they are multiplied from left to "
    "right."
)
_TURNS = formula(r"\mathbf{R}(\mathbf{p}) = \mathbf{R}")
_UNIT = formula(r"\mathbf{p}\cdot\mathbf{p} = 1")
Rule = DavenportAngles | TurnChain | ClosedForm


@dataclass(frozen=True)
class Conversions:
    """What converts between a model's coordinates, its unit quaternion and its matrix.

    Each is derived and proved in the ring of the model when it is asked for.
    """

    model: RotationModel

    @cached_property
    def _form(self) -> ClosedForm | None:
        return closed_form(self.model)

    @cached_property
    def _rule(self) -> Rule | str:
        return self._form or davenport_angles(self.model) or turn_chain(self.model)

    @cached_property
    def quaternion(self) -> Step | None:
        """The unit quaternion; None if it has no formula of its own, but is taken from R."""
        model, form = self.model, self._form
        if form is not None:
            return _of_form(model, form) if form.quaternion else None
        if not model.turns or len(model.turns) > LONGEST_CHAIN:
            return None
        try:
            step = _step_of_turns(model)
        except AlgebraError:  # half of a fixed angle need not have a sine that is a root
            return None
        # Where it is a root of a root, the ring may not know that; R, which is proved, is taken.
        return step if all(proof.is_exact for proof in step.proofs) else None

    @property
    def because(self) -> Sentence:
        """How the quaternion follows."""
        return sentence(self._form.forward) if self._form else _FACTORS

    @property
    def inverse(self) -> Rule | None:
        """How the coordinates follow from a quaternion of any length but zero."""
        return None if isinstance(self._rule, str) else self._rule

    @property
    def without(self) -> str:
        """Why the coordinates do not follow from a rotation; empty if there is `inverse`."""
        if not isinstance(self._rule, str):
            return ""
        return f"The coordinates do not follow from a rotation: {self._rule}."

    @property
    def from_matrix(self) -> Proof:
        """That 4 p pᵀ can be read off from R."""
        return _read_off()

    @cached_property
    def variants(self) -> tuple[Step, ...]:
        """Quantities of a quaternion of any length, for those who know that its length is one."""
        model, form = self.model, self._form
        if form is None or form.rule != "quaternion" or model.constraints:
            return ()
        names = [model.coordinates[place].func.__name__ for place in form.order]
        unit = UnitQuaternion(names, scalar_last=form.is_scalar_last, passive=model.passive)
        return tuple(map(_of_unit_length, map(derive(unit).step, _OF_UNIT_LENGTH)))

    @property
    def proofs(self) -> tuple[Proof, ...]:
        forward = self.quaternion.proofs if self.quaternion else ()
        return (*forward, *(self.inverse.proofs if self.inverse else ()), self.from_matrix)

    @property
    def is_proved(self) -> bool:
        return all(proof.is_exact for proof in self.proofs)


def _of_unit_length(step: Step) -> Step:
    quantity = step.quantity
    about = f"{quantity.about}, for a quaternion of length one"
    return replace(
        step, number=0, quantity=quantity._replace(name=quantity.name + UNIT, about=about)
    )


def _of_form(model: RotationModel, form: ClosedForm) -> Step:
    """In the order of the coordinates: (x, y, z, w) if the scalar is last."""
    codec = codec_for([*model.matrix, *form.quaternion], constraints=model.constraints, order=0)
    shown = sp.ImmutableMatrix(form.quaternion)
    step = _proved_step(model, codec, shown, sentence(form.forward))
    if not form.is_scalar_last:
        return step
    quantity = step.quantity._replace(about="unit quaternion of the rotation, scalar last")
    moved = sp.ImmutableMatrix(scalar_last(form.quaternion))
    return replace(step, quantity=quantity, expression=moved)


def _step_of_turns(model: RotationModel) -> Step:
    """The product of cos(β/2) + sin(β/2) e over all turns, in the form of textbooks."""
    factors = [half_turn(turn.direction, turn.angle) for turn in model.turns]
    codec = codec_for(
        [*model.matrix, *(part for factor in factors for part in factor)],
        constraints=model.constraints,
        order=0,
    )
    whole = reduce(product, (tuple(map(codec.encode, factor)) for factor in factors))
    column = RingMatrix.column(codec.ring, map(codec.ring.reduce, whole))
    return _proved_step(model, codec, presenter_for(codec).matrix(column), _FACTORS)


def _proved_step(
    model: RotationModel, codec: Codec, shown: sp.ImmutableMatrix, because: Sentence
) -> Step:
    prove = Prover(model, codec)
    is_fixed = shown.free_symbols.isdisjoint(model.constants)
    return Step(
        number=0,
        quantity=QUATERNION if is_fixed else QUATERNION._replace(inputs=("q", "parameters")),
        expression=shown,
        because=text_of(because),
        proofs=(
            prove.vanishes(codec.column(rotation_of(list(shown)) - model.matrix), _TURNS),
            prove.vanishes(codec.column([shown.dot(shown) - 1]), _UNIT),
        ),
    )


@cache
def _read_off() -> Proof:
    """4 p pᵀ = K(R): sums and differences of the entries of R, for every unit quaternion p."""
    model = UnitQuaternion()
    column = sp.Matrix(model.coordinates)
    text = r"4\,\mathbf{p}\mathbf{p}^{\mathsf T} = \mathbf{K}"
    residual = outer_product(model.matrix) - 4 * column * column.T
    return vanishing(model, [claim(text, *residual)])[0]
