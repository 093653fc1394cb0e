"""Expressions as text in the infix notation that Python, C and JavaScript share."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction
from math import isnan

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

Literal = Callable[[float], str]


def infix(expression: Expression, functions: Mapping[str, str], number: Literal = repr) -> str:
    """The expression in one line; `functions` are the target's names for functions.

    A function without a name there keeps its own, a guard is or_nan(value, scale), and `number`
    is how the target writes a number. "choice" there is a form with three places, the condition
    first, "nan" a word, and "==" the sign of equality.
    """
    return _text(expression, functions, number)[0]


def literal(value: Fraction | float, number: Literal = repr) -> str:
    """A number as a literal of a floating-point type; a fraction that is none, as a quotient."""
    if Fraction(float(value)) == value:
        return number(float(value))
    fraction = Fraction(value)
    return f"{number(float(fraction.numerator))} / {number(float(fraction.denominator))}"


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
        case Number(value):
            text = literal(value, number)
            return text, _PRODUCT if "/" in text else _ATOM
        case Call(function):
            given = ", ".join(argument.text for argument in expression.arguments)
            return f"{functions.get(function, function)}({given})", _ATOM
        case Compare(relation, left, right):
            sign = functions.get(relation, relation)
            return f"{within(left, _SUM)} {sign} {within(right, _SUM)}", _CHOICE
        case Choice():
            form = functions.get("choice", "{1} if {0} else {2}")
            return form.format(*(within(part, _CHOICE) for part in parts(expression))), _CHOICE
        case Guarded(value, scale):
            limit = "None" if scale is None else within(scale, _SUM)
            return f"or_nan({value.text}, {limit})", _ATOM
        case Negative(operand):
            return f"-{within(operand, _PRODUCT)}", _SUM
        case Sum(terms):
            first, *others = (within(term, _SUM) for term in terms)
            signed = (f"- {t[1:]}" if t.startswith("-") else f"+ {t}" for t in others)
            return " ".join([first, *signed]), _SUM
        case Product(factors, divisors):
            above = " * ".join(within(factor, _PRODUCT) for factor in factors)
            if not divisors:
                return above, _PRODUCT
            if len(divisors) == 1:
                return f"{above} / {within(divisors[0], _ATOM)}", _PRODUCT
            below = " * ".join(within(divisor, _PRODUCT) for divisor in divisors)
            return f"{above} / ({below})", _PRODUCT
