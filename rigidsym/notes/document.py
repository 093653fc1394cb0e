"""A note as data: sections of paragraphs, equations and tables, for any printer.

Text is a tuple of spans: plain words, formulas (in both markups), code, references. Equations
hold SymPy matrices, so that each printer can break and abbreviate them for its own width.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property
from itertools import chain

from rigidsym.errors import AlgebraError, ModelError, TemplateFault
from rigidsym.formula.display import Equation as Equation
from rigidsym.formula.letters import Letters
from rigidsym.formula.reader import sentence, text_of
from rigidsym.formula.tree import Formula
from rigidsym.mechanics.derivation import phrases
from rigidsym.models.rotation import Citation
from rigidsym.notes.figure.drawing import Drawing
from rigidsym.system.records import NamedTuple, Record


class Code(NamedTuple):
    """A name in a program, or a call."""

    text: str


class Styled(NamedTuple):
    """Words in another style, or with a link to an address."""

    style: str  # "emphasis", "strong" or "link"
    inside: Text
    address: str = ""  # without blanks, brackets and quotes

    @property
    def text(self) -> str:
        return text_of(self.inside) + f" ({self.address})" * bool(self.address)


class EquationReference(NamedTuple):
    """The number of a numbered equation of this document."""

    label: str

    @property
    def text(self) -> str:
        return self.label


class FigureReference(NamedTuple):
    """A figure of this document, by its place among them, from 1."""

    number: int

    @property
    def text(self) -> str:
        return str(self.number)


class Cited(NamedTuple):
    """A place in a source."""

    citation: Citation

    @property
    def text(self) -> str:
        return str(self.citation)

    @property
    def place(self) -> str:
        """Where in the source: the equation, or else the section; nothing where it is the whole."""
        equation, section = self.citation.equation, self.citation.section
        return f"eq.\u00a0{equation}" if equation else section.replace(" ", "\u00a0")


Span = str | Formula | Code | Styled | EquationReference | FigureReference | Cited
Text = tuple[Span, ...]


class Paragraph(NamedTuple):
    text: Text


def said(key: str, *spans: Span) -> Paragraph:
    """A sentence of templates/notes/en/equations.toml; raises TemplateFault for a faulty one."""
    try:
        return Paragraph(sentence(phrases("equations")[key], *spans))
    except AlgebraError as error:
        raise TemplateFault(f"en/equations.toml, {key}: {error}") from error


class Listing(NamedTuple):
    """A list, of which each item is a line."""

    items: tuple[Text, ...]
    marks: tuple[str, ...]  # before each item: "-" for bullets, or "1.", "2.", ...


class EquationRow(NamedTuple):
    """Short unnumbered equations that may share a line."""

    equations: tuple[Equation, ...]


class NoteTable(NamedTuple):
    caption: str
    head: tuple[Text, ...]
    rows: tuple[tuple[Text, ...], ...]
    of_words: int | None = None  # the column whose cells may take several lines


class Figure(NamedTuple):
    drawing: Drawing
    caption: Text  # which line is what
    description: Text  # what the figure says, in words that do without it


NoteBlock = Paragraph | Listing | Equation | EquationRow | NoteTable | Figure


class Section(NamedTuple):
    title: str
    blocks: tuple[NoteBlock, ...]


class Document(Record, kw_only=True):
    """A note. Equation labels are unique in it; sources are numbered in order of appearance."""

    name: str  # of the derivation: lower case, digits, underscores
    title: Text
    subtitle: str
    letters: Letters
    sections: tuple[Section, ...]
    author: str = ""
    byline: tuple[str, ...] = ()  # below the title: author, course, date
    language: str = "en"
    # only the same document has the same printer: equations with other claims are equal, and users
    # have templates of their own
    __eq__ = object.__eq__
    __hash__ = object.__hash__

    @property
    def blocks(self) -> Iterator[NoteBlock]:
        """All blocks in order."""
        return chain.from_iterable(section.blocks for section in self.sections)

    @cached_property
    def equations(self) -> tuple[Equation, ...]:
        """The numbered equations, in order, each once: a label belongs to the first print."""
        return tuple(b for b in self.blocks if isinstance(b, Equation) and b.number and b.label)

    @cached_property
    def displays(self) -> tuple[Equation, ...]:
        """All equations in order, including equations that share a line."""
        groups = (b.equations if isinstance(b, EquationRow) else (b,) for b in self.blocks)
        return tuple(e for e in chain.from_iterable(groups) if isinstance(e, Equation))

    @cached_property
    def figures(self) -> tuple[Figure, ...]:
        """The figures, in order; their numbers are their places."""
        return tuple(block for block in self.blocks if isinstance(block, Figure))

    @cached_property
    def sources(self) -> tuple[str, ...]:
        """The sources that the text cites, each once, in order of appearance."""
        texts = chain.from_iterable(map(texts_of, self.blocks))
        spans = chain.from_iterable(map(spans_of, texts))
        return tuple(dict.fromkeys(s.citation.text for s in spans if isinstance(s, Cited)))

    def source_number(self, cited: Cited) -> int:
        """The number of the source that is cited."""
        return self.sources.index(cited.citation.text) + 1

    def number(self, label: str) -> int:
        """The number of an equation, by its label; raises ModelError if the note lacks it."""
        for equation in self.equations:
            if equation.label == label and equation.number:
                return equation.number
        raise ModelError(f"the note refers to the equation of {label}, but its template has none")


def texts_of(block: NoteBlock) -> Iterator[Text]:
    """The texts of a block, in order."""
    match block:
        case Paragraph(text):
            yield text
        case Listing(items):
            yield from items
        case Figure():
            yield from (block.caption, block.description)
        case NoteTable():
            yield from chain(block.head, *block.rows)


def spans_of(text: Text) -> Iterator[Span]:
    """The spans of a text, and those inside its styled words."""
    for span in text:
        yield span
        if isinstance(span, Styled):
            yield from spans_of(span.inside)
