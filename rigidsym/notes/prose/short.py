"""Long quantities in short: not by their components, but by what they are made of."""

from __future__ import annotations

from rigidsym.mechanics.claims import fill, transpose_of
from rigidsym.mechanics.derivation import Derivation, Markup, Step
from rigidsym.mechanics.quantities.kinematics import BODY, COSINES, RATES, ROTATION, SPACE, Frame
from rigidsym.models.rotation import RotationModel
from rigidsym.notes.formula.notation import Notation
from rigidsym.notes.formula.vector_rates import rate_of_form
from rigidsym.notes.prose.prose import product, turn
from rigidsym.notes.prose.vector_words import sum_of_vectors

_DEFINED = frozenset(  # by other quantities, and so are rates from an angular velocity
    {
        "spin_matrix",
        "inertia_tensor_space",
        "rotational_energy",
        "kinetic_energy",
        "angular_momentum_rotation_body",
        "angular_momentum_rotation",
        "angular_momentum",
    }
)
_ACCELERATIONS = Markup(r"\ddot{\mathbf{q}}", "q\u0308")
_FRAMES = {frame.name: frame for frame in (SPACE, BODY)}


def in_short(step: Step, derivation: Derivation, notation: Notation) -> tuple[Markup, ...] | None:
    """What a quantity is equal to, by other quantities; None where it is known by itself alone."""
    kind, _, frame = step.quantity.name.rpartition("_")
    if step.quantity.name == "rotation_matrix" and derivation.model.turns:
        return (_turns(derivation.model, notation),)
    if step.quantity.name == "rotation_rate":
        return (_poisson(passive=derivation.model.passive),)
    if step.quantity.name in _DEFINED or kind == "rates_from_angular_velocity":
        return ()
    if kind == "inverse_rate_matrix" and _is_least(derivation):
        return (_least(_FRAMES[frame]),)
    if kind == "angular_acceleration":
        return (_acceleration(derivation, _FRAMES[frame], notation),)
    return None


def _turns(model: RotationModel, notation: Notation) -> Markup:
    """R_z(φ) R_x(θ) R_z(ψ), and its transpose for A."""
    whole = product([turn(each, notation) for each in model.turns])
    if not model.passive:
        return whole
    return fill(r"\left({0}\right)^{{\mathsf T}}", "({0})ᵀ", whole)


def _poisson(*, passive: bool) -> Markup:
    """dR/dt = C(Ω) R, and dA/dt = −C(Ω′) A."""
    if passive:
        return fill(r"-\mathbf{{C}}({0})\,{1}", "−C({0}) {1}", BODY.omega, COSINES)
    return fill(r"\mathbf{{C}}({0})\,{1}", "C({0}) {1}", SPACE.omega, ROTATION)


def _is_least(derivation: Derivation) -> bool:
    """Whether the right inverse is that of least norm: nothing binds the rates."""
    return len(derivation.model.coordinates) > 3 and not derivation.model.constraints


def _least(frame: Frame) -> Markup:
    """Wᵀ (W Wᵀ)⁻¹."""
    latex, text = r"{1}\left({0}{1}\right)^{{-1}}", "{1} ({0} {1})⁻¹"
    return fill(latex, text, frame.matrix, transpose_of(frame.matrix))


def _acceleration(derivation: Derivation, frame: Frame, notation: Notation) -> Markup:
    """The derivative of the vector form of Ω, or Ẇ q̇ + W q̈."""
    names = [step.quantity.name for step in derivation.steps]
    velocity = f"angular_velocity_{frame.name}"
    form = derivation.step(velocity).vector_form if velocity in names else None
    if form is not None and notation.length is not None:
        return sum_of_vectors(rate_of_form(form, notation.length.rate), notation)
    latex, text = r"{0}\,{1} + \frac{{d{0}}}{{dt}}\,{2}", "{0} {1} + d{0}/dt {2}"
    return fill(latex, text, frame.matrix, _ACCELERATIONS, RATES)
