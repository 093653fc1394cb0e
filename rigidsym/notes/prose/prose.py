"""The sentences of the note that lead from one equation to the next."""

from __future__ import annotations

from collections.abc import Iterator

from rigidsym.formula.display import Done
from rigidsym.formula.letters import Letters
from rigidsym.formula.reader import formula
from rigidsym.formula.scalars import formula_of
from rigidsym.formula.tree import COMMA, Apply, Bracket, Formula, Symbol, equal, joined, row
from rigidsym.mechanics.quantities.claims import rate_of, spin_of
from rigidsym.mechanics.quantities.kinematics import BODY, COSINES, ROTATION, SPACE
from rigidsym.models.rotation import Turn, lecture
from rigidsym.notes.document.document import Cited, Equation, NoteBlock, Paragraph, Text, words
from rigidsym.notes.prose.words import ACTIVE, BODY_POSITION, PASSIVE, POSITION

_TURNING = lecture("3", "section 1.2")
_MOTION = lecture("15", "section 3.2")
_VELOCITY = formula(r"\dot{\mathbf{x}}")
_BODY_VELOCITY = formula(r"\dot{\mathbf{x}}'")
_SHORTHAND = (
    formula(r"s_\alpha"),
    formula(r"\sin\alpha"),
    formula(r"c_\alpha"),
    formula(r"\cos\alpha"),
)
_VECTOR = formula(r"\mathbf{u}")


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
    yield from _passive_motion() if passive else _active_motion()
    yield Paragraph(words("For a vector {} the matrix of {} is", _VECTOR, _operator(_VECTOR)))


def _active_motion() -> Iterator[NoteBlock]:
    spinning = spin_of(ROTATION)
    yield Paragraph(words("A point at rest in the body, {}, has the velocity", ACTIVE))
    yield Equation(
        sides=(
            _VELOCITY,
            row(rate_of(ROTATION), BODY_POSITION),
            row(spinning, POSITION),
        )
    )
    yield Paragraph(
        words(
            "This velocity is also {}\u00a0{}, so that {} is the matrix of the operator "
            "{}\u00a0{}.",
            _cross(SPACE.omega, POSITION),
            Cited(_TURNING),
            spinning,
            _operator(SPACE.omega),
            Cited(_MOTION),
        )
    )


def _passive_motion() -> Iterator[NoteBlock]:
    spinning = spin_of(COSINES)
    yield Paragraph(
        words(
            "A point at rest in space has the body components {}, which change at the rate", PASSIVE
        )
    )
    yield Equation(
        sides=(
            _BODY_VELOCITY,
            row(rate_of(COSINES), POSITION),
            row(spinning, BODY_POSITION),
        )
    )
    yield Paragraph(
        words(
            "As seen from the body, the point moves with the velocity {}, so that {} is the "
            "matrix of the operator {}\u00a0{}.",
            _minus(_cross(BODY.omega, BODY_POSITION)),
            spinning,
            _minus(_operator(BODY.omega)),
            Cited(_MOTION),
        )
    )


def _cross(left: Formula, right: Formula) -> Formula:
    return formula(r"#1\times#2", left, right)


def _operator(vector: Formula) -> Formula:
    return formula(r"#1\times", vector)


def _minus(symbol: Formula) -> Formula:
    return formula("-#1", symbol)


def announcement(equation: Equation, done: Done) -> Text:
    """What a reader has to be told of the way an equation is set, before it; often nothing."""
    if done == "abbreviated":
        return words("With the abbreviations {} for {} and {} for {},", *_SHORTHAND)
    if done == "listed":
        return words("The entries of {} are", equal(*equation.sides))
    return ()


def proofs_in_words(*, is_proved: bool) -> Text:
    """What the table of proofs means by its words."""
    exact = (
        "Each identity was verified exactly, as a polynomial identity in the sines and cosines "
        "using sin² + cos² = 1 (and similar relations for other functions). “Exact” means that "
        "the two sides were shown to be identical."
    )
    unproved = (
        " “Unproved” means that the difference of the two sides was not shown to vanish; it is "
        "given below the table."
    )
    return (exact if is_proved else exact + unproved,)
