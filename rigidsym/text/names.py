"""Names of coordinates and constants in text: how they are spelled, and which are free."""

from __future__ import annotations

import re

import sympy as sp
from sympy.printing.pretty.pretty_symbology import pretty_symbol, pretty_use_unicode

from rigidsym.errors import ExpressionError
from rigidsym.text.bounds import FUNCTIONS

_LONGEST = 40

_LETTERS = "αβγδεζηθικλμνξπρστυφχψωΓΔΘΛΞΠΣΥΦΨΩϕϑϵϰϱϖ\u00b5\u2126"  # the last two: micro, ohm
_LETTER_NAMES = """
alpha beta gamma delta epsilon zeta eta theta iota kappa lambda mu nu xi pi rho sigma tau upsilon
phi chi psi omega Gamma Delta Theta Lambda Xi Pi Sigma Upsilon Phi Psi Omega
phi theta epsilon kappa rho varpi mu Omega
"""  # without omicron and the other capitals, which look like Latin letters
_GREEK = dict(zip(_LETTERS, _LETTER_NAMES.split(), strict=True))
GREEK_LETTERS = "".join(_GREEK)
_SPELLING = str.maketrans(_GREEK)

_TAKEN = {
    **dict.fromkeys(FUNCTIONS, "a function"),
    **dict.fromkeys(("q", "out", "np"), "a name that the generated functions use"),
    **dict.fromkeys(("deg", "degree", "degrees"), "a unit; angles are in radians, 30° is pi/6"),
    "pi": "the number π",
    "t": "the time",
}
_FORM = re.compile(r"[A-Za-z][A-Za-z0-9]*(?:_[A-Za-z0-9]+)*")
_ANGULAR_VELOCITY = re.compile(r"Omega_(?:body_)?[123]|omega_(?:space|body)(?:_[123])?")


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
    fault = _fault(name)
    if fault:
        raise ExpressionError(f"{text!r} is not a valid name: {fault}")
    return name


def _fault(name: str) -> str:
    if not _FORM.fullmatch(name):
        return "expected a letter (Latin or Greek), then letters, digits and single underscores"
    if name in _TAKEN:
        return f"{name} is {_TAKEN[name]}"
    # theta_dot is the rate of theta in every text and in generated functions.
    if name.endswith("dot"):
        return "a name that ends in dot reads as a rate"
    if _ANGULAR_VELOCITY.fullmatch(name):
        return "it is a component of the angular velocity"
    return ""
