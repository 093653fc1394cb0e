"""The styles of a note: a lecture explains, a paper is terse, an audit shows every identity."""

from __future__ import annotations

from dataclasses import replace

from rigidsym.errors import ModelError
from rigidsym.notes.document.document import Document, Equation, NoteBlock, Paragraph, Section
from rigidsym.notes.sections.compose import FUNCTIONS, IDENTITIES, SYMBOLS
from rigidsym.notes.sections.summary import TITLE as SUMMARY

STYLES = ("lecture", "paper", "audit")  # the default first
APPENDIX = "Appendix: identities verified"

_LEFT_OUT = {"lecture": (FUNCTIONS,), "paper": (FUNCTIONS, IDENTITIES, SYMBOLS, SUMMARY)}
_VERIFIED = {
    "lecture": "Each numbered equation has been verified exactly, as listed in the appendix.",
    "paper": "Each numbered equation has been verified exactly.",
}


def in_style(document: Document, style: str, *, is_short: bool = False) -> Document:
    """The document in a style; unproved claims stay in every one.

    A short note has no tables at its end, unless it is an audit. Raises ModelError for a name
    that is not one of STYLES.
    """
    if style not in STYLES:
        raise ModelError(f"style is {', '.join(STYLES[:-1])} or {STYLES[-1]}, and not {style!r}")
    if style == "audit":
        return document
    left_out = _LEFT_OUT["paper" if is_short else style]
    kept = [section for section in document.sections if section.title not in left_out]
    identities = [replace(s, title=APPENDIX) for s in kept if s.title == IDENTITIES]
    others = [section for section in kept if section.title != IDENTITIES]
    if all(not equation.unproved for equation in document.equations):
        first, *rest = others
        said = Paragraph((_VERIFIED["paper" if is_short else style],))
        others = [replace(first, blocks=(*first.blocks, said)), *rest]
    return replace(document, sections=tuple(map(_plain, (*others, *identities))))


def _plain(section: Section) -> Section:
    return replace(section, blocks=tuple(map(_without_proofs, section.blocks)))


def _without_proofs(block: NoteBlock) -> NoteBlock:
    """An equation without the identities that were verified and without its function."""
    return replace(block, proved=(), function="") if isinstance(block, Equation) else block
