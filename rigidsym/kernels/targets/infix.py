"""Expressions as text in the infix notation that Python, C and JavaScript share."""

from __future__ import annotations

import re
from collections.abc import Mapping
from fractions import Fraction
from math import isnan
from textwrap import wrap
from types import MappingProxyType

from rigidsym.kernels import ir

_CHOICE, _SUM, _PRODUCT, _ATOM = range(4)  # how tightly a piece of text holds together

# Spaces at which no line ends: within products and definitions, and behind operators and words.
_UNBROKEN = re.compile(r" (?=[*/=])|(?<=[-+*/=<>?:]) |(?<=\bif) |(?<=\belse) ")

_LIMITS = {"limit0": "None", "limit1": "{}", "limit2": "{}, 2"}


def infix(
    expression: ir.Expression, forms: Mapping[str, str] = MappingProxyType({}), number: str = "{}"
) -> str:
    """The expression in one line; `forms` are how the target writes what is not arithmetic.

    A form has {} for the arguments of a function; a function without one keeps its name. "or_nan"
    is the form of guards, "limit0" of their limit without a scale, "limit1" and "limit2" with one
    and with a square of eps. "choice" has three places, the condition first; "nan" is a word, and
    "==" the sign of equality. `number` is the form of a number.
    """
    return _text(expression, forms, number)[0]


def _text(expression: ir.Expression, forms: Mapping[str, str], number: str) -> tuple[str, int]:
    """The text, and how tightly it holds together."""

    def within(part: ir.Expression, tightness: int) -> str:
        text, held = _text(part, forms, number)
        return text if held >= tightness else f"({text})"

    def called(function: str, arguments: str) -> str:
        return forms.get(function, f"{function}({{}})").format(arguments)

    match expression:
        case ir.Name(text):
            return text, _ATOM
        case ir.Number(value) if isnan(value):
            return forms.get("nan", "nan"), _ATOM
        case ir.Number(value) if value == float(value):
            return number.format(float(value)), _ATOM
        case ir.Number(value):
            ratio = (number.format(float(whole)) for whole in Fraction(value).as_integer_ratio())
            return " / ".join(ratio), _PRODUCT
        case ir.Call(function):
            return called(function, ", ".join(a.text for a in expression.arguments)), _ATOM
        case ir.Compare(relation, left, right):
            sign = forms.get(relation, relation)
            return f"{within(left, _SUM)} {sign} {within(right, _SUM)}", _CHOICE
        case ir.Choice():
            form = forms.get("choice", "{1} if {0} else {2}")
            return form.format(*(within(part, _CHOICE) for part in ir.parts(expression))), _CHOICE
        case ir.Guarded(value, scale, power):
            key = f"limit{0 if scale is None else power}"
            limit = forms.get(key, _LIMITS[key]).format(within(scale, _SUM) if scale else "")
            return called("or_nan", f"{value.text}, {limit}"), _ATOM
        case ir.Negative(operand):
            return f"-{within(operand, _PRODUCT)}", _SUM
        case ir.Sum(terms):
            first, *others = (within(term, _SUM) for term in terms)
            signed = (f"- {t[1:]}" if t.startswith("-") else f"+ {t}" for t in others)
            return " ".join([first, *signed]), _SUM
        case ir.Product(factors, divisors):
            whole = " * ".join(within(part, _PRODUCT) for part in factors)
            if len(divisors) > 1:
                whole += f" / ({' * '.join(within(part, _PRODUCT) for part in divisors)})"
            elif divisors:
                whole += f" / {within(divisors[0], _ATOM)}"
            return whole, _PRODUCT


def broken(text: str, width: int, margin: str = "") -> str:
    """The text in lines that begin with a term; `margin` is before all but the first."""
    if len(text) > width:
        glued = _UNBROKEN.sub("\xa0", text)
        lines = wrap(
            glued, width, subsequent_indent=margin, break_long_words=False, break_on_hyphens=False
        )
        text = "\n".join(lines)
    return text.replace("\xa0", " ")
