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
from collections.abc import Iterable
from dataclasses import replace
from functools import lru_cache
from typing import Any, Literal, TypeVar

from sympy.printing.conventions import split_super_sub

from rigidsym.errors import AlgebraError
from rigidsym.formula import tree
from rigidsym.formula.tree import Formula

_NAMES = (
    "alpha beta gamma delta epsilon zeta eta theta iota kappa lambda mu nu xi omicron pi rho sigma "
    "tau upsilon phi chi psi omega"
)
GREEK = dict(zip(_NAMES.split(), "αβγδεζηθικλμνξοπρστυφχψω", strict=True))
GREEK |= {name.title(): letter.upper() for name, letter in GREEK.items()}
GREEK |= {"lamda": "λ", "Lamda": "Λ"}  # in SymPy, since `lambda` is a keyword of Python
VARIANTS = {"varphi": "ϕ", "vartheta": "ϑ", "varepsilon": "ϵ", "varrho": "ϱ", "varsigma": "ς"}
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
    r"\quad": tree.GAP,
    r"\qquad": tree.GAP,
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
    whole = reader.row()
    if reader.tokens:
        raise reader.error()
    return whole


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


class _TexReader:
    """Reads tokens from left to right; a blank parts a bracket from a letter."""

    def __init__(self, text: str, parts: tuple[tree.Formula, ...]) -> None:
        self.text = text
        self.parts = parts
        tokens = (match[0] for match in _TOKEN.finditer(text))
        # Reversed, so that the list is a stack from which pop() takes the next token.
        self.tokens = [_NORMAL.get(t, t[:2] if t[:2] == r"\\" else t) for t in tokens][::-1]

    @property
    def next(self) -> str:
        """The token that is read next; empty at the end."""
        return self.tokens[-1] if self.tokens else ""

    def error(self) -> AlgebraError:
        rest = "".join(reversed(self.tokens)) or "the end"
        return AlgebraError(f"no formula: {self.text!r}, at {rest!r}")

    def row(self, *ends: str) -> tree.Formula:
        """Parts up to one of `ends`, which is not read; or up to the end of all."""
        parts: list[tree.Formula] = []
        while self.next not in (*ends, ""):
            if self.next.isspace() or self.next in _IGNORED:
                self.tokens.pop()
            else:
                parts.append(self._applied())
        return tree.row(*parts)

    def _within(self, end: str) -> tree.Formula:
        """What stands before a closing bracket, which is read too."""
        inside = self.row(end)
        if not self.tokens:
            raise self.error()
        self.tokens.pop()
        return inside

    def _applied(self) -> tree.Formula:
        """A part with its scripts, and the argument of a symbol."""
        base = self._scripted(self._part())
        head = base.base if isinstance(base, tree.Power) else base
        if not (isinstance(head, tree.Symbol) and self.next == "("):
            return base
        self.tokens.pop()
        return self._scripted(tree.Apply(base, self._within(")")))

    def _scripted(self, base: tree.Formula) -> tree.Formula:
        """A part with its primes, index and exponent."""
        while self.next in ("'", "_", "^"):
            base = self._script(base, self.tokens.pop())
        return base

    def _script(self, base: tree.Formula, mark: str) -> tree.Formula:
        match base:
            case tree.Power() if mark != "^":  # d^⊥_i
                return tree.Power(self._script(base.base, mark), base.exponent)
            case tree.Symbol() if mark == "'":
                return replace(base, prime="′")
        script = self._argument()
        match base:
            case tree.Big():
                return replace(base, above=script) if mark == "^" else replace(base, below=script)
            case _ if mark == "^":
                is_transpose = script == tree.Symbol("T")
                return tree.Power(base, tree.TRANSPOSE if is_transpose else script)
            case tree.Symbol():
                return replace(base, index=script)
        return tree.Indexed(base, script)

    def _argument(self) -> tree.Formula:
        """What stands in braces, or one token."""
        while self.next.isspace():
            self.tokens.pop()
        return self._part()

    def _part(self) -> tree.Formula:
        token = self.tokens.pop() if self.tokens else ""
        if token in _ATOMS:
            return _ATOMS[token]
        if token in _OPEN:
            kind = _OPEN[token]
            return tree.Bracket(self._within(kind[1]), kind)
        if token == "{":
            return self._within("}")
        if token.isdigit():
            return tree.Numeral(token)
        if token.startswith("#"):
            return self.parts[int(token[1:]) - 1]
        # In dR/dt and d\mathbf{R} the d is a differential; a d before a space is a letter.
        if token == "d" and (self.next[:1].isalpha() or self.next[:1] in ("\\", "#")):
            return tree.Differential() if self.next != r"\," else tree.Symbol("d")
        if token.isalpha() and len(token) == 1:
            return tree.Symbol(token)
        part = self._macro(token) if token.startswith("\\") else None
        if part is None:
            self.tokens.append(token)
            raise self.error()
        return part

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
            above, below = self._argument(), self._argument()
            # The derivative with respect to time is a node of its own, since notations write it as
            # a dot, too.
            by_time = tree.row(tree.Differential(), tree.Symbol("t"))
            match above:
                case tree.Row((tree.Differential("d"), *differentiated)) if below == by_time:
                    return tree.Rate(tree.row(*differentiated))
            return tree.Fraction(above, below)
        if token == r"\sqrt":
            return tree.Radical(self._argument())
        letter = GREEK.get(token[1:])
        return tree.Symbol(letter) if letter else None

    def _call(self, function: str) -> tree.Formula:
        """The function of the next part; a power is that of the value."""
        exponent = 1
        if self.next == "^":
            self.tokens.pop()
            power = self._argument()
            assert isinstance(power, tree.Numeral)
            exponent = int(power.digits)
        while self.next.isspace() or self.next == r"\,":
            self.tokens.pop()
        return tree.FunctionCall(function, self._scripted(self._part()), exponent)

    def _matrix(self) -> tree.Formula:
        rows: list[list[tree.Formula]] = [[]]
        end = r"\end{pmatrix}"
        while True:
            rows[-1].append(self.row("&", end, r"\\"))
            if not self.tokens:
                raise self.error()
            mark = self.tokens.pop()
            if mark == end:
                return tree.Matrix(tuple(map(tuple, rows)))
            if mark != "&":
                rows.append([])


def _faced(inside: tree.Formula, face: tree.Face) -> tree.Formula:
    """A letter, a word, or a bold 1 or 0, in another face."""
    match inside:
        case tree.Numeral(digits):
            return tree.Symbol(digits, face)
        case tree.Row(parts):
            letters = (part.letter for part in parts if isinstance(part, tree.Symbol))
            return tree.Symbol("".join(letters), face)
        case tree.Symbol():
            return replace(inside, face=face)
    return inside


@lru_cache(maxsize=1024)
def named(label: str, order: int = 0) -> tree.Formula:
    """A name, or its derivative with respect to time: φ̇₁, and d yaw₁/dt.

    A dot above a word would stand above one of its letters, as if they were factors, and so the
    derivative of a word is a quotient in every notation.
    """
    head, above, below = split_super_sub(label)
    index = tree.row(*map(_part, below)) if below else None
    prime: tree.Prime = "′" if head.endswith("'") else ""  # I'_12: of the body
    symbol = _letter(head.removesuffix("'"))
    is_word = len(symbol.letter) > 1
    symbol = replace(symbol, prime=prime, index=index, dots=0 if is_word else order)
    raised = tree.Power(symbol, tree.Row(tuple(map(_part, above)))) if above else symbol
    return tree.Rate(raised, order) if is_word and order else raised


def _part(text: str) -> tree.Formula:
    return tree.Numeral(text) if text.isdigit() else _letter(text)


def _letter(name: str) -> tree.Symbol:
    return tree.Symbol(GREEK.get(name) or VARIANTS.get(name, name))


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
