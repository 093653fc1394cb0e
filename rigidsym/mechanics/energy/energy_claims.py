"""What is proved of energies and momenta, as formulas for both ways of printing."""

from __future__ import annotations

from rigidsym.mechanics.claims import fill, transpose_of
from rigidsym.mechanics.derivation import Markup
from rigidsym.mechanics.quantities.energy import (
    CENTRE,
    CENTRE_VELOCITY,
    INERTIA,
    INERTIA_SPACE,
    MOMENTUM_BODY,
    MOMENTUM_CENTRE,
    MOMENTUM_ROTATION,
    ROTATIONAL,
    TRANSLATIONAL,
    half_product,
)
from rigidsym.mechanics.quantities.kinematics import BODY, ROTATION, SPACE

PARTICLE = Markup(r"\mathbf{x}_i", "xᵢ")
PARTICLE_VELOCITY = Markup(r"\dot{\mathbf{x}}_i", "ẋᵢ")
POSITION = Markup(r"\mathbf{r}_i", "rᵢ")
VELOCITY = Markup(r"\dot{\mathbf{r}}_i", "ṙᵢ")
SUM = Markup(r"{\textstyle\sum_i} m_i", "Σ mᵢ")


def half_sum(velocity: Markup) -> Markup:
    """½ Σ mᵢ |v|²."""
    return fill(r"\tfrac{{1}}{{2}} {0}\,|{1}|^2", "½ {0} |{1}|²", SUM, velocity)


def crossed_sum(position: Markup, velocity: Markup) -> Markup:
    """Σ mᵢ x × v."""
    return fill(r"{0}\,{1}\times{2}", "{0} {1} × {2}", SUM, position, velocity)


def _equal(first: Markup, second: Markup) -> Markup:
    return fill("{0} = {1}", "{0} = {1}", first, second)


def translation_of_particles() -> Markup:
    return _equal(half_sum(CENTRE_VELOCITY), TRANSLATIONAL)


def both_forms() -> Markup:
    """½ Ωᵀ I Ω = ½ Ω′ᵀ I′ Ω′ with I = R I′ Rᵀ."""
    turned = fill(r"({0}\,{1}\,{2})", "({0} {1} {2})", ROTATION, INERTIA, transpose_of(ROTATION))
    return _equal(half_product(SPACE.omega, turned), ROTATIONAL)


def rotation_of_particles() -> Markup:
    return _equal(half_sum(PARTICLE_VELOCITY), ROTATIONAL)


def energy_splits() -> Markup:
    return _equal(half_sum(VELOCITY), fill("{0} + {1}", "{0} + {1}", TRANSLATIONAL, ROTATIONAL))


def no_cross_term() -> Markup:
    return fill(r"{0}\,{1} = \mathbf{{0}}", "{0} {1} = 0", SUM, PARTICLE_VELOCITY)


def momentum_of_centre() -> Markup:
    return _equal(crossed_sum(CENTRE, CENTRE_VELOCITY), MOMENTUM_CENTRE)


def twice_energy_body() -> Markup:
    return fill(r"{0}\cdot{1} = 2 {2}", "{0} · {1} = 2 {2}", MOMENTUM_BODY, BODY.omega, ROTATIONAL)


def twice_energy() -> Markup:
    return fill(
        r"{0}\cdot{1} = 2 {2}", "{0} · {1} = 2 {2}", MOMENTUM_ROTATION, SPACE.omega, ROTATIONAL
    )


def momentum_turns() -> Markup:
    return fill(
        r"{0}\,{1} = {2}\,{3}",
        "{0} {1} = {2} {3}",
        INERTIA_SPACE,
        SPACE.omega,
        ROTATION,
        MOMENTUM_BODY,
    )


def momentum_of_particles() -> Markup:
    return _equal(crossed_sum(PARTICLE, PARTICLE_VELOCITY), MOMENTUM_ROTATION)


def momentum_splits() -> Markup:
    whole = fill("{0} + {1}", "{0} + {1}", MOMENTUM_CENTRE, MOMENTUM_ROTATION)
    return _equal(crossed_sum(POSITION, VELOCITY), whole)
