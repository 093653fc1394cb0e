"""The sentences of the note that lead from one equation to the next."""

from __future__ import annotations

import sympy as sp

from rigidsym.formula.display import Done
from rigidsym.formula.letters import Letters
from rigidsym.formula.reader import formula
from rigidsym.formula.scalars import formula_of
from rigidsym.formula.tree import COMMA, Apply, Bracket, Formula, Symbol, equal, joined
from rigidsym.mechanics.quantities.kinematics import PRESENTED
from rigidsym.models.rotation import SOURCES, Turn
from rigidsym.models.so3 import hat
from rigidsym.notes.document.document import (
    Cited,
    Equation,
    EquationRow,
    NoteBlock,
    Paragraph,
    Text,
    words,
)
from rigidsym.notes.prose.words import (
    ACTIVE,
    BODY_POSITION,
    BODY_POSITION_RATE,
    OPERATOR,
    PASSIVE,
    POSITION,
    POSITION_RATE,
)

_OPERATOR = Equation(sides=(OPERATOR,), matrix=hat(sp.Matrix(sp.symbols("u_1:4"))))
_TURNING = Cited(SOURCES["Landau 31"])
_R, _A = PRESENTED[False], PRESENTED[True]
_IS_SKEW = (
    r"The matrix of $\mathbf{u}\times$ is skew for any $\mathbf{u}$, and so is {}, by "
    "differentiation of {}:"
)
_SHORTHAND = words(
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
        words(
            "This velocity is also $\\boldsymbol{\\Omega}\\times\\mathbf{x}$\u00a0{}, so that {} "
            "is the matrix of the operator $\\boldsymbol{\\Omega}\\times$.",
            *(_TURNING, _R.spin),
        )
    ),
    Paragraph(words(_IS_SKEW, _R.spin, _R.orthogonal)),
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
        words(
            "As seen from the body, the point moves with the velocity "
            "$-\\boldsymbol{\\Omega}'\\times\\mathbf{x}'$\u00a0{}, so that {} is the matrix of "
            "the operator $-\\boldsymbol{\\Omega}'\\times$.",
            *(_TURNING, _A.spin),
        )
    ),
    Paragraph(words(_IS_SKEW, _A.spin, _A.orthogonal)),
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
        return words("The entries of {} are", equal(*equation.sides))
    return ()


def proofs_in_words(*, is_proved: bool) -> Text:
    """What the table of proofs means by its words."""
    return (HOW_VERIFIED, EXACT_MEANS if is_proved else EXACT_MEANS + _UNPROVED_MEANS)
