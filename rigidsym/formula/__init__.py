"""Formulas as trees, and the pens that print them."""

from rigidsym.formula.latex_pen import LatexPen
from rigidsym.formula.tree import WRITERS
from rigidsym.formula.unicode_pen import UnicodePen

WRITERS["latex"] = LatexPen()
WRITERS["text"] = UnicodePen()
