"""The note of a derivation, and the formats it is printed in."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

from rigidsym.errors import ModelError
from rigidsym.formula.notation import DEFAULT, FRAMES, Notation
from rigidsym.mechanics.derivation import Derivation
from rigidsym.notes.document.catalogue import language_of
from rigidsym.notes.document.document import Document
from rigidsym.notes.document.own_text import OwnText
from rigidsym.notes.formats import FORMATS
from rigidsym.notes.sections.compose import Composer
from rigidsym.notes.sections.styles import in_style, left_out_of

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
    document = composer.document(left_out_of(style, is_short=composer.is_short))
    if notation.frames != FRAMES:
        document = document.changed(lambda text: tuple(map(notation.named, text)))
    document = in_style(document, style, is_short=composer.is_short).translated(into)
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
