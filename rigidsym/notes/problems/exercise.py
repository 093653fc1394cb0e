"""Problems with worked solutions: data, sheets for students and for teachers, and Moodle XML."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from decimal import ROUND_HALF_UP, Context
from html import escape
from random import Random
from typing import Any

from rigidsym.errors import ModelError
from rigidsym.formula.display import display
from rigidsym.formula.letters import Letters
from rigidsym.formula.reader import decimal
from rigidsym.formula.tree import Formula, equal
from rigidsym.mechanics.derivation import Argument
from rigidsym.notes.document.document import (
    Document,
    Equation,
    NoteBlock,
    Paragraph,
    Section,
    Strong,
    Text,
    listed,
)
from rigidsym.notes.formula.derivation_letters import letters_of
from rigidsym.notes.template import sections_of

_WIDTH = 40.0  # ems of a display in a quiz
_DRAWS = 8  # of one kind, before the next one is tried


@dataclass(frozen=True, kw_only=True, slots=True)
class Asked:
    """What is asked for: a number, or one of several texts."""

    symbol: Formula | None = None  # of a number
    value: float = 0.0
    unit: str = ""
    choices: tuple[str, ...] = ()  # the right one first

    @property
    def text(self) -> Text:
        if self.choices:
            return (self.choices[0],)
        assert self.symbol is not None
        shown = equal(self.symbol, numeral(self.value))
        if not self.unit:
            return (shown,)
        unit = self.unit if self.unit == "°" else f" {self.unit}"
        return (shown, unit.replace(" ", "\u00a0"))

    @property
    def cloze(self) -> str:
        """The answer as Moodle embeds it; a number may be off by one per cent."""
        if self.choices:
            right, *wrong = self.choices
            return "{1:MULTICHOICE_S:=" + "~".join((right, *wrong)) + "}"
        tolerance = max(0.01 * abs(self.value), 1e-3)
        return f"{{1:NUMERICAL:={self.value:.6g}:{tolerance:.2g}}} {self.unit}"


@dataclass(frozen=True, kw_only=True, slots=True)
class Exercise:
    """A question and its solution, which leads to the answers."""

    title: str
    question: tuple[NoteBlock, ...]
    solution: tuple[NoteBlock, ...]
    answers: tuple[Asked, ...]
    arguments: tuple[Argument, ...] = ()  # whose letters the formulas have

    @property
    def answer(self) -> Paragraph:
        return Paragraph((Strong("Answer:"), " ", *listed([a.text for a in self.answers]), "."))

    def is_like(self, other: Exercise) -> bool:
        """Whether the question is the same, or all answers are, as they are printed."""
        mine, theirs = ([(a.text, a.choices) for a in e.answers] for e in (self, other))
        return self.question == other.question or mine == theirs


def exercise(
    name: str,
    answers: Iterable[Asked],
    arguments: tuple[Argument, ...] = (),
    **facts: Any,
) -> Exercise:
    """The problem that a template of templates/notes/en/problems says, and its solution."""
    letters = letters_of(arguments)
    _, question, solution = sections_of(f"en/problems/{name}", letters, **facts)
    return Exercise(
        title=question.title,
        question=question.blocks,
        solution=solution.blocks,
        answers=tuple(answers),
        arguments=arguments,
    )


@dataclass(frozen=True, kw_only=True, slots=True)
class Sheet:
    """The problems of one variant."""

    subject: str
    title: str
    variant: int
    problems: tuple[Exercise, ...]

    @property
    def name(self) -> str:
        return f"problems_{self.subject}_{self.variant}"

    def document(self, *, solved: bool) -> Document:
        """The sheet, or the sheet with its solutions."""
        return Document(
            name=f"{self.name}_solutions" if solved else self.name,
            title="Solutions" if solved else "Problems",
            subtitle=f"{self.title}, variant {self.variant}",
            letters=self.letters,
            sections=tuple(
                Section(p.title, (*p.question, *_solution(p)) if solved else p.question)
                for p in self.problems
            ),
        )

    @property
    def letters(self) -> Letters:
        return letters_of([a for problem in self.problems for a in problem.arguments])

    @property
    def moodle(self) -> str:
        """A question bank in Moodle XML: one question with embedded answers a problem."""
        document = self.document(solved=False)
        asked = zip(document.sections, self.problems, strict=True)
        questions = "".join(_question(*each, document.letters) for each in asked)
        return f'<?xml version="1.0" encoding="UTF-8"?>\n<quiz>\n{questions}</quiz>\n'


_Kind = Callable[[Random], Exercise]
Subject = tuple[str, Sequence[_Kind]]  # its title, and its kinds in turn


def sheet_of(
    subject: str,
    kinds: Mapping[str, Subject],
    *,
    count: int,
    variant: int,
) -> Sheet:
    """`count` problems of a subject, its kinds in turn; the same variant is the same sheet.

    No two are alike: a problem is drawn again, and where a kind has no more, of the next kind.
    Raises ModelError for a subject that is not among the kinds.
    """
    if subject not in kinds:
        raise ModelError(f"no problems on {subject!r}; there are {', '.join(kinds)}")
    title, made = kinds[subject]
    problems: list[Exercise] = []
    for k in range(count):
        drawn = _drawn(made, k, f"{subject} {variant} {k}")
        problems.append(next(p for p in drawn if not any(map(p.is_like, problems))))
    return Sheet(
        subject=subject,
        title=title,
        variant=variant,
        problems=tuple(problems),
    )


def _drawn(kinds: Sequence[_Kind], start: int, seed: str) -> Iterator[Exercise]:
    """Problems to choose from: several of one kind, then of the next, without end."""
    for attempt in itertools.count():
        kind = kinds[(start + attempt // _DRAWS) % len(kinds)]
        yield kind(Random(f"{seed} {attempt}" if attempt else seed))


def _solution(problem: Exercise) -> Iterator[NoteBlock]:
    first, *others = problem.solution
    assert isinstance(first, Paragraph)
    yield Paragraph((Strong("Solution."), " ", *first.text))
    yield from others
    yield problem.answer


def numeral(value: float) -> Formula:
    """A number with four digits at most; 18.275 is rounded up, as students do."""
    rounded = Context(prec=4, rounding=ROUND_HALF_UP).create_decimal(f"{value:.12g}")
    return decimal(float(rounded), most=4)


def _question(section: Section, problem: Exercise, letters: Letters) -> str:
    """A problem, asked in the words of a section."""
    return (
        '<question type="cloze">\n'
        f"<name><text>{escape(section.title)}</text></name>\n"
        f'<questiontext format="html"><text><![CDATA[{_html(section, problem, letters)}]]></text>'
        "</questiontext>\n</question>\n"
    )


def _html(question: Section, problem: Exercise, letters: Letters) -> str:
    parts = [_block(block, letters) for block in question.blocks]
    for answer in problem.answers:
        asked = f"\\({answer.symbol.latex}\\) = " if answer.symbol else ""
        parts.append(f"<p>{asked}{answer.cloze}</p>")
    return "\n".join(parts)


def _block(block: NoteBlock, letters: Letters) -> str:
    if isinstance(block, Equation):
        return f"<p>\\[{escape(display(block, letters, _WIDTH).text, quote=False)}\\]</p>"
    assert isinstance(block, Paragraph)
    spans = (
        f"\\({escape(span.latex, quote=False)}\\)"
        if isinstance(span, Formula)
        else escape(str(span))
        for span in block.text
    )
    return f"<p>{''.join(spans)}</p>"
