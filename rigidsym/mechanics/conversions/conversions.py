"""Coordinates to the unit quaternion and back, and to R: what converts, how, and its proofs.

A quaternion p is scalar first here, (p_w, p_x, p_y, p_z); only the results for a model whose own
quaternion is scalar last are in its order. It is that of R, which turns the body, also where a
model presents the transpose.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache, reduce

import sympy as sp

from rigidsym.algebra.codec import Codec, codec_for
from rigidsym.algebra.matrix import RingMatrix
from rigidsym.algebra.present import presenter_for
from rigidsym.errors import AlgebraError
from rigidsym.formula.reader import formula
from rigidsym.formula.sentence import Sentence, sentence, text_of
from rigidsym.formula.tree import Formula
from rigidsym.mechanics.conversions.closed_forms import ClosedForm, closed_form
from rigidsym.mechanics.conversions.davenport_angles import (
    DavenportAngles,
    davenport_angles,
    davenport_claims,
)
from rigidsym.mechanics.conversions.three_axes import (
    half_claims,
    middle_claims,
    outer_claims,
    three_axes,
    triangle,
    triangle_claims,
)
from rigidsym.mechanics.conversions.turn_chain import (
    WITTENBURG_LILOV_2003,
    TurnChain,
    description,
    known_claims,
    turn_chain,
)
from rigidsym.mechanics.derivation import Proof, Quantity, Step
from rigidsym.mechanics.derive import derive
from rigidsym.mechanics.prove import Prover
from rigidsym.models.parametrisations import UnitQuaternion
from rigidsym.models.rotation import Citation, RotationModel
from rigidsym.models.so3 import hat

Parts = tuple[sp.Expr, ...]  # of a quaternion, scalar first

LONGEST_CHAIN = 4  # turns whose product is written out: its terms double with each
P = formula(r"\mathbf{p}")
SHEPPERD = Citation(
    text="S. Shepperd, Quaternion from Rotation Matrix, Journal of Guidance and Control 1 (1978)"
)
_RODRIGUES = Citation(
    text="M. Shuster, A Survey of Attitude Representations, Journal of the Astronautical "
    "Sciences 41 (1993)"
)
QUATERNION = Quantity(
    name="quaternion",
    symbol=P,
    about="unit quaternion of the rotation, scalar first",
    unit="",
    inputs=("q",),
    shape="vector",
    source=_RODRIGUES,
)
UNIT = "_unit"  # ends the names of what holds for quaternions of length one
_OF_UNIT_LENGTH = ("rotation_matrix", "angular_velocity_space", "angular_velocity_body")
_FACTORS = sentence(
    r"Each turn by $\beta$ about $\mathbf{e}$ is the quaternion "
    r"$\cos\frac{\beta}{2} + \mathbf{e}\sin\frac{\beta}{2}$; they are multiplied from left to "
    "right."
)
_OUTER_ANGLES = sentence(
    r"$\mathbf{C}$ is the fixed turn about the second axis that takes the first to the third. In "
    "the frame of the first two axes and their cross product, the quaternion of "
    r"$\mathbf{R}\,\mathbf{C}$ is $\kappa$ ($\cos\frac{\beta'}{2}\cos\sigma$, "
    r"$\cos\frac{\beta'}{2}\sin\sigma$, $\sin\frac{\beta'}{2}\cos\delta$, "
    r"$\sin\frac{\beta'}{2}\sin\delta$): $\beta'$ is the middle angle plus the angle of "
    r"$\mathbf{C}$, $\sigma$ half the sum and $\delta$ half the difference of the outer angles. "
    r"So $\sigma = \operatorname{atan2}(a_1, a_0)$, $\delta = \operatorname{atan2}(a_3, a_2)$, and "
    r"$\tan\frac{\beta'}{2}$ is the quotient of the lengths of $(a_2, a_3)$ and $(a_0, a_1)$."
)
_TURNS = formula(r"\mathbf{R}(\mathbf{p}) = \mathbf{R}")
_UNIT = formula(r"\mathbf{p}\cdot\mathbf{p} = 1")


@dataclass(frozen=True, kw_only=True, slots=True)
class InverseConversion:
    """How the coordinates follow from a quaternion of any length but zero."""

    rule: DavenportAngles | TurnChain | ClosedForm
    because: Sentence  # how it follows
    branch: Sentence  # which of the possible coordinates are given
    proofs: tuple[Proof, ...]
    source: Citation | None = None
    given: tuple[str, ...] = ()  # arguments that the functions take besides: "parameters", "kept"

    @property
    def is_scalar_last(self) -> bool:
        """Whether quaternions are (x, y, z, w), as the coordinates are."""
        return isinstance(self.rule, ClosedForm) and self.rule.is_scalar_last


@dataclass(frozen=True, kw_only=True, slots=True)
class Conversions:
    """What converts between a model's coordinates, its unit quaternion and its matrix.

    Where the quaternion has no formula of its own it is taken from R; where the coordinates do
    not follow from a rotation, `without` says why.
    """

    model: RotationModel
    quaternion: Step | None
    because: Sentence  # how the quaternion follows
    inverse: InverseConversion | None
    without: str  # a sentence; empty where there is `inverse`
    from_matrix: Proof  # that 4 p pᵀ can be read off from R
    variants: tuple[Step, ...] = ()  # quantities in a shorter form, for coordinates that obey more

    @property
    def proofs(self) -> tuple[Proof, ...]:
        forward = self.quaternion.proofs if self.quaternion else ()
        return (*forward, *(self.inverse.proofs if self.inverse else ()), self.from_matrix)

    @property
    def is_proved(self) -> bool:
        return all(proof.is_exact for proof in self.proofs)


def conversions_of(model: RotationModel) -> Conversions:
    """The conversions of one model, each proved in its ring."""
    form = closed_form(model)
    inverse, without = None, ""
    if form is not None:
        inverse = _by_form(model, form)
    else:
        turns = davenport_angles(model) or turn_chain(model)
        if isinstance(turns, DavenportAngles):
            inverse = _by_turns(model, turns)
        elif isinstance(turns, TurnChain):
            inverse = _by_chain(model, turns)
        else:
            without = f"The coordinates do not follow from a rotation: {turns}."
    return Conversions(
        model=model,
        quaternion=_forward(model, form),
        because=form.because if form else _FACTORS,
        inverse=inverse,
        without=without,
        from_matrix=_read_off(),
        variants=_unit_variants(model, form),
    )


def _unit_variants(model: RotationModel, form: ClosedForm | None) -> tuple[Step, ...]:
    """What a quaternion of any length is good for, for those who know that its length is one."""
    if form is None or form.rule != "quaternion" or model.constraints:
        return ()
    names = [model.coordinates[place].func.__name__ for place in form.order]
    unit = UnitQuaternion(names, scalar_last=form.order[0] != 0, passive=model.passive)
    steps = (derive(unit).step(name) for name in _OF_UNIT_LENGTH)
    return tuple(replace(step, number=0, quantity=_of_unit_length(step.quantity)) for step in steps)


def _of_unit_length(quantity: Quantity) -> Quantity:
    return replace(
        quantity,
        name=quantity.name + UNIT,
        about=f"{quantity.about}, for a quaternion of length one",
    )


def rotation_of(parts: Sequence[sp.Expr]) -> sp.Matrix:
    """The matrix (3, 3) of a quaternion, times the square of its length."""
    w, *vector = parts
    v = sp.Matrix(vector)
    return (w**2 - v.dot(v)) * sp.eye(3) + 2 * v * v.T + 2 * w * hat(v)


def _forward(model: RotationModel, form: ClosedForm | None) -> Step | None:
    """The unit quaternion as a formula in the coordinates; None where R has to be taken apart."""
    if form is not None:
        step = _step(model, form.quaternion, form.because) if form.quaternion else None
        return _scalar_last(step) if step and form.is_scalar_last else step
    if not model.turns or len(model.turns) > LONGEST_CHAIN:
        return None
    try:
        step = _step_of_turns(model)
    except AlgebraError:  # half of a fixed angle need not have a sine that is a root
        return None
    # Where it is a root of a root, the ring may not know that: R, which is proved, is taken apart.
    return step if all(proof.is_exact for proof in step.proofs) else None


def _scalar_last(step: Step) -> Step:
    """The quaternion in the order of the coordinates, (x, y, z, w)."""
    w, *vector = step.expression
    quantity = replace(step.quantity, about="unit quaternion of the rotation, scalar last")
    return replace(step, quantity=quantity, expression=sp.ImmutableMatrix([*vector, w]))


def _step_of_turns(model: RotationModel) -> Step:
    """The product of cos(β/2) + sin(β/2) e over all turns, in the form of textbooks."""
    factors = [half_turn(turn.direction, turn.angle) for turn in model.turns]
    codec = codec_for(
        [*model.matrix, *(part for factor in factors for part in factor)],
        constraints=model.constraints,
        order=0,
    )
    product = reduce(lambda a, b: _product(codec, a, b), (_encoded(codec, f) for f in factors))
    shown = presenter_for(codec).matrix(product)
    return _proved_step(
        model,
        codec,
        shown,
        _FACTORS,
    )


def half_turn(direction: Sequence[sp.Expr], angle: sp.Expr) -> Parts:
    """cos(β/2) + sin(β/2) e, the unit quaternion of the turn by β about the unit axis e."""
    return (sp.cos(angle / 2), *(sp.sin(angle / 2) * part for part in direction))


def _step(model: RotationModel, parts: Parts, because: Sentence) -> Step:
    codec = codec_for([*model.matrix, *parts], constraints=model.constraints, order=0)
    return _proved_step(model, codec, sp.ImmutableMatrix(parts), because)


def _proved_step(
    model: RotationModel, codec: Codec, shown: sp.ImmutableMatrix, because: Sentence
) -> Step:
    prove = Prover(model, codec)
    residual = [codec.encode(e) for e in rotation_of(list(shown)) - model.matrix]
    length = codec.encode(shown.dot(shown) - 1)
    is_fixed = shown.free_symbols.isdisjoint(model.constants)
    return Step(
        number=0,
        quantity=QUATERNION if is_fixed else replace(QUATERNION, inputs=("q", "parameters")),
        expression=shown,
        because=text_of(because),
        proofs=(
            prove.vanishes(RingMatrix.column(codec.ring, residual), _TURNS),
            prove.vanishes(RingMatrix.column(codec.ring, [length]), _UNIT),
        ),
    )


def _encoded(codec: Codec, parts: Parts) -> RingMatrix:
    return RingMatrix.column(codec.ring, [codec.encode(part) for part in parts])


def _product(codec: Codec, first: RingMatrix, second: RingMatrix) -> RingMatrix:
    """The product of two quaternions, as columns (4, 1)."""
    w, x, y, z = first.entries
    left = RingMatrix.of(codec.ring, [[w, -x, -y, -z], [x, w, -z, y], [y, z, w, -x], [z, -y, x, w]])
    return left @ second


def _by_turns(model: RotationModel, rule: DavenportAngles) -> InverseConversion:
    return InverseConversion(
        rule=rule,
        because=_OUTER_ANGLES,
        branch=rule.branch,
        proofs=_vanishing(model, davenport_claims(model, rule)),
    )


def _by_chain(model: RotationModel, rule: TurnChain) -> InverseConversion:
    because, branch = description(model, rule)
    return InverseConversion(
        rule=rule,
        because=because,
        branch=branch,
        proofs=(
            *_vanishing(model, known_claims(model, rule)),
            *_outer_turns(),
            *_middle(rule),
        ),
        source=WITTENBURG_LILOV_2003,
        given=(*(["parameters"] if model.constants else []), *(["kept"] if rule.kept else [])),
    )


@cache
def _outer_turns() -> tuple[Proof, ...]:
    """What solves the outer turns about any axes, once for all models."""
    axes = three_axes()
    return _vanishing(axes, outer_claims(axes))


def _middle(rule: TurnChain) -> tuple[Proof, ...]:
    if len(rule.solved) < 3:
        return ()
    return _middle_turn() if rule.has_two_sets else _middle_of_half()


@cache
def _middle_of_half() -> tuple[Proof, ...]:
    """What solves it where the outer turns are by one angle."""
    axes = three_axes()
    return _vanishing(axes, half_claims(axes))


@cache
def _middle_turn() -> tuple[Proof, ...]:
    """What solves the turn between them."""
    axes, sides = three_axes(), triangle()
    return (*_vanishing(axes, middle_claims(axes)), *_vanishing(sides, triangle_claims(sides)))


def _by_form(model: RotationModel, form: ClosedForm) -> InverseConversion:
    return InverseConversion(
        rule=form,
        because=form.back_because,
        branch=form.branch,
        proofs=_vanishing(model, form.claims),
    )


def _vanishing(
    model: RotationModel, claims: Sequence[tuple[tuple[sp.Expr, ...], Formula]]
) -> tuple[Proof, ...]:
    """Proofs that the residuals of each claim reduce to zero."""
    if not claims:
        return ()
    residuals = [residual for claim, _ in claims for residual in claim]
    codec = codec_for([*model.matrix, *residuals], constraints=model.constraints, order=0)
    prove = Prover(model, codec)
    return tuple(
        prove.vanishes(RingMatrix.column(codec.ring, map(codec.encode, claim)), text)
        for claim, text in claims
    )


@cache
def _read_off() -> Proof:
    """4 p pᵀ = K(R): sums and differences of the entries of R, for every unit quaternion p."""
    model = UnitQuaternion()
    column = sp.Matrix(model.coordinates)
    residual = tuple(outer_product(model.matrix) - 4 * column * column.T)
    claim = formula(r"4\,\mathbf{p}\mathbf{p}^{\mathsf T} = \mathbf{K}")
    return _vanishing(model, [(residual, claim)])[0]


def outer_product(matrix: sp.MatrixBase) -> sp.Matrix:
    """K(R) = 4 p pᵀ, (4, 4), of a rotation matrix (Shepperd, 1978)."""
    r = matrix
    trace = r[0, 0] + r[1, 1] + r[2, 2]
    diagonal = [1 + trace, *(1 + 2 * r[k, k] - trace for k in range(3))]
    above = {
        (0, 1): r[2, 1] - r[1, 2],
        (0, 2): r[0, 2] - r[2, 0],
        (0, 3): r[1, 0] - r[0, 1],
        (1, 2): r[1, 0] + r[0, 1],
        (1, 3): r[0, 2] + r[2, 0],
        (2, 3): r[2, 1] + r[1, 2],
    }
    return sp.Matrix(4, 4, lambda i, j: diagonal[i] if i == j else above[min(i, j), max(i, j)])
