"""What is proved beside the steps, as formulas for both ways of printing."""

from __future__ import annotations

from rigidsym.mechanics.derivation import Markup


def fill(latex: str, text: str, *symbols: Markup) -> Markup:
    """Both templates filled with the symbols: {0}, {1}, ... in LaTeX and in text."""
    return Markup(
        latex.format(*(symbol.latex for symbol in symbols)),
        text.format(*(symbol.text for symbol in symbols)),
    )


def rate_of(matrix: Markup) -> Markup:
    return fill(r"\frac{{d{0}}}{{dt}}", "d{0}/dt", matrix)


def rate_of_whole(product: Markup) -> Markup:
    return fill(r"\frac{{d}}{{dt}}\left({0}\right)", "d({0})/dt", product)


def transpose_of(matrix: Markup) -> Markup:
    return fill(r"{0}^{{\mathsf T}}", "{0}ᵀ", matrix)


def spin_of(matrix: Markup) -> Markup:
    return fill(r"{0}{1}", "{0}·{1}", rate_of(matrix), transpose_of(matrix))


def orthogonal(matrix: Markup) -> Markup:
    return fill(r"{0}{1} = \mathbf{{1}}", "{0} {1} = 1", matrix, transpose_of(matrix))


def proper(matrix: Markup) -> Markup:
    return fill(r"\det {0} = 1", "det {0} = 1", matrix)


def stays_orthogonal(matrix: Markup) -> Markup:
    """The derivative of the statement that the matrix is orthogonal."""
    return fill(
        r"{0}{1} + {2}{3} = \mathbf{{0}}",
        "{0} {1} + {2} {3} = 0",
        rate_of(matrix),
        transpose_of(matrix),
        matrix,
        rate_of(transpose_of(matrix)),
    )


def skew(spin: Markup) -> Markup:
    return fill(r"{0} + \left({0}\right)^{{\mathsf T}} = \mathbf{{0}}", "{0} + ({0})ᵀ = 0", spin)


def is_operator(vector: Markup, matrix: Markup, sign: str = "") -> Markup:
    """The matrix is the skew operator of plus or minus the vector."""
    latex, text = r"{1} = " + sign + r"\mathbf{{C}}({0})", "{1} = " + sign.replace("-", "−")
    return fill(latex, text + "C({0})", vector, matrix)


def rotates(rotation: Markup, body: Markup, space: Markup) -> Markup:
    return fill(r"{2} = {0}\,{1}", "{2} = {0} {1}", rotation, body, space)


def maps_rates(matrix: Markup, rates: Markup, omega: Markup) -> Markup:
    return fill(r"{0}\,{1} = {2}", "{0} {1} = {2}", matrix, rates, omega)


def inverse_of(matrix: Markup, inverse: Markup) -> Markup:
    return fill(r"{0}{1} = \mathbf{{1}}", "{0} {1} = 1", matrix, inverse)


def solves(matrix: Markup, inverse: Markup, omega: Markup) -> Markup:
    return fill(r"{0}\left({1}{2}\right) = {2}", "{0} ({1} {2}) = {2}", matrix, inverse, omega)
