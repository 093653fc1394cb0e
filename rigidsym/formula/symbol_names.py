"""The symbol that a name in Python stands for: φ̇₁ for the rate of phi_1."""

from __future__ import annotations

from functools import lru_cache

import sympy as sp
from sympy.printing.conventions import split_super_sub
from sympy.printing.pretty.pretty_symbology import pretty_symbol

from rigidsym.formula.reader import greek_letter
from rigidsym.formula.tree import Formula, Numeral, Power, Rate, Row, Symbol

_VARIANTS = {"varphi": "φ", "vartheta": "ϑ", "varepsilon": "ε", "varrho": "ϱ", "varsigma": "ς"}


@lru_cache(maxsize=1024)
def named(label: str, order: int = 0) -> Formula:
    """A name, or its derivative with respect to time: φ̇₁, and d yaw₁/dt.

    A dot above a word would stand above one of its letters, as if they were factors, and so the
    derivative of a word is a quotient in every notation.
    """
    head, above, below = split_super_sub(label)
    index = tuple(map(_part, below))
    symbol = Symbol(
        _letter(head),
        index=(index[0] if len(index) == 1 else Row(index)) if index else None,
        macro=_macro(head),
    )
    is_word = len(symbol.letter) > 1 and not symbol.macro
    if not is_word:
        symbol = Symbol(symbol.letter, dots=order, index=symbol.index, macro=symbol.macro)
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
