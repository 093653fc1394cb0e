"""Names of coordinates and constants in text: how they are spelled, and which are free."""

from __future__ import annotations

import re

import sympy as sp
from sympy.core.alphabets import greeks
from sympy.printing.pretty.pretty_symbology import pretty_symbol, pretty_use_unicode

from rigidsym.errors import ExpressionError
from rigidsym.text.bounds import FUNCTIONS

_LONGEST = 40

ALPHABET = dict(zip("αβγδεζηθικλμνξοπρστυφχψω", greeks, strict=True))
# without omicron and the other capitals, which look like Latin letters
_GREEK = {letter: name for letter, name in ALPHABET.items() if letter != "ο"}
_GREEK |= {letter: ALPHABET[letter.lower()].title() for letter in "ΓΔΘΛΞΠΣΥΦΨΩ"}
_GREEK |= {"ϕ": "phi", "ϑ": "theta", "ϵ": "epsilon", "ϰ": "kappa", "ϱ": "rho", "ϖ": "varpi"}
_GREEK |= {"\u00b5": "mu", "\u2126": "Omega"}  # the signs of micro and ohm
GREEK_LETTERS = "".join(_GREEK)
_SPELLING = str.maketrans(_GREEK)

_TAKEN = {**dict.fromkeys(FUNCTIONS, "a function"), "pi": "the number π", "t": "the time"}
_FORM = re.compile(r"[A-Za-z][A-Za-z0-9]*(?:_[A-Za-z0-9]+)*")
_ANGULAR_VELOCITY = re.compile(r"Omega_(?:body_)?[123]|omega_(?:space|body)(?:_[123])?")

MODULE_NAME = re.compile(r"[a-z][a-z0-9_]*")  # of a derivation, its folder and its module
A_MODULE_NAME = "expected lower-case letters, digits and underscores, beginning with a letter"


def spelled(text: str) -> str:
    """The name in Latin letters: `phi_1` for `φ_1`."""
    return text.translate(_SPELLING)


def lettered(name: str) -> str:
    """The name as it is read, `φ₁` for `phi_1`, also where a terminal knows no such letters."""
    # SymPy's setting is global, so it is put back.
    before = pretty_use_unicode(True)
    try:
        return str(pretty_symbol(name))
    finally:
        pretty_use_unicode(before)


def check_name(text: str | sp.Symbol) -> str:
    """The plain name of a coordinate or a constant: `phi` for `phi`, for `φ` and for a symbol.

    Raises ExpressionError for what cannot name one.
    """
    if isinstance(text, sp.Symbol):
        text = text.name
    if not isinstance(text, str):
        raise ExpressionError(f"expected a name in quotes, got {text!r}")
    name = spelled(text)
    if not 0 < len(name) <= _LONGEST:
        raise ExpressionError(f"expected a name of 1 to {_LONGEST} letters, got {len(name)}")
    if not _FORM.fullmatch(name):
        raise _invalid(
            text, "expected a letter (Latin or Greek), then letters, digits and single underscores"
        )
    if name in _TAKEN:
        raise _invalid(text, f"{name} is {_TAKEN[name]}")
    if name in ("q", "out", "np"):
        raise _invalid(text, f"{name} is a name that the generated functions use")
    if name in ("deg", "degree", "degrees"):
        raise _invalid(text, f"{name} is a unit; angles are in radians, 30° is pi/6")
    # theta_dot is the rate of theta in every text and in generated functions.
    if name.endswith("dot"):
        raise _invalid(text, "a name that ends in dot reads as a rate")
    if _ANGULAR_VELOCITY.fullmatch(name):
        raise _invalid(text, "it is a component of the angular velocity")
    return name


def _invalid(text: str, reason: str) -> ExpressionError:
    return ExpressionError(f"{text!r} is not a valid name: {reason}")
