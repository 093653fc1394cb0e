r"""What a note says, by templates: facts and Markdown with Jinja make the blocks of a document.

A template prints facts by `{{ }}`: formulas, expressions of SymPy, the user's own texts, equations,
tables and figures. Each leaves a mark in the Markdown, a letter of the private use area, so that
nothing in it is read as Markdown. Formulas are also typed between dollar signs, as in LaTeX, where
they may hold facts; `$$` begins and ends a display, and `\qquad` parts equations that may share a
line. Paragraphs, headings, *emphasis*, **strong words**, `code`, [links](https://...), lists,
tables and escapes such as `\$` are those of Markdown. To import markdown-it-py would take longer
than to read a whole note here.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextvars import ContextVar
from html import unescape
from itertools import count, groupby
from textwrap import dedent
from typing import Any
from urllib.parse import quote

import sympy as sp
from jinja2 import TemplateRuntimeError, Undefined, pass_context
from jinja2.runtime import Context
from markupsafe import Markup

from rigidsym.errors import AlgebraError, TemplateFault
from rigidsym.formula.letters import Letters
from rigidsym.formula.reader import formula, text_of
from rigidsym.formula.scalars import formula_of
from rigidsym.formula.tree import Formula, with_names
from rigidsym.models.rotation import Citation
from rigidsym.notes import document as doc
from rigidsym.notes.figure.drawing import Drawing
from rigidsym.system import resources

# Of a private use area, whose letters no font has; `re` compiles ranges up to U+FFFF slowly.
_FIRST = 0xF0000
_MARK = "[\U000f0000-\U000ffffd]"
# In `code` and in a formula nothing else is read, so that marks take their places first.
_TYPED = re.compile(
    r"\\(?P<escaped>[!-/:-@\[-`{-~])|\$(?P<math>[^$]+)\$|(?<!`)`(?P<code>[^`]+)`(?!`)"
    r"|(?P<entity>&#?\w+;)|(?<!!)\[(?P<words>[^]]+)\]\((?P<address>(?:\([^()\s<>]*\)|[^()\s<>])+)\)"
)
_STYLED = re.compile(
    r"\*\*(?=\S)(?P<strong>(?:\*[^*]+\*|[^*])+)(?<=\S)\*\*"
    rf"|\*(?=\S)(?P<emphasis>(?:\*\*[^*]+\*\*|[^*])+)(?<=\S)\*|(?P<mark>{_MARK})"
)
# Before an item; years, of four digits, begin none.
_BULLET = r"(?:[-*+]|\d{1,2}[.)])\s"
_ITEM = re.compile(rf"(?={_BULLET})(?P<number>\d*)\S\s+(?P<words>.+)", re.DOTALL)
# an item with blank lines before the next one
_LOOSE = re.compile(rf"^( *{_BULLET}.*(?:\n.*\S.*)*)\n\s*\n(?= *{_BULLET})", re.MULTILINE)
# images, other links, HTML, fenced code, line breaks, quotations, rules, _words_, lists in lists
_UNREAD = re.compile(
    r"!\[|\][(\[]|<[A-Za-z/!?]|``|\\$|^(?:>|~~~|[-*_=\s]+$)|(?<!\w)_+\w[^_\n]*_+(?!\w)"
    rf"|^\s+{_BULLET}",
    re.MULTILINE,
)
_IN_ADDRESS = "!#%&'*+,/:;=?@[]~"
_TABLE = "Table:"
_BLOCKS = (doc.Paragraph, doc.Equation, doc.EquationRow, doc.NoteTable, doc.Figure, list)


class _Reader:
    """Reads the Markdown of a template, with the things that its marks stand for."""

    def __init__(self, template: str, letters: Letters) -> None:
        self.template = template
        self.letters = letters
        self.things: list[Any] = []

    def mark(self, thing: Any) -> str:
        """The mark of the k-th thing is the k-th letter of the private use area."""
        self.things.append(thing)
        return chr(_FIRST + len(self.things) - 1)

    def thing(self, text: str) -> Any:
        """What a text that is one mark stands for, and None for others."""
        return self.things[ord(text) - _FIRST] if re.fullmatch(_MARK, text) else None

    def blocks(self, chunk: str) -> Iterator[doc.NoteBlock]:
        """The blocks between two blank lines."""
        if chunk.startswith("$$"):
            yield self._display(chunk)
            return
        whole = self.marked(chunk)
        thing = self.thing(whole)
        if isinstance(thing, _BLOCKS):
            yield from thing if isinstance(thing, list) else (thing,)
        elif whole.startswith(("|", _TABLE)):
            yield self._table(whole)
        elif row := re.search(r"^\|.*", whole, re.MULTILINE):
            raise self.unread(row[0], "|")
        else:
            yield from self._paragraphs(whole)

    def marked(self, chunk: str) -> str:
        """Words with a mark for each formula, code, link and escaped character."""
        whole = _TYPED.sub(self._typed, chunk)
        if "$" in whole:
            lines = (line for line in chunk.splitlines() if "$" in _TYPED.sub("", line))
            raise self.fault(next(lines, chunk), "expected $ at the end of a formula")
        if unread := _UNREAD.search(whole):
            start = whole.rfind("\n", 0, unread.start()) + 1
            raise self.unread(whole[start:].partition("\n")[0], unread[0])
        return whole

    def _typed(self, match: re.Match[str]) -> str:
        if match["math"]:
            return self.mark(self._formula(match["math"]))
        if match["code"]:
            return self.mark(doc.Code(self._plain(match["code"])))
        if match["words"]:
            words = self.text(self.marked(match["words"]))
            address = quote(self._plain(match["address"]), safe=_IN_ADDRESS)
            return self.mark(doc.Styled("link", words, address))
        return self.mark(match["escaped"] or unescape(match["entity"]))

    def _plain(self, words: str) -> str:
        """Words in which only facts are read."""
        return re.sub(_MARK, lambda mark: text_of(self._fact(mark[0])), words)

    def _fact(self, mark: str) -> doc.Text:
        thing = self.thing(mark)
        return thing if type(thing) is tuple else (thing,)

    def _paragraphs(self, words: str) -> Iterator[doc.Paragraph | doc.Listing]:
        """A paragraph, a list, or a list on the line below a paragraph."""
        parts = re.split(rf"\n(?={_BULLET})", words)
        if not _ITEM.match(parts[0]):
            yield doc.Paragraph(self.text(parts.pop(0)))
        matches = (match for match in map(_ITEM.match, parts) if match)
        for has_numbers, run in groupby(matches, lambda match: bool(match["number"])):
            items = list(run)
            first = int(items[0]["number"] or 0)
            marks = (f"{k}." if has_numbers else "-" for k, _ in enumerate(items, first))
            yield doc.Listing(tuple(self.text(item["words"]) for item in items), tuple(marks))

    def _display(self, chunk: str) -> doc.Equation | doc.EquationRow:
        if not re.fullmatch(r"\$\$[^$]+\$\$", chunk):
            lines = (line for line in chunk.splitlines() if line.strip("$ "))
            raise self.fault(next(lines, chunk), "expected $$ at the end of a formula")
        equations = tuple(map(self._equation, chunk.strip("$").split(r"\qquad")))
        return doc.EquationRow(equations) if len(equations) > 1 else equations[0]

    def _equation(self, typed: str) -> doc.Equation:
        """Sides that are equal; a matrix as the last of them may be listed where it is too wide."""
        *sides, last = re.split(r"\s=\s", typed.strip())
        matrix = self.thing(last)
        if not isinstance(matrix, sp.MatrixBase):
            return doc.Equation(sides=tuple(map(self._formula, (*sides, last))))
        return doc.Equation(sides=tuple(map(self._formula, sides)), matrix=matrix.as_immutable())

    def _formula(self, typed: str) -> Formula:
        """A typed formula, with the facts in it."""
        parts = map(self.thing, re.findall(_MARK, typed))
        places = count(1)
        tex = re.sub(_MARK, lambda _: f"#{next(places)}", typed.strip())
        try:
            read = formula(tex, *(formula(p) if isinstance(p, str) else p for p in parts))
        except AlgebraError as error:
            raise self.fault(typed, str(error)) from error
        # facts may hold letters of the user's, which stay
        return with_names(read, self.letters.own) if tex == typed.strip() else read

    def _table(self, chunk: str) -> doc.NoteTable:
        """The rows of a table, below "Table:" and its caption; `:---` begins a column of words."""
        lines = chunk.splitlines()
        caption = lines.pop(0).removeprefix(_TABLE) if chunk.startswith(_TABLE) else ""
        rows = [[cell.strip() for cell in line.strip().strip("|").split("|")] for line in lines]
        are_rows = rows[1:] and all(re.fullmatch(":?-+:?", cell) for cell in rows[1])
        are_rows = are_rows and all(line.lstrip().startswith("|") for line in lines)
        if not are_rows or any(len(row) != len(rows[0]) for row in rows):
            expected = "expected equally many cells in each row, |---| in the second, the caption"
            raise self.fault(chunk.splitlines()[0], f"{expected} directly above")
        of_words = next((k for k, cell in enumerate(rows[1]) if cell.startswith(":")), None)
        head, *others = (tuple(map(self.text, row)) for row in (rows[0], *rows[2:]))
        return doc.NoteTable(text_of(self.text(caption.strip())), head, tuple(others), of_words)

    def unread(self, line: str, what: str) -> TemplateFault:
        expected = "expected words, *emphasis*, **strong words**, `code`, [links](address), lists"
        seen = "a list in a list" if what[0].isspace() else f"'{what.strip()}'"
        return self.fault(line, f"{expected} or a table, not {seen}")

    def fault(self, line: str, expected: str) -> TemplateFault:
        """With file and line of the template, by the longest part of a line without facts."""
        words = max(re.split(_MARK, line), key=len)
        return TemplateFault(f"{resources.place_of(words, self.template)}: {expected}")

    def text(self, words: str) -> doc.Text:
        """The spans of a line, in which neighbouring words are one span."""
        words, *parts = _STYLED.split(" ".join(part.strip() for part in words.splitlines()))
        spans: list[doc.Span] = [words]
        for strong, emphasis, mark, words in zip(*[iter(parts)] * 4, strict=True):
            style = "strong" if strong else "emphasis"
            inside = self.text(strong or emphasis or "")
            spans += self._fact(mark) if mark else (doc.Styled(style, inside),)
            spans.append(words)
        text: list[doc.Span] = []
        for are_words, group in groupby(spans, lambda span: isinstance(span, str)):
            neighbours = list(group)
            text += ["".join(map(str, neighbours))] if are_words else neighbours
        return tuple(span for span in text if span != "")


_READER: ContextVar[_Reader] = ContextVar("reader")


@pass_context  # or Jinja would print constants once, when it compiles the template
def _printed(_: Context, value: Any) -> Markup:
    if isinstance(value, Markup) or value == "":  # of a macro, or nothing
        return Markup(value)
    if isinstance(value, Undefined):
        return Markup(str(value))  # raises
    if value is None:
        raise TemplateRuntimeError("this fact is None here; ask for it first, {% if ... %}")
    reader = _READER.get()
    if isinstance(value, int):
        value = str(value)
    elif isinstance(value, sp.Basic) and not isinstance(value, sp.MatrixBase):
        value = formula_of(value, reader.letters)
    elif isinstance(value, Citation):
        if not isinstance(value.text, str):
            raise TemplateRuntimeError(f"cite({value.text!r}): expected a text in quotes")
        value = doc.Cited(value)
    elif callable(value):
        raise TemplateRuntimeError("expected parentheses after its name, as in {{ super() }}")
    elif type(value) is tuple and value and isinstance(value[0], _BLOCKS):
        value = [*value]  # blocks; other tuples are texts
    mark = reader.mark(value)
    # No paragraph holds a block, whatever the template has beside it.
    return Markup(f"\n\n{mark}\n\n" if isinstance(value, _BLOCKS) else mark)


def sections_of(name: str, letters: Letters, **facts: Any) -> Iterator[doc.Section]:
    """The sections of a template: first what comes before any heading, with an empty title.

    Raises TemplateFault, with the template and its line, for a fact that there is not, for a
    formula that cannot be read, and for Markdown that notes do not print.
    """
    reader = _Reader(f"{name}.md.jinja", letters)
    token = _READER.set(reader)
    try:
        environment = resources.environment(autoescape=True, finalize=_printed)
        markdown = environment.get_template(reader.template).render(facts)
    finally:
        _READER.reset(token)
    title = ""
    blocks: list[doc.NoteBlock] = []
    chunks = re.split(r"\n\s*\n|\n(?=#+ )", _LOOSE.sub(r"\1\n", markdown))
    for chunk in (dedent(chunk).strip() for chunk in chunks):
        heading, _, rest = chunk.partition("\n") if re.match("#+ ", chunk) else ("", "", chunk)
        if heading:
            yield doc.Section(title, tuple(blocks))
            title, blocks = text_of(reader.text(reader.marked(heading.strip("# ")))), []
        if rest.strip():
            blocks += reader.blocks(rest.strip())
    yield doc.Section(title, tuple(blocks))


def blocks_of(name: str, letters: Letters, **facts: Any) -> tuple[doc.NoteBlock, ...]:
    """The blocks of a template without headings."""
    section, *others = sections_of(name, letters, **facts)
    if others:
        reader = _Reader(f"{name}.md.jinja", letters)
        raise reader.fault(others[0].title, "expected no heading in this template")
    return section.blocks


def figure_with(name: str, drawing: Drawing, letters: Letters, **facts: Any) -> doc.Figure:
    """A drawing with its caption, the first paragraph of a template; the others describe it."""
    blocks = blocks_of(name, letters, **facts)
    caption, *others = (block.text for block in blocks if isinstance(block, doc.Paragraph))
    return doc.Figure(drawing, caption, others[0] if others else ())
