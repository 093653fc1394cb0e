"""The sentences of the note that lead from one equation to the next."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from rigidsym.mechanics.claims import fill, rate_of, spin_of
from rigidsym.mechanics.derivation import Markup
from rigidsym.mechanics.quantities.kinematics import BODY, COSINES, ROTATION, SPACE
from rigidsym.models.rotation import Turn, lecture
from rigidsym.notes.document.document import Block, Cited, Equation, Paragraph, Text
from rigidsym.notes.formula.formula import markup
from rigidsym.notes.formula.notation import Notation
from rigidsym.notes.layout.layout import Done
from rigidsym.notes.prose.words import ACTIVE, BODY_POSITION, PASSIVE, POSITION, equal, words

_TURNING = lecture("3", "section 1.2")
_MOTION = lecture("15", "section 3.2")
_VELOCITY = Markup(r"\dot{\mathbf{x}}", "ẋ")
_BODY_VELOCITY = Markup(r"\dot{\mathbf{x}}'", "ẋ′")
_SHORTHAND = (
    Markup(r"s_\alpha", "s_α"),
    Markup(r"\sin\alpha", "sin α"),
    Markup(r"c_\alpha", "c_α"),
    Markup(r"\cos\alpha", "cos α"),
)
_VECTOR = Markup(r"\mathbf{u}", "u")


def product(factors: Sequence[Markup]) -> Markup:
    return Markup(
        r"\,".join(factor.latex for factor in factors), " ".join(factor.text for factor in factors)
    )


def turn(turn: Turn, notation: Notation) -> Markup:
    """R_z(φ), or R_[0, 3/5, 4/5](φ)."""
    angle = markup(turn.angle, notation)
    axis = axis_of(turn, notation)
    latex = rf"{{{axis.latex}}}" if turn.components else axis.latex
    return fill(r"\mathbf{{R}}_{0}({1})", "R_{0}({1})", Markup(latex, axis.text), angle)


def axis_of(turn: Turn, notation: Notation) -> Markup:
    """The axis of a turn: its letter, or its components."""
    if not turn.components:
        return Markup(turn.axis, turn.axis)
    parts = [markup(part, notation) for part in turn.components]
    latex, text = (", ".join(getattr(part, kind) for part in parts) for kind in ("latex", "text"))
    return Markup(f"[{latex}]", f"[{text}]")


def motion(*, passive: bool) -> Iterator[Block]:
    """Why the derivative times the transpose is the operator of the angular velocity."""
    yield from _passive_motion() if passive else _active_motion()
    yield Paragraph(words("For a vector {} the matrix of {} is", _VECTOR, _operator(_VECTOR)))


def _active_motion() -> Iterator[Block]:
    spinning = spin_of(ROTATION)
    yield Paragraph(words("A point at rest in the body, {}, has the velocity", ACTIVE))
    yield Equation(
        sides=(
            _VELOCITY,
            product([rate_of(ROTATION), BODY_POSITION]),
            product([spinning, POSITION]),
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


def _passive_motion() -> Iterator[Block]:
    spinning = spin_of(COSINES)
    yield Paragraph(
        words("A point at rest in space has the body components {}, which change by", PASSIVE)
    )
    yield Equation(
        sides=(
            _BODY_VELOCITY,
            product([rate_of(COSINES), POSITION]),
            product([spinning, BODY_POSITION]),
        )
    )
    yield Paragraph(
        words(
            "Seen from the body it turns backwards, by {}, so that {} is the matrix of the "
            "operator {}\u00a0{}.",
            _minus(_cross(BODY.omega, BODY_POSITION)),
            spinning,
            _minus(_operator(BODY.omega)),
            Cited(_MOTION),
        )
    )


def _cross(left: Markup, right: Markup) -> Markup:
    return fill(r"{0}\times{1}", "{0} × {1}", left, right)


def _operator(vector: Markup) -> Markup:
    return fill(r"{0}\times", "{0} ×", vector)


def _minus(symbol: Markup) -> Markup:
    return fill("-{0}", "−{0}", symbol)


def announcement(equation: Equation, done: Done) -> Text:
    """What a reader has to be told of the way an equation is set, before it; often nothing."""
    if done == "abbreviated":
        return words("In short, with {} for {} and {} for {} of any angle,", *_SHORTHAND)
    if done == "listed":
        return words("The entries of {} are", equal(*equation.sides))
    return ()


def proofs_in_words(*, is_proved: bool) -> Text:
    """What the table of proofs means by its words."""
    exact = (
        "Each claim was put to the ring of polynomials in which the derivation was made, modulo "
        "the relations between its generators, such as that of sine and cosine. It is exact where "
        "the difference of its two sides reduces to zero there."
    )
    unproved = (
        " It is unproved where something is left over and the relations that are known do not "
        "decide whether that is zero; then it is shown below the table."
    )
    return (exact if is_proved else exact + unproved,)
