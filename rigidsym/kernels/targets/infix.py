"""Expressions as text in the infix notation that Python, C and JavaScript share."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from fractions import Fraction
from functools import lru_cache
from math import isnan
from textwrap import wrap
from types import MappingProxyType

from rigidsym.kernels.ir import (
    Call,
    Choice,
    Compare,
    Expression,
    Guarded,
    Name,
    Negative,
    Number,
    Product,
    Sum,
    parts,
)

_CHOICE, _SUM, _PRODUCT, _ATOM = range(4)  # how tightly a piece of text holds together

# Spaces at which no line ends: within products and definitions, and behind operators and words.
_UNBROKEN = re.compile(r" (?=[*/=])|(?<=[-+*/=<>?:]) |(?<=\bif) |(?<=\belse) ")

Literal = Callable[[float], str]


def infix(
    expression: Expression,
    functions: Mapping[str, str] = MappingProxyType({}),
    number: Literal = repr,
) -> str:
    """The expression in one line; `functions` are the target's names for functions.

    A function without a name there keeps its own; "or_nan" names the function of guards, "None"
    their missing scale. A name with {} is a form for the arguments. "choice" there is a form with
    three places, the condition first, "nan" a word, and "==" the sign of equality. `number` is how
    the target writes a number.
    """
    return _whole(expression, tuple(functions.items()), number)


@lru_cache(maxsize=4096)  # lines are measured before they are printed, and kernels are shared
def _whole(
    expression: Expression,
    functions: tuple[tuple[str, str], ...],
    number: Literal,
) -> str:
    return _text(expression, dict(functions), number)[0]


def _text(expression: Expression, functions: Mapping[str, str], number: Literal) -> tuple[str, int]:
    """The text, and how tightly it holds together."""

    def within(part: Expression, tightness: int) -> str:
        text, held = _text(part, functions, number)
        return text if held >= tightness else f"({text})"

    match expression:
        case Name(text):
            return text, _ATOM
        case Number(value) if isnan(value):
            return functions.get("nan", "nan"), _ATOM
        case Number(value) if value == float(value):
            return number(float(value)), _ATOM
        case Number(value):
            ratio = (number(float(whole)) for whole in Fraction(value).as_integer_ratio())
            return " / ".join(ratio), _PRODUCT
        case Call(function):
            names = [argument.text for argument in expression.arguments]
            return _called(functions.get(function, function), names), _ATOM
        case Compare(relation, left, right):
            sign = functions.get(relation, relation)
            return f"{within(left, _SUM)} {sign} {within(right, _SUM)}", _CHOICE
        case Choice():
            form = functions.get("choice", "{1} if {0} else {2}")
            return form.format(*(within(part, _CHOICE) for part in parts(expression))), _CHOICE
        case Guarded(value, scale, power):
            limit = functions.get("None", "None") if scale is None else within(scale, _SUM)
            given = [value.text, limit, *([str(power)] if power != 1 else [])]
            return _called(functions.get("or_nan", "or_nan"), given), _ATOM
        case Negative(operand):
            return f"-{within(operand, _PRODUCT)}", _SUM
        case Sum(terms):
            first, *others = (within(term, _SUM) for term in terms)
            signed = (f"- {t[1:]}" if t.startswith("-") else f"+ {t}" for t in others)
            return " ".join([first, *signed]), _SUM
        case Product(factors, divisors):
            above, below = (
                " * ".join(within(part, tightness) for part in side)
                for side, tightness in (
                    (factors, _PRODUCT),
                    (divisors, _PRODUCT if len(divisors) > 1 else _ATOM),
                )
            )
            if not divisors:
                return above, _PRODUCT
            return f"{above} / {f'({below})' if len(divisors) > 1 else below}", _PRODUCT


def _called(function: str, arguments: list[str]) -> str:
    listed = ", ".join(arguments)
    return function.format(listed) if "{}" in function else f"{function}({listed})"


def broken(text: str, width: int, margin: str = "") -> str:
    """The text in lines that begin with a term; `margin` is before all but the first."""
    if len(text) <= width:
        return text
    glued = _UNBROKEN.sub("\xa0", text)
    lines = wrap(
        glued, width, subsequent_indent=margin, break_long_words=False, break_on_hyphens=False
    )
    return "\n".join(lines).replace("\xa0", " ")
