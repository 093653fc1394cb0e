r"""The quantities of energy and momentum, one entry each (lecture, eq. 2 and 8 to 14).

A workspace k (`mechanics.body`) has the mass, the centre and the inertia tensor of the body, and
sums over its particles, r = r_C + x with x = R x′ for a place x′ at rest in the body. The sums
follow from the mass and the inertia tensor (`mechanics.particles`).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from rigidsym.formula.reader import formula
from rigidsym.mechanics.derivation import Law, Quantity, by_name, law, when
from rigidsym.mechanics.quantities.mass import AT_REST
from rigidsym.models.rotation import SOURCES

ROTATIONAL = formula("E_R")
MOMENTUM_ROTATION = formula(r"\L_R")
MOMENTUM_BODY = formula(r"\L'_R")
ENERGY, MOMENTUM = "energy", "momentum"  # sections
_SUM = formula(r"{\textstyle\sum_i} m_i")


def _over_particles(claim: str, summand: Callable[[Any], Any], times: int = 1) -> Law:
    """The sum of m times a summand over the particles, #1 in the claim, is `times` the quantity."""
    return law(claim, lambda k, x: k.sum(summand(k)) - k.read(times * x), _SUM)


_ENERGY: dict[str, Any] = {"unit": "J", "shape": "scalar", "section": ENERGY}
_ENERGY["source"] = SOURCES["Landau 32"]
_MOMENTUM: dict[str, Any] = {"unit": "kg m^2/s", "shape": "vector", "section": MOMENTUM}
_OF_CENTRE = {**_MOMENTUM, "source": SOURCES["Goldstein 1.2"], "without": AT_REST}
_OF_ROTATION = {**_MOMENTUM, "source": SOURCES["Landau 33"], "is_result": True}

translational_energy = Quantity(
    **_ENERGY,
    symbol=formula("E_C"),
    inputs=("centre_dot",),
    definition=formula(r"\tfrac{1}{2} M\,|\dot\r_C|^2"),
    value=lambda k: k.half_of_squares(k.velocity),
    laws=(
        _over_particles(r"\tfrac{1}{2} #1\,|\dot\r_C|^2 = E_C", lambda k: k.square(k.velocity), 2),
    ),
    reason="energy_of_centre",
    without=AT_REST,
)

rotational_energy = Quantity(
    **_ENERGY,
    symbol=ROTATIONAL,
    inputs=("q", "q_dot"),
    definition=formula(r"\tfrac{1}{2}\,\Om'^T\,\I'\,\Om'"),
    value=lambda k: k.half_form(k.omega_body),
    laws=(
        law(
            r"\tfrac{1}{2}\,\Om^T\,#1\,\Om = E_R",
            lambda k, x: k.back.T @ k.inertia @ k.back - k.read(2 * x),
            formula(r"(\R\,\I'\,\R^T)"),
        ),
        _over_particles(r"\tfrac{1}{2} #1\,|\dot\x_i|^2 = E_R", lambda k: k.square(k.x_dot), 2),
    ),
    reason="quadratic_form",
    is_result=True,
    variants=(when("fixed_point", meaning="rotational_energy_fixed_point"),),
)

kinetic_energy = Quantity(
    **_ENERGY,
    symbol=formula("E_K"),
    inputs=("q", "q_dot", "centre_dot"),
    definition=formula("E_C + E_R"),
    value=lambda k: k.half_of_squares(k.velocity) + k.half_form(k.omega_body),
    laws=(
        _over_particles(
            r"\tfrac{1}{2} #1\,|\dot\r_i|^2 = E_C + E_R",
            lambda k: k.square(k.velocity + k.x_dot),
            2,
        ),
    ),
    reason="energy_splits",
    is_result=True,
    without=AT_REST,
)

angular_momentum_centre = Quantity(
    **_OF_CENTRE,
    symbol=formula(r"\L_C"),
    inputs=("centre", "centre_dot"),
    definition=formula(r"\r_C\times(M\,\dot\r_C)"),
    value=lambda k: k.present.matrix(k.momentum_of_centre),
    laws=(_over_particles(r"#1\,\r_C\times\dot\r_C = \L_C", lambda k: k.centre.cross(k.velocity)),),
    reason="momentum_of_centre",
)

angular_momentum_rotation_body = Quantity(
    **_OF_ROTATION,
    symbol=MOMENTUM_BODY,
    inputs=("q", "q_dot"),
    definition=formula(r"\I'\Om'"),
    value=lambda k: k.momentum_form_body,
    laws=(
        law(
            r"\L'_R\cdot\Om' = 2 E_R", lambda k, x: k.read(x).T @ k.omega_body - k.twice_rotational
        ),
    ),
    reason="tensor_times_velocity",
)

angular_momentum_rotation = Quantity(
    **_OF_ROTATION,
    symbol=MOMENTUM_ROTATION,
    inputs=("q", "q_dot"),
    definition=formula(r"\I\Om"),
    value=lambda k: k.momentum_form,
    laws=(
        law(r"\I\,\Om = \R\,\L'_R", lambda k, x: k.rotation @ (k.inertia @ k.back) - k.read(x)),
        law(r"\L_R\cdot\Om = 2 E_R", lambda k, x: k.read(x).T @ k.omega_space - k.twice_rotational),
        _over_particles(r"#1\,\x_i\times\dot\x_i = \L_R", lambda k: k.x.cross(k.x_dot)),
    ),
    reason="momentum_rotated",
)

angular_momentum = Quantity(
    **_OF_CENTRE,
    symbol=formula(r"\L"),
    inputs=("q", "q_dot", "centre", "centre_dot"),
    definition=formula(r"\L_C + \L_R"),
    value=lambda k: k.present.matrix(k.momentum_of_centre) + k.momentum_form,
    laws=(
        _over_particles(
            r"#1\,\r_i\times\dot\r_i = \L_C + \L_R",
            lambda k: (k.centre + k.x).cross(k.velocity + k.x_dot),
        ),
    ),
    reason="momentum_splits",
    is_result=True,
)

ENERGY_QUANTITIES = by_name(globals())
