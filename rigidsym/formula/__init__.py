"""Formulas as trees, and the pens that print them."""

from rigidsym.formula.latex_pen import LatexPen
from rigidsym.formula.tree import WRITERS
from rigidsym.formula.unicode_pen import UnicodePen

WRITERS["latex"] = lambda formula: LatexPen().write(formula).text
WRITERS["text"] = lambda formula: UnicodePen().write(formula).text
