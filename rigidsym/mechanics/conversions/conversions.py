"""Coordinates to the unit quaternion and back, and from R: with proofs, and as functions.

A quaternion p is scalar first here, (p_0, p_1, p_2, p_3); only the results for a model with a
scalar-last quaternion have its order. It represents R, which turns the body, even if a model
presents the transpose.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property, reduce
from itertools import chain

import sympy as sp

from rigidsym.algebra.codec import codec_for
from rigidsym.algebra.matrix import RingMatrix
from rigidsym.algebra.present import presenter_for
from rigidsym.errors import AlgebraError
from rigidsym.formula.reader import Sentence, formula, sentence, text_of
from rigidsym.mechanics.conversions.function import (
    MATRIX,
    PARTS,
    SHEPPERD,
    Continuity,
    ConversionFunction,
    Converted,
    NamedValues,
    half_turn,
    outer_product,
    product,
)
from rigidsym.mechanics.conversions.rules import WORDS, Rule, rule_of, vanishing
from rigidsym.mechanics.derivation import Derivation, Proof, Quantity, Step, argument
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
    def inverse(self) -> Rule | None:
        """How the coordinates follow from a quaternion of any length but zero."""
        return rule_of(self.model)

    @cached_property
    def quaternion(self) -> Step | None:
        """The unit quaternion; None if it has no short closed form."""
        model, rule = self.model, self.inverse
        # R = R₁ R₂ ⋯ has the quaternion p₁ p₂ ⋯, and the turn by β about e has
        # cos(β/2) + sin(β/2) e.
        factors = [half_turn(turn.direction, turn.angle) for turn in model.turns]
        if rule is not None and rule.quaternion:
            factors = [rule.quaternion]
        # Each factor has two terms, cos and sin, so a product of n turns has up to 2ⁿ terms an
        # entry.
        if not 0 < len(factors) <= LONGEST_CHAIN:
            return None
        entries = [*model.matrix, *chain.from_iterable(factors)]
        try:
            codec = codec_for(entries, constraints=model.constraints, order=0)
            value = sp.ImmutableMatrix(factors[0])
            if len(factors) > 1:
                whole = reduce(product, (tuple(map(codec.encode, factor)) for factor in factors))
                value = presenter_for(codec).matrix(RingMatrix.column(codec.ring, whole))
        except AlgebraError:  # half of a fixed angle need not have a sine that is a root
            return None
        prove, is_fixed = Prover(model, codec), value.free_symbols.isdisjoint(model.constants)
        # ±p are the same rotation, so R(p) = R and |p| = 1 are all that can be claimed.
        same = codec.column(rotation_of(list(value)) - model.matrix)
        proofs = (
            prove.vanishes(same, formula(r"\R(\p) = \R")),
            prove.vanishes(codec.column([value.dot(value) - 1]), formula(r"\p\cdot\p = 1")),
        )
        if not all(proof.is_exact for proof in proofs):
            return None  # where it is a root of a root, the ring may not know that
        quantity = QUATERNION if is_fixed else QUATERNION._replace(inputs=("q", "parameters"))
        if rule is not None:
            value = sp.ImmutableMatrix(rule.listed(tuple(value)))
            quantity = quantity._replace(about=quantity.about.replace("first", rule.scalar))
        words = text_of(self.because)
        return Step(quantity=quantity, expression=value, words=words, proofs=proofs)

    @property
    def because(self) -> Sentence:
        """How the quaternion follows."""
        kind = self.inverse.kind if self.inverse else "euler"
        return sentence(WORDS["turns" if kind == "euler" else kind]["forward"])

    @property
    def without(self) -> str:
        """What to use in place of an inverse; empty if there is one."""
        return "" if self.inverse else WORDS["without"]

    @cached_property
    def from_matrix(self) -> Proof:
        """4 p pᵀ = K(R): sums and differences of the entries of R, for every unit quaternion p."""
        model = parametrised("unit_quaternion")
        column = sp.Matrix(model.coordinates)
        # R is quadratic in p, so each entry is a polynomial that vanishes by p·p = 1.
        residual = outer_product(model.matrix) - 4 * column * column.T
        return vanishing(model, [(tuple(residual), formula(r"4\,\p\p^T = \mathbf{K}"))])[0]

    @property
    def proofs(self) -> tuple[Proof, ...]:
        forward = self.quaternion.proofs if self.quaternion else ()
        return (*forward, *(self.inverse.proofs if self.inverse else ()), self.from_matrix)

    @property
    def is_proved(self) -> bool:
        return all(proof.is_exact for proof in self.proofs)


def converted(derivation: Derivation) -> Converted:
    """The functions of the conversions; where there are none, a remark says why."""
    conversions = Conversions(derivation.model)
    rule, step = conversions.inverse, conversions.quaternion
    number = len(derivation.steps) + 1  # in the note
    steps = (replace(step, number=number),) if step else ()
    if rule is None:
        remarks = (WORDS["without"], *(() if step else (WORDS["without_quaternion"],)))
        return Converted(steps=steps, remarks=remarks)
    functions = [_to_coordinates(rule, source) for source in ("quaternion", "rotation_matrix")]
    if rule.forward is not None:
        q = derivation.argument("q")
        values = NamedValues(q.symbols)
        parts = rule.forward(values, tuple(q.symbols[place] for place in rule.order))
        forward = ConversionFunction(
            name="quaternion",
            symbol="p",
            argument=q,
            values=tuple(values.lines),
            outputs=rule.listed(parts),
            about=QUATERNION.about.replace("first", rule.scalar),
            remarks=(
                *([f"Equation ({number}) of the note."] if step else []),
                WORDS[rule.kind]["function"],
            ),
        )
        steps, functions = (), [forward, *functions]
    continuity = None
    if "continuity" in rule.words:  # the coordinates are not unique
        kind = rule.kind.replace("unit_", "")
        continuity = Continuity(kind, (rule.words["continuity"],), rule.quarters)
    return Converted(steps, tuple(functions), continuity)


def _to_coordinates(rule: Rule, source: str) -> ConversionFunction:
    """`from_quaternion` or `from_rotation_matrix`."""
    is_matrix = source == "rotation_matrix"
    inputs: Sequence[sp.Symbol] = tuple(map(sp.Dummy, MATRIX if is_matrix else PARTS))
    values = NamedValues(inputs)
    if is_matrix:
        matrix, kind = sp.Matrix(3, 3, inputs), "R"
        if rule.model.passive:  # The rules are about R; a passive model presents A = Rᵀ.
            matrix, kind = matrix.T, "A, the transpose of R"
        coordinates = rule.from_matrix(values, matrix)
    else:
        # The way back holds for every length but zero, so the quaternion is scaled and not
        # normalised: the sum of sizes needs no root, and no square can overflow.
        coordinates = rule.from_quaternion(values, values.scaled(inputs))
        inputs, kind = rule.listed(inputs), f"scalar {rule.scalar}"
    texts, units = WORDS["functions"][source], rule.model.coordinate_units
    remarks = (rule.because, rule.branch, sentence(texts["remark"].format(SHEPPERD)))
    name, about = source.removeprefix("rotation_"), texts["input"].format(kind)
    return ConversionFunction(
        name=f"from_{source}",
        argument=argument(name, inputs, about, names=[symbol.name for symbol in inputs]),
        is_matrix=is_matrix,
        values=tuple(values.lines),
        outputs=coordinates,
        about=texts["about"].format(kind),
        remarks=tuple(map(text_of, remarks)),
        unit=units[0] if len({*units}) == 1 else f"({', '.join(units)})",
    )
