"""Text to SymPy, by Python's grammar. The text is never run.

Python's own reader would take `lambda` for a keyword, normalise letters (NFKC) and round 0.1. So
tokens are read here, and each is checked against the one before it. Python's grammar then gets the
text with a plain name in place of every operand, only to tell how tightly operators bind.
`rigidsym.text.bounds` does the arithmetic.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Mapping
from itertools import accumulate, takewhile

import sympy as sp

from rigidsym.errors import ExpressionError, offer
from rigidsym.system.files import table_beside
from rigidsym.text.bounds import FUNCTIONS, Sized, apply, operate
from rigidsym.text.names import GREEK_LETTERS, spelled

MOST_CHARACTERS = 2000
_DEEPEST = 50  # nested brackets
_MOST_DIGITS = 40  # of one number, and the largest power of ten it may carry

_LETTER = "A-Za-z_" + GREEK_LETTERS
_TOKEN = re.compile(
    r"(?P<number>(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)"
    rf"|(?P<name>[{_LETTER}][{_LETTER}0-9]*)"
    r"|(?P<operator>\*\*|[-+*/(),])|(?P<space>[ \t\r\n]+)|(?P<other>(?s:.))",
    re.ASCII,
)
_OPERATORS = {ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/", ast.Pow: "**"}
_TURN = re.compile(r"([xyz]|\[[^\[\]]*\])\s*\(")
_BETWEEN_TURNS = re.compile(r"\s*(\*?)\s*")


def parse_expression(text: str, names: Mapping[str, sp.Expr]) -> sp.Expr:
    """The expression in a text, with the declared names, `pi` and numbers.

    Numbers are exact (0.1 is 1/10), Greek letters are short for their names (φ for phi), and
    exponents are rational numbers. Known functions: `rigidsym.text.bounds.FUNCTIONS`.

    Raises ExpressionError, with the column, for any other text and for one that is too large.
    """
    _check_length(text)
    _check_order(text)
    spaced = re.sub(r"\s", " ", text)
    plain = _TOKEN.sub(
        lambda m: "x" * len(m[0]) if m.lastgroup in ("number", "name") else m[0], spaced
    )
    try:
        # One line in brackets, since Python takes a space before an expression for an indent.
        return _Reader(text, names).read(ast.parse(f"({plain})", mode="eval").body).expression
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
    names = (spelled(token[0]) for token in _tokens(text) if token.lastgroup == "name")
    return tuple(dict.fromkeys(name for name in names if name not in (*FUNCTIONS, "pi")))


def _check_length(text: str) -> None:
    if len(text) > MOST_CHARACTERS:
        raise ExpressionError(
            f"a text of {len(text)} characters; expected at most {MOST_CHARACTERS}"
        )


def _tokens(text: str) -> list[re.Match[str]]:
    tokens = [token for token in _TOKEN.finditer(text) if token.lastgroup != "space"]
    for token in tokens:
        if token.lastgroup == "other":
            hints = table_beside(__file__, "hints.toml")
            hint = hints.get(token[0], hints["other"])
            raise ExpressionError(f"unexpected {token[0]!r}; {hint}", column=token.start() + 1)
    return tokens


def _expected(what: str, text: str, place: int) -> ExpressionError:
    rest = text[place:].lstrip()
    character = repr(rest[0]) if rest else "the end"
    return ExpressionError(f"expected {what}, found {character}", column=len(text) - len(rest) + 1)


def _check_order(text: str) -> None:
    """Raises ExpressionError unless operands, operators and brackets follow one another rightly."""
    brackets: list[tuple[int, bool]] = []  # column of each that is open, and if a function has it
    before = ""  # the kind of the last token; a bracket that closes ends a value, as a name does
    for token in _tokens(text):
        symbol, kind, column = token[0], str(token.lastgroup), token.start() + 1
        is_value, is_call = before in ("number", "name", ")"), symbol == "(" and before == "name"
        if is_value and (kind != "operator" or (symbol == "(" and not is_call)):
            message = f"expected an operator before {symbol!r}, such as *"
            raise ExpressionError(message, column=column)
        if not is_value and kind == "operator" and symbol not in ("+", "-", "("):
            raise _expected("a number, a name or (", text, token.start())
        if symbol == "," and not (brackets and brackets[-1][1]):
            raise ExpressionError(
                "a comma only separates arguments of a function; write decimals with a point",
                column=column,
            )
        if symbol == "(":
            brackets.append((column, is_call))
            if len(brackets) > _DEEPEST:
                raise ExpressionError(f"more than {_DEEPEST} nested brackets", column=column)
        if symbol == ")":
            if not brackets:
                raise ExpressionError("unmatched )", column=column)
            brackets.pop()
        before = symbol if kind == "operator" else kind
    if before not in ("number", "name", ")"):
        raise _expected("a number, a name or (", text, len(text))
    if brackets:
        raise ExpressionError("unclosed (", column=brackets[-1][0])


class _Reader:
    """The values of the nodes of one expression."""

    def __init__(self, text: str, names: Mapping[str, sp.Expr]) -> None:
        self._text, self._names = text, names

    def read(self, node: ast.expr) -> Sized:
        """The value of a node; its column in the text is one less in brackets, from 0."""
        operations = []
        while isinstance(node, ast.BinOp):  # a sum of hundreds of terms is deep to the left only
            operations.append(node)
            node = node.left
        value = self._operand(node)
        for operation in reversed(operations):
            right = operation.right
            operator = _OPERATORS.get(type(operation.op), "//")
            value = operate(operator, value, self.read(right), right.col_offset)
        return value

    def _operand(self, node: ast.expr) -> Sized:
        if isinstance(node, ast.UnaryOp):
            value = self.read(node.operand)
            is_minus = isinstance(node.op, ast.USub)
            return value._replace(expression=-value.expression) if is_minus else value
        if isinstance(node, ast.Call):
            return self._call(self._word(node.func), node)
        word, column = self._word(node), node.col_offset
        name = spelled(word)
        if word[0] in ".0123456789":
            return _number(word, column)
        if name in self._names:
            return Sized.atom(sp.sympify(self._names[name], strict=True))
        if name == "pi":
            return Sized(sp.pi, 0, 1, 1)
        fault = f"unknown name {word!r}; {offer(name, self._names)}"
        if name in FUNCTIONS:
            fault = f"{name} is a function; expected {name}(...)"
        raise ExpressionError(fault, column=column)

    def _word(self, node: ast.expr) -> str:
        return self._text[node.col_offset - 1 : (node.end_col_offset or 0) - 1]

    def _call(self, word: str, node: ast.Call) -> Sized:
        name, column = spelled(word), node.col_offset
        if word not in FUNCTIONS:
            hint = f"write {name}*(...)" if name in self._names else offer(word, FUNCTIONS)
            raise ExpressionError(f"{word!r} is not a function; {hint}", column=column)
        arguments = list(map(self.read, node.args))
        wanted = 2 if name == "atan2" else 1
        if len(arguments) != wanted:
            raise ExpressionError(
                f"{name} takes {wanted} argument{'s' * (wanted > 1)}, got {len(arguments)}",
                column=column,
            )
        return apply(name, arguments, column)


def _number(text: str, column: int) -> Sized:
    mantissa, _, power = text.lower().partition("e")
    digits = len(mantissa.replace(".", ""))
    # Five characters decide; Python refuses to read a text of thousands of digits as a number.
    size = power.lstrip("+-").lstrip("0")[:5]
    if max(digits, int(size or 0)) > _MOST_DIGITS:
        raise ExpressionError(
            f"a number of more than {_MOST_DIGITS} digits, or a larger power of ten", column=column
        )
    return Sized.number(sp.Rational(text))
