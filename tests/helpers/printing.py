"""SymPy expressions as each pen writes them."""

from __future__ import annotations

import sympy as sp

from rigidsym.formula.latex_pen import LatexPen
from rigidsym.formula.letters import Letters
from rigidsym.formula.scalars import formula_of
from rigidsym.formula.unicode_pen import UnicodePen


def latex(expression: sp.Expr, letters: Letters, *, short: bool = False) -> str:
    """In LaTeX; with `short`, s_θ and c_θ for sine and cosine."""
    pen = LatexPen(letters.notation, short=short)
    return pen.write(formula_of(sp.sympify(expression), letters)).text


def text(expression: sp.Expr, letters: Letters) -> str:
    """On one line of Unicode."""
    return UnicodePen(letters.notation).write(formula_of(sp.sympify(expression), letters)).text
