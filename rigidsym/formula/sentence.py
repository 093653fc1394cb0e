"""Sentences that hold formulas."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, TypeVar

from rigidsym.formula.reader import formula
from rigidsym.formula.tree import Formula

_Span = TypeVar("_Span")
Sentence = tuple[str | Formula, ...]


def sentence(typed: str, *spans: _Span) -> tuple[str | Formula | _Span, ...]:
    r"""The text r"The axis $\mathbf{e}$ of {}" with its formulas read, and a span for each {}."""
    given = iter(spans)
    found: list[str | Formula | _Span] = []
    for place, part in enumerate(typed.split("$")):
        if place % 2:
            found.append(formula(part))
            continue
        first, *others = part.split("{}")
        found.append(first)
        for words in others:
            found += [next(given), words]
    return tuple(span for span in found if span != "")


def text_of(words: Iterable[Any]) -> str:
    """The sentence on one line of Unicode; each span is words, or has a `text`."""
    return "".join(span if isinstance(span, str) else span.text for span in words)


def by_text(formulas: Iterable[Formula]) -> dict[str, Formula]:
    """Formulas by their plain text, as it may stand in a sentence."""
    return {found.text: found for found in formulas}
