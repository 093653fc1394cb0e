"""Long quantities in short: not by their components, but by what they are made of."""

from __future__ import annotations

from rigidsym.formula.letters import TIME, Letters
from rigidsym.formula.reader import formula
from rigidsym.formula.tree import (
    PLUS,
    Differential,
    Formula,
    Fraction,
    Rate,
    Row,
    joined,
    row,
    transpose_of,
)
from rigidsym.mechanics.derivation import Derivation, Step
from rigidsym.mechanics.quantities.energy import MOMENTUM_BODY
from rigidsym.mechanics.quantities.kinematics import BODY, RATES, ROTATION, SPACE, Frame
from rigidsym.models.rotation import RotationModel
from rigidsym.notes.formula.vector_rates import rates_of_form
from rigidsym.notes.prose.prose import turn
from rigidsym.notes.prose.vector_words import in_notation, sum_of_vectors

_DEFINED = frozenset(  # by other quantities, and so are rates from an angular velocity
    {
        "spin_matrix",
        "inertia_tensor_space",
        "rotational_energy",
        "kinetic_energy",
        "angular_momentum_rotation_body",
        "angular_momentum",
    }
)
_ACCELERATIONS = formula(r"\ddot{\mathbf{q}}")
_FRAMES = {"space": SPACE, "body": BODY}


def in_short(step: Step, derivation: Derivation, letters: Letters) -> tuple[Formula, ...] | None:
    """What a quantity is equal to, by other quantities; None where it is known by itself alone."""
    kind, _, frame = step.quantity.name.rpartition("_")
    if step.quantity.name == "rotation_matrix" and derivation.model.turns:
        return (_turns(derivation.model, letters),)
    if step.quantity.name == "rotation_rate":
        return (by_the_chain_rule(step.quantity.symbol, letters),)
    if step.quantity.name == "angular_momentum_rotation":
        return (row(ROTATION, MOMENTUM_BODY),)
    if step.quantity.name in _DEFINED or kind == "rates_from_angular_velocity":
        return ()
    if kind == "inverse_rate_matrix" and _is_least(derivation):
        return (_least(_FRAMES[frame]),)
    if kind == "angular_acceleration":
        return (_acceleration(derivation, _FRAMES[frame], letters),)
    return None


def _turns(model: RotationModel, letters: Letters) -> Formula:
    """R_z(φ) R_x(θ) R_z(ψ), and its transpose for A."""
    whole = row(*(turn(each, letters) for each in model.turns))
    if not model.passive:
        return whole
    return formula(r"\left(#1\right)^{\mathsf T}", whole)


def by_the_chain_rule(rate: Formula, letters: Letters) -> Formula:
    """dR/dt = φ̇ ∂R/∂φ + ..., which is what its entries come from."""
    coordinates = [q for q, (order, k) in letters.places.items() if order == 0 and k >= 0]
    above = Row((Differential("∂"), rate.of if isinstance(rate, Rate) else rate))
    terms = [
        row(letters.name(q.diff(TIME)), Fraction(above, row(Differential("∂"), letters.name(q))))
        for q in coordinates
    ]
    return joined(terms, PLUS)


def _is_least(derivation: Derivation) -> bool:
    """Whether the right inverse is that of least norm: nothing binds the rates."""
    return len(derivation.model.coordinates) > 3 and not derivation.model.constraints


def _least(frame: Frame) -> Formula:
    """Wᵀ (W Wᵀ)⁻¹."""
    return formula(r"#2\,(#1#2)^{-1}", frame.matrix, transpose_of(frame.matrix))


def _acceleration(derivation: Derivation, frame: Frame, letters: Letters) -> Formula:
    """The derivative of the vector form of Ω, or Ẇ q̇ + W q̈."""
    names = [step.quantity.name for step in derivation.steps]
    velocity = f"angular_velocity_{frame.name}"
    form = derivation.step(velocity).vector_form if velocity in names else None
    if form is not None and letters.length is not None:
        rates = rates_of_form(in_notation(form, letters.length), letters.length.rate)
        return min((sum_of_vectors(rate, letters) for rate in rates), key=lambda f: len(f.text))
    return formula(r"#1\,#2 + #4\,#3", frame.matrix, _ACCELERATIONS, RATES, Rate(frame.matrix))
