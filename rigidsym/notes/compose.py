"""Derivation -> Document, in the manner of a good lecture.

Equations carry the numbers of the steps; what is only recalled has none.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import sympy as sp

from rigidsym.mechanics.claims import orthogonal, skew, spin_of
from rigidsym.mechanics.derivation import Derivation, Markup, Proof, Step
from rigidsym.mechanics.quantities import BODY, COSINES, RATES, ROTATION, SPACE
from rigidsym.models.rotation import Citation
from rigidsym.models.so3 import elementary, hat
from rigidsym.notes.document import (
    Block,
    Cited,
    Code,
    Document,
    Equation,
    EquationReference,
    EquationRow,
    Paragraph,
    Section,
    Strong,
    Table,
    Text,
)
from rigidsym.notes.entries import RESIDUAL, entry_names, indexed
from rigidsym.notes.formula import markup
from rigidsym.notes.notation import notation_of
from rigidsym.notes.prose import DETERMINANTS, equal, motion, product, proofs_in_words, turn, zeros
from rigidsym.notes.words import (
    convention,
    singular,
    symbols_of,
    unit_in_words,
    with_symbols,
    words,
)

_OPERATOR = Markup(r"\mathbf{C}(\mathbf{u})", "C(u)")
_TURN_ANGLES = ("beta", "chi", "delta", "epsilon")  # one that no coordinate is called by is taken

_ANGULAR_VELOCITY = (
    "rotation_rate",
    "spin_matrix",
    "angular_velocity_space",
    "angular_velocity_body",
)
_RATES = tuple(
    f"{name}_{frame}"
    for frame in ("space", "body")
    for name in ("rate_matrix", "inverse_rate_matrix", "rates_from_angular_velocity")
)
_ACCELERATION = ("angular_acceleration_space", "angular_acceleration_body")


def compose(
    derivation: Derivation, *, module: str | None = None, functions: Sequence[str] = ()
) -> Document:
    """The note of a derivation.

    `module` is the file name of a kernel module and `functions` the quantities it evaluates; each
    of their equations names its function.
    """
    composer = _Composer(derivation, module, tuple(functions))
    return Document(
        name=derivation.name,
        title=derivation.title,
        subtitle="Kinematics of a rotation",
        notation=composer.notation,
        sections=tuple(composer.sections()),
    )


class _Composer:
    """The sections of one note."""

    def __init__(
        self, derivation: Derivation, module: str | None, functions: tuple[str, ...]
    ) -> None:
        self.derivation = derivation
        self.model = derivation.model
        self.module = module
        self.functions = functions
        self.notation = notation_of(derivation.arguments)
        self.symbols = symbols_of(derivation)
        self.said: set[str] = set()

    def sections(self) -> Iterator[Section]:
        parts = {
            "Convention": self._convention(),
            "The rotation": self._rotation(),
            "The angular velocity": self._angular_velocity(),
            "The rates of the coordinates": self._rates(),
            "Where the rates fail": self._singularities(),
            "The angular acceleration": self._steps(_ACCELERATION),
            "What was proved": self._proofs(),
            "Functions": self._functions(),
        }
        filled = ((title, tuple(blocks)) for title, blocks in parts.items())
        return (Section(title, blocks) for title, blocks in filled if blocks)

    def _convention(self) -> Iterator[Block]:
        return (Paragraph(text) for text in convention(self.derivation))

    def _rotation(self) -> Iterator[Block]:
        if self.model.turns:
            yield from self._product_of_turns()
        yield from self._steps(("rotation_matrix",))

    def _product_of_turns(self) -> Iterator[Block]:
        yield Paragraph(
            words("The rotation is a product of turns\u00a0{}:", Cited(self.model.source))
        )
        turns = [turn(t.axis, markup(t.angle, self.notation)) for t in self.model.turns]
        yield Equation(sides=(ROTATION, product(turns)))
        yield Paragraph(
            (
                "Read from left to right, they are about the axes as they have turned; read from "
                "right to left, about the axes fixed in space. Right-handed turns by an angle ",
                markup(self._turn_angle(), self.notation),
                " are",
            )
        )
        yield EquationRow(tuple(self._elementary(axis) for axis in self._axes()))

    def _axes(self) -> list[str]:
        return sorted({t.axis for t in self.model.turns})

    def _turn_angle(self) -> sp.Symbol:
        taken = {coordinate.func.__name__ for coordinate in self.model.coordinates}
        return sp.Symbol(next(name for name in _TURN_ANGLES if name not in taken))

    def _elementary(self, axis: str) -> Equation:
        angle = self._turn_angle()
        side = turn(axis, markup(angle, self.notation))
        return Equation(sides=(side,), matrix=elementary(axis, angle))

    def _angular_velocity(self) -> Iterator[Block]:
        shown = COSINES if self.model.passive else ROTATION
        yield from motion(passive=self.model.passive)
        yield Equation(sides=(_OPERATOR,), matrix=hat(sp.Matrix(sp.symbols("u_1:4"))))
        yield Paragraph(
            words("That it is skew follows from {} by differentiation:", orthogonal(shown))
        )
        yield Equation(sides=(skew(spin_of(shown)),))
        yield from self._steps(_ANGULAR_VELOCITY)

    def _rates(self) -> Iterator[Block]:
        yield Paragraph(
            words(
                "The rate matrices are defined by {} and {}, so that {}.",
                equal(SPACE.omega, product([SPACE.matrix, RATES])),
                equal(BODY.omega, product([BODY.matrix, RATES])),
                equal(SPACE.matrix, product([ROTATION, BODY.matrix])),
            )
        )
        yield from self._steps(_RATES)
        if self.derivation.singularities is None:
            yield Paragraph(("The rate matrices have no inverse; the rates are not solved for.",))

    def _singularities(self) -> Iterator[Block]:
        singularities = self.derivation.singularities
        if singularities is None:
            return
        yield Paragraph(("Both rate matrices have the determinant",))
        value = markup(singularities.determinant, self.notation)
        yield Equation(sides=(*DETERMINANTS, value))
        yield Paragraph(zeros(singularities, self.notation))
        for point in singularities.points:
            yield Paragraph(singular(point, self.derivation))

    def _steps(self, names: Sequence[str]) -> Iterator[Block]:
        for step in self.derivation.steps:
            if step.quantity.name in names:
                yield Paragraph(self._lead(step))
                yield self._equation(step)

    def _lead(self, step: Step) -> Text:
        """How the quantity follows; what has been said once is not said again."""
        if step.because in self.said:
            return (f"Likewise, the {step.quantity.about}:",)
        self.said.add(step.because)
        source = self._source(step)
        if source is None:
            return with_symbols(step.because, self.symbols)
        sentence = with_symbols(step.because.removesuffix("."), self.symbols)
        return (*sentence, "\u00a0", Cited(source), ".")

    def _source(self, step: Step) -> Citation | None:
        """The source of a step; the model's own is cited once, where the rotation is given."""
        is_given = step.quantity.name == "rotation_matrix" and not self.model.turns
        if is_given:
            return self.model.source
        return None if step.quantity.source == self.model.source else step.quantity.source

    def _equation(self, step: Step) -> Equation:
        quantity = step.quantity
        definition = () if not quantity.definition.text else (quantity.definition,)
        return Equation(
            sides=(quantity.symbol, *definition),
            matrix=step.expression,
            entries=entry_names(step, self.derivation),
            number=step.number,
            label=quantity.name,
            function=_call(step) if quantity.name in self.functions else "",
            proved=tuple(proof.claim for proof in step.proofs if proof.is_exact),
            unproved=tuple(proof.claim for proof in step.proofs if not proof.is_exact),
        )

    def _proofs(self) -> Iterator[Block]:
        yield Paragraph(proofs_in_words(is_proved=self.derivation.is_proved))
        yield Table(
            head=(("Equation",), ("Claim",), ("Status",)),
            rows=tuple(
                (_reference(step), (proof.claim,), _status(proof))
                for step in self.derivation.steps
                for proof in step.proofs
            ),
        )
        for proof in self.derivation.proofs:
            if not proof.is_exact:
                yield from _left_over(proof)

    def _functions(self) -> Iterator[Block]:
        if not self.module:
            return
        yield Paragraph(
            words(
                "The module {} evaluates the equations for arrays of any shape, components last.",
                Code(self.module),
            )
        )
        yield Table(
            head=(("Equation",), ("Quantity",), ("Function",), ("Unit",)),
            rows=tuple(
                (
                    _reference(step),
                    (step.quantity.symbol,),
                    (Code(_call(step)),),
                    (unit_in_words(step.quantity.unit),),
                )
                for step in self.derivation.steps
                if step.quantity.name in self.functions
            ),
        )


def _call(step: Step) -> str:
    return f"{step.quantity.name}({', '.join(step.quantity.inputs)})"


def _reference(step: Step) -> Text:
    return (EquationReference(step.quantity.name),)


def _status(proof: Proof) -> Text:
    return ("exact",) if proof.is_exact else (Strong("unproved"),)


def _left_over(proof: Proof) -> Iterator[Block]:
    """What remains of a claim that could not be decided."""
    yield Paragraph((Strong("Unproved:"), " ", proof.claim, ". What is left over is"))
    if proof.residual is not None:
        yield Equation(
            sides=(RESIDUAL,),
            matrix=proof.residual,
            entries=indexed(RESIDUAL, proof.residual.shape),
        )
