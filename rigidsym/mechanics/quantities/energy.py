"""The quantities of energy and momentum: names, symbols, units and what they follow from."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING

from rigidsym.mechanics.claims import fill, transpose_of
from rigidsym.mechanics.derivation import Markup, Quantity
from rigidsym.mechanics.quantities.kinematics import BODY, SPACE
from rigidsym.models.rotation import lecture

if TYPE_CHECKING:
    from rigidsym.models.body import RigidBody

INERTIA = Markup(r"\mathbf{I}'", "I′")
INERTIA_SPACE = Markup(r"\mathbf{I}", "I")
CENTRE = Markup(r"\mathbf{r}_C", "r_C")
CENTRE_VELOCITY = Markup(r"\dot{\mathbf{r}}_C", "ṙ_C")
KINETIC = Markup("E_K", "E_K")
TRANSLATIONAL = Markup("E_C", "E_C")
ROTATIONAL = Markup("E_R", "E_R")
MOMENTUM = Markup(r"\mathbf{L}", "L")
MOMENTUM_CENTRE = Markup(r"\mathbf{L}_C", "L_C")
MOMENTUM_ROTATION = Markup(r"\mathbf{L}_R", "L_R")
MOMENTUM_BODY = Markup(r"\mathbf{L}'_R", "L′_R")
MASS = Markup("M", "M")

_CENTRE, _Q = ("centre", "centre_dot"), ("q", "q_dot")
_JOULE, _MOMENTUM = "J", "kg m^2/s"


def half_product(omega: Markup, inertia: Markup) -> Markup:
    """½ Ωᵀ I Ω."""
    return fill(
        r"\tfrac{{1}}{{2}}\,{0}\,{1}\,{2}", "½ {0} {1} {2}", transpose_of(omega), inertia, omega
    )


def _table() -> tuple[Quantity, ...]:
    return (
        Quantity(
            name="translational_energy",
            symbol=TRANSLATIONAL,
            definition=fill(
                r"\tfrac{{1}}{{2}} {0}\,|{1}|^2", "½ {0} |{1}|²", MASS, CENTRE_VELOCITY
            ),
            about="kinetic energy of the mass in the centre of mass",
            unit=_JOULE,
            inputs=("centre_dot",),
            is_scalar=True,
            source=lecture("2", "section 1.1"),
        ),
        Quantity(
            name="rotational_energy",
            symbol=ROTATIONAL,
            definition=half_product(BODY.omega, INERTIA),
            about="kinetic energy of the rotation about the centre of mass",
            unit=_JOULE,
            inputs=_Q,
            is_scalar=True,
            source=lecture("8", "section 2.1"),
        ),
        Quantity(
            name="kinetic_energy",
            symbol=KINETIC,
            definition=fill("{0} + {1}", "{0} + {1}", TRANSLATIONAL, ROTATIONAL),
            about="kinetic energy",
            unit=_JOULE,
            inputs=(*_Q, "centre_dot"),
            is_scalar=True,
            source=lecture("2", "section 1.1"),
        ),
        Quantity(
            name="angular_momentum_centre",
            symbol=MOMENTUM_CENTRE,
            definition=fill(
                r"{0}\times({1}\,{2})", "{0} × ({1} {2})", CENTRE, MASS, CENTRE_VELOCITY
            ),
            about="angular momentum of the mass in the centre of mass, space components",
            unit=_MOMENTUM,
            inputs=_CENTRE,
            is_vector=True,
            source=lecture("12", "section 3.1"),
        ),
        Quantity(
            name="angular_momentum_rotation_body",
            symbol=MOMENTUM_BODY,
            definition=fill("{0}{1}", "{0} {1}", INERTIA, BODY.omega),
            about="angular momentum of the rotation, body components",
            unit=_MOMENTUM,
            inputs=_Q,
            is_vector=True,
            source=lecture("14", "section 3.1"),
        ),
        Quantity(
            name="angular_momentum_rotation",
            symbol=MOMENTUM_ROTATION,
            definition=fill("{0}{1}", "{0} {1}", INERTIA_SPACE, SPACE.omega),
            about="angular momentum of the rotation, space components",
            unit=_MOMENTUM,
            inputs=_Q,
            is_vector=True,
            source=lecture("13", "section 3.1"),
        ),
        Quantity(
            name="angular_momentum",
            symbol=MOMENTUM,
            definition=fill("{0} + {1}", "{0} + {1}", MOMENTUM_CENTRE, MOMENTUM_ROTATION),
            about="angular momentum about the origin, space components",
            unit=_MOMENTUM,
            inputs=(*_Q, *_CENTRE),
            is_vector=True,
            source=lecture("11", "section 3.1"),
        ),
    )


def body_in_words(body: RigidBody | None) -> tuple[str, ...]:
    """What is said of a body beside the convention of its rotation, in plain sentences."""
    if body is None:
        return ()
    return (
        f"{body.title}, of mass {body.mass}; its inertia tensor is about the centre of mass, "
        "along the axes of x′.",
        "The centre of mass is at r_C = (X, Y, Z) in space.",
    )


ENERGY_QUANTITIES: Mapping[str, Quantity] = MappingProxyType({q.name: q for q in _table()})
MOMENTA = tuple(name for name in ENERGY_QUANTITIES if name.startswith("angular_momentum"))
ENERGIES = tuple(name for name in ENERGY_QUANTITIES if name not in MOMENTA)
