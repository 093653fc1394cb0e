"""Any text as LaTeX text: what is special to TeX is escaped, what the font lacks is replaced.

`cleaned` is text that any format can hold: no control characters, no half characters, no hidden
direction.
"""

from __future__ import annotations

import re
import unicodedata
from functools import cache, lru_cache
from string import ascii_letters, digits

from rigidsym.formula.latex_pen import GREEK_MACROS

_SPECIAL = {character: f"\\{character}" for character in "{}$&#%_"} | {
    "\\": r"\textbackslash{}",
    "^": r"\textasciicircum{}",
    "~": r"\textasciitilde{}",
    "<": r"\textless{}",
    ">": r"\textgreater{}",
    "|": r"\textbar{}",
    '"': r"\textquotedbl{}",
    "`": r"\textasciigrave{}",
    "\u2011": r"\mbox{-}",  # no line ends there
    "\u00a0": "~",
}
_MACROS = r"' - \times \cdot \pm \partial \surd \infty \le \ge \ne \approx \to"
_MATH = dict(zip("′−×·±∂√∞≤≥≠≈→", _MACROS.split(), strict=True)) | {"ᵀ": r"^{\mathsf T}"}
_SCRIPTS = {"<super>": "^", "<sub>": "_"}  # as Unicode tells of ², ₀, ₊ and ₐ
_PLAIN = frozenset(f"{ascii_letters}{digits}+-=()")  # what LaTeX writes there as it is
_PUNCTUATION = "–—‘’“”„…€"
_MISSING = set("ĦħĸĿŀŉŦŧſ")  # in the range of Latin letters, but not in the T1 fonts
_LIGATURES = re.compile(r"([-,'])(?=\1)")


@lru_cache(maxsize=1 << 12)  # notes have most words in common
def escape(text: str) -> str:
    """The text in LaTeX; a character that no font has appears as its code, [U+4E2D]."""
    characters = unicodedata.normalize("NFC", text)
    # A function takes half the time of a template such as r"\1{}".
    return _LIGATURES.sub(lambda found: f"{found[0]}{{}}", "".join(map(_character, characters)))


@cache
def _character(character: str) -> str:
    if character in _SPECIAL:
        return _SPECIAL[character]
    if formula := _formula(character):
        return rf"\ensuremath{{{formula}}}"
    if character.isspace() or unicodedata.category(character).startswith("C"):
        return " "
    is_in_font = character <= "\u017e" and character not in _MISSING
    return character if is_in_font or character in _PUNCTUATION else f"[U+{ord(character):04X}]"


def _formula(character: str) -> str:
    """A character of formulas, also above or below the line, in LaTeX; empty for others."""
    place, *codes = unicodedata.decomposition(character).split() or [""]
    if character not in _MATH and place in _SCRIPTS and len(codes) == 1:
        base = chr(int(codes[0], 16))
        written = base if base in _PLAIN else _formula(base)
        return f"{_SCRIPTS[place]}{{{written}}}" if written else ""
    return _MATH.get(character) or GREEK_MACROS.get(character, "")


# controls, formats such as a change of direction, surrogates, unassigned; line separators
_HIDDEN = ("C", "Zl", "Zp")


def cleaned(text: str) -> str:
    """The text with a blank in place of each character that is not printed, or ends a line."""
    if text.isprintable() and text.isascii():
        return text
    return "".join(
        " " if unicodedata.category(c).startswith(_HIDDEN) else c
        for c in unicodedata.normalize("NFC", text)
    )
