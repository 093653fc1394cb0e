r"""Formulas as they are typed in the source: a small part of TeX, read once into a tree.

    formula(r"\mathbf{I}' = #1\,\mathbf{R}", OMEGA)

`#1`, `#2`, ... stand for formulas that are given. Known are letters, numbers, `\mathbf` and
`\boldsymbol`, `\dot`, primes, indices, powers, `\frac`, `\sqrt`, brackets, functions, sums,
integrals, signs and `pmatrix`. A bracket directly behind a letter holds its argument, C(u);
behind `\,` it is a factor.
"""

from __future__ import annotations

import re
import unicodedata
from dataclasses import replace
from functools import lru_cache
from typing import Literal

import sympy as sp
from sympy.printing.conventions import split_super_sub
from sympy.printing.pretty.pretty_symbology import pretty_symbol

from rigidsym.errors import AlgebraError
from rigidsym.formula.tree import (
    MINUS,
    TRANSPOSE,
    Apply,
    Big,
    Bracket,
    Differential,
    Face,
    Formula,
    Fraction,
    FunctionCall,
    Gap,
    Indexed,
    Matrix,
    Numeral,
    Power,
    Prime,
    Radical,
    Rate,
    Row,
    Sign,
    Symbol,
    Words,
    row,
)

FUNCTIONS = ("sin", "cos", "tan", "cot", "det", "exp", "arctan")
_TOKEN = re.compile(
    r"\\text\{(?P<text>[^{}]*)\}|\\mathit\{(?P<word>[^{}]*)\}|\\operatorname\{(?P<name>\w+)\}"
    r"|\\begin\{(?P<begin>\w+)\}|\\end\{(?P<end>\w+)\}"
    r"|#\d|\\\\(?:\[\w+\])?|\\[A-Za-z]+|\\.|\d+|\s+|."
)
_ATOMS: dict[str, Formula] = {
    **{sign: Sign(sign) for sign in "+=/,;<"},
    "…": Symbol("…"),
    "-": MINUS,
    r"\times": Sign("×"),
    r"\cdot": Sign("·"),
    r"\pm": Sign("±"),
    r"\le": Sign("≤"),
    r"\in": Sign("∈"),
    r"\Leftrightarrow": Sign("⇔"),
    r"\ldots": Symbol("…"),
    r"\perp": Symbol("⊥"),
    r"\parallel": Symbol("∥"),
    r"\ast": Symbol("∗"),
    r"\varphi": Symbol("φ"),
    r"\sum": Big("∑"),
    r"\int": Big("∫"),
    r"\partial": Differential("∂"),
    r"\quad": Gap(),
    r"\qquad": Gap(),
}
_FACES: dict[str, Face] = {
    r"\mathbf": "bold",
    r"\boldsymbol": "bold",
    r"\mathrm": "upright",
    r"\mathsf": "sans",
}
_DOTS = {r"\dot": 1, r"\ddot": 2}
_OPEN: dict[str, Literal["()", "[]", "||"]] = {"(": "()", "[": "[]", "|": "||"}
_IGNORED = (r"\,", "\\ ", r"\right", r"\textstyle")
_NORMAL = {r"\left": r"\,", r"\bigl": r"\,", r"\bigr": r"\right"}  # such a bracket is a factor


@lru_cache(maxsize=4096)
def formula(text: str, *parts: Formula) -> Formula:
    """The tree of a typed formula, with `parts` in place of #1, #2, ...

    Raises AlgebraError, showing the rest, where it cannot be read.
    """
    reader = _TexReader(text, parts)
    found = reader.row(())
    if reader.tokens:
        raise reader.error()
    return found


@lru_cache(maxsize=256)
def greek_letter(name: str) -> str:
    """The letter with a name such as Omega; empty where there is none."""
    kind = "CAPITAL" if name[0].isupper() else "SMALL"
    letter = name.upper().replace("LAMBDA", "LAMDA")
    try:
        return unicodedata.lookup(f"GREEK {kind} LETTER {letter}")
    except KeyError:
        return ""


class _TexReader:
    """Reads tokens from left to right; a blank parts a bracket from a letter."""

    def __init__(self, text: str, parts: tuple[Formula, ...]) -> None:
        self.text = text
        self.parts = parts
        found = (match[0] for match in _TOKEN.finditer(text))
        self.tokens = [_NORMAL.get(t, t[:2] if t[:2] == r"\\" else t) for t in found][::-1]

    def error(self) -> AlgebraError:
        left = "".join(reversed(self.tokens)) or "the end"
        return AlgebraError(f"no formula: {self.text!r}, at {left!r}")

    def row(self, ends: tuple[str, ...]) -> Formula:
        """Parts up to one of `ends`, which is left; or up to the end of all."""
        parts: list[Formula] = []
        while self.tokens and self.tokens[-1] not in ends:
            token = self.tokens[-1]
            if token.isspace() or token in _IGNORED:
                self.tokens.pop()
            else:
                parts.append(self._scripted())
        return row(*parts)

    def _scripted(self) -> Formula:
        """A part with its primes, index and exponent, and the argument of a symbol."""
        base = self._part()
        while self._next() in ("'", "_", "^"):
            base = self._script(base, self.tokens.pop())
        is_applied = isinstance(base, Symbol) or (
            isinstance(base, Power) and isinstance(base.base, Symbol)
        )
        if is_applied and self._next() == "(":
            inside = self._part()
            assert isinstance(inside, Bracket)
            base = Apply(base, inside.inside)
            while self._next() in ("'", "_", "^"):
                base = self._script(base, self.tokens.pop())
        return base

    def _script(self, base: Formula, mark: str) -> Formula:
        if mark == "^":
            exponent = self._argument()
            if exponent == Symbol("T"):
                exponent = TRANSPOSE
            return replace(base, above=exponent) if isinstance(base, Big) else Power(base, exponent)
        if isinstance(base, Power):  # d^⊥_i
            return Power(self._script(base.base, mark), base.exponent)
        if isinstance(base, Big):
            return replace(base, below=self._argument())
        if not isinstance(base, Symbol):
            return Indexed(base, self._argument())
        return replace(base, prime="′") if mark == "'" else replace(base, index=self._argument())

    def _argument(self) -> Formula:
        """What stands in braces, or one token."""
        while self._next().isspace():
            self.tokens.pop()
        if self._next() != "{":
            return self._part()
        self.tokens.pop()
        inside = self.row(("}",))
        self._expect("}")
        return inside

    def _part(self) -> Formula:
        token = self.tokens.pop() if self.tokens else ""
        if token in _ATOMS:
            return _ATOMS[token]
        if token in _OPEN:
            kind = _OPEN[token]
            inside = self.row((kind[1],))
            self._expect(kind[1])
            return Bracket(inside, kind)
        if token == "{":
            self.tokens.append(token)
            return self._argument()
        if token.isdigit():
            return Numeral(token)
        if token.startswith("#"):
            return self.parts[int(token[1:]) - 1]
        if token == "d" and (self._next()[:1].isalpha() or self._next()[:1] in ("\\", "#")):
            return Differential() if self._next() != r"\," else Symbol("d")
        found = self._macro(token) if token.startswith("\\") else None
        if len(token) == 1 and token.isalpha():
            found = Symbol(token)
        if found is None:
            self.tokens.append(token)
            raise self.error()
        return found

    def _macro(self, token: str) -> Formula | None:
        match = _TOKEN.fullmatch(token)
        assert match
        if match["text"] is not None:
            return Words(match["text"])
        if match["word"]:
            return Symbol(match["word"])
        if match["name"] or token[1:] in FUNCTIONS:
            return self._call(match["name"] or token[1:])
        if match["begin"] == "pmatrix":
            return self._matrix()
        if token in _FACES:
            return _faced(self._argument(), _FACES[token])
        if token in _DOTS:
            inside = self._argument()
            if not isinstance(inside, Symbol):
                raise self.error()
            return replace(inside, dots=inside.dots + _DOTS[token])
        if token in (r"\frac", r"\tfrac"):
            return _quotient(self._argument(), self._argument())
        if token == r"\sqrt":
            return Radical(self._argument())
        letter = greek_letter(token[1:])
        return Symbol(letter) if letter else None

    def _call(self, function: str) -> Formula:
        """The function of the next part; a power is that of the value."""
        exponent = 1
        if self._next() == "^":
            self.tokens.pop()
            power = self._argument()
            assert isinstance(power, Numeral)
            exponent = int(power.digits)
        while self._next().isspace() or self._next() == r"\,":
            self.tokens.pop()
        argument = self._part()
        while self._next() in ("'", "_", "^"):
            argument = self._script(argument, self.tokens.pop())
        return FunctionCall(function, argument, exponent)

    def _matrix(self) -> Formula:
        rows: list[list[Formula]] = [[]]
        ends = ("&", r"\end{pmatrix}", r"\\")
        while True:
            rows[-1].append(self.row(ends))
            if not self.tokens:
                raise self.error()
            end = self.tokens.pop()
            if end == r"\end{pmatrix}":
                return Matrix(tuple(map(tuple, rows)))
            if end == r"\\":
                rows.append([])

    def _next(self) -> str:
        return self.tokens[-1] if self.tokens else ""

    def _expect(self, token: str) -> None:
        while self._next() in _IGNORED:
            self.tokens.pop()
        if self._next() != token:
            raise self.error()
        self.tokens.pop()


def _faced(inside: Formula, face: Face) -> Formula:
    """A letter, a word, or a bold 1 or 0, in another face."""
    if isinstance(inside, Numeral):
        return Symbol(inside.digits, face)
    if isinstance(inside, Row):
        letters = (part.letter for part in inside.parts if isinstance(part, Symbol))
        return Symbol("".join(letters), face)
    return replace(inside, face=face) if isinstance(inside, Symbol) else inside


def _quotient(above: Formula, below: Formula) -> Formula:
    """A fraction, or the derivative with respect to time."""
    by_time = row(Differential(), Symbol("t"))
    if below != by_time:
        return Fraction(above, below)
    if isinstance(above, Row) and above.parts[0] == Differential():
        return Rate(row(*above.parts[1:]))
    return Fraction(above, below)


_VARIANTS = {"varphi": "φ", "vartheta": "ϑ", "varepsilon": "ε", "varrho": "ϱ", "varsigma": "ς"}


@lru_cache(maxsize=1024)
def named(label: str, order: int = 0) -> Formula:
    """A name, or its derivative with respect to time: φ̇₁, and d yaw₁/dt.

    A dot above a word would stand above one of its letters, as if they were factors, and so the
    derivative of a word is a quotient in every notation.
    """
    head, above, below = split_super_sub(label)
    index = tuple(map(_part, below))
    prime: Prime = "′" if head.endswith("'") else ""  # I'_12: of the body
    head = head.removesuffix("'")
    symbol = Symbol(
        _letter(head),
        prime=prime,
        index=(index[0] if len(index) == 1 else Row(index)) if index else None,
        macro=_macro(head),
    )
    is_word = len(symbol.letter) > 1 and not symbol.macro
    if not is_word:
        symbol = replace(symbol, dots=order)
    raised = Power(symbol, Row(tuple(map(_part, above)))) if above else symbol
    return Rate(raised, order) if is_word and order else raised


def _part(text: str) -> Formula:
    return Numeral(text) if text.isdigit() else Symbol(_letter(text), macro=_macro(text))


def _letter(name: str) -> str:
    return _VARIANTS.get(name) or greek_letter(name) or pretty_symbol(name)


def _macro(name: str) -> str:
    """LaTeX of a name that is neither a letter of an alphabet nor a word; empty for others."""
    latex = str(sp.latex(sp.Symbol(name)))
    is_greek = (
        len(name) > 1 and greek_letter(name) and latex == f"\\{name}".replace("lamda", "lambda")
    )
    return "" if latex == name or is_greek else latex
