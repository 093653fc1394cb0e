r"""Formulas, and sentences with formulas in them, as they are typed in the source.

    formula(r"\mathbf{I}' = #1\,\mathbf{R}", OMEGA)
    sentence(r"The axis $\mathbf{e}$ of {}", ROTATION)

A formula is a small part of TeX, read once into a tree. It has short commands of its own: a
single letter or digit is bold, `\R` for `\mathbf{R}`, and so is `\Om` for Ω.

`#1`, `#2`, ... stand for formulas that are given. Known are letters, numbers, `\mathbf` and
`\boldsymbol`, `\dot`, primes, indices, powers, `\frac`, `\sqrt`, brackets, functions, sums,
integrals, signs and `pmatrix`. A bracket directly behind a letter holds its argument, C(u);
behind a blank or `\,` it is a factor.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import replace
from functools import lru_cache
from string import ascii_letters, digits
from typing import Any, Literal, TypeVar

from sympy.printing.conventions import split_super_sub

from rigidsym.errors import AlgebraError
from rigidsym.formula import tree
from rigidsym.formula.tree import Formula
from rigidsym.text.names import ALPHABET

GREEK = {name: letter for letter, name in ALPHABET.items()}
GREEK |= {name.title(): letter.upper() for name, letter in GREEK.items()}
GREEK |= {"lamda": "λ", "Lamda": "Λ"}  # in SymPy, since `lambda` is a keyword of Python
VARIANTS = {"varphi": "ϕ", "vartheta": "ϑ", "varepsilon": "ϵ", "varrho": "ϱ", "varsigma": "ς"}
FUNCTIONS = ("sin", "cos", "tan", "cot", "det", "exp", "arctan")
SIGNS = {r"\times": "×", r"\cdot": "·", r"\pm": "±", r"\le": "≤", r"\in": "∈"}
SIGNS |= {r"\Leftrightarrow": "⇔"}
LETTERS = {r"\ldots": "…", r"\perp": "⊥", r"\parallel": "∥", r"\ast": "∗"}
_TOKEN = re.compile(
    r"\\(?:text|operatorname)\{[^{}]*\}|\\math[a-z]+\{\w+\}|\\(?:begin|end)\{pmatrix\}"
    r"|\\[A-Za-z]+|\\.|#\d+|\d+|\s+|."
)
_BLANKS = (r"\,", "\\ ", r"\left", r"\right", r"\bigl", r"\bigr", r"\textstyle")
_NORMAL = {**dict.fromkeys(_BLANKS, " "), r"\tfrac": r"\frac"}
_ATOMS: dict[str, Formula] = {
    **{letter: tree.Symbol(letter) for letter in (*ascii_letters, "…")},
    **{f"\\{name}": tree.Symbol(letter) for name, letter in GREEK.items()},
    **{f"\\{character}": tree.Symbol(character, "bold") for character in ascii_letters + digits},
    **{sign: tree.Sign(sign) for sign in "+=/,;<"},
    **{macro: tree.Sign(sign) for macro, sign in SIGNS.items()},
    **{macro: tree.Symbol(letter) for macro, letter in LETTERS.items()},
    "-": tree.MINUS,
    r"\varphi": tree.Symbol("φ"),
    r"\Om": tree.Symbol("Ω", "bold"),
    r"\sum": tree.Big("∑"),
    r"\int": tree.Big("∫"),
    r"\partial": tree.Differential("∂"),
    r"\quad": tree.GAP,
    r"\qquad": tree.GAP,
}
_FACES: dict[str, tree.Face] = {
    r"\mathbf": "bold",
    r"\boldsymbol": "bold",
    r"\mathit": "italic",
    r"\mathrm": "upright",
    r"\mathsf": "sans",
}
_DOTS = {r"\dot": 1, r"\ddot": 2}
_OPEN: dict[str, Literal["()", "[]", "||"]] = {"(": "()", "[": "[]", "|": "||"}
_BY_TIME = tree.row(tree.Differential(), tree.Symbol("t"))
_LONGEST = 6  # digits of a whole number that has no power of ten


@lru_cache(maxsize=4096)
def formula(text: str, *parts: Formula) -> Formula:
    """The tree of a typed formula, with `parts` in place of #1, #2, ...

    Raises AlgebraError, showing the rest, where it cannot be read.
    """
    reader = _TexReader(text, parts)
    whole = reader.row()
    if reader.tokens:
        raise reader.error()
    return whole


def decimal(value: float, most: int = 6) -> Formula:
    """A number with so many digits, times a power of ten if it is very large or small."""
    mantissa, _, power = f"{abs(value):.{most}g}".partition("e")
    if 0 < int(power or 0) < _LONGEST:
        mantissa, power = f"{abs(float(f'{value:.{most}g}')):.0f}", ""
    number: Formula = tree.Numeral(mantissa)
    if power:
        ten = rf"10^{{{int(power)}}}"
        number = formula(ten) if mantissa == "1" else formula(rf"#1\cdot {ten}", number)
    return tree.row(tree.MINUS, number) if value < 0 else number


class _TexReader:
    """Reads tokens from left to right; a blank parts a bracket from a letter."""

    def __init__(self, text: str, parts: tuple[Formula, ...]) -> None:
        self.text = text
        self.parts = parts
        # Reversed, so that the list is a stack from which pop() takes the next token.
        tokens = _TOKEN.findall(text)[::-1]
        self.tokens = [_NORMAL.get(t, " " if t.isspace() else t) for t in tokens]

    @property
    def next(self) -> str:
        """The token that is read next; empty at the end."""
        return self.tokens[-1] if self.tokens else ""

    def error(self, missing: str = "an argument") -> AlgebraError:
        rest = "".join(reversed(self.tokens))
        where = f" from '{rest}' on" if rest else f": {missing} is missing at its end"
        return AlgebraError(f"cannot read the formula '{self.text}'{where}")

    def row(self, *ends: str) -> Formula:
        """Parts up to one of `ends`, which is not read; or up to the end of all."""
        parts: list[Formula] = []
        while self.next not in (*ends, ""):
            if self.next == " ":
                self.tokens.pop()
                continue
            part = self.scripted(self.part())
            head = part.base if isinstance(part, tree.Power) else part
            if isinstance(head, tree.Symbol) and self.next == "(":
                self.tokens.pop()
                part = self.scripted(tree.Apply(part, self.within(")")))
            parts.append(part)
        return tree.row(*parts)

    def within(self, end: str) -> Formula:
        """What stands before a closing bracket, which is read too."""
        inside = self.row(end)
        if not self.tokens:
            raise self.error(end)
        self.tokens.pop()
        return inside

    def scripted(self, base: Formula) -> Formula:
        """A part with its primes, index and exponent."""
        while self.next in ("'", "_", "^"):
            base = self.script(base, self.tokens.pop())
        return base

    def script(self, base: Formula, mark: str) -> Formula:
        match base:
            case tree.Power() if mark != "^":  # d^⊥_i
                return tree.Power(self.script(base.base, mark), base.exponent)
            case tree.Symbol() if mark == "'":
                return tree.Symbol(base.letter, base.face, base.dots, "′", base.index)
        script = self.argument()
        match base:
            case tree.Big():
                return replace(base, above=script) if mark == "^" else replace(base, below=script)
            case _ if mark == "^":
                return tree.Power(base, tree.TRANSPOSE if script == tree.Symbol("T") else script)
            case tree.Symbol():
                return tree.Symbol(base.letter, base.face, base.dots, base.prime, script)
        return tree.Indexed(base, script)

    def argument(self) -> Formula:
        """What stands in braces, or one token."""
        while self.next == " ":
            self.tokens.pop()
        return self.part()

    def part(self) -> Formula:
        token = self.tokens.pop() if self.tokens else ""
        # In dR/dt and d\mathbf{R} the d is a differential; a d before a space is a letter.
        if token == "d" and (self.next[:1].isalpha() or self.next[:1] in ("\\", "#")):
            return tree.Differential()
        if token in _ATOMS:
            return _ATOMS[token]
        if token in _OPEN:
            kind = _OPEN[token]
            return tree.Bracket(self.within(kind[1]), kind)
        if token == "{":
            return self.within("}")
        if token.isdigit():
            return tree.Numeral(token)
        if token.startswith("#"):
            return self.parts[int(token[1:]) - 1]
        if token in _FACES and isinstance(inside := self.argument(), tree.Symbol):
            return replace(inside, face=_FACES[token])
        if token in _DOTS and isinstance(inside := self.argument(), tree.Symbol):
            return replace(inside, dots=inside.dots + _DOTS[token])
        if token == r"\frac":
            above, below = self.argument(), self.argument()
            # The derivative with respect to time is a node of its own, since notations write it as
            # a dot, too.
            match above:
                case tree.Row((tree.Differential("d"), *differentiated)) if below == _BY_TIME:
                    return tree.Rate(tree.row(*differentiated))
            return tree.Fraction(above, below)
        if token == r"\sqrt":
            return tree.Radical(self.argument())
        if token == r"\begin{pmatrix}":
            return self.matrix()
        name, _, words = token.removesuffix("}").partition("{")
        if words and name in _FACES:  # in which no d is a differential
            return tree.Symbol(words, _FACES[name])
        if name == r"\text":
            return tree.Words(words)
        if name == r"\operatorname" or name[1:] in FUNCTIONS:
            return self.call(words or name[1:])
        self.tokens.append(token)
        raise self.error()

    def call(self, function: str) -> Formula:
        """The function of the next part; a power is that of the value."""
        exponent = 1
        if self.next == "^":
            self.tokens.pop()
            power = self.argument()
            assert isinstance(power, tree.Numeral)
            exponent = int(power.digits)
        return tree.FunctionCall(function, self.scripted(self.argument()), exponent)

    def matrix(self) -> Formula:
        rows: list[list[Formula]] = [[]]
        mark, end = "", r"\end{pmatrix}"
        while mark != end:
            rows[-1].append(self.row("&", end, r"\\"))
            if not self.tokens:
                raise self.error(end)
            mark = self.tokens.pop()
            rows += [[]] if mark == r"\\" else []
        return tree.Matrix(tuple(map(tuple, rows)))


@lru_cache(maxsize=1024)
def named(label: str, order: int = 0) -> Formula:
    """A name, or its derivative with respect to time: φ̇₁, and d yaw₁/dt.

    A dot above a word would stand above one of its letters, as if they were factors, and so the
    derivative of a word is a quotient in every notation.
    """
    head, above, below = split_super_sub(label)
    index = tree.row(*map(_name_part, below)) if below else None
    prime: tree.Prime = "′" if head.endswith("'") else ""  # I'_12: of the body
    symbol = _letter(head.removesuffix("'"))
    is_word = len(symbol.letter) > 1
    symbol = replace(symbol, prime=prime, index=index, dots=0 if is_word else order)
    raised = tree.Power(symbol, tree.Row(tuple(map(_name_part, above)))) if above else symbol
    return tree.Rate(raised, order) if is_word and order else raised


def _name_part(text: str) -> Formula:
    return tree.Numeral(text) if text.isdigit() else _letter(text)


def _letter(name: str) -> tree.Symbol:
    return tree.Symbol(GREEK.get(name) or VARIANTS.get(name, name))


_Span = TypeVar("_Span")
Sentence = tuple[str | Formula, ...]
_SPAN = re.compile(r"\$[^$]*\$|\{\}|.+?(?=\$|\{\}|\Z)", re.DOTALL)


def sentence(typed: str, *spans: _Span) -> tuple[str | Formula | _Span, ...]:
    r"""The text r"The axis $\mathbf{e}$ of {}" with its formulas read, and a span for each {}.

    Raises AlgebraError for a formula that cannot be read or has no end, and for too many {}.
    """
    values = iter(spans)
    parts = _SPAN.findall(typed)
    if typed.count("$") % 2 or parts.count("{}") > len(spans):
        raise AlgebraError(f"'{typed}': expected pairs of $, and at most {len(spans)} '{{}}'")
    return tuple(
        next(values) if part == "{}" else formula(part[1:-1]) if part[0] == "$" else part
        for part in parts
    )


def text_of(words: Iterable[Any]) -> str:
    """The sentence on one line of Unicode; each span is words, or has a `text`."""
    return "".join(span if isinstance(span, str) else span.text for span in words)
