"""Text to SymPy, by how tightly operators bind. The text is never run.

    sum      value (operator sum)* | ("+" | "-") sum
    value    number | name | name "(" sum ("," sum)* ")" | "(" sum ")"

Python's own reader would take `lambda` for a keyword, normalise letters (NFKC) and round 0.1.
`rigidsym.text.bounds` does the arithmetic.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from itertools import accumulate, takewhile
from typing import NamedTuple

import sympy as sp

from rigidsym.errors import ExpressionError, offer
from rigidsym.text.bounds import FUNCTIONS, Sized, apply, operate
from rigidsym.text.names import GREEK_LETTERS, spelled

MOST_CHARACTERS = 2000
_DEEPEST = 50  # nested brackets
_MOST_DIGITS = 40  # of one number, and the largest power of ten it may carry

_LETTER = "A-Za-z_" + GREEK_LETTERS
_TOKEN = re.compile(
    r"(?P<number>(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)"
    rf"|(?P<name>[{_LETTER}][{_LETTER}0-9]*)"
    r"|(?P<operator>\*\*|[-+*/(),])",
    re.ASCII,
)
# Precedence climbing: an operator takes the operand to its right as far as operators that bind more
# tightly reach. A sign lies between products and powers.
_BINDING = {"+": 1, "-": 1, "*": 2, "/": 2, "**": 4}
_SIGN = 3  # -a*b is (-a)*b, and -a**2 is -(a**2)
_HINTS = {
    "^": "write ** for a power",
    "²": "write **2",
    "³": "write **3",
    "·": "write *",
    "×": "write *",
    "÷": "write /",
    "−": "write -",
    "√": "write sqrt(...)",
    "[": "group with ( and )",
    "{": "group with ( and )",
    "=": "expected an expression, not an equation",
    "%": "angles are in radians; for degrees write pi/180*...",
    "°": "angles are in radians; for degrees write pi/180*...",
}

_TURN = re.compile(r"([xyz]|\[[^\[\]]*\])\s*\(")
_BETWEEN_TURNS = re.compile(r"\s*(\*?)\s*")


def parse_expression(text: str, names: Mapping[str, sp.Expr]) -> sp.Expr:
    """The expression in a text, with the declared names, `pi` and numbers.

    Numbers are exact (0.1 is 1/10), Greek letters are short for their names (φ for phi), and
    exponents are rational numbers. Known functions: `rigidsym.text.bounds.FUNCTIONS`.

    Raises ExpressionError, with the column, for any other text and for one that is too large.
    """
    _check_length(text)
    try:
        return _Reader(text, names).whole().expression
    except (RecursionError, MemoryError):
        raise ExpressionError(
            "operations are nested too deeply; expected a shorter expression"
        ) from None


def parse_turns(text: str) -> tuple[tuple[str, str, int], ...]:
    """(axis, angle, column of the angle) of each turn in `z(phi) [1,1,0](psi)`, left to right.

    Turns follow one another, with or without `*`; an axis is x, y, z, or its components in
    square brackets. Raises ExpressionError with the column.
    """
    _check_length(text)
    turns: list[tuple[str, str, int]] = []
    place = len(text) - len(text.lstrip())
    # An empty text is read once, for its error.
    while place < len(text) or not turns:
        turn = _TURN.match(text, place)
        if turn is None:
            raise _expected("a turn: x(...), y(...), z(...) or [1,1,0](...)", text, place)
        # The angle ends where the depth of the brackets, 1 behind the first, falls to 0.
        depths = accumulate(({"(": 1, ")": -1}.get(c, 0) for c in text[turn.end() :]), initial=1)
        inside = text[turn.end() :][: sum(1 for _ in takewhile(bool, depths)) - 1]
        end = turn.end() + len(inside)
        if end == len(text):
            raise ExpressionError("unclosed (", column=turn.end())
        if not inside.strip():
            raise _expected("an angle", text, end)
        column = end - len(inside.lstrip()) + 1
        turns.append((turn[1], inside.strip(), column))
        between = _BETWEEN_TURNS.match(text, end + 1)
        place = between.end() if between else end + 1
        if between and between[1] and place == len(text):
            raise _expected("a turn after *", text, place)
    return tuple(turns)


def names_in(text: str) -> tuple[str, ...]:
    """The plain names in an expression that are not functions or pi, in order, each once."""
    _check_length(text)
    found = (spelled(token.text) for token in _tokens(text) if token.kind == "name")
    return tuple(dict.fromkeys(name for name in found if name not in (*FUNCTIONS, "pi")))


class _Token(NamedTuple):
    kind: str  # number, name or operator
    text: str
    start: int  # counted from 0, in characters


def _check_length(text: str) -> None:
    if len(text) > MOST_CHARACTERS:
        raise ExpressionError(
            f"a text of {len(text)} characters; expected at most {MOST_CHARACTERS}"
        )


def _tokens(text: str) -> list[_Token]:
    tokens: list[_Token] = []
    place = 0
    while place < len(text):
        if text[place] in " \t\r\n":
            place += 1
            continue
        match = _TOKEN.match(text, place)
        if match is None:
            character = text[place]
            hint = _HINTS.get(character, "expected a number, a name, ( ) or one of + - * / **")
            raise ExpressionError(f"unexpected {character!r}; {hint}", column=place + 1)
        tokens.append(_Token(str(match.lastgroup), match[0], place))
        place = match.end()
    return tokens


def _expected(what: str, text: str, place: int) -> ExpressionError:
    rest = text[place:].lstrip()
    found = repr(rest[0]) if rest else "the end"
    return ExpressionError(f"expected {what}, found {found}", column=len(text) - len(rest) + 1)


class _Reader:
    """The values of one expression, from left to right."""

    def __init__(self, text: str, names: Mapping[str, sp.Expr]) -> None:
        self._text, self._names = text, names
        self._tokens = _tokens(text)[::-1]  # the next one is the last
        self._depth = 0  # open brackets

    def whole(self) -> Sized:
        # The weakest operator is read first, so this takes the whole text unless something is
        # misplaced.
        value = self._read(_BINDING["+"])
        if self._tokens:
            raise self._misplaced()
        return value

    @property
    def _next(self) -> str:
        return self._tokens[-1].text if self._tokens else ""

    def _misplaced(self) -> ExpressionError:
        """The error for a bracket or a comma behind a value."""
        hint = "a comma only separates arguments of a function; write decimals with a point"
        message = "unmatched )" if self._next == ")" else hint
        return ExpressionError(message, column=self._tokens[-1].start + 1)

    def _read(self, least: int) -> Sized:
        """A value and the operators behind it that bind at least so tightly."""
        if self._next in ("+", "-"):
            is_minus = self._tokens.pop().text == "-"
            value = self._read(_SIGN)
            value = value._replace(expression=-value.expression) if is_minus else value
        else:
            value = self._value()
        while _BINDING.get(self._next, -1) >= least:
            operator = self._tokens.pop().text
            # The column of a fault is that of the right operand, behind its brackets.
            inside = (token.start + 1 for token in reversed(self._tokens) if token.text != "(")
            column = next(inside, 1)
            # a power has a sign and a power of its own: 2**-3**2 is 2**(-(3**2))
            right = self._read(_SIGN if operator == "**" else _BINDING[operator] + 1)
            value = operate(operator, value, right, column)
        return value

    def _value(self) -> Sized:
        if not self._tokens or (self._tokens[-1].kind == "operator" and self._next != "("):
            place = self._tokens[-1].start if self._tokens else len(self._text)
            raise _expected("a number, a name or (", self._text, place)
        token = self._tokens.pop()
        if token.text == "(":
            (value,) = self._in_brackets(token, ())
        elif token.kind == "number":
            value = _number(token)
        else:
            value = self._named(token)
        if self._next == "(" or (self._tokens and self._tokens[-1].kind != "operator"):
            raise ExpressionError(
                f"expected an operator before {self._next!r}, such as *",
                column=self._tokens[-1].start + 1,
            )
        return value

    def _in_brackets(self, bracket: _Token, separators: tuple[str, ...]) -> list[Sized]:
        """The values up to the bracket that closes one."""
        self._depth += 1
        column = bracket.start + 1
        if self._depth > _DEEPEST:
            raise ExpressionError(f"more than {_DEEPEST} nested brackets", column=column)
        values = [self._read(_BINDING["+"])]
        while self._next in separators:
            self._tokens.pop()
            values.append(self._read(_BINDING["+"]))
        if not self._tokens:
            raise ExpressionError("unclosed (", column=column)
        if self._next != ")":
            raise self._misplaced()
        self._tokens.pop()
        self._depth -= 1
        return values

    def _named(self, token: _Token) -> Sized:
        """A name, or a function of what follows in brackets."""
        name, column = spelled(token.text), token.start + 1
        if self._next != "(":
            if name in self._names:
                return Sized.atom(sp.sympify(self._names[name], strict=True))
            if name == "pi":
                return Sized(sp.pi, 0, 1, 1)
            fault = f"unknown name {token.text!r}; {offer(name, self._names)}"
            if name in FUNCTIONS:
                fault = f"{name} is a function; expected {name}(...)"
            raise ExpressionError(fault, column=column)
        if token.text not in FUNCTIONS:
            hint = f"write {name}*(...)" if name in self._names else offer(token.text, FUNCTIONS)
            raise ExpressionError(f"{token.text!r} is not a function; {hint}", column=column)
        arguments = self._in_brackets(self._tokens.pop(), (",",))
        wanted = 2 if name == "atan2" else 1
        if len(arguments) != wanted:
            raise ExpressionError(
                f"{name} takes {wanted} argument{'s' * (wanted > 1)}, got {len(arguments)}",
                column=column,
            )
        return apply(name, arguments, column)


def _number(token: _Token) -> Sized:
    mantissa, _, power = token.text.lower().partition("e")
    digits = len(mantissa.replace(".", ""))
    # Five characters decide; Python refuses to read a text of thousands of digits as a number.
    size = power.lstrip("+-").lstrip("0")[:5]
    if max(digits, int(size or 0)) > _MOST_DIGITS:
        raise ExpressionError(
            f"a number of more than {_MOST_DIGITS} digits, or a larger power of ten",
            column=token.start + 1,
        )
    return Sized.number(sp.Rational(token.text))
