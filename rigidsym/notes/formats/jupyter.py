"""What Jupyter shows of a derivation or of one of its steps; plain text where it can do no better.

Jupyter asks an object for its `_repr_mimebundle_` and shows the richest form that it can draw.
"""

from __future__ import annotations

from collections.abc import Sequence

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
    arguments, model = derivation.arguments, derivation.model
    steps = (latex_of(step, arguments, manner, model) for step in derivation.steps)
    return {
        "text/markdown": note.markdown(),
        "text/latex": "\n\n".join(steps),
        "text/plain": show(derivation, manner=manner),
    }


def step_bundle_of(
    step: Step, arguments: Sequence[Argument], manner: Manner, model: RotationModel | None = None
) -> dict[str, str]:
    """One step: its equation, and the lines that a terminal shows of it."""
    return {
        "text/latex": latex_of(step, arguments, manner, model),
        "text/plain": show_step(step, arguments, manner=manner, model=model),
    }


def latex_of(
    step: Step, arguments: Sequence[Argument], manner: Manner, model: RotationModel | None = None
) -> str:
    """The equation of a step between dollar signs, with its number."""
    notation = notation_of(arguments, manner, model)
    equation = as_vectors(equation_of(step, arguments), step, notation)
    shown = display(equation_in_manner(equation, manner), notation, _WIDTH)
    return f"$$\n{formula(shown.latex)}\n\\tag{{{step.number}}}\n$$"
