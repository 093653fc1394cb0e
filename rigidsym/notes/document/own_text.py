"""What users add to a note and leave out of it: [text] of a derivation file."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from difflib import get_close_matches

from rigidsym.errors import ModelError, offer
from rigidsym.formula.reader import formula
from rigidsym.models.rotation import LECTURE, Citation
from rigidsym.notes.document.catalogue import Catalogue
from rigidsym.notes.document.document import (
    Cited,
    Document,
    Equation,
    EquationReference,
    NoteBlock,
    NoteTable,
    Paragraph,
    Section,
    Span,
    Text,
)

_KEY = re.compile(r"\[(\w+)\]")
_OF_LECTURE = "lecture"  # the key under which the source of the lecture gets a name of one's own


@dataclass(frozen=True, kw_only=True, slots=True)
class OwnText:
    """Sentences before and after equations and sections, what is left out, title and sources.

    `before` and `after` hold sentences by the name of a quantity or the title of a section, and
    `omit` such names. Formulas stand between dollar signs, as in LaTeX, and [key] cites one of
    `sources`; the key "lecture" names the lecture notes. Raises ModelError for a sentence that
    cannot be read.
    """

    author: str = ""
    course: str = ""
    date: str = ""
    omit: tuple[str, ...] = ()
    before: Mapping[str, str] = field(default_factory=dict)
    after: Mapping[str, str] = field(default_factory=dict)
    sources: Mapping[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for typed in (*self.before.values(), *self.after.values()):
            self._read(typed)

    def applied(self, document: Document) -> Document:
        """The document with these changes; its equations are numbered without gaps.

        Raises ModelError, with the nearest name, for one that the document does not have.
        """
        labels = {equation.label for equation in document.equations}

        def known(name: str) -> str:  # titles may be given in English, too
            return name if name in labels else document.language.words(name)

        before, after = ({known(k): v for k, v in own.items()} for own in (self.before, self.after))
        own = replace(self, omit=tuple(map(known, self.omit)), before=before, after=after)
        return own._applied(document)

    def _applied(self, document: Document) -> Document:
        known = [*(s.title for s in document.sections), *(e.label for e in document.equations)]
        for name in (*self.omit, *self.before, *self.after):
            if not any(map(_Named(name), known)):
                raise ModelError(f"[text]: the note has no {name!r}; {offer(name, known)}")
        kept = [s for s in document.sections if not any(_Named(o)(s.title) for o in self.omit)]
        sections = (s._replace(blocks=tuple(self._blocks(s))) for s in kept)
        changed = replace(
            document,
            sections=_numbered(tuple(s for s in sections if s.blocks), document),
            author=self.author,
            byline=tuple(filter(None, (self.author, self.course, self.date))),
            more_sources=tuple(self.sources.values()),
        )
        labels = {equation.label for equation in changed.equations}
        shorter = _without_rows(changed, labels)
        return shorter.changed(lambda text: self._renamed(text, labels, document.language))

    def _blocks(self, section: Section) -> Iterator[NoteBlock]:
        yield from self._own(self.before, section.title)
        held: list[NoteBlock] = []  # what leads to an equation
        for block in section.blocks:
            if isinstance(block, Equation) and block.label:
                earlier, lead = _parted(held)
                yield from earlier
                if block.label not in self.omit:
                    yield from self._own(self.before, block.label)
                    yield from (*lead, block)
                    yield from self._own(self.after, block.label)
                held = []
            else:
                held.append(block)
        yield from held
        yield from self._own(self.after, section.title)

    def _own(self, sentences: Mapping[str, str], name: str) -> Iterator[Paragraph]:
        yield from (Paragraph(self._read(t)) for own, t in sentences.items() if _Named(own)(name))

    def _read(self, typed: str) -> Text:
        words = typed.split("$")
        if len(words) % 2 == 0:
            raise ModelError(f"a dollar sign without its pair in {typed!r}")
        spans: list[Span] = []
        for place, part in enumerate(words):
            spans += [formula(part)] if place % 2 else self._cited(part)
        return tuple(span for span in spans if span != "")

    def _cited(self, words: str) -> Iterator[Span]:
        for place, part in enumerate(_KEY.split(words)):
            if place % 2 and part in self.sources:
                yield Cited(Citation(text=self.sources[part]))
            elif place % 2 and get_close_matches(part, self.sources):
                raise ModelError(f"no source has the key {part!r}; {offer(part, self.sources)}")
            else:
                yield f"[{part}]" if place % 2 else part

    def _renamed(self, text: Text, labels: set[str], language: Catalogue) -> Text:
        """The text with the name of the lecture, and without references to what is left out."""
        return tuple(self._span(span, labels, language) for span in text)

    def _span(self, span: Span, labels: set[str], language: Catalogue) -> Span:
        if isinstance(span, EquationReference) and span.label not in labels:
            return language.words(f"the {span.label.replace('_', ' ')}")
        if isinstance(span, Cited) and span.citation.text == LECTURE:
            return Cited(span.citation._replace(text=self.sources.get(_OF_LECTURE, LECTURE)))
        return span


@dataclass(frozen=True, slots=True)
class _Named:
    """Whether something has a name, in capitals or not."""

    name: str

    def __call__(self, other: str) -> bool:
        return self.name.casefold() == other.casefold()


def _parted(blocks: Sequence[NoteBlock]) -> tuple[Sequence[NoteBlock], Sequence[NoteBlock]]:
    """What stands before the last paragraph, and that with the definitions behind it."""
    paragraphs = [k for k, block in enumerate(blocks) if isinstance(block, Paragraph)]
    cut = paragraphs[-1] if paragraphs else len(blocks)
    return blocks[:cut], blocks[cut:]


def _numbered(sections: tuple[Section, ...], document: Document) -> tuple[Section, ...]:
    """With the numbers of what was left out closed up."""
    left = {b.label for s in sections for b in s.blocks if isinstance(b, Equation) and b.number}
    kept = sorted(e.number or 0 for e in document.equations if e.label in left)
    gone = sorted(e.number or 0 for e in document.equations if e.label not in left)
    number = {old: old - sum(g < old for g in gone) for old in kept}
    return tuple(
        section._replace(
            blocks=tuple(
                replace(b, number=number[b.number]) if isinstance(b, Equation) and b.number else b
                for b in section.blocks
            ),
        )
        for section in sections
    )


def _without_rows(document: Document, labels: set[str]) -> Document:
    """Tables without the rows on equations that were left out."""

    def cut(block: NoteBlock) -> NoteBlock:
        if not isinstance(block, NoteTable):
            return block
        rows = (row for row in block.rows if not _refers_elsewhere(row, labels))
        return block._replace(rows=tuple(rows))

    sections = (s._replace(blocks=tuple(map(cut, s.blocks))) for s in document.sections)
    return replace(document, sections=tuple(sections))


def _refers_elsewhere(row: Sequence[Text], labels: set[str]) -> bool:
    references = [s for cell in row for s in cell if isinstance(s, EquationReference)]
    return bool(references) and all(r.label not in labels for r in references)
