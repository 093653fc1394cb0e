"""The note of a derivation, its styles, and the formats it is printed in.

A lecture explains, and an audit shows every identity.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from rigidsym.errors import ModelError
from rigidsym.formula.notation import DEFAULT, Notation
from rigidsym.mechanics.derivation import Derivation
from rigidsym.notes import formats
from rigidsym.notes.document import Document
from rigidsym.system import resources
from rigidsym.system.records import NamedTuple

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
        return formats.render(self.document, ending)

    def latex(self) -> str:
        """A complete LaTeX file."""
        return self.render("tex")

    def html(self) -> str:
        """A complete HTML file with MathML, for any screen; it loads nothing."""
        return self.render("html")

    def markdown(self) -> str:
        """Markdown with mathematics between dollar signs, as GitHub and Jupyter read it."""
        return self.render("md")


def note(
    derivation: Derivation,
    *,
    module: str | None = None,
    notation: Notation = DEFAULT,
    conversions: Conversions | None = None,
    style: str = "audit",
) -> Note:
    """The note of a derivation, and of the conversions if they are given, in a style.

    `module` is the file name of its kernel module, if there is one; then each equation of an audit
    names its function. Raises ModelError for a style without a template.
    """
    resources.check_names(f"{template_of(check_style(style))}.md.jinja")
    # composing draws figures, for which NumPy is imported; a style is checked without
    from rigidsym.notes.compose import Composer

    composer = Composer(
        derivation,
        module=module,
        notation=notation,
        conversions=conversions,
        is_audit=style == "audit",
    )
    return Note(composer.document(template_of(style)))


def template_of(style: str) -> str:
    """The name of the template of a style: lecture is en/lecture, and fr/lecture is itself."""
    return style if "/" in style else f"en/{style}"


def check_style(style: str) -> str:
    """The style itself. Raises ModelError for one that has no template, shipped or the user's."""
    name = f"{template_of(style)}.md.jinja"
    try:
        resources.template(name)
    except (FileNotFoundError, ValueError):
        names = ", ".join(resources.STYLES)
        raise ModelError(
            f"no style {style!r}: expected {names}, or your own {name} in --templates DIR"
        ) from None
    return style
