"""What the buttons of a page copy: each equation in the languages that people write it in."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace

from rigidsym.formula.display import display
from rigidsym.kernels.lowering.lower import lower
from rigidsym.kernels.targets.c import printer as c
from rigidsym.kernels.targets.numpy import printer as numpy
from rigidsym.mechanics.derivation import Derivation
from rigidsym.notes.document.document import Document
from rigidsym.page.copy_c import c_of
from rigidsym.page.copy_python import python_of
from rigidsym.page.copy_series import series_for

LANGUAGES: Mapping[str, str] = {"latex": "LaTeX", "python": "Python", "c": "C"}  # as shown

_PAPER = 30.0  # ems of a display on paper


def copies_of(derivation: Derivation, document: Document) -> Mapping[str, Mapping[str, str]]:
    """label: language: text, for each numbered equation that a kernel evaluates."""
    program = lower(derivation, numpy.RESERVED | c.RESERVED)
    kernels = {kernel.name: kernel for kernel in program.kernels}
    series = series_for(program.kernels)
    return {
        label: {
            "latex": text,
            "python": python_of(kernels[label], series),
            "c": c_of(kernels[label], series),
        }
        for label, text in _latex(document)
        if label in kernels
    }


def _latex(document: Document) -> Iterator[tuple[str, str]]:
    for equation in document.equations:
        plain = replace(equation, is_result=False)  # who copies it has boxes of their own
        inside = display(plain, document.letters, _PAPER).text
        yield equation.label, f"\\[\n{inside}\n\\]\n"
