"""The quantities of energy and momentum: a new one is an entry here and in `energy.derive`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rigidsym.mechanics.claims import fill, transpose_of
from rigidsym.mechanics.derivation import Markup
from rigidsym.mechanics.quantities.kinematics import BODY, ROTATION, SPACE
from rigidsym.mechanics.quantities.mass import INERTIA, INERTIA_SPACE, MASS
from rigidsym.mechanics.quantities.table import read_table

if TYPE_CHECKING:
    from rigidsym.models.body import RigidBody

CENTRE = Markup(r"\mathbf{r}_C", "r_C")
CENTRE_VELOCITY = Markup(r"\dot{\mathbf{r}}_C", "ṙ_C")
KINETIC = Markup("E_K", "E_K")
TRANSLATIONAL = Markup("E_C", "E_C")
ROTATIONAL = Markup("E_R", "E_R")
MOMENTUM = Markup(r"\mathbf{L}", "L")
MOMENTUM_CENTRE = Markup(r"\mathbf{L}_C", "L_C")
MOMENTUM_ROTATION = Markup(r"\mathbf{L}_R", "L_R")
MOMENTUM_BODY = Markup(r"\mathbf{L}'_R", "L′_R")


def half_product(omega: Markup, inertia: Markup) -> Markup:
    """½ Ωᵀ I Ω."""
    return fill(
        r"\tfrac{{1}}{{2}}\,{0}\,{1}\,{2}", "½ {0} {1} {2}", transpose_of(omega), inertia, omega
    )


def _sum(first: Markup, second: Markup) -> Markup:
    return fill("{0} + {1}", "{0} + {1}", first, second)


def _product(matrix: Markup, vector: Markup) -> Markup:
    return fill("{0}{1}", "{0} {1}", matrix, vector)


_HALF_SQUARE = fill(r"\tfrac{{1}}{{2}} {0}\,|{1}|^2", "½ {0} |{1}|²", MASS, CENTRE_VELOCITY)
_ARM = fill(r"{0}\times({1}\,{2})", "{0} × ({1} {2})", CENTRE, MASS, CENTRE_VELOCITY)

ENERGY_QUANTITIES = read_table(
    """
    translational_energy            scalar  J         centre_dot                    1.1 (2)
        kinetic energy of the mass in the centre of mass
    rotational_energy               scalar  J         q q_dot                       2.1 (8)
        kinetic energy of the rotation about the centre of mass
    kinetic_energy                  scalar  J         q q_dot centre_dot            1.1 (2)
        kinetic energy
    angular_momentum_centre         vector  kg m^2/s  centre centre_dot             3.1 (12)
        angular momentum of the mass in the centre of mass, space components
    angular_momentum_rotation_body  vector  kg m^2/s  q q_dot                       3.1 (14)
        angular momentum of the rotation, body components
    angular_momentum_rotation       vector  kg m^2/s  q q_dot                       3.1 (13)
        angular momentum of the rotation, space components
    angular_momentum                vector  kg m^2/s  q q_dot centre centre_dot     3.1 (11)
        angular momentum about the origin, space components
    """,
    {
        "translational_energy": (TRANSLATIONAL, _HALF_SQUARE),
        "rotational_energy": (ROTATIONAL, half_product(BODY.omega, INERTIA)),
        "kinetic_energy": (KINETIC, _sum(TRANSLATIONAL, ROTATIONAL)),
        "angular_momentum_centre": (MOMENTUM_CENTRE, _ARM),
        "angular_momentum_rotation_body": (MOMENTUM_BODY, _product(INERTIA, BODY.omega)),
        "angular_momentum_rotation": (MOMENTUM_ROTATION, _product(INERTIA_SPACE, SPACE.omega)),
        "angular_momentum": (MOMENTUM, _sum(MOMENTUM_CENTRE, MOMENTUM_ROTATION)),
    },
)
MOMENTA = tuple(name for name in ENERGY_QUANTITIES if name.startswith("angular_momentum"))
ENERGIES = tuple(name for name in ENERGY_QUANTITIES if name not in MOMENTA)


def body_in_words(body: RigidBody | None) -> tuple[str, ...]:
    """A body in plain sentences, to follow the convention of its rotation."""
    if body is None:
        return ()
    return (
        f"{body.title}, of mass {body.mass}; its inertia tensor is about the centre of mass, "
        "along the axes of x′.",
        "The centre of mass is at r_C = (X, Y, Z) in space.",
    )


# Claims.

_PARTICLE = Markup(r"\mathbf{x}_i", "xᵢ")
_PARTICLE_VELOCITY = Markup(r"\dot{\mathbf{x}}_i", "ẋᵢ")
_POSITION = Markup(r"\mathbf{r}_i", "rᵢ")
_VELOCITY = Markup(r"\dot{\mathbf{r}}_i", "ṙᵢ")
_SUM = Markup(r"{\textstyle\sum_i} m_i", "Σ mᵢ")


def _equal(first: Markup, second: Markup) -> Markup:
    return fill("{0} = {1}", "{0} = {1}", first, second)


def _half_sum(velocity: Markup) -> Markup:
    """½ Σ mᵢ |v|²."""
    return fill(r"\tfrac{{1}}{{2}} {0}\,|{1}|^2", "½ {0} |{1}|²", _SUM, velocity)


def _crossed_sum(position: Markup, velocity: Markup) -> Markup:
    """Σ mᵢ x × v."""
    return fill(r"{0}\,{1}\times{2}", "{0} {1} × {2}", _SUM, position, velocity)


def _twice_energy(momentum: Markup, omega: Markup) -> Markup:
    return fill(r"{0}\cdot{1} = 2 {2}", "{0} · {1} = 2 {2}", momentum, omega, ROTATIONAL)


_ROTATED = fill(r"({0}\,{1}\,{2})", "({0} {1} {2})", ROTATION, INERTIA, transpose_of(ROTATION))
TRANSLATION_OF_PARTICLES = _equal(_half_sum(CENTRE_VELOCITY), TRANSLATIONAL)
BOTH_FORMS = _equal(half_product(SPACE.omega, _ROTATED), ROTATIONAL)
ROTATION_OF_PARTICLES = _equal(_half_sum(_PARTICLE_VELOCITY), ROTATIONAL)
ENERGY_SPLITS = _equal(_half_sum(_VELOCITY), _sum(TRANSLATIONAL, ROTATIONAL))
NO_CROSS_TERM = fill(r"{0}\,{1} = \mathbf{{0}}", "{0} {1} = 0", _SUM, _PARTICLE_VELOCITY)
MOMENTUM_OF_CENTRE = _equal(_crossed_sum(CENTRE, CENTRE_VELOCITY), MOMENTUM_CENTRE)
TWICE_ENERGY_BODY = _twice_energy(MOMENTUM_BODY, BODY.omega)
TWICE_ENERGY = _twice_energy(MOMENTUM_ROTATION, SPACE.omega)
MOMENTUM_TURNS = fill(
    r"{0}\,{1} = {2}\,{3}",
    "{0} {1} = {2} {3}",
    *(INERTIA_SPACE, SPACE.omega, ROTATION, MOMENTUM_BODY),
)
MOMENTUM_OF_PARTICLES = _equal(_crossed_sum(_PARTICLE, _PARTICLE_VELOCITY), MOMENTUM_ROTATION)
MOMENTUM_SPLITS = _equal(
    _crossed_sum(_POSITION, _VELOCITY), _sum(MOMENTUM_CENTRE, MOMENTUM_ROTATION)
)
