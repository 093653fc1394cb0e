"""Coordinates to the unit quaternion and back, and to R: with proofs, and as functions.

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
from rigidsym.mechanics.conversions.function import (
    PARTS,
    SHEPPERD,
    Continuity,
    ConversionFunction,
    ConversionInput,
    Converted,
    NamedValues,
    Where,
    argument_of,
    half_turn,
    outer_product,
    product,
    scalar_last,
    scaled,
    shepperd,
    short_way,
    square,
    symbols,
    unit,
)
from rigidsym.mechanics.conversions.inverse import (
    ClosedForm,
    EulerRule,
    InverseRule,
    claim,
    inverse_rule,
    vanishing,
)
from rigidsym.mechanics.derivation import Derivation, Proof, Quantity, Step
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
WITHOUT_INVERSE = (
    "Coordinates follow from a rotation in closed form for the 24 Euler conventions and the named "
    "parametrisations. For others, fit rotation_matrix(q) to the given matrix with "
    "scipy.optimize.least_squares, or use the nearest of the 24."
)


@dataclass(frozen=True)
class Conversions:
    """What converts between a model's coordinates, its unit quaternion and its matrix.

    Each is derived and proved in the ring of the model when it is asked for.
    """

    model: RotationModel

    @cached_property
    def inverse(self) -> InverseRule | None:
        """How the coordinates follow from a quaternion of any length but zero."""
        return inverse_rule(self.model)

    @property
    def _form(self) -> ClosedForm | None:
        return self.inverse if isinstance(self.inverse, ClosedForm) else None

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
    def without(self) -> str:
        """What to use in place of an inverse; empty if there is one."""
        return "" if self.inverse else WITHOUT_INVERSE

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
    return replace(step, quantity=quantity._replace(name=quantity.name + UNIT, about=about))


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
        words=text_of(because),
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


# Conversions as functions: their arguments, their values in order, and remarks on them


MATRIX = tuple(f"r{row}{column}" for row in (1, 2, 3) for column in (1, 2, 3))

_TWO_SETS = (
    "Two sets of angles in [−π, π] give each rotation, and whole turns may be added to them. Each "
    "sample gets the angles nearest to the sample before. At a pole, only the sum or the "
    "difference of the outer angles is determined. The other is taken from the last sample away "
    "from poles, or from the first one if there is none before. A sample within 32 eps (radians) "
    "of a pole counts as at the pole, which changes R by up to twice that."
)


def converted(derivation: Derivation) -> Converted:
    """The functions of the conversions; where there is no inverse, a remark says why."""
    conversions = Conversions(derivation.model)
    inverse = conversions.inverse
    steps, functions = _quaternion(derivation, conversions)
    if inverse is not None:
        functions += (_from_quaternion(derivation, inverse), from_matrix(derivation, inverse))
        functions += _shadow_sets(derivation, inverse)
    names = {step.quantity.name for step in derivation.steps}
    variants = (v for v in conversions.variants if v.quantity.name.removesuffix(UNIT) in names)
    return Converted(
        steps=(*steps, *variants),
        functions=functions,
        continuity=_continuity(inverse) if inverse else None,
        remarks=(conversions.without,) if conversions.without else (),
    )


def _quaternion(
    derivation: Derivation, conversions: Conversions
) -> tuple[tuple[Step, ...], tuple[ConversionFunction, ...]]:
    """The unit quaternion, as a step where it has a formula of its own."""
    number_in_note = len(derivation.steps) + 1
    rule = conversions.inverse
    if isinstance(rule, ClosedForm) and conversions.variants:
        return (), (_of_any_length(derivation, rule, number_in_note),)
    if isinstance(rule, ClosedForm) and rule.rule == "rotation_vector":
        return (), (_of_rotation_vector(derivation, number_in_note),)
    if conversions.quaternion is not None:
        return (replace(conversions.quaternion, number=number_in_note),), ()
    return (), (_quaternion_of_matrix(derivation),)


def _from_quaternion(derivation: Derivation, inverse: InverseRule) -> ConversionFunction:
    given = symbols(PARTS)
    values = NamedValues(given[0])
    quaternion = scaled(values, given)
    order = "last" if inverse.is_scalar_last else "first"
    listed = scalar_last(given) if inverse.is_scalar_last else given
    rotation = argument_of("quaternion", listed, f"a quaternion of any length, scalar {order}")
    return values.function(
        "from_quaternion",
        [ConversionInput(argument=rotation)],
        inverse.from_quaternion(values, quaternion),
        f"the coordinates of a quaternion, scalar {order}",
        *_remarks(inverse),
        "The length of the quaternion does not matter; a zero quaternion gives NaN.",
        unit=_unit(derivation.model),
    )


def from_matrix(derivation: Derivation, inverse: InverseRule) -> ConversionFunction:
    """The function `from_rotation_matrix`."""
    model = derivation.model
    given = symbols(MATRIX)
    values = NamedValues(given[0])
    matrix = sp.Matrix(3, 3, given)
    outputs = inverse.from_matrix(values, matrix.T if model.passive else matrix)
    shown = "A, the transpose of R" if model.passive else "R"
    rotation = argument_of("matrix", given, f"a rotation matrix {shown}")
    return values.function(
        "from_rotation_matrix",
        [ConversionInput(argument=rotation, is_matrix=True)],
        outputs,
        f"the coordinates of a rotation matrix {shown}, as `rotation_matrix` gives it",
        *_remarks(inverse),
        f"The largest component of the quaternion is computed first ({SHEPPERD}). The matrix is "
        "assumed to be a rotation; this is not checked.",
        unit=_unit(model),
    )


def _remarks(inverse: InverseRule) -> tuple[str, ...]:
    return text_of(inverse.because), text_of(inverse.branch)


def _unit(model: RotationModel) -> str:
    units = dict.fromkeys(model.coordinate_units)
    return next(iter(units)) if len(units) == 1 else f"({', '.join(model.coordinate_units)})"


def _quaternion_of_matrix(derivation: Derivation) -> ConversionFunction:
    """The quaternion of a rotation that is known by its matrix alone."""
    model = derivation.model
    found = {step.quantity.name: step.expression for step in derivation.steps}
    presented = found.get("rotation_matrix")
    if presented is None:
        matrix = sp.Matrix(model.matrix)
    else:
        matrix = sp.Matrix(presented.T if model.passive else presented)
    entries = symbols(MATRIX)
    values = NamedValues(model.coordinates[0])
    quaternion = short_way(values, shepperd(values, sp.Matrix(3, 3, entries)))
    names = ("q", "parameters") if model.constants else ("q",)
    function = values.function(
        "quaternion",
        [ConversionInput(argument=derivation.argument(name)) for name in names],
        unit(values, quaternion),
        "unit quaternion of the rotation, scalar first and not negative",
        f"Its largest component is computed first, from R ({SHEPPERD}).",
        symbol="p",
    )
    return replace(function, shared=tuple(zip(entries, matrix, strict=True)))


def _of_any_length(
    derivation: Derivation, rule: ClosedForm, number_in_note: int
) -> ConversionFunction:
    q, is_last = derivation.model.coordinates, rule.is_scalar_last
    values = NamedValues(q[0])
    parts = unit(values, scaled(values, (q[3], *q[:3]) if is_last else q))
    order = "last" if is_last else "first"
    return values.function(
        "quaternion",
        [ConversionInput(argument=derivation.argument("q"))],
        scalar_last(parts) if is_last else parts,
        f"unit quaternion of the rotation, scalar {order}",
        f"Equation ({number_in_note}) of the note.",
        "The coordinates are divided by their length; zero gives NaN.",
        symbol="p",
    )


def _of_rotation_vector(derivation: Derivation, number_in_note: int) -> ConversionFunction:
    """Where n² is too small for a float, sin(n/2)/n is 1/2."""
    q = derivation.argument("q")
    values = NamedValues(q.symbols[0])
    size = values.let("square", square(q.symbols))
    none = sp.Eq(size, 0)
    length = values.let("length", sp.sqrt(Where(none, sp.S.One, size)))
    factor = values.let("factor", Where(none, sp.S.Half, sp.sin(length / 2) / length))
    return values.function(
        "quaternion",
        [ConversionInput(argument=q)],
        [Where(none, sp.S.One, sp.cos(length / 2)), *(factor * part for part in q.symbols)],
        "unit quaternion of the rotation, scalar first: cos(n/2) and v sin(n/2)/n",
        f"Equation ({number_in_note}) of the note; accurate at every length.",
        symbol="p",
    )


def _shadow_sets(derivation: Derivation, inverse: InverseRule) -> tuple[ConversionFunction, ...]:
    """The other set of modified Rodrigues parameters, and the shorter of both."""
    if not isinstance(inverse, ClosedForm) or inverse.rule != "modified_rodrigues":
        return ()
    q = derivation.argument("q")
    shadow, shorter = NamedValues(q.symbols[0]), NamedValues(q.symbols[0])
    size = shadow.let("square", square(q.symbols))
    length = shorter.let("square", square(q.symbols))
    scale = shorter.let("scale", Where(length > 1, -length, sp.S.One))
    return (
        shadow.function(
            "shadow_set",
            [ConversionInput(argument=q)],
            [-part / size for part in q.symbols],
            "the other set of the same rotation, −s/(s·s)",
            "The shadow of zero is at infinity; the result is NaN.",
            symbol="s",
        ),
        shorter.function(
            "shorter_set",
            [ConversionInput(argument=q)],
            [part / scale for part in q.symbols],
            "the same rotation by the set with s·s ≤ 1: the shadow set where s·s > 1",
            symbol="s",
        ),
    )


def _continuity(inverse: InverseRule) -> Continuity | None:
    """The continuity of the coordinates; None if they are unique."""
    if isinstance(inverse, EulerRule):
        return Continuity(kind="euler", remarks=(_TWO_SETS,), quarters=inverse.quarters)
    if not isinstance(inverse, ClosedForm) or not inverse.continuity:
        return None
    kind = "quaternion" if inverse.has_both_signs else inverse.rule
    return Continuity(kind=kind, remarks=(inverse.continuity,))
