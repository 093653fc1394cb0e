"""How wide formulas are when typeset: Latin Modern at 11 points, in ems, rounded up.

A test sets formulas with TeX and compares.
"""

from __future__ import annotations

import unicodedata

from rigidsym.formula.tree import Symbol

SCRIPT = 0.8  # size of indices and exponents
OPERATOR_SPACE = 0.34  # thin spaces on both sides of a function
THIN = 0.17
QUAD = 1.0
EQUAL = 1.34
PRIME = 0.26
FRACTION = 0.26  # beyond the wider of its two parts
ROOT = 0.9
DIGIT = 0.5
BRACKET = 0.39
LARGE = {"flat": 0.0, "large": 0.25, "stretched": 0.35}  # beyond the bracket
COLUMN_GAP = 0.92
TALL_BRACKETS = 1.62
BIG = 1.45

_GREEK = {
    **dict.fromkeys(("iota", "epsilon", "delta"), 0.49),
    **dict.fromkeys(("theta", "xi", "zeta", "rho", "eta", "tau"), 0.56),
    **dict.fromkeys(("nu", "upsilon", "gamma", "kappa", "lamda"), 0.6),
    **dict.fromkeys(("mu", "pi", "sigma", "phi", "beta", "chi", "alpha"), 0.65),
    **dict.fromkeys(("omega", "psi", "Gamma", "Xi", "Lamda"), 0.7),
    **dict.fromkeys(("Omega", "Phi", "Sigma", "Pi", "Theta", "Upsilon", "Psi"), 0.78),
    "Delta": 0.84,
}
_LETTERS = {
    **dict.fromkeys("lijt", 0.41),
    **dict.fromkeys("bcers", 0.52),
    **dict.fromkeys("adfghknopquvxyz", 0.62),
    **dict.fromkeys("mw", 0.88),
    **dict.fromkeys("MW", 1.16),
    **dict.fromkeys("0123456789", DIGIT),
}
_SIGNS = {"+": 1.23, "−": 1.23, "±": 1.23, "=": EQUAL, "·": 0.8, "/": 0.5, ",": 0.45, ";": 0.45}
_FUNCTIONS = {"sin": 1.24, "cos": 1.34, "tan": 1.46, "cot": 1.34, "det": 1.39}
_FACES = {"bold": 1.2, "sans": 1.05}
_WORD = 0.87
_CAPITAL = 0.92
_UNKNOWN = 1.0


def letter_width(symbol: Symbol) -> float:
    """Of a symbol without its prime and index."""
    width = sum(map(_letter, symbol.letter)) * _FACES.get(symbol.face, 1.0)
    return width * _WORD if len(symbol.letter) > 1 else width


def _letter(letter: str) -> float:
    if letter in _LETTERS:
        return _LETTERS[letter]
    kind, _, name = unicodedata.name(letter, "").partition(" LETTER ")
    greek = {"GREEK SMALL": name.lower(), "GREEK CAPITAL": name.title()}.get(kind, "")
    return _GREEK.get(greek) or (_CAPITAL if letter.isalpha() else _UNKNOWN)


def sign_width(character: str) -> float:
    return _SIGNS.get(character, _UNKNOWN)


def function_width(name: str) -> float:
    own = _FUNCTIONS.get(name)
    return (own if own else sum(map(_letter, name))) + OPERATOR_SPACE


def words_width(words: str) -> float:
    return 0.5 * len(words)
