"""The sentences of the note that lead from one equation to the next."""

from __future__ import annotations

from collections.abc import Iterator

import sympy as sp

from rigidsym.formula.display import Done
from rigidsym.formula.letters import Letters
from rigidsym.formula.scalars import formula_of
from rigidsym.formula.tree import COMMA, Apply, Bracket, Formula, Rate, Symbol, equal, joined, row
from rigidsym.mechanics.quantities.kinematics import PRESENTED
from rigidsym.models.rotation import SOURCES, Turn
from rigidsym.models.so3 import hat
from rigidsym.notes.document.document import (
    Cited,
    Equation,
    EquationRow,
    NoteBlock,
    Text,
    said,
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

_TURNING = Cited(SOURCES["Landau 31"])
_SHORTHAND = words(
    r"With the abbreviations $s_\alpha$ for $\sin\alpha$ and $c_\alpha$ for $\cos\alpha$,"
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


def motion(*, passive: bool) -> Iterator[NoteBlock]:
    """Why the derivative times the transpose is the operator of the angular velocity."""
    shown = PRESENTED[passive]
    place, velocity = (BODY_POSITION, BODY_POSITION_RATE) if passive else (POSITION, POSITION_RATE)
    other = POSITION if passive else BODY_POSITION
    if passive:
        yield said(
            "A point at rest in space has the body components {}, which change at the rate", PASSIVE
        )
    else:
        yield said("A point at rest in the body, {}, has the velocity", ACTIVE)
    yield Equation(sides=(velocity, row(Rate(shown.matrix), other), row(shown.spin, place)))
    if passive:
        yield said(
            "As seen from the body, the point moves with the velocity "
            "$-\\boldsymbol{\\Omega}'\\times\\mathbf{x}'$\u00a0{}, so that {} is the matrix of "
            "the operator $-\\boldsymbol{\\Omega}'\\times$.",
            *(_TURNING, shown.spin),
        )
    else:
        yield said(
            "This velocity is also $\\boldsymbol{\\Omega}\\times\\mathbf{x}$\u00a0{}, so that {} "
            "is the matrix of the operator $\\boldsymbol{\\Omega}\\times$.",
            *(_TURNING, shown.spin),
        )
    yield said(
        r"The matrix of $\mathbf{u}\times$ is skew for any $\mathbf{u}$, and so is {}, by "
        "differentiation of {}:",
        *(shown.spin, shown.orthogonal),
    )
    operator = Equation(sides=(OPERATOR,), matrix=hat(sp.Matrix(sp.symbols("u_1:4"))))
    yield EquationRow((operator, Equation(sides=(shown.skew,))))


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
