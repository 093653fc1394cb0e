r"""What a note says, by templates: facts and Markdown with Jinja make the blocks of a document.

A template prints facts by `{{ }}`: formulas, expressions of SymPy, the user's own texts, equations,
tables and figures. Each leaves a mark in the Markdown, a letter of the private use area, so that
nothing in it is read as Markdown. Formulas are also typed between dollar signs, as in LaTeX, where
they may hold facts; `$$` begins and ends a display, and `\qquad` parts equations that may share a
line. `\$` is a dollar sign. Paragraphs, headings, **strong words**, `code` and tables are those of
Markdown.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from contextvars import ContextVar
from itertools import groupby
from typing import TYPE_CHECKING, Any, NamedTuple

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
from rigidsym.system import resources

if TYPE_CHECKING:
    from rigidsym.notes.figure.drawing import Drawing

# Of a private use area, whose letters no font has; `re` compiles ranges up to U+FFFF slowly.
_FIRST = 0xF0000
_MARK = "[\U000f0000-\U000ffffd]"
_INLINE = re.compile(
    r"\\(?P<dollar>\$)|\$(?P<math>[^$]+)\$|\*\*(?P<strong>.+?)\*\*|`(?P<code>[^`]+)`"
    rf"|(?P<mark>{_MARK})"
)
_MARKUP = re.compile(rf"[$*`|#&\n]|{_MARK}")  # what would be read as Markdown, or as a mark
_TABLE = "Table:"
_BLOCKS = (doc.Paragraph, doc.Equation, doc.EquationRow, doc.NoteTable, doc.Figure, list)


class _Marks(NamedTuple):
    """What the marks of one text stand for, in the order in which they were printed."""

    letters: Letters
    things: list[Any]


_MARKS: ContextVar[_Marks] = ContextVar("marks")


@pass_context  # or Jinja would print constants once, when it compiles the template
def _printed(_: Context, value: Any) -> Markup:
    if isinstance(value, Markup):  # of a macro
        return value
    if isinstance(value, Undefined):
        return Markup(str(value))  # raises
    if value is None:
        raise TemplateRuntimeError("this fact is None here; ask for it first, {% if ... %}")
    if isinstance(value, int | str) and not _MARKUP.search(str(value)):
        return Markup(str(value))
    marks = _MARKS.get()
    if isinstance(value, sp.Basic) and not isinstance(value, sp.MatrixBase):
        value = formula_of(value, marks.letters)
    elif isinstance(value, Citation):
        value = doc.Cited(value)
    elif type(value) is tuple and value and isinstance(value[0], _BLOCKS):
        value = [*value]  # blocks; other tuples are texts
    marks.things.append(value)
    # The mark of the k-th thing is the k-th letter of the private use area.
    mark = chr(_FIRST + len(marks.things) - 1)
    # No paragraph holds a block, whatever the template has beside it.
    return Markup(f"\n\n{mark}\n\n" if isinstance(value, _BLOCKS) else mark)


def sections_of(name: str, letters: Letters, **facts: Any) -> Iterator[doc.Section]:
    """The sections of a template: first what comes before any heading, with an empty title.

    Raises TemplateFault, with the template and its line, for a fact that there is not, and for a
    formula that cannot be read.
    """
    marks = _Marks(letters, [])
    token = _MARKS.set(marks)
    try:
        environment = resources.environment(autoescape=True, finalize=_printed)
        markdown = environment.get_template(f"{name}.md.jinja").render(facts)
    finally:
        _MARKS.reset(token)
    section = doc.Section("", ())
    blocks: list[doc.NoteBlock] = []
    for chunk in map(str.strip, re.split(r"\n\s*\n", markdown)):
        heading, _, rest = chunk.partition("\n") if chunk.startswith("#") else ("", "", chunk)
        _check_ends(heading)
        _check_ends(rest)
        if heading:
            yield section._replace(blocks=tuple(blocks))
            title = text_of(_text(heading.strip("# "), marks))
            section, blocks = doc.Section(title, ()), []
        if rest.strip():
            blocks += _blocks(rest.strip(), marks)
    yield section._replace(blocks=tuple(blocks))


def _check_ends(chunk: str) -> None:
    """Raises TemplateFault, with the line, if a formula of a paragraph has no end."""
    is_display = chunk.startswith("$$")

    def is_whole(typed: str) -> bool:
        if is_display:
            return re.fullmatch(r"\$\$[^$]+\$\$", typed) is not None
        return "$" not in _INLINE.sub("", typed.replace("**", ""))

    if not is_whole(chunk):
        lines = (line for line in chunk.splitlines() if line.strip("$ ") and not is_whole(line))
        raise TemplateFault(
            f"{_place_of(next(lines, chunk))}: "
            f"expected {'$$' if is_display else '$'} at the end of a formula"
        )


def _place_of(line: str) -> str:
    """File and line of the template, by the longest part of a line of Markdown without facts."""
    return resources.place_of(max(re.split(_MARK, line), key=len))


def blocks_of(name: str, letters: Letters, **facts: Any) -> tuple[doc.NoteBlock, ...]:
    """The blocks of a template without headings."""
    (section,) = sections_of(name, letters, **facts)
    return section.blocks


def texts_of(name: str, letters: Letters, **facts: Any) -> tuple[doc.Text, ...]:
    """The paragraphs of a template of sentences only."""
    blocks = blocks_of(name, letters, **facts)
    return tuple(block.text for block in blocks if isinstance(block, doc.Paragraph))


def figure_with(name: str, drawing: Drawing, letters: Letters, **facts: Any) -> doc.Figure:
    """A drawing with its caption, the first paragraph of a template; the others describe it."""
    caption, *others = texts_of(name, letters, **facts)
    return doc.Figure(drawing, caption, others[0] if others else ())


def _blocks(chunk: str, marks: _Marks) -> Iterator[doc.NoteBlock]:
    thing = marks.things[ord(chunk) - _FIRST] if re.fullmatch(_MARK, chunk) else None
    if chunk.startswith("$$"):
        inside = chunk.strip("$").strip()
        equations = tuple(_equation(part, marks) for part in inside.split(r"\qquad"))
        yield doc.EquationRow(equations) if len(equations) > 1 else equations[0]
    elif chunk.startswith(("|", _TABLE)):
        yield _table(chunk, marks)
    elif isinstance(thing, _BLOCKS):
        yield from thing if isinstance(thing, list) else (thing,)
    else:
        yield doc.Paragraph(_text(chunk, marks))


def _equation(typed: str, marks: _Marks) -> doc.Equation:
    """Sides that are equal; a matrix as the last of them may be listed where it is too wide."""
    *sides, last = re.split(r"\s=\s", typed.strip())
    thing = marks.things[ord(last) - _FIRST] if re.fullmatch(_MARK, last) else None
    if isinstance(thing, sp.MatrixBase):
        return doc.Equation(
            sides=tuple(_formula(s, marks) for s in sides), matrix=thing.as_immutable()
        )
    return doc.Equation(sides=tuple(_formula(side, marks) for side in (*sides, last)))


def _formula(typed: str, marks: _Marks) -> Formula:
    """A typed formula, with the facts in it."""
    parts = [marks.things[ord(mark) - _FIRST] for mark in re.findall(_MARK, typed)]
    places = iter(range(1, 1 + len(parts)))
    try:
        read = formula(re.sub(_MARK, lambda _: f"#{next(places)}", typed.strip()), *parts)
        # facts may hold letters of the user's, which stay
        return read if parts else with_names(read, marks.letters.own)
    except AlgebraError as error:
        raise TemplateFault(f"{_place_of(typed)}: {error}") from error


def _table(chunk: str, marks: _Marks) -> doc.NoteTable:
    """The rows of a table, below "Table:" and its caption; `:---` begins a column of words."""
    lines = chunk.splitlines()
    caption = lines.pop(0).removeprefix(_TABLE).strip() if chunk.startswith(_TABLE) else ""
    rows = [[cell.strip() for cell in line.strip().strip("|").split("|")] for line in lines]
    of_words = next((k for k, cell in enumerate(rows[1]) if cell.startswith(":")), None)
    head, *others = (tuple(_text(cell, marks) for cell in row) for row in (rows[0], *rows[2:]))
    return doc.NoteTable(text_of(_text(caption, marks)), head, tuple(others), of_words)


def _text(words: str, marks: _Marks) -> doc.Text:
    """The spans of a line, in which neighbouring words are one span."""
    line = " ".join(part.strip() for part in words.splitlines()).replace("&nbsp;", "\u00a0")
    spans: list[doc.Span] = []
    end = 0
    for match in _INLINE.finditer(line):
        spans.append(line[end : match.start()])
        spans += _spans(match, marks)
        end = match.end()
    spans.append(line[end:])
    text: list[doc.Span] = []
    for are_words, group in groupby(spans, lambda span: isinstance(span, str)):
        neighbours = list(group)
        text += ["".join(map(str, neighbours))] if are_words else neighbours
    return tuple(span for span in text if span != "")


def _spans(match: re.Match[str], marks: _Marks) -> Iterable[doc.Span]:
    if match["math"]:
        return (_formula(match["math"], marks),)
    if match["strong"]:
        return (doc.Strong(text_of(_text(match["strong"], marks))),)
    if match["dollar"]:
        return ("$",)
    if match["code"]:  # in which only facts are read
        code = re.sub(_MARK, lambda mark: text_of(_fact(mark[0], marks)), match["code"])
        return (doc.Code(code),)
    return _fact(match["mark"], marks)


def _fact(mark: str, marks: _Marks) -> doc.Text:
    thing = marks.things[ord(mark) - _FIRST]
    return thing if type(thing) is tuple else (thing,)
