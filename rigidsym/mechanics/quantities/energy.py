"""The quantities of energy and momentum: a new one is an entry here and in `energy.derive`."""

from __future__ import annotations

import re
from itertools import filterfalse

from rigidsym.formula.reader import formula
from rigidsym.formula.tree import transpose_of
from rigidsym.mechanics.quantities.kinematics import BODY, ROTATION, SPACE
from rigidsym.mechanics.quantities.mass import INERTIA, INERTIA_SPACE, MASS
from rigidsym.mechanics.quantities.table import read_table

CENTRE = formula(r"\mathbf{r}_C")
CENTRE_VELOCITY = formula(r"\dot{\mathbf{r}}_C")
KINETIC = formula("E_K")
TRANSLATIONAL = formula("E_C")
ROTATIONAL = formula("E_R")
MOMENTUM = formula(r"\mathbf{L}")
MOMENTUM_CENTRE = formula(r"\mathbf{L}_C")
MOMENTUM_ROTATION = formula(r"\mathbf{L}_R")
MOMENTUM_BODY = formula(r"\mathbf{L}'_R")


_HALF_PRODUCT = r"\tfrac{1}{2}\,#1\,#2\,#3"  # ½ Ωᵀ I Ω
_OF_BODY = formula(_HALF_PRODUCT, transpose_of(BODY.omega), INERTIA, BODY.omega)
_HALF_SQUARE = formula(r"\tfrac{1}{2} #1\,|#2|^2", MASS, CENTRE_VELOCITY)
_ARM = formula(r"#1\times(#2\,#3)", CENTRE, MASS, CENTRE_VELOCITY)

ENERGY_QUANTITIES = read_table(
    """
    translational_energy            scalar  J         centre_dot                    Landau 32
        kinetic energy of the motion of the centre of mass
    rotational_energy               scalar  J         q q_dot                       Landau 32
        kinetic energy of the rotation about the centre of mass
    kinetic_energy                  scalar  J         q q_dot centre_dot            Landau 32
        kinetic energy
    angular_momentum_centre         vector  kg m^2/s  centre centre_dot             Goldstein 1.2
        angular momentum of the motion of the centre of mass, space components
    angular_momentum_rotation_body  vector  kg m^2/s  q q_dot                       Landau 33
        angular momentum of the rotation, body components
    angular_momentum_rotation       vector  kg m^2/s  q q_dot                       Landau 33
        angular momentum of the rotation, space components
    angular_momentum                vector  kg m^2/s  q q_dot centre centre_dot     Goldstein 1.2
        angular momentum about the origin, space components
    """,
    {
        "translational_energy": (TRANSLATIONAL, _HALF_SQUARE),
        "rotational_energy": (ROTATIONAL, _OF_BODY),
        "kinetic_energy": (KINETIC, formula("#1 + #2", TRANSLATIONAL, ROTATIONAL)),
        "angular_momentum_centre": (MOMENTUM_CENTRE, _ARM),
        "angular_momentum_rotation_body": (MOMENTUM_BODY, formula("#1#2", INERTIA, BODY.omega)),
        "angular_momentum_rotation": (
            MOMENTUM_ROTATION,
            formula("#1#2", INERTIA_SPACE, SPACE.omega),
        ),
        "angular_momentum": (MOMENTUM, formula("#1 + #2", MOMENTUM_CENTRE, MOMENTUM_ROTATION)),
    },
)
MOMENTA = tuple(filter(re.compile("angular_momentum").match, ENERGY_QUANTITIES))
ENERGIES = tuple(filterfalse(MOMENTA.__contains__, ENERGY_QUANTITIES))


# Claims.

_PARTICLE = formula(r"\mathbf{x}_i")
_PARTICLE_VELOCITY = formula(r"\dot{\mathbf{x}}_i")
_POSITION = formula(r"\mathbf{r}_i")
_VELOCITY = formula(r"\dot{\mathbf{r}}_i")
_SUM = formula(r"{\textstyle\sum_i} m_i")


_ROTATED = formula(r"(#1\,#2\,#3)", ROTATION, INERTIA, transpose_of(ROTATION))
_HALF_SUM, _ARMS = r"\tfrac{1}{2} #1\,|#2|^2", r"#1\,#2\times#3"  # ½ Σ mᵢ |v|², Σ mᵢ x × v
TRANSLATION_OF_PARTICLES = formula(f"{_HALF_SUM} = #3", _SUM, CENTRE_VELOCITY, TRANSLATIONAL)
BOTH_FORMS = formula(
    f"{_HALF_PRODUCT} = #4", transpose_of(SPACE.omega), _ROTATED, SPACE.omega, ROTATIONAL
)
ROTATION_OF_PARTICLES = formula(f"{_HALF_SUM} = #3", _SUM, _PARTICLE_VELOCITY, ROTATIONAL)
ENERGY_SPLITS = formula(f"{_HALF_SUM} = #3 + #4", _SUM, _VELOCITY, TRANSLATIONAL, ROTATIONAL)
MOMENTUM_OF_CENTRE = formula(f"{_ARMS} = #4", _SUM, CENTRE, CENTRE_VELOCITY, MOMENTUM_CENTRE)
TWICE_ENERGY_BODY = formula(r"#1\cdot#2 = 2 #3", MOMENTUM_BODY, BODY.omega, ROTATIONAL)
TWICE_ENERGY = formula(r"#1\cdot#2 = 2 #3", MOMENTUM_ROTATION, SPACE.omega, ROTATIONAL)
MOMENTUM_TURNS = formula(r"#1\,#2 = #3\,#4", INERTIA_SPACE, SPACE.omega, ROTATION, MOMENTUM_BODY)
MOMENTUM_OF_PARTICLES = formula(
    f"{_ARMS} = #4", _SUM, _PARTICLE, _PARTICLE_VELOCITY, MOMENTUM_ROTATION
)
MOMENTUM_SPLITS = formula(
    f"{_ARMS} = #4 + #5", _SUM, _POSITION, _VELOCITY, MOMENTUM_CENTRE, MOMENTUM_ROTATION
)
