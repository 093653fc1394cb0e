"""What the buttons of a page copy: each equation in the languages that people write it in."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from rigidsym.kernels.lower import lower
from rigidsym.kernels.targets import numpy
from rigidsym.mechanics.derivation import Derivation
from rigidsym.notes.document import Document
from rigidsym.notes.layout import display
from rigidsym.page.python import python_of

LANGUAGES: Mapping[str, str] = {"latex": "LaTeX", "python": "Python"}  # and how they are written

_PAPER = 30.0  # ems of a display on paper


def copies_of(derivation: Derivation, document: Document) -> Mapping[str, Mapping[str, str]]:
    """label: language: text, for each numbered equation that a kernel evaluates."""
    program = lower(derivation, numpy.RESERVED)
    python = {kernel.name: python_of(kernel) for kernel in program.kernels}
    return {
        label: {"latex": text, "python": python[label]}
        for label, text in _latex(document)
        if label in python
    }


def _latex(document: Document) -> Iterator[tuple[str, str]]:
    for equation in document.equations:
        inside = display(equation, document.notation, _PAPER).latex
        yield equation.label, f"\\[\n{inside}\n\\]\n"
