"""Derivation -> Document, in the manner of a good lecture.

The template of a style orders the sections. It has the facts, and prints the equations of a section
by `steps`, one equation by `equation`. Equations carry the numbers of the steps; what is only
recalled has none.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import replace
from functools import cached_property
from itertools import groupby
from typing import TYPE_CHECKING, Any

import sympy as sp
from jinja2 import TemplateRuntimeError

from rigidsym.errors import offer
from rigidsym.formula.notation import DEFAULT, Notation
from rigidsym.formula.reader import formula, named, text_of
from rigidsym.formula.scalars import formula_of
from rigidsym.formula.tree import COMMA, Bracket, Formula, joined, with_names
from rigidsym.mechanics.conversions.function import SHEPPERD, outer_product
from rigidsym.mechanics.derivation import OF_RATES, Derivation, Proof, Statement, Step, sentence_of
from rigidsym.mechanics.quantities.dynamics import LETTERS
from rigidsym.mechanics.quantities.kinematics import ROTATION
from rigidsym.mechanics.quantities.table import own_letters, stems_of
from rigidsym.models.parametrisations import GIVEN
from rigidsym.models.rotation import SOURCES, Citation, hat, lecture
from rigidsym.notes import document as doc
from rigidsym.notes.equations import claims_of, equation_of, in_parts, sums
from rigidsym.notes.facts.rotation import RotationFacts, facts_of_rotation, product_of, title_of
from rigidsym.notes.facts.singular import singular_facts
from rigidsym.notes.fitting import as_vectors, fitted, without_entries
from rigidsym.notes.letters import letters_of, meanings_of
from rigidsym.notes.named_body import OFFSET, Parts, in_names, textbook_form
from rigidsym.notes.template import blocks_of, sections_of
from rigidsym.notes.words import (
    is_body_alone,
    number,
    symbols_of,
    unit_in_words,
    with_source,
    with_symbols,
)

if TYPE_CHECKING:
    from rigidsym.mechanics.conversions.conversions import Conversions

_SECTIONS = (
    *("rotation", "angular_velocity", "rates", "angular_acceleration"),
    *("body", "inertia", "energy", "momentum", "motion"),
)
_CROSS_MATRIX = hat(sp.Matrix(sp.symbols("u_1:4")))
_DIAGONAL = formula("(I'_{11}, I'_{22}, I'_{33})")
_OF_JOINTS = "wHIfaN"  # letters of abbreviations, in sentences about them
_MOST_PARTS = 40  # definitions, a page of them; a result that needs more is only defined
_WHERE_SHOWN = {  # what has no equation of its own in the lecture, and the one that it belongs to
    "rotation_rate": "velocity_by_the_rotation",
    "spin_matrix": "velocity_by_the_rotation",
    "angular_velocity_space": "angular_velocity_of_the_rotation",
    "energy_expanded": "energy_splits",
    "energy_as_a_form": "inertia_of_particles",
    "products_of_turned_vectors": "rotation_goes_over",
    "momentum_expanded": "momentum_splits",
    "momentum_by_the_tensor": "momentum_of_rotation",
    "entries_of_inertia": "inertia_of_particles",
    "moment_about_a_line": "inertia_of_particles",
}


class Composer:
    """What a template prints, for one derivation.

    `module` is the file name of a kernel module; the equations of an audit name their functions.
    """

    def __init__(
        self,
        derivation: Derivation,
        *,
        module: str | None = None,
        notation: Notation = DEFAULT,
        conversions: Conversions | None = None,
        is_audit: bool = True,
    ) -> None:
        self.derivation, self.moments = in_names(derivation)
        self.model = derivation.model
        self.module = module or ""
        self.functions = [s.quantity.name for s in derivation.steps if module and s.quantity.inputs]
        self.conversions = conversions
        self.letters = letters_of(derivation.arguments, notation, derivation.model)
        if derivation.body:
            body, forces = derivation.body, derivation.forces
            own = own_letters(derivation.arguments, body, forces)
            names = {symbol: with_names(letter, own) for symbol, letter in LETTERS.items()}
            self.letters = replace(self.letters, names={**self.letters.names, **names}, own=own)
        self.symbols = symbols_of(derivation, self.letters.own)
        if derivation.forces:  # after the coordinates, which no abbreviation is called by
            stems = stems_of(name for each in derivation.arguments for name in each.names)
            self.symbols |= {stem: named(stems[stem]) for stem in _OF_JOINTS}
        self.is_audit = is_audit
        self.cited: set[Citation] = set()
        self._defined: set[sp.Basic] = set()  # names of intermediate quantities, once printed

    def document(self, name: str) -> doc.Document:
        """The note, as a template orders its sections."""
        sections = list(sections_of(name, self.letters, **self.facts()))
        byline = [block for section in sections if not section.title for block in section.blocks]
        labels: set[str] = set()

        def finished(block: doc.NoteBlock) -> doc.NoteBlock:
            """An equation that is printed again keeps its number, and the first has the label."""
            if not isinstance(block, doc.Equation):
                return block
            label = "" if block.label in labels else block.label
            labels.add(label)
            # a lecture leaves out that identities were verified
            return replace(block, label=label, proved=block.proved if self.is_audit else ())

        sections = [s._replace(blocks=tuple(map(finished, s.blocks))) for s in sections]
        return doc.Document(
            name=self.derivation.name,
            title=title_of(self.derivation, self.letters),
            subtitle="" if is_body_alone(self.derivation) else self.derivation.subject,
            letters=self.letters,
            sections=tuple(s for s in sections if s.title and s.blocks),
            byline=tuple(text_of(b.text) for b in byline if isinstance(b, doc.Paragraph)),
            language=name.split("/")[0],
        )

    def facts(self) -> dict[str, Any]:
        """What the template of a style may print, and the booleans that it asks."""
        derivation = self.derivation
        mass = motion = None
        if derivation.body or derivation.forces:
            # bodies in numbers and pictures of motions take long to import, and rotations have none
            from rigidsym.notes.facts.mass import MassFacts
            from rigidsym.notes.facts.motion import MotionFacts

            body, forces = derivation.body, derivation.forces
            mass = body and MassFacts(derivation, body, self.letters)
            motion = forces and MotionFacts(derivation, forces, self.letters)
        proofs = self._proofs()
        are_proved = all(proof.is_exact for _, proof in proofs)
        return {
            **facts_of_rotation(derivation, self.letters),
            "singular": singular_facts(derivation),
            "mass": mass,
            "motion": motion,
            "conversions": self.conversions,
            "quaternion": self._quaternion(),
            "theory": [
                (title, [block for each in statements for block in self._statement(each)])
                for title, statements in groupby(derivation.theory, key=lambda s: s.section)
            ],
            "numbered_product": self._product,
            "steps": self.steps,
            "equation": self.equation,
            "reference": self._reference,
            "cite": lambda source: Citation(text=source),
            "words": lambda words: with_symbols(words, self.symbols),
            "unit_in_words": unit_in_words,
            "number": number,
            "sources": SOURCES,
            "source_of_theory": lecture(),
            "shepperd": SHEPPERD,
            "first_figure": doc.FigureReference(1),
            "cross_matrix": _CROSS_MATRIX,
            "columns": self._columns() if self.conversions else [],
            "moments": [*self.moments] and [doc.said("here"), in_parts(self.moments, self.letters)],
            "abbreviations": lambda value: self._abbreviations(
                derivation.definitions_in(value, self._defined)
            ),
            "has_offset": mass and any(step.expression.has(*OFFSET) for step in derivation.steps),
            "proofs": proofs,
            "are_proved": are_proved,
            "has_status": self.is_audit or not are_proved,
            "has_rates": any(step.quantity.section == OF_RATES for step in derivation.steps),
            "symbols": self._symbols,
            "meanings": meanings_of(derivation, has_rotation=not is_body_alone(derivation)),
            "module": self.module,
            "functions": self.functions,
            "is_body_alone": is_body_alone(derivation),
            "has_dots": self.letters.notation.rates == "dot",
        }

    @staticmethod
    def _columns() -> list[sp.Matrix]:
        """Of K(R), (4, 4), in the entries of R; each is a multiple of the quaternion."""
        outer = outer_product(sp.Matrix(3, 3, lambda i, j: sp.Symbol(f"R_{i + 1}{j + 1}")))
        return [outer[:, k] for k in range(4)]

    def steps(self, section: str) -> list[doc.NoteBlock]:
        """The equations of a section, each behind how it follows.

        They are printed in order: a name that was explained once is only referred to. Raises
        TemplateRuntimeError, with the nearest name, for a section that there is not.
        """
        if section not in _SECTIONS:
            near = offer(section, _SECTIONS)
            raise TemplateRuntimeError(f"no section {section!r} of equations; {near}")
        blocks: list[doc.NoteBlock] = []
        derivation = self.derivation
        for step in derivation.steps:
            if step.quantity.section == section:
                blocks.append(doc.Paragraph(self._lead(step)))
                equation = self._displayed[step.quantity.name]
                # A recursion over the turns is printed in place of names.
                value = sp.S.Zero if step.recursion else step.expression
                parts = derivation.definitions_in(value, self._defined)
                count = len(self._defined) + len(parts)
                if parts and count > _MOST_PARTS and equation.sides[1:]:
                    blocks += (without_entries(equation), doc.said("left_out"))
                    continue
                blocks += self._abbreviations(parts)
                blocks += fitted(equation, step, derivation, self.letters, is_audit=self.is_audit)
        return blocks

    def _abbreviations(self, parts: Parts) -> list[doc.NoteBlock]:
        """The definitions, which are printed once."""
        self._defined |= {name for name, _ in parts}
        return [doc.said("abbreviations"), in_parts(parts, self.letters)] if parts else []

    def equation(self, name: str) -> doc.Equation:
        """The numbered equation of a quantity, without the words that lead to it.

        Raises TemplateRuntimeError, with the nearest name, if the derivation lacks it.
        """
        _check_derived(name, self._displayed)
        return self._displayed[name]

    def _reference(self, name: str) -> doc.EquationReference:
        """To the equation of a quantity, or in the lecture to the one that it belongs to."""
        derivation = self.derivation
        names = [*(s.quantity.name for s in derivation.steps), *(s.name for s in derivation.theory)]
        _check_derived(name, names)
        return doc.EquationReference(_WHERE_SHOWN.get(name, name) if derivation.theory else name)

    @cached_property
    def _displayed(self) -> Mapping[str, doc.Equation]:
        """The equations of all steps, with vectors if they have such a form, as they fit."""
        equations = {
            s.quantity.name: as_vectors(self._equation(s), s, self.letters)
            for s in self.derivation.steps
        }
        if self._product:  # it has the number, and the entries have none
            entries = equations["rotation_matrix"]
            entries = replace(entries, number=None, label="", is_result=False)
            equations["rotation_matrix"] = replace(entries, proved=(), function="")
        return equations

    def _equation(self, step: Step) -> doc.Equation:
        """The equation of a step; in the lecture some have no number of their own."""
        name = step.quantity.name
        equation = equation_of(step, self.derivation.arguments)
        equation = replace(equation, is_result=step.quantity.is_result)
        if self.is_audit and name in self.functions:
            equation = replace(equation, function=_call(step))
        if self.derivation.theory and name in _WHERE_SHOWN:
            equation = replace(equation, number=None, label="", is_result=False)
        if name == "principal_moments" and self.moments:
            names = {moment: name for name, moment in self.moments}
            moments = [names.get(moment, moment) for moment in step.expression]
            # (I₁, I₁, I₃), or the entries of I′ if they differ
            written = [formula_of(moment, self.letters) for moment in moments]
            end = _DIAGONAL if len({*moments}) == 3 else Bracket(joined(written, COMMA))
            equation = replace(equation, sides=(*equation.sides, end), matrix=None, entries=())
        more = textbook_form(name, self.derivation, self.letters)
        return replace(equation, sides=(*equation.sides, *more))

    def _lead(self, step: Step) -> doc.Text:
        """How the quantity follows; a source is cited once, and the theory needs no other."""
        because, source, model = step.because, step.quantity.source, self.model
        if self.derivation.theory:
            return with_symbols(because, self.symbols)
        rotation = RotationFacts(model, self.letters)
        if step.quantity.name == "rotation_matrix" and not model.turns:
            # the model's own source is cited here, where the rotation is given
            source = None if model.source.text == GIVEN else model.source
            if (rotation.is_quaternion or rotation.is_vector) and not model.passive:
                because = sentence_of("matrix_of_this_rotation")
        elif source == model.source:
            source = None
        if source in self.cited:
            source = None
        elif source:
            self.cited.add(source)
        return with_source(with_symbols(because, self.symbols), source)

    # The lecture

    def _statement(self, statement: Statement) -> Iterator[doc.NoteBlock]:
        matrix = sums(statement, self.letters)
        proved, unproved = claims_of(statement.proofs)
        yield doc.Paragraph(statement.because)
        yield doc.Equation(
            sides=(*statement.sides, *([matrix] if matrix else [])),
            number=statement.number,
            label=statement.name if statement.number else "",
            proved=proved,
            unproved=unproved,
            is_result=statement.is_result,
        )

    @cached_property
    def _product(self) -> doc.Equation | None:
        """R as a product of turns, which has the number in the lecture."""
        if not (self.derivation.theory and self.model.turns):
            return None
        equation = self._equation(self.derivation.step("rotation_matrix"))
        product = product_of(self.model.turns, self.letters)
        return replace(equation, sides=(ROTATION, product), matrix=None, entries=())

    # The end

    def _quaternion(self) -> dict[str, Any] | None:
        """The unit quaternion, with the number behind those of the steps."""
        step = self.conversions.quaternion if self.conversions else None
        if step is None or self.conversions is None:
            return None
        numbered = replace(step, number=len(self.derivation.steps) + 1)
        equation = equation_of(numbered, self.derivation.arguments)
        function = _call(step) if self.is_audit and self.module else ""
        because = with_source(self.conversions.because, step.quantity.source)
        equation = replace(equation, is_result=True, function=function)
        return {"because": because, "equation": equation}

    def _symbols(self) -> doc.NoteTable:
        """Each symbol once, with its first meaning."""
        (table,) = blocks_of("en/symbols", self.letters, **self.facts())
        assert isinstance(table, doc.NoteTable)
        rows: dict[doc.Text, tuple[doc.Text, ...]] = {}
        for cells in table.rows:
            rows.setdefault(cells[0], cells)
        return table._replace(rows=tuple(rows.values()))

    def _proofs(self) -> list[tuple[doc.EquationReference, Proof]]:
        """Each claim once, with the first equation that needs it, in the order of the equations."""
        stated = [(s.name, s.number, s.proofs) for s in self.derivation.theory]
        stated += [(s.quantity.name, s.number, s.proofs) for s in self.derivation.steps]
        numbers = {name: number or 0 for name, number, _ in stated}
        once: dict[tuple[Formula, str], tuple[doc.EquationReference, Proof]] = {}
        for name, _, proofs in stated:
            reference = self._reference(name)
            for proof in proofs:
                once.setdefault((proof.claim, proof.status), (reference, proof))
        return sorted(once.values(), key=lambda pair: numbers[pair[0].label])


def _check_derived(name: str, names: Collection[str]) -> None:
    if name not in names:
        raise TemplateRuntimeError(f"nothing is derived by the name {name!r}; {offer(name, names)}")


def _call(step: Step) -> str:
    return f"{step.quantity.name}({', '.join(step.quantity.inputs)})"
