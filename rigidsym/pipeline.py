"""From checked data to the content of files: pure, so that `check` can compare and tests can read.

Nothing here writes; the command line does.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass, replace
from typing import TYPE_CHECKING

from rigidsym.mechanics.derivation import Proof
from rigidsym.motion import Motion, derive
from rigidsym.notes.formats.record import record
from rigidsym.notes.note import Note
from rigidsym.spec.derivation_file import DerivationSpec

if TYPE_CHECKING:
    from rigidsym.mechanics.conversions.conversions import Conversions

PDF = "pdf"  # made from the LaTeX, which is written beside it
PAGE = "page"  # NAME_page.html: the note with a figure that moves

_PRINTERS = {"tex": Note.latex, "html": Note.html, "md": Note.markdown, "ipynb": Note.notebook}


def page_name(name: str) -> str:
    """The file of a derivation's page."""
    return f"{name}_{PAGE}.html"


@dataclass(frozen=True, kw_only=True, slots=True)
class Product:
    """One derivation and the text files that are printed from it."""

    motion: Motion
    conversions: Conversions | None  # where they were asked for
    files: Mapping[str, str]  # file name -> content, for the folder that is named motion.name
    wants_pdf: bool

    @property
    def name(self) -> str:
        return self.motion.name

    @property
    def proofs(self) -> tuple[Proof, ...]:
        """All that was claimed, of the conversions too where they were asked for."""
        return (*self.motion.proofs, *(self.conversions.proofs if self.conversions else ()))

    @property
    def record_text(self) -> str:
        return self.files[f"{self.name}.json"]


def product(spec: DerivationSpec) -> Product:
    """The product of a specification that names one rotation."""
    motion = motion_of(spec)
    conversions = motion.conversions if spec.conversions else None
    texts = _texts(motion, conversions, spec)
    return Product(
        motion=motion,
        conversions=conversions,
        files=dict(texts),
        wants_pdf=PDF in spec.note,
    )


def motion_of(spec: DerivationSpec) -> Motion:
    """The derivation of a specification that names one rotation."""
    (model,) = spec.models
    motion = derive(model, only=spec.quantities, body=spec.body, theory=spec.theory)
    motion = replace(motion, name=spec.name, title=spec.title or motion.title)
    return motion.written(**asdict(spec.manner))


def _texts(
    motion: Motion, conversions: Conversions | None, spec: DerivationSpec
) -> Iterator[tuple[str, str]]:
    """(name, content) of each text file, the record last, since it speaks for the others."""
    for target in spec.kernels:
        module = motion.kernels(target, conversions=spec.conversions, derivatives=spec.derivatives)
        yield from module.files.items()
    note = motion.note(with_kernels="numpy" in spec.kernels, conversions=spec.conversions)
    for ending, printed in _PRINTERS.items():
        if ending in spec.note or (ending == "tex" and PDF in spec.note):
            yield f"{spec.name}.{ending}", printed(note)
    if PAGE in spec.note:
        from rigidsym.page.page import print_page

        yield page_name(spec.name), print_page(motion, note.document)
    data = record(motion, spec.to_data(), conversions)
    yield f"{spec.name}.json", json.dumps(data, indent=1, ensure_ascii=False) + "\n"
