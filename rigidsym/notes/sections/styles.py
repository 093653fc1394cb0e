"""The styles of a note: a lecture explains, a paper is terse, an audit shows every identity."""

from __future__ import annotations

from dataclasses import replace

from rigidsym.errors import ModelError
from rigidsym.formula.display import PAGE, display
from rigidsym.formula.letters import Letters
from rigidsym.notes.document.document import (
    Document,
    Equation,
    NoteBlock,
    NoteTable,
    Paragraph,
    Section,
)
from rigidsym.notes.prose.prose import EXACT_MEANS, HOW_VERIFIED
from rigidsym.notes.prose.short import by_the_chain_rule
from rigidsym.notes.sections.claims_table import EXACT
from rigidsym.notes.sections.compose import FUNCTIONS, IDENTITIES, SYMBOLS
from rigidsym.notes.sections.summary import TITLE as SUMMARY

STYLES = ("lecture", "paper", "audit")  # the default first
APPENDIX = "Appendix: identities verified"

_LEFT_OUT = {
    "lecture": (FUNCTIONS, SYMBOLS, SUMMARY),
    "paper": (FUNCTIONS, SYMBOLS, SUMMARY, IDENTITIES),
}
_VERIFIED = (
    "Each numbered equation has been verified exactly, unless it is a definition or is given."
)


def left_out_of(style: str, *, is_short: bool = False) -> tuple[str, ...]:
    """The titles of the sections that a style does without.

    A short note has no tables at its end, unless it is an audit. Raises ModelError for a name
    that is not one of STYLES.
    """
    if style not in STYLES:
        raise ModelError(f"style is {', '.join(STYLES[:-1])} or {STYLES[-1]}, and not {style!r}")
    return () if style == "audit" else _LEFT_OUT["paper" if is_short else style]


def in_style(document: Document, style: str, *, is_short: bool = False) -> Document:
    """The document in a style; unproved claims stay in every one. Raises ModelError."""
    left_out = left_out_of(style, is_short=is_short)
    if style == "audit":
        return document
    letters = document.letters
    kept = [
        section._replace(blocks=tuple(_by_the_chain_rule(b, letters) for b in section.blocks))
        for section in document.sections
        if section.title not in left_out
    ]
    identities = [s._replace(title=APPENDIX) for s in kept if s.title == IDENTITIES]
    others = [section for section in kept if section.title != IDENTITIES]
    if not identities and all(not equation.unproved for equation in document.equations):
        first, *rest = others
        others = [first._replace(blocks=(*first.blocks, Paragraph((_VERIFIED,)))), *rest]
    return replace(document, sections=tuple(map(_plain, (*others, *identities))))


def _plain(section: Section) -> Section:
    return section._replace(blocks=tuple(map(_without_proofs, section.blocks)))


def _without_proofs(block: NoteBlock) -> NoteBlock:
    """Without the identities that were verified, the functions, and a column of nothing new."""
    if isinstance(block, Equation):
        return replace(block, proved=(), function="")
    if block == Paragraph((HOW_VERIFIED, EXACT_MEANS)):
        return Paragraph((HOW_VERIFIED,))
    if isinstance(block, NoteTable) and block.rows and all(r[-1] == EXACT for r in block.rows):
        rows = tuple(row[:-1] for row in block.rows)
        return block._replace(head=block.head[:-1], rows=rows)
    return block


def _by_the_chain_rule(block: NoteBlock, letters: Letters) -> NoteBlock:
    """dR/dt = φ̇ ∂R/∂φ + ..., in place of nine long entries."""
    if not isinstance(block, Equation) or block.label != "rotation_rate" or block.matrix is None:
        return block
    if not display(block, letters, PAGE).done:
        return block
    rate = block.sides[0]
    sides = (rate, by_the_chain_rule(rate, letters))
    return replace(block, sides=sides, matrix=None, entries=())
