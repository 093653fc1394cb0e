"""How wide a formula is: in columns of a terminal, and in ems of the note's font.

The widths are those of Latin Modern at 11 points, in ems, rounded up; a test sets formulas with
TeX and compares.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Sequence
from functools import lru_cache

_MATRIX = re.compile(r"\\begin\{pmatrix\}(.*?)\\end\{pmatrix\}", re.DOTALL)
_ROW_END = re.compile(r"\\\\(?:\[\w+\])?")
_TOKEN = re.compile(r"\\[A-Za-z]+|\\.|[^\s]")
_SCRIPT = 0.8  # size of indices and exponents
_OPERATOR_SPACE = 0.34  # thin spaces on both sides of \sin
_GREEK = {
    **dict.fromkeys(("iota", "epsilon", "delta", "varsigma", "ell", "varepsilon"), 0.49),
    **dict.fromkeys(("theta", "xi", "zeta", "rho", "varrho", "eta", "tau"), 0.56),
    **dict.fromkeys(("nu", "upsilon", "gamma", "kappa", "lambda", "partial", "vartheta"), 0.6),
    **dict.fromkeys(("mu", "pi", "sigma", "phi", "beta", "chi", "alpha"), 0.65),
    **dict.fromkeys(("omega", "psi", "varphi", "Gamma", "Xi", "Lambda"), 0.7),
    **dict.fromkeys(("Omega", "Phi", "Sigma", "Pi", "Theta", "Upsilon", "Psi"), 0.78),
    "Delta": 0.84,
}
_LETTERS = {
    **dict.fromkeys("lijt", 0.41),
    **dict.fromkeys("bcers", 0.52),
    **dict.fromkeys("adfghknopquvxyz", 0.62),
    **dict.fromkeys("mw", 0.88),
    **dict.fromkeys("MW", 1.16),
    **dict.fromkeys("0123456789", 0.5),
}
_SYMBOLS = {
    **dict.fromkeys("+-", 1.23),
    "=": 1.34,
    "(": 0.39,
    ")": 0.39,
    "/": 0.5,
    "'": 0.26,
    ",": 0.45,
    r"\,": 0.17,
    r"\quad": 1.0,
    r"\qquad": 2.0,
    r"\sum": 1.45,
    "{": 0.0,
    "}": 0.0,
}
_FUNCTIONS = {r"\sin": 1.24, r"\cos": 1.34, r"\tan": 1.46, r"\cot": 1.34, r"\det": 1.39}
_FENCES = {
    r"\left": 0.35,
    r"\right": 0.35,
    r"\bigl": 0.1,
    r"\bigr": 0.1,
    r"\Bigl": 0.25,
    r"\Bigr": 0.25,
}  # beyond the bracket
_BARE = {
    r"\dot": 1.0,
    r"\ddot": 1.0,
    r"\vec": 1.0,
    r"\mathrm": 1.0,
    r"\mathit": 0.87,
    r"\mathsf": 1.05,
}
_BOLD = {r"\mathbf": 1.2, r"\boldsymbol": 1.2}
_CAPITAL = 0.92
_UNKNOWN = 1.0
_COLUMN_GAP = 0.92
_TALL_BRACKETS = 1.62


def columns(text: str) -> int:
    """Columns of a terminal: accents above a letter take none, wide characters two."""
    return sum(map(_character_columns, text))


def _character_columns(character: str) -> int:
    if unicodedata.combining(character):
        return 0
    return 2 if unicodedata.east_asian_width(character) in "WF" else 1


@lru_cache(maxsize=8192)
def ems(latex: str) -> float:
    """Estimated width of a formula in LaTeX, in ems; rather too wide than too narrow."""
    matrices = sum(map(_whole_matrix, _MATRIX.findall(latex)))
    return _Ruler(_TOKEN.findall(_MATRIX.sub("", latex))).until("") + matrices


def _whole_matrix(inside: str) -> float:
    return matrix_ems([row.split("&") for row in _ROW_END.split(inside)])


def matrix_ems(rows: Sequence[Sequence[str]]) -> float:
    """Estimated width of a matrix with its brackets, in ems."""
    widths = [max(map(ems, column)) for column in zip(*rows, strict=True)]
    return sum(widths) + _COLUMN_GAP * (len(widths) - 1) + _TALL_BRACKETS


class _Ruler:
    """Walks over the tokens of a formula and adds up their widths."""

    def __init__(self, tokens: Sequence[str]) -> None:
        self._tokens = list(reversed(tokens))

    def until(self, end: str) -> float:
        """The width up to the token `end`, which is consumed; "" stands for the end of all."""
        total = 0.0
        while self._tokens:
            token = self._tokens.pop()
            if token == end:
                break
            total += self._width(token)
        return total

    def _width(self, token: str) -> float:
        if token == "{":
            return self.until("}")
        if token in "_^":
            return _SCRIPT * self._argument()
        if token == r"\frac":
            return max(self._argument(), self._argument()) + 0.26
        if token == r"\sqrt":
            return self._argument() + 0.9
        if token in _BARE or token in _BOLD:
            return self._argument() * (_BARE.get(token) or _BOLD[token])
        return _token_ems(token)

    def _argument(self) -> float:
        return self._width(self._tokens.pop())


def _token_ems(token: str) -> float:
    if token in _FUNCTIONS:
        return _FUNCTIONS[token] + _OPERATOR_SPACE
    if token in _FENCES:
        return _FENCES[token]
    known = _SYMBOLS.get(token) or _LETTERS.get(token) or _GREEK.get(token[1:])
    return known or (_CAPITAL if len(token) == 1 and token.isalpha() else _UNKNOWN)
