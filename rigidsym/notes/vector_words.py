"""A vector quantity as a sum of vectors, for the note and the terminal."""

from __future__ import annotations

import sympy as sp

from rigidsym.mechanics.derivation import Markup, VectorForm
from rigidsym.notes.document import Text
from rigidsym.notes.formula import markup
from rigidsym.notes.notation import Notation
from rigidsym.notes.order import is_negative
from rigidsym.notes.words import vector

_V = Markup(r"\mathbf{v}", "v")
_LENGTH = Markup(r"|\mathbf{v}|", "|v|")


def sum_of_vectors(form: VectorForm, notation: Notation) -> Markup:
    """The terms with their coefficients: v̇ + (1 − cos n)/n² v × v̇ + ..."""
    latex, text = "", ""
    for term in form.terms:
        minus = is_negative(term.coefficient)
        factor = _factor(-term.coefficient if minus else term.coefficient, notation)
        between = (" - ", " − ") if minus else (" + ", " + ")
        if not latex:
            between = ("-", "−") if minus else ("", "")
        latex += between[0] + factor.latex + term.vector.latex
        text += between[1] + factor.text + term.vector.text
    return Markup(latex, text)


def _factor(coefficient: sp.Expr, notation: Notation) -> Markup:
    """A coefficient before a vector; 1 is not written, and a sum stands in brackets."""
    if coefficient == 1:
        return Markup("", "")
    written = markup(coefficient, notation)
    if coefficient.is_Add:
        return Markup(rf"\left({written.latex}\right)\,", f"({written.text}) ")
    return Markup(rf"{written.latex}\,", f"{written.text} ")


def where(form: VectorForm, notation: Notation) -> Text:
    """What v and n stand for."""
    parts: Text = (_V, " = ", *vector(form.components, notation))
    if any(term.coefficient.has(form.length) for term in form.terms):
        parts = (*parts, " and ", Markup(str(form.length), str(form.length)), " = ", _LENGTH)
    return parts
