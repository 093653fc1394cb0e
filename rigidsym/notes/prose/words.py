"""Sentences with formulas in them: what the note and the terminal say in words.

First the convention; then the sentences that lead from one equation to the next.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from functools import lru_cache
from itertools import chain

import sympy as sp

from rigidsym.formula.display import Done
from rigidsym.formula.letters import Letters
from rigidsym.formula.notation import Notation
from rigidsym.formula.reader import formula, sentence
from rigidsym.formula.scalars import formula_of
from rigidsym.formula.tree import (
    COMMA,
    Apply,
    Bracket,
    Formula,
    Symbol,
    equal,
    joined,
    transpose_of,
)
from rigidsym.mechanics.derivation import Argument, Derivation
from rigidsym.mechanics.quantities.energy import CENTRE
from rigidsym.mechanics.quantities.kinematics import (
    BODY,
    COSINES,
    PRESENTED,
    RATES,
    ROTATION,
    SPACE,
)
from rigidsym.mechanics.quantities.mass import DIRECTION, MASS, OF_BODY_ALONE, POINT
from rigidsym.mechanics.quantities.table import is_quaternion
from rigidsym.models.body import ABOUT_FIXED_POINT
from rigidsym.models.rotation import AXES, SOURCES, Citation, Turn, hat
from rigidsym.notes.document.document import (
    Cited,
    Code,
    Equation,
    EquationRow,
    NoteBlock,
    Paragraph,
    Text,
    listed,
)
from rigidsym.notes.formula.derivation_letters import VECTOR, length_of, letters_of

POSITION = formula(r"\mathbf{x}")
BODY_POSITION = formula(r"\mathbf{x}'")
POSITION_RATE, BODY_POSITION_RATE = formula(r"\dot{\mathbf{x}}"), formula(r"\dot{\mathbf{x}}'")
COORDINATES = formula(r"\mathbf{q}")
OPERATOR = formula(r"\mathbf{C}(\mathbf{u})")  # of u ×
VECTOR_OF = formula(r"\mathbf{C}^{-1}")
ACTIVE = formula(r"#1 = #2\,#3", POSITION, ROTATION, BODY_POSITION)
PASSIVE = formula(r"#1 = #2\,#3", BODY_POSITION, COSINES, POSITION)
TRANSPOSED = formula(r"#1 = #2^{\mathsf T}", COSINES, ROTATION)

_OF_ROTATIONS = (ROTATION, transpose_of(ROTATION), transpose_of(COSINES), *map(Symbol, AXES))
_OF_RATES = (SPACE.omega, BODY.omega, SPACE.matrix, BODY.matrix, RATES, VECTOR_OF)
_OF_BODIES = (
    BODY_POSITION,
    formula(r"|#1\times(#2-#3)|", DIRECTION, BODY_POSITION, POINT),
    formula(r"#1^{\mathsf T}\mathbf{I}'\,#1 = 1", BODY_POSITION),
    POINT,
    DIRECTION,
)

_OF_TURNS = tuple(
    map(formula, (r"\mathbf{T}_k", r"\mathbf{n}_k", r"\theta_k", r"\mathbf{P}_0 = \mathbf{1}"))
)
_SUPERSCRIPTS = str.maketrans("0123456789-", "⁰¹²³⁴⁵⁶⁷⁸⁹⁻")
_ALSO_WORDS = ("a", "A", "I")  # words of a sentence, unless a sign follows: a + i b


_ON_OMEGA = sentence(
    "The angular velocity has the components {} along the axes of space and {} along the axes of "
    "the body.",
    SPACE.omega,
    BODY.omega,
)
_DIRECTION = {  # whether the passive form is shown
    True: sentence(
        "The matrix shown is the direction cosine matrix {}, the passive form: {} takes "
        "components along the axes of space to components along the axes of the body.",
        TRANSPOSED,
        PASSIVE,
    ),
    False: sentence(
        "The rotation is active: {} takes components along the axes of the body to components "
        "along the axes of space.",
        ACTIVE,
    ),
}


def symbols_of(derivation: Derivation) -> dict[str, Formula]:
    """The symbols that may occur in a sentence about a derivation, by their plain text."""
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
    found = {symbol.text: symbol for symbol in named}
    for argument in derivation.arguments:
        if argument.name == "q":
            found |= zip(argument.names, argument.notation, strict=True)
    return found


def with_symbols(words: str, symbols: Mapping[str, Formula]) -> Text:
    """A plain sentence, with the symbols in it made into formulas."""
    parts = _any_of(tuple(symbols)).split(words)
    return tuple(symbols.get(part, part) for part in parts if part)


@lru_cache(maxsize=64)
def _any_of(texts: tuple[str, ...]) -> re.Pattern[str]:
    longest_first = sorted(texts, key=len, reverse=True)
    known = (rf"{t}(?= [+=])" if t in _ALSO_WORDS else re.escape(t) for t in longest_first)
    return re.compile(r"(?<!\w)(" + "|".join(known) + r")(?!\w)")


def with_source(text: Text, source: Citation | None) -> Text:
    """A sentence with its source cited before the stop at its end."""
    *head, last = text
    if source is None or not isinstance(last, str):
        return text
    body = last.rstrip(".,:;")
    return tuple(
        span for span in (*head, body, "\u00a0", Cited(source), last[len(body) :]) if span != ""
    )


def convention(
    derivation: Derivation, symbols: Mapping[str, Formula], notation: Notation
) -> tuple[Text, ...]:
    """The convention, a sentence or two an entry: turns, direction of the rotation, frames."""
    q = derivation.argument("q")
    named = q.names if is_quaternion(q.names, q.units) else ()  # printed in other letters
    return (
        *(with_symbols(words, symbols) for words in derivation.model.convention),
        _DIRECTION[derivation.model.passive],
        _ON_OMEGA,
        _coordinates(q, named, has_dots=notation.rates == "dot"),
        *vector_in_words(derivation, notation),
        *_body(derivation, notation),
        *_conditions(derivation, notation),
    )


def vector_in_words(derivation: Derivation, notation: Notation) -> Iterator[Text]:
    """The vector, and the letter for its length, where they stand in the formulas."""
    letters = letters_of(derivation.arguments, notation, derivation.model)
    length, parts = letters.length, derivation.model.vector
    has_form = any(step.vector_form for step in derivation.steps)
    said = ("The vector is ", VECTOR, " = ", *vector(parts, letters), ".") if has_form else ()
    if length is None:
        if said:
            yield said
        return
    n, rate = length.names.values()
    v = VECTOR if length.components == parts else COORDINATES
    whole = formula("|#1|", v)
    yield (
        *((*said, " ") if said else ()),
        *sentence("The length {} is written {}, so that {}", whole, n, _square(n, v)),
        *sentence(
            " and {}.",
            formula(r"#1\,#2 = #3\cdot\dot{#3}", n, rate, v),
        ),
    )


def _square(length: Formula, of: Formula) -> Formula:
    return formula(r"#1^{2} = #2\cdot#2", length, of)


def is_body_alone(derivation: Derivation) -> bool:
    """Whether nothing is derived of the rotation, so that a note leaves it out."""
    names = [step.quantity.name for step in derivation.steps]
    return bool(names) and all(name in OF_BODY_ALONE for name in names)


def _body(derivation: Derivation, notation: Notation) -> Iterator[Text]:
    """The mass of the body, its axes, and where its centre of mass is."""
    body = derivation.body
    if body is None:
        return
    letters = letters_of(derivation.arguments, notation)
    if derivation.about_fixed_point:
        yield (ABOUT_FIXED_POINT,)
        return
    used = {name for step in derivation.steps for name in step.quantity.inputs}
    if derivation.forces and "centre" not in used and "centre_dot" not in used:
        yield ("The inertia tensor is about the centre of mass, along the axes of the body.",)
        return
    given = formula_of(body.mass, letters)
    centre = listed([(name,) for name in derivation.argument("centre").notation], ", ")
    head = sentence(
        "The body has the mass {}, and its inertia tensor is about the centre of mass, along the "
        "axes of the body; the centre of mass is at {} = (",
        MASS if any(s.quantity.name == "mass" for s in derivation.steps) else given,
        CENTRE,
    )
    yield (*head, *centre, ") in space.")


def _conditions(derivation: Derivation, notation: Notation) -> Iterator[Text]:
    """What the coordinates and constants are bound by, which the proofs make use of."""
    letters = letters_of(derivation.arguments, notation, derivation.model)
    for constraint in derivation.model.constraints:
        number, rest = constraint.as_coeff_Add()
        sides = (formula_of(rest, letters), formula_of(-number, letters))
        yield sentence("All identities hold under the condition {}.", equal(*sides))


def _coordinates(argument: Argument, in_programs: Iterable[str], *, has_dots: bool) -> Text:
    names = listed([(name,) for name in argument.notation], ", ")
    units = sorted(set(argument.units))
    measured = f", in {unit_in_words(units[0])}" if len(units) == 1 and units[0] else ""
    several = len(argument.notation) > 1
    head = (f"The coordinate{'s are' if several else ' is'} ", COORDINATES, " = (")
    dots = "; a dot denotes the derivative with respect to time" if has_dots else ""
    codes = listed([(Code(name),) for name in in_programs], ", ")
    programs: Text = (", in programs ", *codes) if codes else ()
    return (*head, *names, f"){measured}", *programs, f"{dots}.")


def unit_in_words(unit: str) -> str:
    """rad/s² for rad/s^2; a pure number has the unit 1."""
    unit = re.sub(r"\((.+)\)\^\(-1/2\)", r"1/√(\1)", unit)
    return re.sub(r"\^(-?\d+)", lambda m: m[1].translate(_SUPERSCRIPTS), unit) or "1"


def vector(entries: Iterable[sp.Expr], letters: Letters) -> Text:
    """The components in a row, with a place to break the line after each comma."""
    return ("(", *listed([(formula_of(entry, letters),) for entry in entries], ", "), ")")


_OPERATOR = Equation(sides=(OPERATOR,), matrix=hat(sp.Matrix(sp.symbols("u_1:4"))))
_TURNING = Cited(SOURCES["Landau 31"])
_R, _A = PRESENTED[False], PRESENTED[True]
_IS_SKEW = (
    r"The matrix of $\mathbf{u}\times$ is skew for any $\mathbf{u}$, and so is {}, by "
    "differentiation of {}:"
)
_SHORTHAND = sentence(
    r"With the abbreviations $s_\alpha$ for $\sin\alpha$ and $c_\alpha$ for $\cos\alpha$,"
)


# why the derivative times the transpose is the operator of the angular velocity
ACTIVE_MOTION: tuple[NoteBlock, ...] = (
    Paragraph(("A point at rest in the body, ", ACTIVE, ", has the velocity")),
    Equation(
        sides=(
            POSITION_RATE,
            formula(r"\frac{d#1}{dt}#2", _R.matrix, BODY_POSITION),
            formula("#1#2", _R.spin, POSITION),
        )
    ),
    Paragraph(
        sentence(
            "This velocity is also $\\boldsymbol{\\Omega}\\times\\mathbf{x}$\u00a0{}, so that {} "
            "is the matrix of the operator $\\boldsymbol{\\Omega}\\times$.",
            *(_TURNING, _R.spin),
        )
    ),
    Paragraph(sentence(_IS_SKEW, _R.spin, _R.orthogonal)),
    EquationRow((_OPERATOR, Equation(sides=(_R.skew,)))),
)
PASSIVE_MOTION: tuple[NoteBlock, ...] = (
    Paragraph(
        (
            "A point at rest in space has the body components ",
            PASSIVE,
            ", which change at the rate",
        )
    ),
    Equation(
        sides=(
            BODY_POSITION_RATE,
            formula(r"\frac{d#1}{dt}#2", _A.matrix, POSITION),
            formula("#1#2", _A.spin, BODY_POSITION),
        )
    ),
    Paragraph(
        sentence(
            "As seen from the body, the point moves with the velocity "
            "$-\\boldsymbol{\\Omega}'\\times\\mathbf{x}'$\u00a0{}, so that {} is the matrix of "
            "the operator $-\\boldsymbol{\\Omega}'\\times$.",
            *(_TURNING, _A.spin),
        )
    ),
    Paragraph(sentence(_IS_SKEW, _A.spin, _A.orthogonal)),
    EquationRow((_OPERATOR, Equation(sides=(_A.skew,)))),
)

HOW_VERIFIED = "Each identity was verified exactly, using relations such as sin² + cos² = 1."
EXACT_MEANS = " “Exact” means that the two sides were shown to be identical."
_UNPROVED_MEANS = (
    " “Unproved” means that the difference of the two sides was not shown to vanish; it is given "
    "below the table."
)


def turn(turn: Turn, letters: Letters) -> Formula:
    """R_z(φ), or R_[0, 3/5, 4/5](φ)."""
    return Apply(Symbol("R", "bold", index=axis_of(turn, letters)), formula_of(turn.angle, letters))


def axis_of(turn: Turn, letters: Letters) -> Formula:
    """The axis of a turn: its letter, or its components."""
    if not turn.components:
        return Symbol(turn.axis)
    return Bracket(joined([formula_of(c, letters) for c in turn.components], COMMA), "[]")


def announcement(equation: Equation, done: Done) -> Text:
    """What a reader has to be told of the way an equation is set, before it; often nothing."""
    if done == "abbreviated":
        return _SHORTHAND
    if done == "listed":
        return sentence("The entries of {} are", equal(*equation.sides))
    return ()


def proofs_in_words(*, is_proved: bool) -> Text:
    """What the table of proofs means by its words."""
    return (HOW_VERIFIED, EXACT_MEANS if is_proved else EXACT_MEANS + _UNPROVED_MEANS)
