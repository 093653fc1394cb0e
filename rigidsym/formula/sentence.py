"""Sentences that hold formulas."""

from __future__ import annotations

import re

from rigidsym.formula.reader import formula
from rigidsym.formula.tree import Formula

Sentence = tuple[str | Formula, ...]
_SPAN = re.compile(r"\$([^$]*)\$|(\{\})")


def sentence(typed: str, *parts: Formula) -> Sentence:
    r"""The sentence of a text such as "The axis $\mathbf{e}$ and {}"; `parts` replace the {}."""
    given = iter(parts)
    spans: list[str | Formula] = []
    for number, span in enumerate(_SPAN.split(typed)):
        if number % 3 == 1 and span is not None:
            spans.append(formula(span))
        elif number % 3 == 2 and span:
            spans.append(next(given))
        elif number % 3 == 0 and span:
            spans.append(span)
    return tuple(spans)


def text_of(words: Sentence) -> str:
    """The sentence on one line of Unicode."""
    return "".join(span if isinstance(span, str) else span.text for span in words)
