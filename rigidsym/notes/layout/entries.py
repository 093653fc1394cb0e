"""Names of the entries of a vector or matrix: Ω′₁, R₂₃, Ṙ₂₃, (W⁻¹)₁₂."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator

from rigidsym.mechanics.derivation import Argument, Markup, Step

_BOLD = re.compile(r"\\(?:mathbf|boldsymbol)\{([^{}]*)\}")
_RATE = re.compile(r"\\frac\{d(\w|\\[A-Za-z]+)\}\{dt\}")
_RATE_TEXT = re.compile(r"d(\w)(′?)/dt")
_INDEX = re.compile(r"(.*[^}])_(\w)")  # an index that the symbol has already
_LIST = re.compile(r"\((\w+(?:, \w+)+)\)")
_LIST_LATEX = re.compile(r"\\left\((.*)\\right\)")
_LETTER = re.compile(r"(?:\w|\\[A-Za-z]+|\\dot\{(?:\w|\\[A-Za-z]+)\})'?")
_LETTER_TEXT = re.compile(r"\w\u0307?′?")
RESIDUAL = Markup(r"\boldsymbol{\Delta}", "Δ")  # what is left over of a claim
_DIGITS = str.maketrans("0123456789", "₀₁₂₃₄₅₆₇₈₉")


def entry_names(step: Step, arguments: Iterable[Argument]) -> tuple[Markup, ...]:
    """A name for each entry, row by row.

    Vectors that are arguments of other quantities, such as the rates, have the names of those.
    """
    if step.quantity.is_scalar:
        return (step.quantity.symbol,)
    known = {argument.name: argument.notation for argument in arguments}
    argument = _argument_name(step.quantity.name)
    return known.get(argument) or indexed(step.quantity.symbol, step.shape)


def _argument_name(quantity: str) -> str:
    """The argument that a quantity may be used as: rates as q_dot, an angular velocity as omega."""
    if quantity.startswith("rates_from_"):
        return "q_dot"
    return quantity.replace("angular_velocity_", "omega_")


def indexed(symbol: Markup, shape: tuple[int, ...]) -> tuple[Markup, ...]:
    """The symbol with the index of each entry, in light face; (a₁, a₂, a₃) lists its own."""
    if listed := _LIST.fullmatch(symbol.text):
        names = _LIST_LATEX.sub(r"\1", symbol.latex).split(", ")
        return tuple(map(Markup, names, listed[1].split(", ")))
    stem, own = _plain_letter(symbol), Markup("", "")
    indexed_already = _INDEX.fullmatch(symbol.text)
    if indexed_already:
        own = Markup(f"{indexed_already[2]},", f"{indexed_already[2]},")
        stem = _plain_letter(
            Markup(symbol.latex.removesuffix(f"_{indexed_already[2]}"), indexed_already[1])
        )
    return tuple(_indexed(stem, own, index) for index in _indices(shape))


def _indices(shape: tuple[int, ...]) -> Iterator[str]:
    if len(shape) == 1:
        return (str(row + 1) for row in range(shape[0]))
    rows, columns = shape
    return (f"{row + 1}{column + 1}" for row in range(rows) for column in range(columns))


def _plain_letter(symbol: Markup) -> Markup:
    """The symbol without bold face, a derivative as a dot, brackets around anything compound."""
    latex = _RATE.sub(r"\\dot{\1}", _BOLD.sub(r"\1", symbol.latex))
    text = _RATE_TEXT.sub("\\1\u0307\\2", symbol.text)
    return Markup(
        latex if _LETTER.fullmatch(latex) else rf"\bigl({latex}\bigr)",
        text if _LETTER_TEXT.fullmatch(text) else f"({text})",
    )


def _indexed(stem: Markup, own: Markup, index: str) -> Markup:
    """R₂₃, or L_R,1 where the symbol has an index of its own."""
    digits = f"_{own.text}{index}" if own.text else index.translate(_DIGITS)
    return Markup(f"{stem.latex}_{{{own.latex}{index}}}", stem.text + digits)
