"""The note of a derivation, its styles, and the formats it is printed in.

A lecture explains, a paper is terse, and an audit shows every identity.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

from rigidsym.errors import ModelError
from rigidsym.formula.display import PAGE, display
from rigidsym.formula.letters import Letters
from rigidsym.formula.notation import DEFAULT, FRAMES, Notation
from rigidsym.mechanics.derivation import Derivation
from rigidsym.notes.document.catalogue import language_of
from rigidsym.notes.document.document import (
    Document,
    Equation,
    NoteBlock,
    NoteTable,
    Paragraph,
    Section,
)
from rigidsym.notes.document.own_text import OwnText
from rigidsym.notes.formats import FORMATS
from rigidsym.notes.prose.words import EXACT_MEANS, HOW_VERIFIED
from rigidsym.notes.sections.compose import FUNCTIONS, IDENTITIES, SYMBOLS, Composer
from rigidsym.notes.sections.end_tables import EXACT
from rigidsym.notes.sections.fitting import by_the_chain_rule
from rigidsym.notes.sections.summary import TITLE as SUMMARY

if TYPE_CHECKING:
    from rigidsym.mechanics.conversions.conversions import Conversions


class Note(NamedTuple):
    """A document, and its printers."""

    document: Document

    def __repr__(self) -> str:
        """One line, for a prompt; the document itself would fill pages."""
        return f"<Note {self.document.name}, {len(self.document.equations)} equations>"

    def _repr_mimebundle_(self, **_: object) -> dict[str, str]:
        """What Jupyter shows: the whole note, or one line."""
        return {"text/markdown": self.markdown(), "text/plain": repr(self)}

    def render(self, ending: str) -> str:
        """The text of a file in one of FORMATS; the same derivation gives the same bytes."""
        return FORMATS[ending].render(self.document)

    def latex(self) -> str:
        """A complete LaTeX file."""
        return self.render("tex")

    def html(self) -> str:
        """A complete HTML file with MathML, for any screen; it loads nothing."""
        return self.render("html")

    def markdown(self) -> str:
        """Markdown with mathematics between dollar signs, as GitHub and Jupyter read it."""
        return self.render("md")

    def notebook(self) -> str:
        """A Jupyter notebook (.ipynb); raises MissingExtra without nbformat."""
        return self.render("ipynb")


def note(
    derivation: Derivation,
    *,
    module: str | None = None,
    functions: Sequence[str] | None = None,
    notation: Notation = DEFAULT,
    conversions: Conversions | None = None,
    style: str = "audit",
    text: OwnText | None = None,
    language: str = "en",
) -> Note:
    """The note of a derivation, and of the conversions if they are given, in a style.

    `module` is the file name of its kernel module, if there is one; `functions` are the quantities
    that module evaluates, all of them by default. Each equation of an audit names its function.
    `text` is what its user adds or leaves out. Raises ModelError for a name that the note has not,
    for a `language` without a catalogue, and for names of frames in another language than English.
    """
    into = language_of(language)
    if notation.frames != FRAMES and language != "en":
        raise ModelError(f"only English notes take names for the frames; language is {language!r}")
    computed = [step.quantity.name for step in derivation.steps if step.quantity.inputs]
    names = computed if functions is None else functions
    composer = _composer_of(derivation)(
        derivation,
        module=module,
        functions=names if module else (),
        notation=notation,
        conversions=conversions,
        is_audit=style == "audit",
    )
    document = composer.document(_left_out_of(style, is_short=composer.is_short))
    if notation.frames != FRAMES:
        document = document.changed(lambda text: tuple(map(notation.named, text)))
    if style != "audit":
        document = without_identities(document)
    document = document.translated(into)
    return Note(text.applied(document) if text else document)


def _composer_of(derivation: Derivation) -> type[Composer]:
    """What composes the note of a derivation, with its theory, its body, or without."""
    if derivation.theory:
        from rigidsym.notes.sections.lecture_note import LectureComposer

        return LectureComposer
    if derivation.body is not None:
        from rigidsym.notes.sections.body_note import BodyComposer

        return BodyComposer
    return Composer


STYLES = ("lecture", "paper", "audit")  # the default first
APPENDIX = "Appendix: identities verified"

_LEFT_OUT = {
    "lecture": (FUNCTIONS, SYMBOLS, SUMMARY),
    "paper": (FUNCTIONS, SYMBOLS, SUMMARY, IDENTITIES),
}
_VERIFIED = (
    "Each numbered equation has been verified exactly, unless it is a definition or is given."
)


def _left_out_of(style: str, *, is_short: bool = False) -> tuple[str, ...]:
    """The titles of the sections that a style does without.

    A short note has no tables at its end, unless it is an audit. Raises ModelError for a name
    that is not one of STYLES.
    """
    if style not in STYLES:
        raise ModelError(f"style is {', '.join(STYLES[:-1])} or {STYLES[-1]}, and not {style!r}")
    return () if style == "audit" else _LEFT_OUT["paper" if is_short else style]


def without_identities(document: Document) -> Document:
    """The document with its identities in an appendix, if anywhere; unproved claims stay."""
    letters = document.letters
    kept = [
        section._replace(blocks=tuple(_by_the_chain_rule(b, letters) for b in section.blocks))
        for section in document.sections
    ]
    identities = [s._replace(title=APPENDIX) for s in kept if s.title == IDENTITIES]
    others = [section for section in kept if section.title != IDENTITIES]
    if not identities and all(not equation.unproved for equation in document.equations):
        first, *rest = others
        others = [first._replace(blocks=(*first.blocks, Paragraph((_VERIFIED,)))), *rest]
    return replace(document, sections=tuple(map(_plain, (*others, *identities))))


def _plain(section: Section) -> Section:
    return section._replace(blocks=tuple(map(_without_proofs, section.blocks)))


def _without_proofs(block: NoteBlock) -> NoteBlock:
    """Without the identities that were verified, the functions, and a column of nothing new."""
    if isinstance(block, Equation):
        return replace(block, proved=(), function="")
    if block == Paragraph((HOW_VERIFIED, EXACT_MEANS)):
        return Paragraph((HOW_VERIFIED,))
    if isinstance(block, NoteTable) and block.rows and all(r[-1] == EXACT for r in block.rows):
        rows = tuple(row[:-1] for row in block.rows)
        return block._replace(head=block.head[:-1], rows=rows)
    return block


def _by_the_chain_rule(block: NoteBlock, letters: Letters) -> NoteBlock:
    """dR/dt = φ̇ ∂R/∂φ + ..., in place of nine long entries."""
    if not isinstance(block, Equation) or block.label != "rotation_rate" or block.matrix is None:
        return block
    if not display(block, letters, PAGE).done:
        return block
    rate = block.sides[0]
    sides = (rate, by_the_chain_rule(rate, letters))
    return replace(block, sides=sides, matrix=None, entries=())
