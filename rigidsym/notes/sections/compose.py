"""Derivation -> Document, in the manner of a good lecture.

Equations carry the numbers of the steps; what is only recalled has none.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from itertools import chain
from typing import TYPE_CHECKING

import sympy as sp

from rigidsym.formula.display import PAGE, Display, display
from rigidsym.formula.notation import DEFAULT, Notation
from rigidsym.formula.reader import formula, sentence
from rigidsym.formula.scalars import formula_of
from rigidsym.formula.tree import NOTHING, Formula, row
from rigidsym.mechanics.derivation import Argument, Derivation, Proof, Step
from rigidsym.mechanics.quantities.dynamics import DYNAMICS_QUANTITIES, EULER_QUANTITIES
from rigidsym.mechanics.quantities.energy import ENERGIES, MOMENTA
from rigidsym.mechanics.quantities.kinematics import BODY, RATES, ROTATION, SPACE
from rigidsym.models.matrices import GIVEN
from rigidsym.models.rotation import Citation, by_axis
from rigidsym.notes.document.document import (
    Cited,
    Document,
    Equation,
    EquationRow,
    Figure,
    FigureReference,
    NoteBlock,
    NoteTable,
    Paragraph,
    Section,
    Text,
)
from rigidsym.notes.formula.derivation_letters import entries_of, letters_of
from rigidsym.notes.prose.rotation_words import (
    angles_in_words,
    figure_of,
    is_told,
    rates_in_words,
    rotation_in_words,
    sum_in_words,
)
from rigidsym.notes.prose.singular_words import (
    failures,
    meaning,
    measured,
    singular_title,
)
from rigidsym.notes.prose.words import (
    ACTIVE_MOTION,
    PASSIVE_MOTION,
    convention,
    symbols_of,
    turn,
    with_source,
    with_symbols,
)
from rigidsym.notes.sections.boxed import RESULTS
from rigidsym.notes.sections.end_tables import claims_in_a_table, functions, program, symbols
from rigidsym.notes.sections.fitting import Fitter, as_vectors
from rigidsym.notes.sections.motion_section import what_follows, what_is_constant, what_moves
from rigidsym.notes.sections.summary import TITLE as SUMMARY, summary

if TYPE_CHECKING:
    from rigidsym.mechanics.conversions.conversions import Conversions

IDENTITIES, SYMBOLS, FUNCTIONS = "Identities verified", "Symbols", "Functions"
_TURN_ANGLES = ("beta", "chi", "delta", "epsilon")  # one that no coordinate is called by is taken

_RATE_MATRICES = Paragraph(
    sentence(
        "The rate matrices are defined by {} and {}, so that {}.",
        formula("#1 = #2#3", SPACE.omega, SPACE.matrix, RATES),
        formula("#1 = #2#3", BODY.omega, BODY.matrix, RATES),
        formula("#1 = #2#3", SPACE.matrix, ROTATION, BODY.matrix),
    )
)
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
ACCELERATION = ("angular_acceleration_space", "angular_acceleration_body")


class Composer:
    """The sections of one note.

    `module` is the file name of a kernel module and `functions` the quantities it evaluates; each
    of their equations names its function. Raises ModelError where a name of the model would be
    taken for one of the notation.
    """

    of_the_body = ""  # ends titles that the theory has too
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
        self.fitter = Fitter(derivation, self.letters, is_audit=is_audit)
        self.cited: set[Citation] = set()

    @property
    def subtitle(self) -> str:
        return self.derivation.subject

    def document(self, left_out: Collection[str] = ()) -> Document:
        """The note, without the sections of these titles."""
        return Document(
            name=self.derivation.name,
            title=self.derivation.title,
            subtitle=self.subtitle,
            letters=self.letters,
            sections=tuple(self.sections(left_out)),
            program=program(self.derivation),
        )

    def sections(self, left_out: Collection[str]) -> Iterator[Section]:
        """The sections that have anything in them, and the summary."""
        parts = chain(self.beginning(), self.end())
        filled = ((title, tuple(blocks)) for title, blocks in parts if title not in left_out)
        sections = [Section(title, blocks) for title, blocks in filled if blocks]
        yield from sections
        if not self.is_short and SUMMARY not in left_out:
            yield self.summary(sections)

    def beginning(self) -> Iterator[tuple[str, Iterator[NoteBlock]]]:
        """Titles with their blocks, up to where the rates are taken."""
        yield "Convention", self._convention()
        yield "The rotation", self._rotation()
        yield "The angular velocity", self._angular_velocity()

    def end(self) -> Iterator[tuple[str, Iterator[NoteBlock]]]:
        """Titles with their blocks, from where the rates are taken."""
        yield "The rates of the coordinates", self._rates()
        yield singular_title(self.derivation), self._singularities()
        yield "The angular acceleration", self._steps(ACCELERATION)
        yield "The body", self._body()
        yield f"The kinetic energy{self.of_the_body}", self._steps(ENERGIES)
        yield f"The angular momentum{self.of_the_body}", self._steps(MOMENTA)
        yield "The equations of motion", self._motion()
        yield "Conversions", self._conversions()
        yield IDENTITIES, self._proofs()
        yield SYMBOLS, self.symbol_table()
        yield FUNCTIONS, self._functions()

    def summary(self, sections: Sequence[Section]) -> Section:
        """The results on one sheet."""
        return summary(self.derivation, sections, self.letters)

    def symbol_table(self) -> Iterator[NoteTable]:
        yield symbols(self.derivation, self.letters)

    def _conversions(self) -> Iterator[NoteBlock]:
        """The section on the unit quaternion and the matrix, with its equation."""
        if self.conversions is None:
            return
        from rigidsym.notes.sections.conversion_section import blocks_of_conversions

        step = self.conversions.quaternion
        if step is not None:
            numbered = replace(step, number=len(self.derivation.steps) + 1)
            call = _call(step) if self.module else ""
            equation = equation_of(numbered, self.derivation.arguments)
            yield Paragraph(with_source(self.conversions.because, step.quantity.source))
            yield replace(equation, function=call, is_result=True)
        yield from blocks_of_conversions(self.conversions, has_functions=bool(self.module))

    def _body(self) -> Iterator[NoteBlock]:
        """What is said of a body; nothing here."""
        return iter(())

    def _motion(self) -> Iterator[NoteBlock]:
        """Lagrange's and Euler's equations, and what is constant along every motion."""
        if self.derivation.forces is not None:
            yield from what_moves(self.derivation, self.letters)
            yield from self._steps((*DYNAMICS_QUANTITIES, *EULER_QUANTITIES))
            yield from what_is_constant(self.derivation, self.letters)
            yield from what_follows(self.derivation, self.letters)

    def _convention(self) -> Iterator[NoteBlock]:
        first, *others = convention(self.derivation, self.symbols, self.letters.notation)
        texts = (first, *angles_in_words(self.model, self.letters), *others)
        return map(Paragraph, texts)

    def _rotation(self) -> Iterator[NoteBlock]:
        if self.model.turns:
            yield from self._product_of_turns()
        else:
            yield from self._figure()
            yield from rotation_in_words(self.model, self.letters)
        yield from self._steps(("rotation_matrix",))

    def _product_of_turns(self) -> Iterator[NoteBlock]:
        turns, angle = [turn(t, self.letters) for t in self.model.turns], self._turn_angle()
        product, any_angle = row(*turns), formula_of(angle, self.letters)
        kind = "a product of turns" if len(turns) > 1 else "a single turn"
        figure = list(self._figure())
        see = (", shown in Figure\u00a0", FigureReference(1)) if figure else ()
        yield Paragraph((f"The rotation is {kind}\u00a0", Cited(self.model.source), *see, ":"))
        yield Equation(sides=(ROTATION, product))
        yield from figure
        if len(turns) > 1:
            read = (
                "Read from left to right, the factors are rotations about the current axes of the "
                "body; read from right to left, about the axes fixed in space. Right-handed turns "
                "by an angle "
            )
            yield Paragraph((read, any_angle, " are"))
        else:
            yield Paragraph(("The right-handed turn by an angle ", any_angle, " is"))
        shown = [
            (t, Equation(sides=(turn(t, self.letters),), matrix=matrix))
            for t, matrix in by_axis(self.model.turns, angle)
        ]
        short = tuple(equation for t, equation in shown if not t.components)
        if short:
            yield EquationRow(short)
        yield from (equation for t, equation in shown if t.components)

    def _figure(self) -> Iterator[Figure]:
        figure = figure_of(self.model, self.letters)
        if figure is not None:
            yield figure

    def _turn_angle(self) -> sp.Symbol:
        taken = {coordinate.func.__name__ for coordinate in self.model.coordinates}
        return sp.Symbol(next(name for name in _TURN_ANGLES if name not in taken))

    def _angular_velocity(self) -> Iterator[NoteBlock]:
        yield from sum_in_words(self.model, self.letters)
        yield from rates_in_words(self.model, self.letters)
        yield from PASSIVE_MOTION if self.model.passive else ACTIVE_MOTION
        yield from self._steps(_ANGULAR_VELOCITY)

    def _rates(self) -> Iterator[NoteBlock]:
        steps = list(self._steps(_RATES))
        found = self.derivation.singularities
        if not steps and found is None:
            return
        yield _RATE_MATRICES
        yield from steps
        if found is not None and found.rank < 3:
            yield Paragraph(
                ("The rate matrices have no inverse, so that the rates do not follow from Ω.",)
            )

    def _singularities(self) -> Iterator[NoteBlock]:
        found = self.derivation.singularities
        if found is None:
            return
        if found.determinant is not None:
            yield Paragraph(meaning(found))
            value = formula_of(found.determinant, self.letters)
            yield Equation(sides=(*measured(found), value))
        yield from map(Paragraph, failures(self.derivation, found))

    @cached_property
    def _displayed(self) -> Mapping[str, tuple[Equation, Display]]:
        """The equations of all steps, with vectors if they have such a form, as they fit."""
        found = {
            s.quantity.name: as_vectors(self._equation(s), s, self.letters)
            for s in self.derivation.steps
        }
        return {name: (e, display(e, self.letters, PAGE)) for name, e in found.items()}

    def _steps(self, names: Sequence[str]) -> Iterator[NoteBlock]:
        for step in self.derivation.steps:
            if step.quantity.name in names:
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
        if is_matrix and is_told(self.model) and not self.model.passive:
            return with_source(("The matrix of this turn is:",), source)
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
        is_result = step.quantity.name in RESULTS
        return replace(equation, function=function, is_result=is_result)

    def _proofs(self) -> Iterator[NoteBlock]:
        steps = self.derivation.steps
        yield from claims_in_a_table([(s.quantity.name, p) for s in steps for p in s.proofs])

    def _functions(self) -> Iterator[NoteBlock]:
        if self.functions:
            yield from functions(self.derivation, self.module, self.functions)


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
