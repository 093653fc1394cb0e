"""Reasons and units in words: the symbols in a plain sentence, sources, superscripts."""

from __future__ import annotations

import re
from collections.abc import Mapping
from functools import lru_cache
from itertools import chain

from rigidsym.formula.reader import formula
from rigidsym.formula.tree import Formula, Symbol, equal, transpose_of
from rigidsym.mechanics.derivation import Derivation
from rigidsym.mechanics.quantities.kinematics import BODY, COSINES, RATES, ROTATION, SPACE
from rigidsym.mechanics.quantities.mass import DIRECTION, OF_BODY_ALONE, POINT
from rigidsym.models.rotation import AXES, Citation
from rigidsym.notes.document import Cited, Equation, Text, said
from rigidsym.notes.letters import VECTOR, length_of

_DIGITS = 6
_BODY_POSITION = formula(r"\mathbf{x}'")

_OF_ROTATIONS = (ROTATION, transpose_of(ROTATION), transpose_of(COSINES), *map(Symbol, AXES))
_OF_RATES = (SPACE.omega, BODY.omega, SPACE.matrix, BODY.matrix, RATES, formula(r"\mathbf{C}^{-1}"))
_OF_BODIES = (
    _BODY_POSITION,
    formula(r"|#1\times(#2-#3)|", DIRECTION, _BODY_POSITION, POINT),
    formula(r"#1^{\mathsf T}\mathbf{I}'\,#1 = 1", _BODY_POSITION),
    POINT,
    DIRECTION,
    formula(r"\c"),
)

_BY_LAGRANGE = r"\M\,\ddot\q + \h = \Q"
_OF_MOTION = [formula(rf"\{letter}") for letter in ("M", "h", "Q", "Q = 0", "N'", "I'")]
_OF_MOTION += map(formula, (_BY_LAGRANGE, r"\Om' = \W'\,\dot\q", "T", "V"))
_OF_TURNS = tuple(map(formula, (r"\T_k", r"\n_k", r"\theta_k", r"\P_0 = \1")))
_SUPERSCRIPTS = str.maketrans("0123456789-", "⁰¹²³⁴⁵⁶⁷⁸⁹⁻")
# Words of a sentence, unless a sign follows (a + i b), a comma or an axis (a about z).
_ALSO_WORDS = ("a", "A", "I")


def symbols_of(derivation: Derivation, own: Mapping[Formula, Formula]) -> dict[str, Formula]:
    """The symbols that may occur in a sentence about a derivation, by their plain text.

    Those of motion come in the letters that are our `own`.
    """
    named = [
        *_OF_ROTATIONS,
        *chain.from_iterable(argument.notation for argument in derivation.arguments),
        *(step.quantity.symbol for step in derivation.steps),
        *_OF_RATES,
        *(_OF_BODIES if derivation.body is not None else ()),
        *_OF_TURNS,
    ]
    if derivation.model.vector:
        length = length_of(derivation.model)
        named += (VECTOR, *([length.names[length.symbol]] if length else ()))
    symbols = {symbol.text: symbol for symbol in named}
    if derivation.forces:
        symbols |= {symbol.text: own.get(symbol, symbol) for symbol in _OF_MOTION}
    for argument in derivation.arguments:
        if argument.name == "q":
            symbols |= zip(argument.names, argument.notation, strict=True)
    return symbols


def with_symbols(words: str, symbols: Mapping[str, Formula]) -> Text:
    """A plain sentence, with the symbols in it made into formulas."""
    parts = _any_of(tuple(symbols)).split(words)
    return tuple(symbols.get(part, part) for part in parts if part)


@lru_cache(maxsize=64)
def _any_of(texts: tuple[str, ...]) -> re.Pattern[str]:
    # A pattern takes the first alternative that matches: Ω′ has to come before Ω.
    longest = sorted(texts, key=len, reverse=True)
    patterns = (rf"{t}(?=,| [+=]| about)" if t in _ALSO_WORDS else re.escape(t) for t in longest)
    return re.compile(r"(?<!\w)(" + "|".join(patterns) + r")(?!\w)")


def with_source(text: Text, source: Citation | None) -> Text:
    """A sentence with its source cited before the stop at its end."""
    *head, last = text
    if source is None or not isinstance(last, str):
        return text
    body = last.rstrip(".,:;")
    return tuple(
        span for span in (*head, body, "\u00a0", Cited(source), last[len(body) :]) if span != ""
    )


def is_body_alone(derivation: Derivation) -> bool:
    """Whether nothing is derived of the rotation, so that a note leaves it out."""
    names = [step.quantity.name for step in derivation.steps]
    return bool(names) and all(name in OF_BODY_ALONE for name in names)


def unit_in_words(unit: str) -> str:
    """rad/s² for rad/s^2; a pure number has the unit 1."""
    unit = re.sub(r"\((.+)\)\^\(-1/2\)", r"1/√(\1)", unit)
    return re.sub(r"\^(-?\d+)", lambda m: m[1].translate(_SUPERSCRIPTS), unit) or "1"


def number(value: float) -> str:
    """A number as a reader wants it."""
    return f"{float(value) + 0.0:.{_DIGITS}g}".replace("-", "−")


def announcement(equation: Equation, is_listed: bool) -> Text:
    """What a reader has to be told of the way an equation is set, before it; often nothing."""
    return said("entries", equal(*equation.sides)).text if is_listed else ()
