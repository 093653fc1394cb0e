"""Notes typeset together."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import replace

from rigidsym.notes.document import Document
from rigidsym.notes.formats.latex import render as print_latex
from rigidsym.notes.formats.pdf import typeset

BEGIN, END = r"\begin{document}", r"\end{document}"


def warnings_of(documents: Iterable[Document]) -> tuple[str, ...]:
    """What TeX complains of in documents, of which some may have the same name, all in one run."""
    renamed = (replace(d, name=f"note_{place}") for place, d in enumerate(documents))
    return typeset(bound_together(list(map(print_latex, renamed))), timeout=600).warnings


def bound_together(notes: list[str]) -> str:
    """Several notes as one document, which is faster than one run of TeX each."""
    preamble = notes[0].split(BEGIN)[0]
    bodies = (text.split(BEGIN)[1].split(END)[0] for text in notes)
    return preamble + BEGIN + "\n\\newpage\\setcounter{section}{0}\n".join(bodies) + END


_COUNTED = re.compile(
    r"\\setcounter\{equation\}\{(\d+)\}|\\(?:begin\{resultof\}|numbered)\{[^:}]*:(\w+)\}"
)


def numbered_by_tex(latex: str) -> dict[str, int]:
    """The numbers that TeX gives to equations, by their labels without the name of the note."""
    numbers: dict[str, int] = {}
    count = 0
    for jump, label in _COUNTED.findall(latex):
        count = int(jump) if jump else count + 1
        if label:
            numbers[label] = count
    return numbers
