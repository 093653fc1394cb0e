"""What Jupyter shows of a derivation or of one of its steps; plain text where it can do no better.

Jupyter asks an object for its `_repr_mimebundle_` and shows the richest form that it can draw.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from rigidsym.formula.display import display
from rigidsym.formula.latex_pen import LatexPen
from rigidsym.formula.notation import Notation
from rigidsym.mechanics.derivation import Argument, Derivation, Step
from rigidsym.models.rotation import RotationModel
from rigidsym.notes.equations import equation_of
from rigidsym.notes.fitting import as_vectors
from rigidsym.notes.formats.terminal import show, show_step
from rigidsym.notes.letters import letters_of

_WIDTH = 44.0  # ems


def bundle_of(derivation: Derivation, markdown: str, notation: Notation) -> dict[str, str]:
    """The whole derivation: as the note, as one display of its equations, as plain text.

    `markdown` is its note.
    """
    return {
        "text/markdown": markdown,
        "text/latex": "\n\n".join(step._repr_latex_() for step in derivation.steps),
        "text/plain": show(derivation, notation=notation),
    }


@dataclass(frozen=True, kw_only=True, slots=True)
class EquationPrinter:
    """Prints the equations of one derivation in one notation."""

    arguments: Sequence[Argument]
    model: RotationModel
    notation: Notation

    def latex(self, step: Step) -> str:
        letters = letters_of(self.arguments, self.notation, self.model)
        equation = as_vectors(equation_of(step, self.arguments), step, letters)
        return display(equation, letters, _WIDTH, LatexPen(self.notation)).text

    def text(self, step: Step) -> str:
        return show_step(step, self.arguments, notation=self.notation, model=self.model)
