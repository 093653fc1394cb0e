"""Coordinates to the unit quaternion and back, and to R: with proofs, and as functions.

A quaternion p is scalar first here, (p_0, p_1, p_2, p_3); only the results for a model with a
scalar-last quaternion have its order. It represents R, which turns the body, even if a model
presents the transpose.
"""

from __future__ import annotations

from collections.abc import Sequence
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
    Vector,
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
    BOTH_SIGNS,
    WORDS,
    InverseRule,
    claim,
    inverse_rule,
    vanishing,
)
from rigidsym.mechanics.derivation import Derivation, Proof, Quantity, Step
from rigidsym.mechanics.prove import Prover
from rigidsym.models.parametrisations import parametrised
from rigidsym.models.rotation import SOURCES, RotationModel, rotation_of

LONGEST_CHAIN = 4  # turns whose product is written out: its terms double with each
QUATERNION = Quantity(
    name="quaternion",
    symbol=formula(r"\p"),
    about="unit quaternion of the rotation, scalar first",
    inputs=("q",),
    shape="vector",
    source=SOURCES["Shuster"],
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

    @cached_property
    def quaternion(self) -> Step | None:
        """The unit quaternion; None if it has no formula of its own, but is taken from R."""
        model, rule = self.model, self.inverse
        if rule is not None and rule.rule != "euler":
            if not rule.quaternion:
                return None
            entries = [*model.matrix, *rule.quaternion]
            codec = codec_for(entries, constraints=model.constraints, order=0)
            step = self._proved_step(codec, sp.ImmutableMatrix(rule.quaternion))
            if not rule.is_scalar_last:
                return step
            # in the order of the coordinates, (x, y, z, w)
            quantity = step.quantity._replace(about="unit quaternion of the rotation, scalar last")
            moved = sp.ImmutableMatrix(scalar_last(rule.quaternion))
            return replace(step, quantity=quantity, expression=moved)
        if not model.turns or len(model.turns) > LONGEST_CHAIN:
            return None
        try:
            step = self._step_of_turns()
        except AlgebraError:  # half of a fixed angle need not have a sine that is a root
            return None
        # Where it is a root of a root, the ring may not know that; R, which is proved, is taken.
        return step if all(proof.is_exact for proof in step.proofs) else None

    @property
    def because(self) -> Sentence:
        """How the quaternion follows."""
        rule = self.inverse.rule if self.inverse else "euler"
        return sentence(WORDS["turns" if rule == "euler" else rule]["forward"])

    @property
    def without(self) -> str:
        """What to use in place of an inverse; empty if there is one."""
        return "" if self.inverse else WORDS["without"]

    @property
    def from_matrix(self) -> Proof:
        """That 4 p pᵀ can be read off from R."""
        return _read_off()

    @property
    def proofs(self) -> tuple[Proof, ...]:
        forward = self.quaternion.proofs if self.quaternion else ()
        return (*forward, *(self.inverse.proofs if self.inverse else ()), self.from_matrix)

    @property
    def is_proved(self) -> bool:
        return all(proof.is_exact for proof in self.proofs)

    def _step_of_turns(self) -> Step:
        """The product of cos(β/2) + sin(β/2) e over all turns, in the form of textbooks."""
        model = self.model
        factors = [half_turn(turn.direction, turn.angle) for turn in model.turns]
        entries = [*model.matrix, *(part for factor in factors for part in factor)]
        codec = codec_for(entries, constraints=model.constraints, order=0)
        whole = reduce(product, (tuple(map(codec.encode, factor)) for factor in factors))
        column = RingMatrix.column(codec.ring, map(codec.ring.reduce, whole))
        return self._proved_step(codec, presenter_for(codec).matrix(column))

    def _proved_step(self, codec: Codec, value: sp.ImmutableMatrix) -> Step:
        """That the quaternion represents R, and that its length is one."""
        model, prove = self.model, Prover(self.model, codec)
        is_fixed = value.free_symbols.isdisjoint(model.constants)
        same = codec.column(rotation_of(list(value)) - model.matrix)
        length = codec.column([value.dot(value) - 1])
        return Step(
            quantity=QUATERNION if is_fixed else QUATERNION._replace(inputs=("q", "parameters")),
            expression=value,
            words=text_of(self.because),
            proofs=(
                prove.vanishes(same, formula(r"\R(\p) = \R")),
                prove.vanishes(length, formula(r"\p\cdot\p = 1")),
            ),
        )


@cache
def _read_off() -> Proof:
    """4 p pᵀ = K(R): sums and differences of the entries of R, for every unit quaternion p."""
    model = parametrised("unit_quaternion")
    column = sp.Matrix(model.coordinates)
    residual = outer_product(model.matrix) - 4 * column * column.T
    return vanishing(model, [claim(r"4\,\p\p^T = \mathbf{K}", *residual)])[0]


# Conversions as functions: their arguments, their values in order, and remarks on them

MATRIX = tuple(f"r{row}{column}" for row in (1, 2, 3) for column in (1, 2, 3))


def converted(derivation: Derivation) -> Converted:
    """The functions of the conversions; where there is no inverse, a remark says why."""
    conversions = Conversions(derivation.model)
    inverse = conversions.inverse
    steps: tuple[Step, ...] = ()  # the unit quaternion, where it has a formula of its own
    functions: tuple[ConversionFunction, ...] = ()
    number = len(derivation.steps) + 1  # in the note
    if inverse is not None and inverse.rule == "quaternion":
        functions = (_of_any_length(derivation, inverse, number),)
    elif inverse is not None and inverse.rule == "rotation_vector":
        functions = (_of_rotation_vector(derivation, number),)
    elif conversions.quaternion is not None:
        steps = (replace(conversions.quaternion, number=number),)
    else:
        functions = (_quaternion_of_matrix(derivation),)
    continuity = None
    if inverse is not None:
        functions += (_from_quaternion(inverse), from_matrix(derivation, inverse))
        if "continuity" in inverse.words:  # the coordinates are not unique
            kind = "quaternion" if inverse.rule in BOTH_SIGNS else inverse.rule
            continuity = Continuity(kind, (inverse.words["continuity"],), inverse.quarters)
    return Converted(
        steps=steps,
        functions=functions,
        continuity=continuity,
        remarks=(conversions.without,) if conversions.without else (),
    )


def _function(
    values: NamedValues,
    name: str,
    inputs: Sequence[ConversionInput],
    outputs: Vector,
    *remarks: str,
    words: str = "",
    symbol: str = "q",
    unit: str = "",
    **holes: object,
) -> ConversionFunction:
    """A function, with the sentences of its name, or of `words`, whose holes are filled."""
    texts = WORDS["functions"][words or name]
    return ConversionFunction(
        name=name,
        symbol=symbol,
        inputs=tuple(inputs),
        values=tuple(values.lines),
        outputs=tuple(outputs),
        about=texts["about"].format(**holes),
        remarks=(*remarks, *(r.format(**holes) for r in texts.get("remarks", ()))),
        unit=unit,
    )


def _from_quaternion(inverse: InverseRule) -> ConversionFunction:
    parts = symbols(PARTS)
    values = NamedValues(parts[0])
    order = "last" if inverse.is_scalar_last else "first"
    listed = scalar_last(parts) if inverse.is_scalar_last else parts
    about = WORDS["functions"]["from_quaternion"]["input"].format(order=order)
    return _function(
        values,
        "from_quaternion",
        [ConversionInput(argument=argument_of("quaternion", listed, about))],
        inverse.from_quaternion(values, scaled(values, parts)),
        *_remarks(inverse),
        unit=_unit(inverse.model),
        order=order,
    )


def from_matrix(derivation: Derivation, inverse: InverseRule) -> ConversionFunction:
    """The function `from_rotation_matrix`."""
    model = derivation.model
    entries = symbols(MATRIX)
    values = NamedValues(entries[0])
    matrix = sp.Matrix(3, 3, entries)
    shown = "A, the transpose of R" if model.passive else "R"
    about = WORDS["functions"]["from_rotation_matrix"]["input"].format(shown=shown)
    return _function(
        values,
        "from_rotation_matrix",
        [ConversionInput(argument=argument_of("matrix", entries, about), is_matrix=True)],
        inverse.from_matrix(values, matrix.T if model.passive else matrix),
        *_remarks(inverse),
        unit=_unit(model),
        shown=shown,
        shepperd=SHEPPERD,
    )


def _remarks(inverse: InverseRule) -> tuple[str, ...]:
    return text_of(inverse.because), text_of(inverse.branch)


def _unit(model: RotationModel) -> str:
    units = dict.fromkeys(model.coordinate_units)
    return next(iter(units)) if len(units) == 1 else f"({', '.join(model.coordinate_units)})"


def _quaternion_of_matrix(derivation: Derivation) -> ConversionFunction:
    """The quaternion of a rotation that is known only by its matrix."""
    model = derivation.model
    steps = {step.quantity.name: step.expression for step in derivation.steps}
    presented = steps.get("rotation_matrix")
    if presented is None:
        matrix = sp.Matrix(model.matrix)
    else:
        matrix = sp.Matrix(presented.T if model.passive else presented)
    entries = symbols(MATRIX)
    values = NamedValues(model.coordinates[0])
    quaternion = short_way(values, shepperd(values, sp.Matrix(3, 3, entries)))
    names = ("q", "parameters") if model.constants else ("q",)
    function = _function(
        values,
        "quaternion",
        [ConversionInput(argument=derivation.argument(name)) for name in names],
        unit(values, quaternion),
        words="quaternion_of_matrix",
        symbol="p",
        shepperd=SHEPPERD,
    )
    return replace(function, shared=tuple(zip(entries, matrix, strict=True)))


def _of_any_length(derivation: Derivation, rule: InverseRule, number: int) -> ConversionFunction:
    q, is_last = derivation.model.coordinates, rule.is_scalar_last
    values = NamedValues(q[0])
    parts = unit(values, scaled(values, (q[3], *q[:3]) if is_last else q))
    return _function(
        values,
        "quaternion",
        [ConversionInput(argument=derivation.argument("q"))],
        scalar_last(parts) if is_last else parts,
        words="quaternion_of_any_length",
        symbol="p",
        order="last" if is_last else "first",
        number=number,
    )


def _of_rotation_vector(derivation: Derivation, number: int) -> ConversionFunction:
    """Where n² is too small for a float, sin(n/2)/n is 1/2."""
    q = derivation.argument("q")
    values = NamedValues(q.symbols[0])
    size = values.let("square", square(q.symbols))
    none = sp.Eq(size, 0)
    length = values.let("length", sp.sqrt(Where(none, sp.S.One, size)))
    factor = values.let("factor", Where(none, sp.S.Half, sp.sin(length / 2) / length))
    parts = (Where(none, sp.S.One, sp.cos(length / 2)), *(factor * part for part in q.symbols))
    inputs = [ConversionInput(argument=q)]
    words = "quaternion_of_vector"
    return _function(values, "quaternion", inputs, parts, words=words, symbol="p", number=number)
