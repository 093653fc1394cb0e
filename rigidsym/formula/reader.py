r"""Formulas, and sentences with formulas in them, as they are typed in the source.

    formula(r"\mathbf{I}' = #1\,\mathbf{R}", OMEGA)
    sentence(r"The axis $\mathbf{e}$ of {}", ROTATION)

A formula is a small part of TeX, read once into a tree. It has short commands of its own: a
single letter or digit is bold, `\R` for `\mathbf{R}`, and so is `\Om` for Ω.

`#1`, `#2`, ... stand for formulas that are given. Known are letters, numbers, `\mathbf` and
`\boldsymbol`, `\dot`, primes, indices, powers, `\frac`, `\sqrt`, brackets, functions, sums,
integrals, signs and `pmatrix`. A bracket directly behind a letter holds its argument, C(u);
behind `\,` it is a factor.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable
from dataclasses import replace
from functools import lru_cache
from typing import Any, Literal, TypeVar

import sympy as sp
from sympy.printing.conventions import split_super_sub
from sympy.printing.pretty.pretty_symbology import pretty_symbol, pretty_use_unicode

from rigidsym.errors import AlgebraError
from rigidsym.formula import tree
from rigidsym.formula.tree import Formula

FUNCTIONS = ("sin", "cos", "tan", "cot", "det", "exp", "arctan")
_TOKEN = re.compile(
    r"\\text\{(?P<text>[^{}]*)\}|\\mathit\{(?P<word>[^{}]*)\}|\\operatorname\{(?P<name>\w+)\}"
    r"|\\begin\{(?P<begin>\w+)\}|\\end\{(?P<end>\w+)\}"
    r"|#\d+|\\\\(?:\[\w+\])?|\\[A-Za-z]+|\\.|\d+|\s+|."
)
SIGNS = {r"\times": "×", r"\cdot": "·", r"\pm": "±", r"\le": "≤", r"\in": "∈"}
SIGNS |= {r"\Leftrightarrow": "⇔"}
LETTERS = {r"\ldots": "…", r"\perp": "⊥", r"\parallel": "∥", r"\ast": "∗"}
_ATOMS: dict[str, tree.Formula] = {
    **{sign: tree.Sign(sign) for sign in "+=/,;<"},
    **{macro: tree.Sign(sign) for macro, sign in SIGNS.items()},
    **{macro: tree.Symbol(letter) for macro, letter in LETTERS.items()},
    "…": tree.Symbol("…"),
    "-": tree.MINUS,
    r"\varphi": tree.Symbol("φ"),
    r"\Om": tree.Symbol("Ω", "bold"),
    r"\sum": tree.Big("∑"),
    r"\int": tree.Big("∫"),
    r"\partial": tree.Differential("∂"),
    r"\quad": tree.Gap(),
    r"\qquad": tree.Gap(),
}
_FACES: dict[str, tree.Face] = {
    r"\mathbf": "bold",
    r"\boldsymbol": "bold",
    r"\mathrm": "upright",
    r"\mathsf": "sans",
}
_DOTS = {r"\dot": 1, r"\ddot": 2}
_OPEN: dict[str, Literal["()", "[]", "||"]] = {"(": "()", "[": "[]", "|": "||"}
_LONGEST = 6  # digits of a whole number that has no power of ten
_IGNORED = (r"\,", "\\ ", r"\right", r"\textstyle")
_NORMAL = {r"\left": r"\,", r"\bigl": r"\,", r"\bigr": r"\right"}  # such a bracket is a factor


@lru_cache(maxsize=4096)
def formula(text: str, *parts: tree.Formula) -> tree.Formula:
    """The tree of a typed formula, with `parts` in place of #1, #2, ...

    Raises AlgebraError, showing the rest, where it cannot be read.
    """
    reader = _TexReader(text, parts)
    found = reader.row(())
    if reader.tokens:
        raise reader.error()
    return found


def decimal(value: float, most: int = 6) -> tree.Formula:
    """A number with so many digits, times a power of ten if it is very large or small."""
    digits, _, power = f"{abs(value):.{most}g}".partition("e")
    if 0 < int(power or 0) < _LONGEST:
        digits, power = f"{abs(float(f'{value:.{most}g}')):.0f}", ""
    found: tree.Formula = tree.Numeral(digits)
    if power:
        ten = rf"10^{{{int(power)}}}"
        found = formula(ten) if digits == "1" else formula(rf"#1\cdot {ten}", found)
    return tree.row(tree.MINUS, found) if value < 0 else found


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

    def __init__(self, text: str, parts: tuple[tree.Formula, ...]) -> None:
        self.text = text
        self.parts = parts
        found = (match[0] for match in _TOKEN.finditer(text))
        self.tokens = [_NORMAL.get(t, t[:2] if t[:2] == r"\\" else t) for t in found][::-1]

    def error(self) -> AlgebraError:
        left = "".join(reversed(self.tokens)) or "the end"
        return AlgebraError(f"no formula: {self.text!r}, at {left!r}")

    def row(self, ends: tuple[str, ...]) -> tree.Formula:
        """Parts up to one of `ends`, which is left; or up to the end of all."""
        parts: list[tree.Formula] = []
        while self.tokens and self.tokens[-1] not in ends:
            token = self.tokens[-1]
            if token.isspace() or token in _IGNORED:
                self.tokens.pop()
            else:
                parts.append(self._scripted())
        return tree.row(*parts)

    def _scripted(self) -> tree.Formula:
        """A part with its primes, index and exponent, and the argument of a symbol."""
        base = self._part()
        while self._next() in ("'", "_", "^"):
            base = self._script(base, self.tokens.pop())
        is_applied = isinstance(base, tree.Symbol) or (
            isinstance(base, tree.Power) and isinstance(base.base, tree.Symbol)
        )
        if is_applied and self._next() == "(":
            inside = self._part()
            assert isinstance(inside, tree.Bracket)
            base = tree.Apply(base, inside.inside)
            while self._next() in ("'", "_", "^"):
                base = self._script(base, self.tokens.pop())
        return base

    def _script(self, base: tree.Formula, mark: str) -> tree.Formula:
        if mark == "^":
            exponent = self._argument()
            if exponent == tree.Symbol("T"):
                exponent = tree.TRANSPOSE
            return (
                replace(base, above=exponent)
                if isinstance(base, tree.Big)
                else tree.Power(base, exponent)
            )
        if isinstance(base, tree.Power):  # d^⊥_i
            return tree.Power(self._script(base.base, mark), base.exponent)
        if isinstance(base, tree.Big):
            return replace(base, below=self._argument())
        if not isinstance(base, tree.Symbol):
            return tree.Indexed(base, self._argument())
        return replace(base, prime="′") if mark == "'" else replace(base, index=self._argument())

    def _argument(self) -> tree.Formula:
        """What stands in braces, or one token."""
        while self._next().isspace():
            self.tokens.pop()
        if self._next() != "{":
            return self._part()
        self.tokens.pop()
        inside = self.row(("}",))
        self._expect("}")
        return inside

    def _part(self) -> tree.Formula:
        token = self.tokens.pop() if self.tokens else ""
        if token in _ATOMS:
            return _ATOMS[token]
        if token in _OPEN:
            kind = _OPEN[token]
            inside = self.row((kind[1],))
            self._expect(kind[1])
            return tree.Bracket(inside, kind)
        if token == "{":
            self.tokens.append(token)
            return self._argument()
        if token.isdigit():
            return tree.Numeral(token)
        if token.startswith("#"):
            return self.parts[int(token[1:]) - 1]
        if token == "d" and (self._next()[:1].isalpha() or self._next()[:1] in ("\\", "#")):
            return tree.Differential() if self._next() != r"\," else tree.Symbol("d")
        found = self._macro(token) if token.startswith("\\") else None
        if len(token) == 1 and token.isalpha():
            found = tree.Symbol(token)
        if found is None:
            self.tokens.append(token)
            raise self.error()
        return found

    def _macro(self, token: str) -> tree.Formula | None:
        match = _TOKEN.fullmatch(token)
        assert match
        if len(token) == 2 and token[1].isalnum():
            return tree.Symbol(token[1], "bold")
        if match["text"] is not None:
            return tree.Words(match["text"])
        if match["word"]:
            return tree.Symbol(match["word"])
        if match["name"] or token[1:] in FUNCTIONS:
            return self._call(match["name"] or token[1:])
        if match["begin"] == "pmatrix":
            return self._matrix()
        if token in _FACES:
            return _faced(self._argument(), _FACES[token])
        if token in _DOTS:
            inside = self._argument()
            if not isinstance(inside, tree.Symbol):
                raise self.error()
            return replace(inside, dots=inside.dots + _DOTS[token])
        if token in (r"\frac", r"\tfrac"):
            return _quotient(self._argument(), self._argument())
        if token == r"\sqrt":
            return tree.Radical(self._argument())
        letter = greek_letter(token[1:])
        return tree.Symbol(letter) if letter else None

    def _call(self, function: str) -> tree.Formula:
        """The function of the next part; a power is that of the value."""
        exponent = 1
        if self._next() == "^":
            self.tokens.pop()
            power = self._argument()
            assert isinstance(power, tree.Numeral)
            exponent = int(power.digits)
        while self._next().isspace() or self._next() == r"\,":
            self.tokens.pop()
        argument = self._part()
        while self._next() in ("'", "_", "^"):
            argument = self._script(argument, self.tokens.pop())
        return tree.FunctionCall(function, argument, exponent)

    def _matrix(self) -> tree.Formula:
        rows: list[list[tree.Formula]] = [[]]
        ends = ("&", r"\end{pmatrix}", r"\\")
        while True:
            rows[-1].append(self.row(ends))
            if not self.tokens:
                raise self.error()
            end = self.tokens.pop()
            if end == r"\end{pmatrix}":
                return tree.Matrix(tuple(map(tuple, rows)))
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


def _faced(inside: tree.Formula, face: tree.Face) -> tree.Formula:
    """A letter, a word, or a bold 1 or 0, in another face."""
    if isinstance(inside, tree.Numeral):
        return tree.Symbol(inside.digits, face)
    if isinstance(inside, tree.Row):
        letters = (part.letter for part in inside.parts if isinstance(part, tree.Symbol))
        return tree.Symbol("".join(letters), face)
    return replace(inside, face=face) if isinstance(inside, tree.Symbol) else inside


def _quotient(above: tree.Formula, below: tree.Formula) -> tree.Formula:
    """A fraction, or the derivative with respect to time."""
    by_time = tree.row(tree.Differential(), tree.Symbol("t"))
    if below != by_time:
        return tree.Fraction(above, below)
    if isinstance(above, tree.Row) and above.parts[0] == tree.Differential():
        return tree.Rate(tree.row(*above.parts[1:]))
    return tree.Fraction(above, below)


_VARIANTS = {"varphi": "φ", "vartheta": "ϑ", "varepsilon": "ε", "varrho": "ϱ", "varsigma": "ς"}


@lru_cache(maxsize=1024)
def named(label: str, order: int = 0) -> tree.Formula:
    """A name, or its derivative with respect to time: φ̇₁, and d yaw₁/dt.

    A dot above a word would stand above one of its letters, as if they were factors, and so the
    derivative of a word is a quotient in every notation.
    """
    head, above, below = split_super_sub(label)
    index = tuple(map(_part, below))
    prime: tree.Prime = "′" if head.endswith("'") else ""  # I'_12: of the body
    head = head.removesuffix("'")
    symbol = tree.Symbol(
        _letter(head),
        prime=prime,
        index=(index[0] if len(index) == 1 else tree.Row(index)) if index else None,
        macro=_macro(head),
    )
    is_word = len(symbol.letter) > 1 and not symbol.macro
    if not is_word:
        symbol = replace(symbol, dots=order)
    raised = tree.Power(symbol, tree.Row(tuple(map(_part, above)))) if above else symbol
    return tree.Rate(raised, order) if is_word and order else raised


def _part(text: str) -> tree.Formula:
    return tree.Numeral(text) if text.isdigit() else tree.Symbol(_letter(text), macro=_macro(text))


def _letter(name: str) -> str:
    """The letter, also if standard output is ASCII, from which SymPy would take no letters."""
    before = pretty_use_unicode(True)
    try:
        return _VARIANTS.get(name) or greek_letter(name) or str(pretty_symbol(name))
    finally:
        pretty_use_unicode(before)


def _macro(name: str) -> str:
    """LaTeX of a name that is neither a letter of an alphabet nor a word; empty for others."""
    latex = str(sp.latex(sp.Symbol(name)))
    is_greek = (
        len(name) > 1 and greek_letter(name) and latex == f"\\{name}".replace("lamda", "lambda")
    )
    return "" if latex == name or is_greek else latex


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
