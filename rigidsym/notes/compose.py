"""Derivation -> Document, in the manner of a good lecture.

Equations carry the numbers of the steps; what is only recalled has none.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

from jinja2 import TemplateRuntimeError

from rigidsym.errors import offer
from rigidsym.formula.display import PAGE, Display, display
from rigidsym.formula.notation import DEFAULT, Notation
from rigidsym.formula.reader import text_of
from rigidsym.formula.tree import NOTHING, Formula
from rigidsym.mechanics.derivation import OF_RATES, Argument, Derivation, Proof, Step
from rigidsym.mechanics.quantities.dynamics import MOTION
from rigidsym.mechanics.quantities.energy import ENERGY, MOMENTUM
from rigidsym.mechanics.quantities.kinematics import (
    ACCELERATION,
    ANGULAR_VELOCITY,
    TURNED,
)
from rigidsym.models.parametrisations import GIVEN
from rigidsym.models.rotation import Citation, lecture
from rigidsym.notes.document import (
    Cited,
    CodeBlock,
    Document,
    Equation,
    EquationReference,
    FigureReference,
    NoteBlock,
    NoteTable,
    Paragraph,
    Section,
    Text,
)
from rigidsym.notes.end_tables import Claim, ClaimFacts, example_of, symbols
from rigidsym.notes.facts.convention import convention_facts
from rigidsym.notes.facts.motion import MotionFacts
from rigidsym.notes.facts.rotation import RotationFacts, angle_facts
from rigidsym.notes.facts.singular import singular_facts
from rigidsym.notes.fitting import Fitter, as_vectors
from rigidsym.notes.letters import entries_of, letters_of
from rigidsym.notes.summary import summary
from rigidsym.notes.template import blocks_of, sections_of
from rigidsym.notes.words import (
    symbols_of,
    with_source,
    with_symbols,
)

if TYPE_CHECKING:
    from rigidsym.mechanics.conversions.conversions import Conversions

_OF_STEPS = {  # parts of a note that have only the steps of a section
    "angular_acceleration": ACCELERATION,
    "energy": ENERGY,
    "momentum": MOMENTUM,
}
PARTS = (  # of a note, which its template places
    *("convention", "rotation", "rotation_of_the_lecture", "angular_velocity", "rates", "singular"),
    *("body", "motion", "conversions", "identities", "symbols", "functions", "summary"),
    *_OF_STEPS,
)


def template_of(style: str) -> str:
    """The name of the template of a style: lecture is en/lecture, and fr/lecture is itself."""
    return style if "/" in style else f"en/{style}"


class Composer:
    """The sections of one note.

    `module` is the file name of a kernel module and `functions` the quantities it evaluates; each
    of their equations names its function. Raises ModelError where a name of the model would be
    taken for one of the notation.
    """

    is_short = False  # whether the note does without tables at its end

    def __init__(
        self,
        derivation: Derivation,
        *,
        module: str | None = None,
        functions: Sequence[str] = (),
        notation: Notation = DEFAULT,
        conversions: Conversions | None = None,
        is_audit: bool = True,
    ) -> None:
        notation.check(derivation.model)
        self.derivation = derivation
        self.model = derivation.model
        self.module = module or ""
        self.functions = tuple(functions)
        self.conversions = conversions
        self.letters = letters_of(derivation.arguments, notation, derivation.model)
        self.symbols = symbols_of(derivation)
        self.is_audit = is_audit
        self.fitter = Fitter(derivation, self.letters, is_audit=is_audit)
        self.cited: set[Citation] = set()
        self.printed: dict[str, Equation] = {}  # by label, as far as the template has come

    @property
    def subtitle(self) -> str:
        return self.derivation.subject

    def document(self, name: str) -> Document:
        """The note, as a template orders its sections."""
        sections = list(sections_of(name, self.letters, **self.facts()))
        byline = [block for section in sections if not section.title for block in section.blocks]
        return Document(
            name=self.derivation.name,
            title=self.derivation.title,
            subtitle=self.subtitle,
            letters=self.letters,
            sections=tuple(s for s in sections if s.title and s.blocks),
            byline=tuple(text_of(block.text) for block in byline if isinstance(block, Paragraph)),
            language=name.split("/")[0],
        )

    def facts(self) -> dict[str, Any]:
        """What the template of a style may print, and the booleans that it asks."""
        singular = singular_facts(self.derivation)
        return {
            "blocks": self.blocks,
            "equation": self.equation,
            "reference": EquationReference,
            "cite": lambda source: Cited(Citation(text=source)),
            "is_body_alone": self.is_short,
            "is_gimbal_lock": singular is not None and singular.is_gimbal_lock,
            "is_proved": self.derivation.is_proved,
            "has_theory": bool(self.derivation.theory),
            "theory": self.theory(),
            "rotation_title": self.model.title,
            "angles": angle_facts(self.model),
            "source_of_theory": Cited(lecture()),
        }

    def blocks(self, part: str) -> list[NoteBlock]:
        """The blocks of one of PARTS, which are printed in order: names explained once stay so.

        Raises TemplateRuntimeError, with the nearest name, for any other.
        """
        if part not in PARTS:
            raise TemplateRuntimeError(f"no part {part!r} of a note; {offer(part, PARTS)}")
        section = _OF_STEPS.get(part)
        blocks = list(self._steps(section) if section else getattr(self, f"_{part}")())
        self.printed |= {b.label: b for b in blocks if isinstance(b, Equation) and b.number}
        return blocks

    def equation(self, name: str) -> Equation:
        """The numbered equation of a quantity, without the words that lead to it.

        Raises TemplateRuntimeError, with the nearest name, if the derivation lacks it.
        """
        if name not in self._displayed:
            known = offer(name, [*self._displayed])
            raise TemplateRuntimeError(f"nothing is derived by the name {name!r}; {known}")
        return self._displayed[name][0]

    def theory(self) -> Sequence[Section]:
        """The sections of the theory for every body and rotation; none here."""
        return ()

    def _summary(self) -> Iterator[NoteBlock]:
        """The results on one sheet."""
        yield from summary(self.derivation, self.printed, self.letters)

    def _symbols(self) -> Iterator[NoteTable]:
        yield symbols(self.derivation, self.letters)

    def _conversions(self) -> Iterator[NoteBlock]:
        """The section on the unit quaternion and the matrix, with its equation."""
        if self.conversions is None:
            return
        from rigidsym.notes.conversion_section import conversion_facts

        facts = conversion_facts(self.conversions)
        step = self.conversions.quaternion
        if step is not None:
            numbered = replace(step, number=len(self.derivation.steps) + 1)
            call = _call(step) if self.module else ""
            equation = equation_of(numbered, self.derivation.arguments)
            because = with_source(self.conversions.because, step.quantity.source)
            quaternion = replace(equation, function=call, is_result=True)
            facts |= {"because": because, "quaternion": quaternion}
        has_functions = bool(self.module)
        yield from blocks_of("en/conversions", self.letters, **facts, has_functions=has_functions)

    def _body(self) -> Iterator[NoteBlock]:
        """What is said of a body; nothing here."""
        return iter(())

    def _motion(self) -> Iterator[NoteBlock]:
        """Lagrange's and Euler's equations, and what is constant along every motion."""
        if self.derivation.forces is not None:
            facts = MotionFacts(self.derivation, self.letters)
            steps = list(self._steps(MOTION))
            yield from blocks_of("en/motion", self.letters, motion=facts, steps=steps)

    def _convention(self) -> Iterator[NoteBlock]:
        facts = convention_facts(self.derivation, self.letters)
        yield from blocks_of("en/convention", self.letters, **facts, angles=angle_facts(self.model))

    def _rotation(self) -> Iterator[NoteBlock]:
        yield from self._of_the_rotation("rotation")
        yield from self._steps(TURNED)

    def _angular_velocity(self) -> Iterator[NoteBlock]:
        yield from self._of_the_rotation("angular_velocity")
        yield from self._steps(ANGULAR_VELOCITY)

    def _of_the_rotation(self, name: str) -> Sequence[NoteBlock]:
        facts = RotationFacts(self.model, self.letters)
        first = FigureReference(1)
        return blocks_of(f"en/{name}", self.letters, rotation=facts, first_figure=first)

    def _rates(self) -> Sequence[NoteBlock]:
        steps = list(self._steps(OF_RATES))
        found = self.derivation.singularities
        if not steps and found is None:
            return ()
        has_no_inverse = found is not None and found.rank < 3
        return blocks_of("en/rates", self.letters, steps=steps, has_no_inverse=has_no_inverse)

    def _singular(self) -> Iterator[NoteBlock]:
        facts = singular_facts(self.derivation)
        if facts is None:
            return
        if facts.has_determinant:
            yield from blocks_of("en/singular_measure", self.letters, singular=facts)
        yield from blocks_of("en/singular", self.letters, singular=facts)

    @cached_property
    def _displayed(self) -> Mapping[str, tuple[Equation, Display]]:
        """The equations of all steps, with vectors if they have such a form, as they fit."""
        found = {
            s.quantity.name: as_vectors(self._equation(s), s, self.letters)
            for s in self.derivation.steps
        }
        return {name: (e, display(e, self.letters, PAGE)) for name, e in found.items()}

    def _steps(self, section: str) -> Iterator[NoteBlock]:
        for step in self.derivation.steps:
            if step.quantity.section == section:
                first, *others = self.fitter.fitted(*self._displayed[step.quantity.name], step)
                lead = self._lead(step)
                if isinstance(first, Paragraph):  # on abbreviations
                    *said, end = lead
                    end = end.replace(":", ".") if isinstance(end, str) else end
                    yield Paragraph((*said, end, " ", *first.text))
                else:
                    yield from (Paragraph(lead), first)
                yield from others

    def _lead(self, step: Step) -> Text:
        """How the quantity follows; a source is cited once."""
        source = self._source(step)
        if source in self.cited:
            source = None
        elif source:
            self.cited.add(source)
        is_matrix = step.quantity.name == "rotation_matrix"
        facts = RotationFacts(self.model, self.letters)
        is_told = facts.is_quaternion or facts.is_vector
        if is_matrix and is_told and not self.model.passive:
            return with_source(("The matrix of this rotation is:",), source)
        return with_source(with_symbols(step.because, self.symbols), source)

    def _source(self, step: Step) -> Citation | None:
        """The source of a step; the model's own is cited once, where the rotation is given."""
        is_given = step.quantity.name == "rotation_matrix" and not self.model.turns
        if is_given:
            return None if self.model.source.text == GIVEN else self.model.source
        return None if step.quantity.source == self.model.source else step.quantity.source

    def _equation(self, step: Step) -> Equation:
        function = _call(step) if step.quantity.name in self.functions else ""
        equation = equation_of(step, self.derivation.arguments)
        return replace(equation, function=function, is_result=step.quantity.is_result)

    def _identities(self) -> Iterator[NoteBlock]:
        steps = self.derivation.steps
        yield from self._claims([(s.quantity.name, p) for s in steps for p in s.proofs])

    def _claims(self, claims: Sequence[Claim]) -> Sequence[NoteBlock]:
        """A table of claims, each with the label of its equation."""
        facts = [ClaimFacts(label, proof) for label, proof in claims]
        unproved = [fact for fact in facts if not fact.is_exact]
        return blocks_of(
            "en/identities",
            self.letters,
            claims=facts,
            unproved=unproved,
            has_status=self.is_audit or bool(unproved),
            has_theory=bool(self.derivation.theory),
        )

    def _functions(self) -> Iterator[NoteBlock]:
        if self.functions:
            example = CodeBlock(example_of(self.derivation, self.module, self.functions))
            module = {"module": self.module, "example": example}
            yield from blocks_of("en/functions", self.letters, **module)


def claims_of(proofs: Iterable[Proof]) -> tuple[tuple[Formula, ...], tuple[Formula, ...]]:
    """The proved claims, and the unproved ones."""
    proofs = list(proofs)
    return (
        tuple([proof.claim for proof in proofs if proof.status == "exact"]),
        tuple([proof.claim for proof in proofs if proof.status != "exact"]),
    )


def equation_of(step: Step, arguments: Iterable[Argument]) -> Equation:
    """The numbered equation of a step."""
    quantity = step.quantity
    definition = () if quantity.definition == NOTHING else (quantity.definition,)
    proved, unproved = claims_of(step.proofs)
    is_scalar = quantity.shape == "scalar"
    is_matrix = not (is_scalar or step.recursion)
    return Equation(
        sides=(quantity.symbol, step.recursion)
        if step.recursion
        else (quantity.symbol, *definition),
        matrix=step.expression if is_matrix else None,
        scalar=step.expression[0] if is_scalar else None,
        entries=entries_of(step, arguments) if is_matrix else (),
        number=step.number,
        label=quantity.name,
        proved=proved,
        unproved=unproved,
    )


def _call(step: Step) -> str:
    return f"{step.quantity.name}({', '.join(step.quantity.inputs)})"
