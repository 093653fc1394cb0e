"""What the buttons of a page copy: each equation in the languages that people write it in."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from rigidsym.kernels.lower import lower
from rigidsym.kernels.targets import c, numpy
from rigidsym.mechanics.derivation import Derivation
from rigidsym.notes.document import Document
from rigidsym.notes.layout import display
from rigidsym.page.c import c_of
from rigidsym.page.python import python_of
from rigidsym.page.series import series_for

LATEX = "latex"
LANGUAGES: Mapping[str, str] = {LATEX: "LaTeX", "python": "Python", "c": "C"}  # as shown

_PAPER = 30.0  # ems of a display on paper


@dataclass(frozen=True, kw_only=True, slots=True)
class Copies:
    """label: language: parts of the text; None stands for what the language has in `shared`."""

    texts: Mapping[str, Mapping[str, Sequence[str | None]]]
    shared: Mapping[str, str]

    def without_code(self, labels: Collection[str]) -> Copies:
        """With LaTeX alone for some."""
        texts = {
            label: {LATEX: text[LATEX]} if label in labels else text
            for label, text in self.texts.items()
        }
        return replace(self, texts=texts)


def copies_of(derivation: Derivation, document: Document) -> Copies:
    """The texts for each numbered equation that a kernel evaluates."""
    program = lower(derivation, numpy.RESERVED | c.RESERVED)
    kernels = {kernel.name: kernel for kernel in program.kernels}
    texts: dict[str, dict[str, list[str | None]]] = {
        label: {LATEX: [text], "python": python_of(kernels[label]), "c": c_of(kernels[label])}
        for label, text in _latex(document)
        if label in kernels
    }
    return Copies(texts=texts, shared=series_for(program.kernels))


def _latex(document: Document) -> Iterator[tuple[str, str]]:
    for equation in document.equations:
        plain = replace(equation, is_result=False)  # who copies it has boxes of their own
        inside = display(plain, document.notation, _PAPER).latex
        yield equation.label, f"\\[\n{inside}\n\\]\n"
