"""Text to SymPy, by a whitelist walk over Python's ast. The text is never run.

The text is read in three passes. `_tokens` cuts it into numbers, names and operators, and refuses
every other character. `_check_order` checks that values and operators alternate and that brackets
close. The rest goes to Python's ast with each name and number masked, since Python would take
`lambda` for a keyword, normalise letters (NFKC) and round 0.1; the walk finds the original text of
a name or number by its column. `rigidsym.text.bounds` does the arithmetic.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Mapping
from fractions import Fraction
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
    tokens = _tokens(text)
    _check_order(tokens, text)
    walk = _Walk({token.start + 1: token for token in tokens}, names)
    try:
        return walk.value(ast.parse(_masked(tokens), mode="eval").body).expression
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
    while place < len(text) or not turns:
        turn = _TURN.match(text, place)
        if turn is None:
            raise _expected("a turn: x(...), y(...), z(...) or [1,1,0](...)", text, place)
        end = _closing(text, turn.end())
        inside = text[turn.end() : end]
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
            raise _unknown_character(text, place)
        tokens.append(_Token(str(match.lastgroup), match[0], place))
        place = match.end()
    return tokens


def _unknown_character(text: str, place: int) -> ExpressionError:
    character = text[place]
    hint = _HINTS.get(character, "expected a number, a name, ( ) or one of + - * / **")
    return ExpressionError(f"unexpected {character!r}; {hint}", column=place + 1)


def _check_order(tokens: list[_Token], text: str) -> None:
    """Values and operators alternate, brackets close, commas separate arguments."""
    open_: list[tuple[_Token, bool]] = []  # a bracket, and whether it opens a function's arguments
    before: _Token | None = None
    for token in tokens:
        if _ends_value(before):
            _check_after_value(before, token, in_call=bool(open_) and open_[-1][1])
        elif token.text not in ("+", "-", "(") and token.kind == "operator":
            raise _expected("a number, a name or (", text, token.start)
        if token.text == "(":
            open_.append((token, before is not None and before.kind == "name"))
            if len(open_) > _DEEPEST:
                raise ExpressionError(
                    f"more than {_DEEPEST} nested brackets", column=token.start + 1
                )
        elif token.text == ")":
            if not open_:
                raise ExpressionError("unmatched )", column=token.start + 1)
            open_.pop()
        before = token
    if not _ends_value(before):
        raise _expected("a number, a name or (", text, len(text))
    if open_:
        raise ExpressionError("unclosed (", column=open_[-1][0].start + 1)


def _ends_value(token: _Token | None) -> bool:
    return token is not None and (token.kind != "operator" or token.text == ")")


def _check_after_value(before: _Token | None, token: _Token, *, in_call: bool) -> None:
    is_call = token.text == "(" and before is not None and before.kind == "name"
    if token.kind != "operator" or (token.text == "(" and not is_call):
        raise ExpressionError(
            f"expected an operator before {token.text!r}, such as *", column=token.start + 1
        )
    if token.text == "," and not in_call:
        raise ExpressionError(
            "a comma only separates arguments of a function; write decimals with a point",
            column=token.start + 1,
        )


def _masked(tokens: list[_Token]) -> str:
    """The text for Python's ast, in brackets: names as underscores, numbers as ones.

    A token that starts at character k is at column k + 1, counted from 0.
    """
    masks = {"name": "_", "number": "1"}
    result = "("
    for token in tokens:
        mask = masks.get(token.kind)
        result = result.ljust(token.start + 1) + (mask * len(token.text) if mask else token.text)
    return result + ")"


def _expected(what: str, text: str, place: int) -> ExpressionError:
    rest = text[place:].lstrip()
    found = repr(rest[0]) if rest else "the end"
    return ExpressionError(f"expected {what}, found {found}", column=len(text) - len(rest) + 1)


def _closing(text: str, place: int) -> int:
    """The position of the bracket that closes the one just before `place`."""
    depth = 1
    for at in range(place, len(text)):
        depth += {"(": 1, ")": -1}.get(text[at], 0)
        if depth == 0:
            return at
    raise ExpressionError("unclosed (", column=place)


class _Walk:
    """Values of the nodes of one expression."""

    def __init__(self, tokens: Mapping[int, _Token], names: Mapping[str, sp.Expr]) -> None:
        self._tokens = tokens  # by their column in the masked text, which counts from 1 here
        self._names = names

    def value(self, node: ast.expr) -> Sized:
        if isinstance(node, ast.BinOp):
            return self._chain(node)
        if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.UAdd | ast.USub):
            operand = self.value(node.operand)
            is_minus = isinstance(node.op, ast.USub)
            return operand._replace(expression=-operand.expression) if is_minus else operand
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and not node.keywords:
            return self._call(node)
        if isinstance(node, ast.Constant):
            return _number(self._tokens[node.col_offset])
        if isinstance(node, ast.Name):
            return self._name(self._tokens[node.col_offset])
        raise ExpressionError(f"{type(node).__name__} is not allowed", column=node.col_offset)

    def _chain(self, node: ast.expr) -> Sized:
        """Operations in a row, a + b - c + ...: a loop, so that a long sum is not deep."""
        operations: list[ast.BinOp] = []
        while isinstance(node, ast.BinOp):
            operations.append(node)
            node = node.left
        value = self.value(node)
        for operation in reversed(operations):
            column = operation.right.col_offset
            value = operate(operation.op, value, self.value(operation.right), column)
        return value

    def _name(self, token: _Token) -> Sized:
        name = spelled(token.text)
        if name in self._names:
            return Sized.atom(sp.sympify(self._names[name], strict=True))
        if name == "pi":
            return Sized(sp.pi, 0, 1, 1)
        if name in FUNCTIONS:
            raise ExpressionError(
                f"{name} is a function; expected {name}(...)", column=token.start + 1
            )
        raise ExpressionError(
            f"unknown name {token.text!r}; {offer(name, self._names)}", column=token.start + 1
        )

    def _call(self, node: ast.Call) -> Sized:
        token = self._tokens[node.col_offset]
        if token.text not in FUNCTIONS:
            is_name = spelled(token.text) in self._names
            hint = f"write {token.text}*(...)" if is_name else offer(token.text, FUNCTIONS)
            raise ExpressionError(
                f"{token.text!r} is not a function; {hint}", column=token.start + 1
            )
        wanted = 2 if token.text == "atan2" else 1
        if len(node.args) != wanted:
            raise ExpressionError(
                f"{token.text} takes {wanted} argument{'s' * (wanted > 1)}, got {len(node.args)}",
                column=token.start + 1,
            )
        arguments = [self.value(argument) for argument in node.args]
        return apply(token.text, arguments, token.start + 1)


def _number(token: _Token) -> Sized:
    mantissa, _, power = token.text.lower().partition("e")
    digits = len(mantissa.replace(".", ""))
    if digits > _MOST_DIGITS or abs(int(power[:5] or 0)) > _MOST_DIGITS:
        raise ExpressionError(
            f"a number of more than {_MOST_DIGITS} digits, or a larger power of ten",
            column=token.start + 1,
        )
    value = Fraction(token.text)
    return Sized.number(sp.Rational(value.numerator, value.denominator))
