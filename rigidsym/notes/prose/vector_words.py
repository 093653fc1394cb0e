"""A vector quantity as a sum of vectors, for the note and the terminal."""

from __future__ import annotations

import sympy as sp

from rigidsym.mechanics.derivation import Markup, VectorForm
from rigidsym.notes.formula.formula import markup
from rigidsym.notes.formula.notation import Notation
from rigidsym.notes.formula.order import is_negative


def sum_of_vectors(form: VectorForm, notation: Notation) -> Markup:
    """The terms with their coefficients: v̇ + (1 − cos n)/n² v × v̇ + ..."""
    latex, text = "", ""
    for term in form.terms:
        coefficient = _in_notation(term.coefficient, form, notation)
        minus = is_negative(coefficient)
        factor = _factor(-coefficient if minus else coefficient, notation)
        between = (" - ", " − ") if minus else (" + ", " + ")
        if not latex:
            between = ("-", "−") if minus else ("", "")
        latex += between[0] + factor.latex + term.vector.latex
        text += between[1] + factor.text + term.vector.text
    return Markup(latex, text)


def _in_notation(coefficient: sp.Expr, form: VectorForm, notation: Notation) -> sp.Expr:
    """A coefficient in the length that the notation has; |v|² is n² − w² where n is |q|."""
    length = notation.length
    if length is None or length.components == form.components:
        return coefficient
    others = [part**2 for part in length.components if part not in form.components]
    return coefficient.subs(form.length, sp.sqrt(length.symbol**2 - sp.Add(*others)))


def _factor(coefficient: sp.Expr, notation: Notation) -> Markup:
    """A coefficient before a vector; 1 is not written, and a sum stands in brackets."""
    if coefficient == 1:
        return Markup("", "")
    written = markup(coefficient, notation)
    if coefficient.is_Add:
        return Markup(rf"\left({written.latex}\right)\,", f"({written.text}) ")
    return Markup(rf"{written.latex}\,", f"{written.text} ")
