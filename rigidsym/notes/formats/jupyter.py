"""What Jupyter shows of a derivation or of one of its steps; plain text where it can do no better.

Jupyter asks an object for its `_repr_mimebundle_` and shows the richest form that it can draw.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from rigidsym.mechanics.derivation import Argument, Derivation, Step
from rigidsym.models.rotation import RotationModel
from rigidsym.notes.document.compose import equation_of
from rigidsym.notes.formats.markdown import formula
from rigidsym.notes.formats.terminal import show, show_step
from rigidsym.notes.formula.manner import Manner
from rigidsym.notes.formula.notation import notation_of
from rigidsym.notes.formula.rewriting import equation_in_manner
from rigidsym.notes.layout.fitting import as_vectors
from rigidsym.notes.layout.layout import display
from rigidsym.notes.note import Note

_WIDTH = 44.0  # ems


def bundle_of(derivation: Derivation, note: Note, manner: Manner) -> dict[str, str]:
    """The whole derivation: as the note, as one display of its equations, as plain text."""
    return {
        "text/markdown": note.markdown(),
        "text/latex": "\n\n".join(step._repr_latex_() for step in derivation.steps),
        "text/plain": show(derivation, manner=manner),
    }


@dataclass(frozen=True, kw_only=True, slots=True)
class EquationPrinter:
    """Prints the equations of one derivation in one notation."""

    arguments: Sequence[Argument]
    model: RotationModel
    manner: Manner

    def latex(self, step: Step) -> str:
        notation = notation_of(self.arguments, self.manner, self.model)
        equation = as_vectors(equation_of(step, self.arguments), step, notation)
        shown = display(equation_in_manner(equation, self.manner), notation, _WIDTH)
        return formula(shown.latex)

    def text(self, step: Step) -> str:
        return show_step(step, self.arguments, manner=self.manner, model=self.model)
