r"""The quantities of energy and momentum, one entry each (lecture, eq. 2 and 8 to 14).

A workspace k (`mechanics.body`) has the mass, the centre and the inertia tensor of the body, and
sums over its particles, r = r_C + x with x = R x′ for a place x′ at rest in the body. The sums
follow from the mass and the inertia tensor (`mechanics.particles`).
"""

from __future__ import annotations

from rigidsym.formula.reader import formula
from rigidsym.mechanics.derivation import Law, Quantity, by_name, when
from rigidsym.models.rotation import SOURCES

CENTRE = formula(r"\mathbf{r}_C")
ROTATIONAL = formula("E_R")
MOMENTUM_ROTATION = formula(r"\mathbf{L}_R")
MOMENTUM_BODY = formula(r"\mathbf{L}'_R")
ENERGY, MOMENTUM = "energy", "momentum"  # sections
_SUM = formula(r"{\textstyle\sum_i} m_i")
_IN_SUMMARY = {ENERGY: "The kinetic energy", MOMENTUM: "The angular momentum"}

translational_energy = Quantity(
    name="translational_energy",
    symbol=formula("E_C"),
    about="kinetic energy of the motion of the centre of mass",
    unit="J",
    inputs=("centre_dot",),
    shape="scalar",
    definition=formula(r"\tfrac{1}{2} M\,|\dot{\mathbf{r}}_C|^2"),
    source=SOURCES["Landau 32"],
    value=lambda k: k.half_of_squares(k.velocity),
    laws=(
        Law(
            formula(r"\tfrac{1}{2} #1\,|\dot{\mathbf{r}}_C|^2 = E_C", _SUM),
            lambda k, x: k.sum(k.square(k.velocity)) - k.read(2 * x),
        ),
    ),
    reason="energy_of_centre",
    section=ENERGY,
    group=_IN_SUMMARY[ENERGY],
    of_centre=True,
)

rotational_energy = Quantity(
    name="rotational_energy",
    symbol=ROTATIONAL,
    about="kinetic energy of the rotation about the centre of mass",
    unit="J",
    inputs=("q", "q_dot"),
    shape="scalar",
    definition=formula(
        r"\tfrac{1}{2}\,\boldsymbol{\Omega}'^{\mathsf T}\,\mathbf{I}'\,\boldsymbol{\Omega}'"
    ),
    source=SOURCES["Landau 32"],
    value=lambda k: k.half_form(k.omega_body),
    laws=(
        Law(
            formula(
                r"\tfrac{1}{2}\,\boldsymbol{\Omega}^{\mathsf T}\,"
                r"#1\,\boldsymbol{\Omega} = E_R",
                formula(r"(\mathbf{R}\,\mathbf{I}'\,\mathbf{R}^{\mathsf T})"),
            ),
            lambda k, x: k.back.T @ k.inertia @ k.back - k.read(2 * x),
        ),
        Law(
            formula(r"\tfrac{1}{2} #1\,|\dot{\mathbf{x}}_i|^2 = E_R", _SUM),
            lambda k, x: k.sum(k.square(k.x_dot)) - k.read(2 * x),
        ),
    ),
    reason="quadratic_form",
    section=ENERGY,
    group=_IN_SUMMARY[ENERGY],
    is_result=True,
    variants=(when("fixed_point", about="kinetic energy of the rotation about the fixed point"),),
)

kinetic_energy = Quantity(
    name="kinetic_energy",
    symbol=formula("E_K"),
    about="kinetic energy",
    unit="J",
    inputs=("q", "q_dot", "centre_dot"),
    shape="scalar",
    definition=formula("E_C + E_R"),
    source=SOURCES["Landau 32"],
    value=lambda k: k.half_of_squares(k.velocity) + k.half_form(k.omega_body),
    laws=(
        Law(
            formula(r"\tfrac{1}{2} #1\,|\dot{\mathbf{r}}_i|^2 = E_C + E_R", _SUM),
            lambda k, x: k.sum(k.square(k.velocity + k.x_dot)) - k.read(2 * x),
        ),
    ),
    reason="energy_splits",
    section=ENERGY,
    group=_IN_SUMMARY[ENERGY],
    is_result=True,
    of_centre=True,
)

angular_momentum_centre = Quantity(
    name="angular_momentum_centre",
    symbol=formula(r"\mathbf{L}_C"),
    about="angular momentum of the motion of the centre of mass, space components",
    unit="kg m^2/s",
    inputs=("centre", "centre_dot"),
    shape="vector",
    definition=formula(r"\mathbf{r}_C\times(M\,\dot{\mathbf{r}}_C)"),
    source=SOURCES["Goldstein 1.2"],
    value=lambda k: k.momentum_of_centre,
    laws=(
        Law(
            formula(r"#1\,\mathbf{r}_C\times\dot{\mathbf{r}}_C = \mathbf{L}_C", _SUM),
            lambda k, x: k.sum(k.centre.cross(k.velocity)) - x,
        ),
    ),
    reason="momentum_of_centre",
    section=MOMENTUM,
    group=_IN_SUMMARY[MOMENTUM],
    of_centre=True,
)

angular_momentum_rotation_body = Quantity(
    name="angular_momentum_rotation_body",
    symbol=MOMENTUM_BODY,
    about="angular momentum of the rotation, body components",
    unit="kg m^2/s",
    inputs=("q", "q_dot"),
    shape="vector",
    definition=formula(r"\mathbf{I}'\boldsymbol{\Omega}'"),
    source=SOURCES["Landau 33"],
    value=lambda k: k.momentum_form_body,
    laws=(
        Law(
            formula(r"\mathbf{L}'_R\cdot\boldsymbol{\Omega}' = 2 E_R"),
            lambda k, x: k.read(x).T @ k.omega_body - k.twice_rotational,
        ),
    ),
    reason="tensor_times_velocity",
    section=MOMENTUM,
    group=_IN_SUMMARY[MOMENTUM],
    is_result=True,
)

angular_momentum_rotation = Quantity(
    name="angular_momentum_rotation",
    symbol=MOMENTUM_ROTATION,
    about="angular momentum of the rotation, space components",
    unit="kg m^2/s",
    inputs=("q", "q_dot"),
    shape="vector",
    definition=formula(r"\mathbf{I}\boldsymbol{\Omega}"),
    source=SOURCES["Landau 33"],
    value=lambda k: k.momentum_form,
    laws=(
        Law(
            formula(r"\mathbf{I}\,\boldsymbol{\Omega} = \mathbf{R}\,\mathbf{L}'_R"),
            lambda k, x: k.rotation @ (k.inertia @ k.back) - k.read(x),
        ),
        Law(
            formula(r"\mathbf{L}_R\cdot\boldsymbol{\Omega} = 2 E_R"),
            lambda k, x: k.read(x).T @ k.omega_space - k.twice_rotational,
        ),
        Law(
            formula(r"#1\,\mathbf{x}_i\times\dot{\mathbf{x}}_i = \mathbf{L}_R", _SUM),
            lambda k, x: k.sum(k.x.cross(k.x_dot)) - k.read(x),
        ),
    ),
    reason="momentum_rotated",
    section=MOMENTUM,
    group=_IN_SUMMARY[MOMENTUM],
    is_result=True,
)

angular_momentum = Quantity(
    name="angular_momentum",
    symbol=formula(r"\mathbf{L}"),
    about="angular momentum about the origin, space components",
    unit="kg m^2/s",
    inputs=("q", "q_dot", "centre", "centre_dot"),
    shape="vector",
    definition=formula(r"\mathbf{L}_C + \mathbf{L}_R"),
    source=SOURCES["Goldstein 1.2"],
    value=lambda k: k.present.matrix(k.momentum_of_centre) + k.momentum_form,
    laws=(
        Law(
            formula(
                r"#1\,\mathbf{r}_i\times\dot{\mathbf{r}}_i = \mathbf{L}_C + \mathbf{L}_R", _SUM
            ),
            lambda k, x: k.sum((k.centre + k.x).cross(k.velocity + k.x_dot)) - k.read(x),
        ),
    ),
    reason="momentum_splits",
    section=MOMENTUM,
    group=_IN_SUMMARY[MOMENTUM],
    is_result=True,
    of_centre=True,
)

ENERGY_QUANTITIES = by_name(globals())
