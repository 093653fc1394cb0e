"""The note of a derivation, and the formats it is printed in."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from rigidsym.mechanics.derivation import Derivation
from rigidsym.notes.compose import compose
from rigidsym.notes.document import Document
from rigidsym.notes.latex import print_latex


@dataclass(frozen=True, slots=True)
class Note:
    """A document, and its printers."""

    document: Document

    def latex(self) -> str:
        """A complete LaTeX file; the same derivation gives the same bytes."""
        return print_latex(self.document)


def note(
    derivation: Derivation, *, module: str | None = None, functions: Sequence[str] | None = None
) -> Note:
    """The note of a derivation.

    `module` is the file name of its kernel module, if there is one; `functions` are the quantities
    that module evaluates, all of them where nothing is said. Each equation names its function.
    """
    names = [step.quantity.name for step in derivation.steps] if functions is None else functions
    return Note(compose(derivation, module=module, functions=names if module else ()))
